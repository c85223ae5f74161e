"""Protocols of an evaluation: classes of excitation, drivers, and test runs."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from cosim.errors import SetupError
from seat_cosim.evaluation.inputs import INPUTS
from seat_cosim.evaluation.system import Road
from seat_cosim.scenarios import ROADS

MAX_SPREAD = 0.05
"""Largest deviation of a test run's SEAT from the mean of the runs, as a share of the mean (ISO 10326-1)."""

MIN_RUNS = 3
"""Smallest number of test runs (ISO 10326-1)."""

REALIZATIONS = 3
"""Number of realizations of each class in a survey."""

CLASSES = tuple(name for name, each in INPUTS.items() if each.standard == "ISO 7096")
"""Classes of ISO 7096."""

ROAD_CLASSES = tuple(str(Road(name, speed)) for name in ROADS for speed in (30.0, 60.0, 90.0))
"""Roads of ISO 8608 at speeds in km/h."""

LIGHT, HEAVY = (52.0, 55.0), (98.0, 103.0)
"""Ranges of the mass of the two test persons of ISO 7096, in kg; *recalled*."""

ISO_7096 = "iso7096"
SURVEY = "survey"
"""Names of the protocols."""


class Run(NamedTuple):
    """A run of a driver on a class.

    Attributes
    ----------
    seed
        Seed of the excitation.
    repetition
        How often the same input was ridden before.
    """

    seed: int
    repetition: int = 0


@dataclass(frozen=True)
class Protocol:
    """Protocol of an evaluation: each driver rides each class several times.

    Attributes
    ----------
    classes
        Names of the excitation's classes.
    masses
        Masses of the drivers, in kg.
    seeds
        Seeds of the excitation; empty for those of :data:`seat_cosim.evaluation.inputs.INPUTS` that conform.
    repetitions
        Number of runs on each seed.
    duration
        Evaluated time of a ride, in s; at least 1 s.
    warm_up
        Time before it that is not evaluated, in s.
    name
        ``survey`` or ``iso7096``.

    Raises
    ------
    SetupError
        If a list is empty or names something twice, or a number is out of range.

    Examples
    --------
    >>> Protocol(classes=("EM3",), duration=60.0).stop_time
    70.0
    >>> [run.repetition for run in iso7096(classes=("EM3",)).runs("EM3")]
    [0, 1, 2]
    """

    classes: tuple[str, ...] = CLASSES
    masses: tuple[float, ...] = (45.0, 55.0, 70.0, 80.0, 100.0, 120.0)
    seeds: tuple[int, ...] = ()
    repetitions: int = 1
    duration: float = 180.0
    warm_up: float = 10.0
    name: str = SURVEY

    def __post_init__(self) -> None:
        """Check all fields."""
        problems = [
            f"{name}: expected each once, got {', '.join(map(str, values)) or 'none'}"
            for name, values in (("classes", self.classes), ("masses", self.masses), ("seeds", self.seeds or (1,)))
            if not values or len(set(values)) < len(values)
        ]
        if self.repeats_inputs and len(self.seeds) > 1:
            problems.append(
                f"seeds: expected one, as protocol {self.name} repeats one input, got {', '.join(map(str, self.seeds))}"
            )
        if self.repetitions < 1:
            problems.append(f"repetitions: expected at least 1, got {self.repetitions}")
        if not (math.isfinite(self.duration) and self.duration >= 1.0):
            problems.append(f"duration: expected at least 1 s, over which MTVV is taken, got {self.duration:g} s")
        if not (math.isfinite(self.warm_up) and self.warm_up >= 0.0):
            problems.append(f"warm-up: expected at least 0 s, got {self.warm_up:g} s")
        if problems:
            raise SetupError(*problems)

    @property
    def repeats_inputs(self) -> bool:
        """Whether the runs repeat one input and there is a damping test, as in ISO 7096; a survey varies the input."""
        return self.name == ISO_7096

    @property
    def stop_time(self) -> float:
        """Simulated time of a ride, in s."""
        return self.warm_up + self.duration

    def runs(self, excitation_class: str) -> list[Run]:
        """Return the runs of each driver on a class.

        Parameters
        ----------
        excitation_class
            Name of the class.
        """
        known = INPUTS.get(excitation_class)
        seeds = self.seeds or (known.seeds if known else tuple(range(1, REALIZATIONS + 1)))
        seeds = seeds[:1] if self.repeats_inputs else seeds if self.seeds else seeds[:REALIZATIONS]
        return [Run(seed, repetition) for seed in seeds for repetition in range(self.repetitions)]

    @property
    def has_both_persons(self) -> bool:
        """Whether a light and a heavy person of ISO 7096 are among the drivers."""
        return all(any(low <= mass <= high for mass in self.masses) for low, high in (LIGHT, HEAVY))


def survey(**given: Any) -> Protocol:
    """Return a survey: six drivers, and realizations of each class that conform.

    Parameters
    ----------
    **given
        Fields of :class:`Protocol` that differ.
    """
    return Protocol(**given)


def iso7096(**given: Any) -> Protocol:
    """Return the protocol of ISO 7096: a light and a heavy person, one conforming input that is ridden three times.

    Parameters
    ----------
    **given
        Fields of :class:`Protocol` that differ.
    """
    return replace(Protocol(masses=(55.0, 100.0), repetitions=MIN_RUNS, name=ISO_7096), **given)


PROTOCOLS: dict[str, Callable[..., Protocol]] = {ISO_7096: iso7096, SURVEY: survey}
"""Name of a protocol to what makes it."""

EDITIONS = {
    ISO_7096: "ISO 7096:2020 after ISO 10326-1:2016, as far as it is public; numbers recalled from earlier editions",
    SURVEY: "a survey over drivers and realizations; no test of a standard",
}
"""Name of a protocol to the edition of its standard."""
