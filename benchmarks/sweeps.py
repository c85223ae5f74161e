"""What a sweep costs: ``python -m benchmarks.sweeps``.

200 runs of 30 s, six recorded signals, metrics of ISO 2631-1, EM1, a mass and a seed for each run: on one worker and on
two, beside fmpy as a user writes it (instances kept and reset, the loop in Python). Rounds take turns; medians and the
quickest. Times count from the first batch that a worker that has loaded its FMUs is given. ``--tasks`` adds what one
task costs, on this machine's processes and on a Dask cluster of two workers, and runs a second against the horizon.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from statistics import median
from time import perf_counter, process_time
from typing import Any, NamedTuple

import click
import numpy as np
from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from benchmarks.masters import H, Plain
from cosim.engine.network import VariableRef
from cosim.metrics import ride, seat_factor
from cosim.sweep.cluster import Cluster
from cosim.sweep.design import Block, Values, Variable
from cosim.sweep.loaded import LoadedSystem
from cosim.sweep.plan import Batch, Plan, Rows, make_plan
from cosim.sweep.pool import Processes, Workers
from cosim.sweep.study import Study
from plant_models.shaker.interface import Profile
from seat_cosim.carried import fmu_folder
from seat_cosim.study import SeatVocabulary

RUNS, STOP_TIME, WARM_UP, BATCH = 200, 30.0, 5.0, 10
SIGNALS = (
    "seat.driver_acceleration",
    "shaker.floor_acceleration",
    "seat.suspension_deflection",
    "controller.force",
    "seat.seat_acceleration",
    "controller.disturbance_estimate",
)
METRICS = ("a_w", "vdv", "mtvv", "crest_factor", "floor_a_w", "seat", "seat_vdv")
HORIZONS = (1.0, 3.0, 10.0, 30.0, 100.0, 300.0)


class Timed(NamedTuple):
    """A plan whose batches come with the time of the processor that they took, which other programs disturb less.

    Attributes
    ----------
    plan
        The plan.
    """

    plan: Plan

    def __call__(self, loaded: LoadedSystem, batch: Batch) -> tuple[Rows, float]:
        """Run a batch; returns its rows and the time in s."""
        begin = process_time()
        rows = self.plan(loaded, batch)
        return rows, process_time() - begin


def study(runs: int = RUNS) -> Study:
    """Return the study: a mass and a seed for each run."""
    masses = tuple(np.linspace(45.0, 120.0, runs).tolist())
    variables = {
        "driver_mass": Variable(Values(masses)),
        "shaker.random.seed": Variable(Values(tuple(range(1, runs + 1)))),
    }
    return Study(
        name="benchmark",
        system="SeatSuspension",
        stop_time=STOP_TIME,
        warm_up=WARM_UP,
        words={"scenario": "random"},
        metrics=(*METRICS, *(f"final({name})" for name in SIGNALS[4:])),
        vary=(Block(variables, "list"),),
        vocabulary=SeatVocabulary(),
    )


def batches(given: Study, size: int) -> deque[Batch]:
    """Return all runs of a study in batches."""
    runs = given.design.runs
    return deque(Batch(i, given.design.points(range(i, min(i + size, runs)))) for i in range(0, runs, size))


class PlainRide(Plain):
    """The same ride as a user of fmpy writes it: instances kept and reset, the loop in Python."""

    def ride(self, stop_time: float, parameters: dict[str, float]) -> np.ndarray:
        """Run with parameters, as ``component.variable``; returns the signals, shape (rows, signals)."""
        wanted = {*self._connections.values(), *map(self._ref, SIGNALS)}
        inputs = {name: [p for p in self._connections if p.component == name] for name in self._fmus}
        outputs = {name: sorted(p for p in wanted if p.component == name) for name in self._fmus}
        to_set = {name: [self._references[name][ref.variable] for ref in refs] for name, refs in inputs.items()}
        to_get = {name: [self._references[name][ref.variable] for ref in refs] for name, refs in outputs.items()}
        values: dict[VariableRef, float] = {}
        for name, fmu in self._fmus.items():
            fmu.reset()
            for text, value in parameters.items():
                ref = self._ref(text)
                if ref.component == name:
                    set_ = fmu.setReal if isinstance(value, float) else fmu.setInteger
                    set_([self._references[name][ref.variable]], [value])
            fmu.setupExperiment(startTime=0.0)
            fmu.enterInitializationMode()
            fmu.exitInitializationMode()
            values.update(zip(outputs[name], fmu.getReal(to_get[name]), strict=True))
        rows, refs = [], [self._ref(name) for name in SIGNALS]
        for k in range(round(stop_time / H)):
            rows.append([values[ref] for ref in refs])
            for name in ("controller", "seat", "shaker"):
                fmu = self._fmus[name]
                if inputs[name]:
                    fmu.setReal(to_set[name], [values[self._connections[port]] for port in inputs[name]])
                fmu.doStep(currentCommunicationPoint=k * H, communicationStepSize=H)
                values.update(zip(outputs[name], fmu.getReal(to_get[name]), strict=True))
        rows.append([values[ref] for ref in refs])
        for fmu in self._fmus.values():
            fmu.terminate()
        return np.array(rows)

    @staticmethod
    def _ref(text: str) -> VariableRef:
        return VariableRef(*text.split(".", 1))


def do(workers: Workers[Batch, Any], waiting: deque[Batch]) -> tuple[float, list[Any]]:
    """Do batches; returns the time in s and the results."""
    begin = perf_counter()
    found = [rows for _, rows in workers.run(lambda: waiting.popleft() if waiting else None)]
    return perf_counter() - begin, found


def measure(rounds: int) -> Table:
    """Measure one worker, two workers and plain fmpy in turns."""
    given = study()
    plan = make_plan(given)
    few = replace(given, vary=study(8).vary)
    times: dict[str, list[tuple[float, float, float, float]]] = {"1 worker": [], "2 workers": [], "fmpy, 1 process": []}
    with ExitStack() as stack:
        pools = {n: stack.enter_context(Processes[Batch, Any](Timed(plan), n)) for n in (1, 2)}
        for pool in pools.values():
            do(pool, batches(few, 2))
        loop = PlainRide(fmu_folder("fmi2"), stack)
        for _ in range(rounds):
            for n, pool in pools.items():
                elapsed, rows = do(pool, batches(given, BATCH))
                metrics = sum(each.metrics for each, _ in rows)
                stepping = sum(each.seconds for each, _ in rows) - metrics
                processor = sum(time for _, time in rows)
                times[f"{n} worker{'s' * (n > 1)}"].append((elapsed, stepping / n, metrics / n, processor / RUNS))
            times["fmpy, 1 process"].append(plain(loop, given))
    table = Table(
        "",
        "total (s)",
        "quickest",
        "stepping, each worker (s)",
        "metrics (s)",
        "runs/s",
        "processor, a run (ms)",
        box=SIMPLE,
    )
    for name, each in times.items():
        total, stepping, metrics, processor = (median(column) for column in zip(*each, strict=True))
        quickest = min(row[0] for row in each)
        parts = f"{stepping:.2f}", f"{metrics:.2f}", f"{RUNS / total:.0f}", f"{1e3 * processor:.2f}"
        table.add_row(name, f"{total:.2f}", f"{quickest:.2f}", *parts)
    one, two = ([row[0] for row in times[name]] for name in ("1 worker", "2 workers"))
    table.add_row("speed-up of 2", f"{median(one) / median(two):.2f}", f"{min(one) / min(two):.2f}", "", "", "", "")
    return table


def plain(loop: PlainRide, given: Study, runs: int = 4) -> tuple[float, float, float, float]:
    """Do a few runs with fmpy alone and the same metrics; returns times in s for all runs."""
    stepping = metrics = 0.0
    processor = process_time()
    for point in given.design.points(range(runs)):
        mass = float(point["driver_mass"])
        seed = int(point["shaker.random.seed"])
        begin = perf_counter()
        rows = loop.ride(
            STOP_TIME,
            {
                "shaker.profile": int(Profile.random),
                "shaker.random.seed": seed,
                "seat.driver_mass": mass,
                "controller.driver_mass": mass,
            },
        )
        middle = perf_counter()
        driver, floor = (ride(rows[:, i], 1.0 / H, WARM_UP) for i in (0, 1))
        seat_factor(driver, floor)
        stepping, metrics = stepping + middle - begin, metrics + perf_counter() - middle
    share = RUNS / runs
    return share * (stepping + metrics), share * stepping, share * metrics, (process_time() - processor) / runs


def tasks() -> Table:
    """Measure what a task costs beside its runs: runs of one step, one for each task."""
    given = replace(study(RUNS), stop_time=0.002, metrics=("final(seat.driver_acceleration)",), warm_up=0.0)
    plan = make_plan(given)
    makers: dict[str, Callable[[], Processes[Batch, Rows] | Cluster[Batch, Rows]]] = {
        "2 processes": lambda: Processes(plan, 2),
        "Dask, 2 workers": lambda: Cluster(plan, None, 2),
    }
    table = Table("", "a task (ms)", "of which its run (ms)", box=SIMPLE)
    for name, make in makers.items():
        with make() as workers:
            do(workers, batches(given, 1))
            found = [do(workers, batches(given, 1)) for _ in range(3)]
        elapsed = median(time for time, _ in found) / RUNS
        own = median(sum(each.seconds for each in rows) / RUNS for _, rows in found)
        table.add_row(name, f"{1e3 * elapsed:.2f}", f"{1e3 * own:.2f}")
    return table


def horizons() -> Table:
    """Measure runs a second of one worker against the horizon, by the processor's time."""
    table = Table("horizon (s)", "runs/s", "a run (ms)", "of which metrics (ms)", box=SIMPLE)
    for stop_time in HORIZONS:
        warm_up = 0.0 if stop_time < 10.0 else WARM_UP
        given = replace(study(max(4, min(40, int(600 / stop_time)))), stop_time=stop_time + warm_up, warm_up=warm_up)
        with Processes[Batch, Any](Timed(make_plan(given)), 1) as workers:
            do(workers, batches(given, 2))
            _, found = do(workers, batches(given, 2))
        each = median(processor / rows.runs for rows, processor in found)
        metrics = each * median(rows.metrics / rows.seconds for rows, _ in found)
        table.add_row(f"{stop_time + warm_up:g}", f"{1.0 / each:.0f}", f"{1e3 * each:.2f}", f"{1e3 * metrics:.2f}")
    return table


@click.command(help=__doc__)
@click.option("--rounds", default=5, show_default=True)
@click.option("--tasks", "with_tasks", is_flag=True, help="What a task costs, and runs a second against the horizon.")
def main(rounds: int, with_tasks: bool) -> None:
    """Print the tables."""
    console = Console(width=120)
    console.print(measure(rounds))
    if with_tasks:
        console.print(tasks())
        console.print(horizons())


if __name__ == "__main__":
    main()
