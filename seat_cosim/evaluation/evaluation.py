"""What a seat does for drivers of different masses on different machines: any system, by the names of its signals.

Each driver rides each class of excitation several times, with other seeds. Runs are independent, so they go to several
processes, with the same numbers whatever their count.
"""

from __future__ import annotations

import math
import multiprocessing
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np

from cosim.errors import CosimError, RunError, SetupError, SignalError
from cosim.metrics import Ride, actuator, daily_vdv, deflection_range, end_stops, ride, seat_factor
from cosim.results.result import Result
from cosim.system import System
from seat_cosim.evaluation.system import EvaluatedSystem

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

SPREAD = 0.05
"""Runs repeat each other where each SEAT is within this share of their mean (ISO 10326-1: three runs)."""


@dataclass(frozen=True)
class Protocol:
    """How it is evaluated.

    Attributes
    ----------
    classes
        Names of the excitation's classes.
    masses
        Drivers', in kg.
    seeds
        One run each.
    duration, settle
        What is evaluated of a run, and what is left out before it, in s.
    """

    classes: tuple[str, ...] = tuple(SEAT_LIMITS)
    masses: tuple[float, ...] = (45.0, 55.0, 70.0, 80.0, 100.0, 120.0)
    seeds: tuple[int, ...] = (1, 2, 3)
    duration: float = 180.0
    settle: float = 10.0

    def __post_init__(self) -> None:
        problems = [
            f"{name}: expected each once, got {', '.join(map(str, values)) or 'none'}"
            for name, values in (("classes", self.classes), ("masses", self.masses), ("seeds", self.seeds))
            if not values or len(set(values)) < len(values)
        ]
        if not (math.isfinite(self.duration) and self.duration >= 1.0):
            problems.append(f"duration: expected at least 1 s, over which MTVV is taken, got {self.duration:g} s")
        if not (math.isfinite(self.settle) and self.settle >= 0.0):
            problems.append(f"settle: expected at least 0 s, got {self.settle:g} s")
        if problems:
            raise SetupError(*problems)


@dataclass(frozen=True)
class Run:
    """One ride of one driver; ``peak`` in m, ``force`` and ``power`` in N and W, None where there is no such signal."""

    seat: Ride
    floor: Ride
    peak: float | None = None
    hits: int | None = None
    force: float | None = None
    power: float | None = None

    @property
    def seat_rms(self) -> float:
        """SEAT by a_w."""
        return seat_factor(self.seat, self.floor).rms

    @property
    def seat_vdv(self) -> float:
        """SEAT by VDV."""
        return seat_factor(self.seat, self.floor).vdv


@dataclass(frozen=True)
class Cell:
    """All rides of one driver on one class; numbers are means over the runs unless they say otherwise."""

    runs: tuple[Run, ...]

    def mean(self, number: Callable[[Run], float | None]) -> float | None:
        """Average over the runs; None where there is no such number."""
        values = [number(run) for run in self.runs]
        found = [value for value in values if value is not None]
        return sum(found) / len(found) if found else None

    @property
    def seat(self) -> float:
        """SEAT by a_w."""
        return sum(run.seat_rms for run in self.runs) / len(self.runs)

    @property
    def a_w(self) -> float:
        """Weighted acceleration of the driver, in m/s2."""
        return sum(run.seat.a_w for run in self.runs) / len(self.runs)

    @property
    def spread(self) -> float:
        """Largest distance of a run's SEAT from the mean, as a share of it."""
        return max(abs(run.seat_rms / self.seat - 1.0) for run in self.runs) if self.seat else 0.0

    @property
    def repeats(self) -> bool:
        """Whether the runs are as many and as close as ISO 10326-1 asks for."""
        return len(self.runs) >= 3 and self.spread <= SPREAD * (1.0 + 1e-9)

    @property
    def peak(self) -> float | None:
        """Largest deflection of all runs, in m."""
        return max((run.peak for run in self.runs if run.peak is not None), default=None)

    @property
    def hits(self) -> int | None:
        """Contacts with the end stops in all runs together."""
        found = [run.hits for run in self.runs if run.hits is not None]
        return sum(found) if found else None


@dataclass(frozen=True)
class Column:
    """A column of the table: its key in files, title and unit on pages, decimals, and where the number comes from.

    ``value`` gives the number in SI units, ``factor`` leads from there to ``unit``.
    """

    key: str
    title: str
    unit: str
    digits: int
    value: Callable[[Cell], float | None]
    factor: float = 1.0

    def number(self, cell: Cell) -> float | None:
        """Return a cell's number in the column's unit."""
        value = self.value(cell)
        return None if value is None else self.factor * value


COLUMNS = (
    Column("seat", "SEAT", "1", 2, lambda cell: cell.seat),
    Column("seat_vdv", "SEAT by VDV", "1", 2, lambda cell: cell.mean(lambda run: run.seat_vdv)),
    Column("spread", "spread of runs", "%", 1, lambda cell: cell.spread, 100.0),
    Column("a_w", "a_w", "m/s²", 2, lambda cell: cell.a_w),
    Column(
        "vdv_8h",
        "VDV in 8 h",
        "m/s^1.75",
        1,
        lambda cell: cell.mean(lambda run: daily_vdv(run.seat.vdv, run.seat.duration)),
    ),
    Column("mtvv", "MTVV", "m/s²", 2, lambda cell: cell.mean(lambda run: run.seat.mtvv)),
    Column("peak_deflection", "largest deflection", "mm", 0, lambda cell: cell.peak, 1e3),
    Column("end_stop_hits", "end-stop hits", "1", 0, lambda cell: cell.hits),
    Column("force_rms", "force, RMS", "N", 0, lambda cell: cell.mean(lambda run: run.force)),
    Column("power", "power, driving", "W", 1, lambda cell: cell.mean(lambda run: run.power)),
)
"""What the table has of a cell."""


@dataclass(frozen=True)
class Evaluation:
    """All rides of one subject.

    Attributes
    ----------
    subject
        What was evaluated.
    cells
        By class and driver's mass in kg, class after class.
    warnings
        What its FMUs said, each text once.
    """

    subject: EvaluatedSystem
    cells: Mapping[tuple[str, float], Cell]
    warnings: list[str] = field(default_factory=list)


def check(subject: EvaluatedSystem, protocol: Protocol) -> None:
    """Check all that can be checked before an FMU is loaded.

    Raises
    ------
    SetupError
        With all problems found: a class, mass or seed out of range, a step size too long for the metrics.
    """
    problems: dict[str, None] = {}
    rides = [
        *((kind, protocol.masses[0], protocol.seeds[0]) for kind in protocol.classes),
        *((protocol.classes[0], mass, protocol.seeds[0]) for mass in protocol.masses),
        *((protocol.classes[0], protocol.masses[0], seed) for seed in protocol.seeds),
    ]
    for each in rides:
        try:
            subject.system.validate(protocol.settle + protocol.duration, parameters=subject.ports.parameters(*each))
            ride(np.zeros(math.ceil(_rate(subject.system)) + 1), _rate(subject.system))
        except SetupError as error:
            problems |= dict.fromkeys(error.problems)
        except SignalError as error:
            problems[f"step size: {error}"] = None
    if problems:
        raise SetupError(*problems)


def _rate(system: System) -> float:
    return 1.0 / system.clock(1.0).step_size


def evaluate(
    subjects: Sequence[EvaluatedSystem],
    protocol: Protocol,
    processes: int = 1,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> list[Evaluation]:
    """Let all drivers ride all classes with all seeds, on each of the subjects.

    Parameters
    ----------
    subjects
        What is compared; each meets the same excitations.
    protocol
        How.
    processes
        How many share the work. With one it is done here; with more, each has its own FMUs, and one that brings its
        process down ends in an error. A script that asks for more than one has to guard its main part
        (``if __name__ == "__main__":``), as always with processes.
    progress
        Called with the parts of the work that are done, and their number.

    Returns
    -------
    list of Evaluation
        In the order of the subjects.

    Raises
    ------
    SetupError
        If something is wrong that can be seen before a run.
    RunError
        If an FMU failed.
    """
    for subject in subjects:
        check(subject, protocol)
    jobs = list(product(subjects, protocol.classes))
    done = _here(jobs, protocol, progress) if processes == 1 else _spread(jobs, protocol, processes, progress)
    found = []
    for number, subject in enumerate(subjects):
        parts = done[number * len(protocol.classes) : (number + 1) * len(protocol.classes)]
        cells = {
            (kind, mass): cell
            for kind, (row, _) in zip(protocol.classes, parts, strict=True)
            for mass, cell in zip(protocol.masses, row, strict=True)
        }
        warnings = dict.fromkeys(text for _, texts in parts for text in texts)
        found.append(Evaluation(subject, cells, list(warnings)))
    return found


_Job = tuple[EvaluatedSystem, str]
_Done = tuple[list[Cell], list[str]]


def _here(jobs: Sequence[_Job], protocol: Protocol, progress: Callable[[int, int], None]) -> list[_Done]:
    done = []
    for number, job in enumerate(jobs, 1):
        done.append(ride_class(*job, protocol))
        progress(number, len(jobs))
    return done


def _spread(
    jobs: Sequence[_Job], protocol: Protocol, processes: int, progress: Callable[[int, int], None]
) -> list[_Done]:
    """Do the jobs in processes of their own, each begun afresh: an FMU's threads do not survive a fork."""
    with ProcessPoolExecutor(processes, multiprocessing.get_context("spawn")) as pool:
        futures = [pool.submit(ride_class, *job, protocol) for job in jobs]
        try:
            for number, future in enumerate(as_completed(futures), 1):
                future.result()
                progress(number, len(jobs))
        except BrokenProcessPool:
            raise RunError("evaluation: expected all rides to end, got a process that an FMU brought down") from None
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
        return [future.result() for future in futures]


def ride_class(subject: EvaluatedSystem, kind: str, protocol: Protocol) -> _Done:
    """Let all drivers ride one class, with the FMUs loaded once.

    Returns
    -------
    list of Cell
        By driver.
    list of str
        What the FMUs said, each text once.

    Raises
    ------
    RunError
        If an FMU failed; says in which ride.
    """
    signals = list(subject.ports.signals)
    rate = _rate(subject.system)
    cells: list[Cell] = []
    warnings: dict[str, None] = {}
    with subject.system.open() as session:
        for mass in protocol.masses:
            runs = []
            for seed in protocol.seeds:
                where = f"{subject.title}, {kind}, {mass:g} kg, seed {seed}"
                try:
                    result = session.run(
                        protocol.settle + protocol.duration,
                        parameters=subject.ports.parameters(kind, mass, seed),
                        record=signals,
                    )
                    if result.error is not None:
                        raise result.error
                    runs.append(measure(subject, result, rate, protocol.settle))
                except CosimError as error:
                    raise RunError(f"{where}: {error}") from error
                warnings |= dict.fromkeys(result.warnings)
            cells.append(Cell(tuple(runs)))
    return cells, list(warnings)


def measure(subject: EvaluatedSystem, result: Result, rate: float, settle: float) -> Run:
    """Take the metrics of one ride.

    Parameters
    ----------
    subject
        Whose ride.
    result
        With all signals of the subject's ports.
    rate
        Rows per second.
    settle
        What to leave out at the beginning, in s.

    Raises
    ------
    SignalError
        If a signal is not finite, or the floor rests.
    """
    ports = subject.ports
    samples = {name: subject.converted(name, result[name]) for name in ports.signals}
    found = Run(ride(samples[ports.seat], rate, settle), ride(samples[ports.floor], rate, settle))
    seat_factor(found.seat, found.floor)
    if ports.deflection is None:
        return found
    deflection = samples[ports.deflection]
    found = replace(found, peak=deflection_range(deflection, rate, settle).peak)
    if subject.travel is not None:
        found = replace(found, hits=end_stops(deflection, rate, subject.travel, settle).hits)
    if ports.force is None:
        return found
    spent = actuator(samples[ports.force], deflection, rate, settle)
    return replace(found, force=spent.force_rms, power=spent.power_positive)
