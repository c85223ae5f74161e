"""Schedule of a run: which components step when, in which groups; the steppers in C and in Python follow it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np

from cosim.engine.clock import Clock
from cosim.errors import Problems, SetupError
from cosim.fmi.isolated import AnyInstance


class Decimation(NamedTuple):
    """How a component steps along with the communication steps.

    Attributes
    ----------
    factor
        It steps at every factor-th tick ...
    substeps
        ... in so many substeps, its inputs held; one of the two is 1.
    step_size
        Of one substep, in s.
    start_time
        Of the run, in s.
    """

    factor: int
    substeps: int
    step_size: float
    start_time: float = 0.0

    def time(self, tick: int, substep: int = 0) -> float:
        """Return when a substep begins, in s: by a product, so that rounding errors do not add up."""
        return self.start_time + (tick // self.factor * self.substeps + substep) * self.step_size

    def stop_time(self, clock: Clock) -> float:
        """Return the stop time to announce to the component, in s: not before the end of its last step.

        A step ends where the sum of its begin and its length is rounded to, an ulp past the clock's stop time at times.
        """
        begin = self.time(clock.steps - self.factor, self.substeps - 1)
        return max(clock.stop_time, begin + self.step_size)


def decimations(component_steps: Mapping[str, float], components: Sequence[str], clock: Clock) -> dict[str, Decimation]:
    """Derive how each component steps.

    Parameters
    ----------
    component_steps
        Component to its own step size in s; all others have the clock's.
    components
        All of them.
    clock
        Of the run.

    Returns
    -------
    dict
        Component to its decimation.

    Raises
    ------
    SetupError
        If a step size is neither a multiple nor a whole part of the clock's, or does not fit into the run: no component
        steps past the stop time.
    """
    found = {name: Decimation(1, 1, clock.step_size, clock.start_time) for name in components}
    problems = Problems()
    for name, step in component_steps.items():
        with problems.collected():
            if name not in found:
                raise SetupError(f"step size of {name}: expected a component among {', '.join(components)}")
            found[name] = _decimation(name, step, clock)
    problems.raise_any()
    return found


def _decimation(name: str, step: float, clock: Clock) -> Decimation:
    h = clock.step_size
    if not 0.0 < step < math.inf:
        raise SetupError(f"step size of {name}: expected a finite number of seconds above 0, got {step}")
    factor, substeps = max(1, round(step / h)), max(1, round(h / step))
    if abs(factor * h - substeps * step) > 1e-9 * max(step, h):
        raise SetupError(f"step size of {name}: expected a multiple or a whole part of {h} s, got {step} s")
    if clock.steps % factor:
        raise SetupError(f"step size of {name}: expected one that fits into {clock.steps * h:g} s, got {step} s")
    return Decimation(factor, substeps, step, clock.start_time)


@dataclass(frozen=True)
class ScheduledComponent:
    """A component of a schedule.

    Attributes
    ----------
    instance
        What steps.
    decimation
        How it steps along with the communication steps.
    """

    instance: AnyInstance
    decimation: Decimation


@dataclass(frozen=True)
class Schedule:
    """Which components step when.

    Attributes
    ----------
    components
        In the order in which they step.
    jacobi
        Whether all components exchange values at once, rather than one after the other.
    clock
        Of the run.
    values
        Values of all outputs, float64, and of constants behind them.
    names
        Names of these outputs, as ``component.element``.
    """

    components: Sequence[ScheduledComponent]
    jacobi: bool
    clock: Clock
    values: np.ndarray[Any, Any]
    names: Sequence[str]

    @property
    def groups(self) -> list[Sequence[ScheduledComponent]]:
        """Components that exchange values at once; in a sequence each is a group of its own."""
        return [self.components] if self.jacobi else [[component] for component in self.components]


class Stepper(Protocol):
    """Steps the components of a schedule, run after run; each run starts with :meth:`begin`."""

    done: int
    """Number of ticks that are complete."""

    def begin(self) -> None:
        """Begin a run: no tick is complete, and no call has returned a warning."""

    def run(self, first: int, last: int) -> None:
        """Step from one tick to another and record.

        Parameters
        ----------
        first, last
            Ticks.

        Raises
        ------
        RunError
            If an FMU refuses a call or an output is not finite; ``done`` says how far it came.
        """
