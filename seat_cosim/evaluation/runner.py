"""Runs an evaluation: rides of drivers of different masses on different classes of excitation, and their metrics.

Rides are independent of each other, so several processes share them; the results do not depend on the number of
processes.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from cosim.engine.session import Session
from cosim.errors import CosimError, RunError, SetupError, SignalError
from cosim.metrics import (
    actuator,
    deflection_range,
    end_stops,
    impact_share,
    ride,
    seat_factor,
    weighted,
    weighted_ride,
)
from cosim.metrics.samples import trim
from cosim.results.result import Result
from cosim.sweep.loaded import LoadedSystem
from cosim.sweep.pool import Processes, ThisProcess, WorkerDied
from cosim.system import System
from seat_cosim.evaluation.damping import DampingTest, run_damping_test
from seat_cosim.evaluation.inputs import conformity
from seat_cosim.evaluation.protocol import Protocol, Run
from seat_cosim.evaluation.results import DriverClassResult, Evaluation, RideResult
from seat_cosim.evaluation.system import EvaluatedSystem

Progress = Callable[[int, int], None]
"""Called with the number of jobs that are done and the number of all jobs."""


class ClassResults(NamedTuple):
    """Results of all drivers on one class.

    Attributes
    ----------
    drivers
        In the order of the protocol's masses.
    warnings
        Warnings of the FMUs, each text once.
    """

    drivers: list[DriverClassResult]
    warnings: list[str]


def check(evaluated: EvaluatedSystem, protocol: Protocol) -> None:
    """Check all that can be checked before an FMU is loaded.

    Parameters
    ----------
    evaluated
        The system.
    protocol
        Classes, masses and seeds that the system must accept.

    Raises
    ------
    SetupError
        With all problems found: a class, mass or seed out of range, a step size too long for the metrics.
    """
    problems: dict[str, None] = {}
    for excitation_class, mass, seed in _rides_to_check(protocol):
        parameters = evaluated.signals.parameters(excitation_class, mass, seed)
        try:
            evaluated.system.validate(protocol.stop_time, parameters=parameters)
            rate = _sampling_rate(evaluated.system)
            ride(np.zeros(math.ceil(rate) + 1), rate)
        except SetupError as error:
            problems |= dict.fromkeys(error.problems)
        except SignalError as error:
            problems[f"step size: {error}"] = None
    if problems:
        raise SetupError(*problems)


def _rides_to_check(protocol: Protocol) -> Iterator[tuple[str, float, int]]:
    """Yield rides in which each class, each mass and each seed appears."""
    (first_class, *_), (first_mass, *_) = protocol.classes, protocol.masses
    runs = {name: protocol.runs(name) for name in protocol.classes}
    yield from ((name, first_mass, runs[name][0].seed) for name in protocol.classes)
    yield from ((first_class, mass, runs[first_class][0].seed) for mass in protocol.masses)
    yield from ((first_class, first_mass, run.seed) for run in runs[first_class])


def _sampling_rate(system: System) -> float:
    """Return the number of communication steps per second."""
    return 1.0 / system.clock(1.0).step_size


def evaluate(
    systems: Sequence[EvaluatedSystem],
    protocol: Protocol,
    processes: int = 1,
    progress: Progress = lambda done, total: None,
) -> list[Evaluation]:
    """Evaluate systems under the same excitations.

    Parameters
    ----------
    systems
        What is compared.
    protocol
        Classes, drivers and seeds.
    processes
        Number of processes. One is the calling process itself. With more, each process loads the FMUs, and an FMU that
        crashes its process raises an error; a script that calls this function must then guard its main part
        (``if __name__ == "__main__":``), as :mod:`multiprocessing` requires.
    progress
        Called after each job; a job is one class on one system, or a damping test.

    Returns
    -------
    list of Evaluation
        In the order of the systems.

    Raises
    ------
    SetupError
        If something is wrong that can be seen before a run.
    RunError
        If an FMU failed.
    """
    for evaluated in systems:
        check(evaluated, protocol)
    tests: tuple[str | None, ...] = (*protocol.classes, None) if protocol.repeats_inputs else protocol.classes
    task, jobs = _Tests(tuple(systems), protocol), list(product(range(len(systems)), tests))
    waiting, done = deque(jobs), dict[_Job, _Found]()
    pool = ThisProcess(task) if processes == 1 else Processes(task, min(processes, len(jobs)))
    with pool as workers:
        for job, found in workers.run(lambda: waiting.popleft() if waiting else None):
            if isinstance(found, WorkerDied):
                raise RunError("evaluation: expected all rides to end, got a process that an FMU brought down")
            done[job] = found
            progress(len(done), len(jobs))
    by_job = iter([done[job] for job in jobs])
    return [_evaluation(evaluated, protocol, [next(by_job) for _ in tests]) for evaluated in systems]


def _evaluation(evaluated: EvaluatedSystem, protocol: Protocol, jobs: Sequence[_Found]) -> Evaluation:
    """Collect the results of one system."""
    found = [each for each in jobs if isinstance(each, ClassResults)]
    damping = next((each for each in jobs if isinstance(each, DampingTest)), None)
    results = {
        (excitation_class, mass): result
        for excitation_class, (drivers, _) in zip(protocol.classes, found, strict=True)
        for mass, result in zip(protocol.masses, drivers, strict=True)
    }
    warnings = dict.fromkeys(text for _, texts in found for text in texts)
    return Evaluation(evaluated, results, list(warnings), damping)


_Job = tuple[int, str | None]
"""Place of a system and a class, or None for the damping test."""

_Found = ClassResults | DampingTest | None


class _Tests(NamedTuple):
    """What the workers of an evaluation do.

    Attributes
    ----------
    systems, protocol
        As given.
    """

    systems: tuple[EvaluatedSystem, ...]
    protocol: Protocol

    def __call__(self, loaded: LoadedSystem, job: _Job) -> _Found:
        """Run the rides of a class, or the damping test."""
        place, excitation_class = job
        evaluated = self.systems[place]
        session = loaded.session(evaluated.system)
        if excitation_class is None:
            return damping_of(evaluated, session)
        return ride_class(evaluated, excitation_class, self.protocol, session)


def ride_class(evaluated: EvaluatedSystem, excitation_class: str, protocol: Protocol, session: Session) -> ClassResults:
    """Run the rides of all drivers on one class.

    Parameters
    ----------
    evaluated
        The system.
    excitation_class
        Name of the class.
    protocol
        Drivers, seeds and times.
    session
        Of the system.

    Raises
    ------
    RunError
        If an FMU failed; names the ride.
    """
    results: list[DriverClassResult] = []
    warnings: dict[str, None] = {}
    for mass in protocol.masses:
        rides = []
        for run in protocol.runs(excitation_class):
            try:
                found, texts = _ride(session, evaluated, protocol, (excitation_class, mass, run))
            except CosimError as error:
                where = f"{evaluated.title}, {excitation_class}, {mass:g} kg, seed {run.seed}"
                raise RunError(f"{where}: {error}") from error
            rides.append(found)
            warnings |= dict.fromkeys(texts)
        results.append(DriverClassResult(tuple(rides)))
    return ClassResults(results, list(warnings))


def damping_of(evaluated: EvaluatedSystem, session: Session) -> DampingTest | None:
    """Run the damping test of a system.

    Parameters
    ----------
    evaluated
        The system.
    session
        Of the system.

    Raises
    ------
    RunError
        If an FMU failed; names the test.
    """
    try:
        return run_damping_test(evaluated, session, _sampling_rate(evaluated.system))
    except CosimError as error:
        raise RunError(f"{evaluated.title}, damping test: {error}") from error


def _ride(
    session: Session, evaluated: EvaluatedSystem, protocol: Protocol, which: tuple[str, float, Run]
) -> tuple[RideResult, Sequence[str]]:
    """Run one ride of a class, mass and run; returns its metrics and the warnings of the FMUs."""
    signals, rate = evaluated.signals, _sampling_rate(evaluated.system)
    excitation_class, mass, run = which
    parameters = signals.parameters(excitation_class, mass, run.seed)
    if signals.noise_seed is not None and run.repetition:
        parameters[signals.noise_seed] = evaluated.sensor_seed + run.repetition
    result = session.run(protocol.stop_time, parameters=parameters, record=list(signals.outputs))
    if result.error is not None:
        raise result.error
    found = measure(evaluated, result, rate, protocol.warm_up)
    floor = evaluated.in_si_units(signals.floor_acceleration, result[signals.floor_acceleration])
    fits = conformity(excitation_class, floor, rate, protocol.warm_up)
    return replace(found, conformity=fits, run=run), result.warnings


def measure(evaluated: EvaluatedSystem, result: Result, rate: float, warm_up: float) -> RideResult:
    """Compute the metrics of one ride.

    Parameters
    ----------
    evaluated
        The system that was run.
    result
        Result with all outputs of the system's signal map.
    rate
        Number of rows per second.
    warm_up
        Time at the beginning that is not evaluated, in s.

    Raises
    ------
    SignalError
        If a signal is not finite, or the floor does not move.
    """
    signals = evaluated.signals
    samples = {name: evaluated.in_si_units(name, result[name]) for name in signals.outputs}
    driver = weighted(samples[signals.seat_acceleration], rate, warm_up)
    found = RideResult(
        seat=weighted_ride(driver, rate),
        floor=ride(samples[signals.floor_acceleration], rate, warm_up),
    )
    seat_factor(found.seat, found.floor)
    if signals.suspension_deflection is None:
        return found
    deflection = samples[signals.suspension_deflection]
    remaining = trim(deflection, rate, warm_up, name="deflection")
    found = replace(
        found,
        peak_deflection=deflection_range(deflection, rate, warm_up).peak,
        mean_deflection=float(remaining.mean()),
    )
    if (travel := evaluated.end_stop_travel) is not None:
        where = (travel, warm_up, evaluated.end_stop_height)
        found = replace(
            found,
            end_stop_hits=end_stops(deflection, rate, *where).hits,
            impact_share=impact_share(driver, deflection, rate, *where),
        )
    if signals.actuator_force is None:
        return found
    force = samples[signals.actuator_force]
    spent = actuator(force, deflection, rate, warm_up)
    if (limit := evaluated.force_limit) is not None:
        found = replace(found, saturated_share=time_at(limit, trim(force, rate, warm_up, name="force")))
    return replace(found, force_rms=spent.force_rms, driving_power=spent.power_positive)


def time_at(limit: float, force: np.ndarray[Any, Any]) -> float:
    """Return the share of the samples in which a force is at its limit.

    Parameters
    ----------
    limit
        Largest magnitude in N.
    force
        Force in N, shape (samples,).

    Examples
    --------
    >>> time_at(250.0, np.array([0.0, 250.0, -250.0, 249.0]))
    0.5
    """
    return float(np.mean(np.abs(force) >= limit * (1.0 - 1e-9)))
