"""Algorithm: who steps when. Time is an integer tick; what is recorded is the observers' business."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol

from cosim.errors import RunError, SetupError
from cosim.instance import Instance


@dataclass(frozen=True)
class Clock:
    """Equidistant communication points t_k = k h, k = 0 ... steps.

    Attributes
    ----------
    step_size
        h, in s.
    steps
        Number of steps N; the run ends at N h.
    """

    step_size: float
    steps: int

    @classmethod
    def until(cls, stop_time: float, step_size: float) -> Clock:
        """Make the clock of a run.

        Raises
        ------
        SetupError
            If a time is not positive and finite, or the stop time is no multiple of the step size.
        """
        problems = [
            f"{name}: expected a finite number of seconds above 0, got {value}"
            for name, value in (("step size", step_size), ("stop time", stop_time))
            if not 0.0 < value < math.inf
        ]
        if problems:
            raise SetupError(*problems)
        steps = round(stop_time / step_size)
        if steps < 1 or abs(steps * step_size - stop_time) > 1e-9 * stop_time:
            raise SetupError(f"stop time: expected a multiple of the step size {step_size} s, got {stop_time} s")
        return cls(step_size, steps)

    def time(self, tick: int) -> float:
        """Return t_k in s: a product, so that rounding errors do not add up."""
        return tick * self.step_size


class Observer(Protocol):
    """Sees a run pass by."""

    def before(self, tick: int) -> None:
        """Look at the values at t_k, before any component has stepped."""

    def after(self, tick: int) -> None:
        """Look at the values after all components have stepped from t_k."""


def gauss_seidel(order: Sequence[Instance], clock: Clock, observers: Iterable[Observer]) -> None:
    """Step the components one after the other, each with the newest outputs of the others.

    Parameters
    ----------
    order
        Instances in their order: what an earlier one computes in this step reaches the later ones without delay, what
        a later one computes reaches the earlier ones in the next step.
    clock
        When.
    observers
        Called before and after every step, in their order.

    Raises
    ------
    RunError
        If an FMU refuses a call; the observers keep what they saw.
    """
    observers = tuple(observers)
    for tick in range(clock.steps):
        for observer in observers:
            observer.before(tick)
        time = clock.time(tick)
        for instance in order:
            try:
                instance.step(time, clock.step_size)
            except RunError:
                raise
            except Exception as error:
                raise instance.failure(error, "step", time) from error
        for observer in observers:
            observer.after(tick)
