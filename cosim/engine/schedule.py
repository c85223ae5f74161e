"""Plan of a run: who steps when and with whom. The loops in C and in Python turn the same plan."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np

from cosim.engine.clock import Clock
from cosim.errors import SetupError
from cosim.fmi.isolated import AnyInstance


class Decimation(NamedTuple):
    """How a component steps along with the communication steps.

    Attributes
    ----------
    every
        It steps at every n-th tick ...
    parts
        ... in so many parts, its inputs held; one of the two is 1.
    step_size
        Of one part, in s.
    """

    every: int
    parts: int
    step_size: float

    def time(self, tick: int, part: int = 0) -> float:
        """Return when a part begins, in s: a product, so that rounding errors do not add up."""
        return (tick // self.every * self.parts + part) * self.step_size


def decimations(component_steps: Mapping[str, float], components: Sequence[str], clock: Clock) -> dict[str, Decimation]:
    """Find out how each component steps.

    Parameters
    ----------
    component_steps
        Component to its own step size in s; all others have the clock's.
    components
        All of them.
    clock
        Of the run.

    Raises
    ------
    SetupError
        If a step size neither holds a whole number of the clock's nor the other way round, or does not fit into the
        run: nothing steps past the stop.
    """
    found = {name: Decimation(1, 1, clock.step_size) for name in components}
    problems: list[str] = []
    for name, step in component_steps.items():
        try:
            if name not in found:
                raise SetupError(f"step size of {name}: expected a component among {', '.join(components)}")
            found[name] = _rate(name, step, clock)
        except SetupError as error:
            problems += error.problems
    if problems:
        raise SetupError(*problems)
    return found


def _rate(name: str, step: float, clock: Clock) -> Decimation:
    """Find out how a component of a step size of its own, in s, steps."""
    h = clock.step_size
    if not 0.0 < step < math.inf:
        raise SetupError(f"step size of {name}: expected a finite number of seconds above 0, got {step}")
    every, parts = max(1, round(step / h)), max(1, round(h / step))
    if abs(every * h - parts * step) > 1e-9 * max(step, h):
        raise SetupError(f"step size of {name}: expected a multiple or a whole part of {h} s, got {step} s")
    if clock.steps % every:
        raise SetupError(f"step size of {name}: expected one that fits into {clock.stop_time:g} s, got {step} s")
    return Decimation(every, parts, step)


@dataclass(frozen=True)
class ScheduledComponent:
    """A component in its turn."""

    instance: AnyInstance
    rate: Decimation


@dataclass(frozen=True)
class Schedule:
    """Who steps when.

    Attributes
    ----------
    turns
        Components in their order.
    at_once
        Whether all exchange values at once, rather than one after the other.
    clock
        When.
    table
        Values of all outputs, float64.
    names
        What stands in the table.
    """

    components: Sequence[ScheduledComponent]
    jacobi: bool
    clock: Clock
    table: np.ndarray[Any, Any]
    names: Sequence[str]

    @property
    def groups(self) -> list[Sequence[ScheduledComponent]]:
        """Who exchanges values with nobody in between: in a sequence, each is a group of its own."""
        return [self.components] if self.jacobi else [[component] for component in self.components]


class Stepper(Protocol):
    """Turns the crank of a plan, run after run; each begins with :meth:`settle`."""

    done: int
    """Number of ticks that are complete."""

    def settle(self) -> None:
        """Pass initial outputs along the connections until they settle.

        Raises
        ------
        RunError
            If an FMU refuses a call.
        """

    def read(self) -> None:
        """Read all outputs; raises as :meth:`settle` does."""

    def run(self, first: int, last: int) -> None:
        """Step from one tick to another, recording.

        Raises
        ------
        RunError
            If an FMU refuses a call or gives what is no number; ``done`` says how far it came.
        """
