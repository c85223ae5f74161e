"""Runs an evaluation: rides of drivers of different masses on different classes of excitation, and their metrics.

Rides are independent of each other, so several processes share them; the results do not depend on the number of
processes.
"""

from __future__ import annotations

import math
import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from itertools import product
from typing import NamedTuple

import numpy as np

from cosim.engine.session import Session
from cosim.errors import CosimError, RunError, SetupError, SignalError
from cosim.metrics import actuator, deflection_range, end_stops, ride, seat_factor
from cosim.results.result import Result
from cosim.system import System
from seat_cosim.evaluation.protocol import Protocol
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
    (first_class, *_), (first_mass, *_), (first_seed, *_) = protocol.classes, protocol.masses, protocol.seeds
    yield from ((name, first_mass, first_seed) for name in protocol.classes)
    yield from ((first_class, mass, first_seed) for mass in protocol.masses)
    yield from ((first_class, first_mass, seed) for seed in protocol.seeds)


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
        Called after each job; a job is one class on one system.

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
    jobs = list(product(systems, protocol.classes))
    if processes == 1:
        done = _run_here(jobs, protocol, progress)
    else:
        done = _run_in_processes(jobs, protocol, processes, progress)
    by_job = iter(done)
    return [_evaluation(evaluated, protocol, [next(by_job) for _ in protocol.classes]) for evaluated in systems]


def _evaluation(evaluated: EvaluatedSystem, protocol: Protocol, found: Sequence[ClassResults]) -> Evaluation:
    """Collect the results of one system."""
    results = {
        (excitation_class, mass): result
        for excitation_class, (drivers, _) in zip(protocol.classes, found, strict=True)
        for mass, result in zip(protocol.masses, drivers, strict=True)
    }
    warnings = dict.fromkeys(text for _, texts in found for text in texts)
    return Evaluation(evaluated, results, list(warnings))


_Job = tuple[EvaluatedSystem, str]


def _run_here(jobs: Sequence[_Job], protocol: Protocol, progress: Progress) -> list[ClassResults]:
    done = []
    for number, job in enumerate(jobs, 1):
        done.append(ride_class(*job, protocol))
        progress(number, len(jobs))
    return done


def _run_in_processes(
    jobs: Sequence[_Job], protocol: Protocol, processes: int, progress: Progress
) -> list[ClassResults]:
    """Run jobs in spawned processes: threads of an FMU do not survive a fork."""
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


def ride_class(evaluated: EvaluatedSystem, excitation_class: str, protocol: Protocol) -> ClassResults:
    """Run the rides of all drivers on one class, with the FMUs loaded once.

    Parameters
    ----------
    evaluated
        The system.
    excitation_class
        Name of the class.
    protocol
        Drivers, seeds and times.

    Raises
    ------
    RunError
        If an FMU failed; names the ride.
    """
    results: list[DriverClassResult] = []
    warnings: dict[str, None] = {}
    with evaluated.system.open() as session:
        for mass in protocol.masses:
            rides = []
            for seed in protocol.seeds:
                try:
                    found, texts = _ride(session, evaluated, protocol, (excitation_class, mass, seed))
                except CosimError as error:
                    where = f"{evaluated.title}, {excitation_class}, {mass:g} kg, seed {seed}"
                    raise RunError(f"{where}: {error}") from error
                rides.append(found)
                warnings |= dict.fromkeys(texts)
            results.append(DriverClassResult(tuple(rides)))
    return ClassResults(results, list(warnings))


def _ride(
    session: Session, evaluated: EvaluatedSystem, protocol: Protocol, which: tuple[str, float, int]
) -> tuple[RideResult, Sequence[str]]:
    """Run one ride of a class, mass and seed; returns its metrics and the warnings of the FMUs."""
    signals = evaluated.signals
    result = session.run(protocol.stop_time, parameters=signals.parameters(*which), record=list(signals.outputs))
    if result.error is not None:
        raise result.error
    return measure(evaluated, result, _sampling_rate(evaluated.system), protocol.warm_up), result.warnings


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
    found = RideResult(
        seat=ride(samples[signals.seat_acceleration], rate, warm_up),
        floor=ride(samples[signals.floor_acceleration], rate, warm_up),
    )
    seat_factor(found.seat, found.floor)
    if signals.suspension_deflection is None:
        return found
    deflection = samples[signals.suspension_deflection]
    found = replace(found, peak_deflection=deflection_range(deflection, rate, warm_up).peak)
    if (travel := evaluated.end_stop_travel) is not None:
        found = replace(
            found, end_stop_hits=end_stops(deflection, rate, travel, warm_up, evaluated.end_stop_height).hits
        )
    if signals.actuator_force is None:
        return found
    spent = actuator(samples[signals.actuator_force], deflection, rate, warm_up)
    return replace(found, force_rms=spent.force_rms, driving_power=spent.power_positive)
