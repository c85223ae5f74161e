"""Time of a run: an integer tick."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from cosim.errors import SetupError


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

    @property
    def stop_time(self) -> float:
        """End of the run in s."""
        return self.time(self.steps)


class Pacer:
    """Holds a run to real time: no step begins before its time has come.

    Parameters
    ----------
    clock
        Of the run, which begins now.

    Attributes
    ----------
    missed
        How many steps were not finished when the next was due.
    worst
        By how much at worst, in s.
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._start = time.monotonic()
        self.missed = 0
        self.worst = 0.0

    def wait(self, tick: int) -> None:
        """Wait until t_k has come; the step that ends there is finished."""
        early = self._start + self._clock.time(tick) - time.monotonic()
        if early >= 0.0:
            time.sleep(early)
        elif tick > 0:
            self.missed += 1
            self.worst = max(self.worst, -early)
