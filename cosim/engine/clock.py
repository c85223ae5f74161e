"""Time of a run: an integer tick."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from cosim.errors import SetupError


@dataclass(frozen=True)
class Clock:
    """Equidistant communication points t_k = t_0 + k h, k = 0 ... steps.

    Attributes
    ----------
    step_size
        h, in s.
    steps
        Number of steps N; the run ends at t_0 + N h.
    start_time
        t_0, in s.
    """

    step_size: float
    steps: int
    start_time: float = 0.0

    @classmethod
    def until(cls, stop_time: float, step_size: float, start_time: float = 0.0) -> Clock:
        """Make the clock of a run.

        Parameters
        ----------
        stop_time, step_size, start_time
            In s.

        Raises
        ------
        SetupError
            If a time is not finite, the stop time not after the start time, or the time between them no multiple of the
            step size.
        """
        problems = []
        if not 0.0 < step_size < math.inf:
            problems.append(f"step size: expected a finite number of seconds above 0, got {step_size}")
        if not math.isfinite(start_time):
            problems.append(f"start time: expected a finite number of seconds, got {start_time}")
        elif not start_time < stop_time < math.inf:
            above = f"above the start time, {start_time:g} s" if start_time else "above 0"
            problems.append(f"stop time: expected a finite number of seconds {above}, got {stop_time}")
        if problems:
            raise SetupError(*problems)
        duration = stop_time - start_time
        steps = round(duration / step_size)
        rounding = 1e-9 * duration + 2.0 * math.ulp(max(abs(start_time), abs(stop_time)))
        if steps < 1 or abs(steps * step_size - duration) > rounding:
            after = f" after the start time, {start_time:g} s" if start_time else ""
            raise SetupError(f"stop time: expected a multiple of the step size {step_size} s{after}, got {stop_time} s")
        return cls(step_size, steps, start_time)

    def time(self, tick: int) -> float:
        """Return t_k in s: by a product, so that rounding errors do not add up."""
        return self.start_time + tick * self.step_size

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
        early = self._start + tick * self._clock.step_size - time.monotonic()
        if early >= 0.0:
            time.sleep(early)
        elif tick > 0:
            self.missed += 1
            self.worst = max(self.worst, -early)
