"""Protocol of an evaluation: classes of excitation, drivers, test runs, and the limits of ISO 7096 and ISO 10326-1."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cosim.errors import SetupError

SEAT_LIMITS = {
    "EM1": 1.1,
    "EM2": 0.9,
    "EM3": 1.0,
    "EM4": 1.1,
    "EM5": 0.7,
    "EM6": 0.7,
    "EM7": 0.6,
    "EM8": 0.8,
    "EM9": 0.9,
}
"""Largest SEAT of ISO 7096 by its classes; *recalled*, not read in the standard."""

MAX_SPREAD = 0.05
"""Largest deviation of a test run's SEAT from the mean of the runs, as a share of the mean (ISO 10326-1)."""

MIN_RUNS = 3
"""Smallest number of test runs (ISO 10326-1)."""


def seat_limit(excitation_class: str) -> float | None:
    """Return the largest SEAT that ISO 7096 allows in a class, as recalled; None for a class of another name."""
    return SEAT_LIMITS.get(excitation_class)


@dataclass(frozen=True)
class Protocol:
    """Protocol of an evaluation: each driver rides each class once with each seed.

    Attributes
    ----------
    classes
        Names of the excitation's classes.
    masses
        Masses of the drivers, in kg.
    seeds
        Seeds of the excitation; one ride each.
    duration
        Evaluated time of a ride, in s; at least 1 s.
    warm_up
        Time before it that is not evaluated, in s.

    Raises
    ------
    SetupError
        If a list is empty or names something twice, or a time is out of range.

    Examples
    --------
    >>> Protocol(classes=("EM3",), duration=60.0).stop_time
    70.0
    """

    classes: tuple[str, ...] = tuple(SEAT_LIMITS)
    masses: tuple[float, ...] = (45.0, 55.0, 70.0, 80.0, 100.0, 120.0)
    seeds: tuple[int, ...] = (1, 2, 3)
    duration: float = 180.0
    warm_up: float = 10.0

    def __post_init__(self) -> None:
        """Check all fields."""
        problems = [
            f"{name}: expected each once, got {', '.join(map(str, values)) or 'none'}"
            for name, values in (("classes", self.classes), ("masses", self.masses), ("seeds", self.seeds))
            if not values or len(set(values)) < len(values)
        ]
        if not (math.isfinite(self.duration) and self.duration >= 1.0):
            problems.append(f"duration: expected at least 1 s, over which MTVV is taken, got {self.duration:g} s")
        if not (math.isfinite(self.warm_up) and self.warm_up >= 0.0):
            problems.append(f"warm-up: expected at least 0 s, got {self.warm_up:g} s")
        if problems:
            raise SetupError(*problems)

    @property
    def stop_time(self) -> float:
        """Simulated time of a ride, in s."""
        return self.warm_up + self.duration
