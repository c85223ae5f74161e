"""Run a sweep: batches of runs on workers, finished ones on the disk, and one table at the end."""

from __future__ import annotations

import platform
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from time import monotonic
from typing import Any, NamedTuple

from cosim.errors import writing_to
from cosim.fmi.interrupts import deferring_signals
from cosim.results.folder_lock import locked_folder
from cosim.sweep.cluster import Cluster
from cosim.sweep.dataset import STUDY, Dataset, read_columns
from cosim.sweep.design import Design
from cosim.sweep.plan import Batch, Column, Plan, Rows, make_plan
from cosim.sweep.pool import Processes, WorkerDied, Workers
from cosim.sweep.study import Study

BATCH_TIME = 1.0
"""Time in s that a batch is to take: long against the overhead of a task, short against what a lost worker costs."""

_LEAST_TIME = 0.05
"""Time in s that the last batches take at least."""

_FIRST_BATCH = 4
"""Runs of the first batches, when the time of a run is not known."""


class Progress(NamedTuple):
    """How far a sweep is.

    Attributes
    ----------
    done, runs
        Number of runs that are done, and of all.
    failed
        Number of those that failed since this process began.
    elapsed
        Time in s since then.
    left
        Estimate of the time in s that is left; None where it is not known.
    """

    done: int
    runs: int
    failed: int
    elapsed: float
    left: float | None


@dataclass(frozen=True)
class SweepResult:
    """A sweep that has ended.

    Attributes
    ----------
    folder
        Its folder.
    path
        The table of all runs, ``runs.parquet``.
    runs
        Number of runs.
    resumed
        Number of them that an earlier sweep had done.
    failed
        Number of runs that failed.
    failures
        The first of them: index and reason.
    elapsed
        Time in s from the first batch to the last one.
    seconds, metrics
        Time in s that workers spent on runs, all together, and the part of it for metrics.
    metric_columns
        Columns of the table that are metrics.
    """

    folder: Path
    path: Path
    runs: int
    resumed: int
    failed: int
    failures: Sequence[tuple[int, str]]
    elapsed: float
    seconds: float
    metrics: float
    metric_columns: Sequence[Column]

    def columns(self, names: Sequence[str] | None = None) -> dict[str, Any]:
        """Read the table of runs.

        Parameters
        ----------
        names
            Columns to read; all where None.

        Returns
        -------
        dict
            Name of each column to its values, see :func:`cosim.sweep.dataset.read_columns`.
        """
        return read_columns(self.path, names)


class _Batches:
    """Gives out batches that take some time, and smaller ones at the end, so that all workers end together.

    Parameters
    ----------
    design
        Gives the values of the variables.
    missing
        Runs to do: first, and the one after the last.
    workers
        Tells how many batches are done at the same time.
    """

    def __init__(self, design: Design, missing: Sequence[tuple[int, int]], workers: Workers[Batch, Rows]) -> None:
        self._design, self._workers = design, workers
        self._missing = deque(missing)
        self._left = sum(stop - start for start, stop in missing)
        self._seconds = self._runs = 0.0

    def take(self) -> Batch | None:
        """Return the next batch; None where all are given out."""
        if not self._missing:
            return None
        start, stop = self._missing.popleft()
        end = min(stop, start + self._size())
        if end < stop:
            self._missing.appendleft((end, stop))
        self._left -= end - start
        return Batch(start, self._design.points(range(start, end)))

    def _size(self) -> int:
        if not self._runs:
            return _FIRST_BATCH
        each = self._seconds / self._runs
        share = self._left // (3 * self._workers.count)
        return max(1, min(int(BATCH_TIME / each), max(share, int(_LEAST_TIME / each))))

    def learn(self, rows: Rows) -> None:
        """Learn from a finished batch how long a run takes.

        Parameters
        ----------
        rows
            Of the batch.
        """
        self._seconds, self._runs = self._seconds + max(rows.seconds, 1e-6), self._runs + rows.runs

    def split(self, batch: Batch) -> None:
        """Give out the halves of a batch that brought its worker down.

        Parameters
        ----------
        batch
            The batch, of two runs or more.
        """
        stop = batch.start + len(batch.points)
        middle = (batch.start + stop) // 2
        self._missing.extendleft([(middle, stop), (batch.start, middle)])
        self._left += len(batch.points)


def about(study: Study, plan: Plan) -> dict[str, Any]:
    """Return what a sweep is, as of JSON.

    Parameters
    ----------
    study, plan
        The study, and its plan.
    """
    fmus = {f"{name} ({model.where.name})": digest for name, model, digest in plan.fmus()}
    return {
        "name": study.name,
        "question": study.question,
        "runs": study.design.runs,
        "fingerprint": plan.fingerprint,
        "versions": plan.versions,
        "fmus": fmus,
        "study": study.source or study.as_json(),
    }


def sweep(
    study: Study,
    folder: str | Path,
    *,
    processes: int = 1,
    scheduler: str | None = None,
    workers: int | None = None,
    force: bool = False,
    command: Sequence[str] = (),
    progress: Callable[[Progress], None] = lambda progress: None,
) -> SweepResult:
    """Run a study, or the rest of it that an earlier call has left.

    Parameters
    ----------
    study
        The study.
    folder
        Where to; a folder that holds the same study, of the same versions and FMUs, is resumed.
    processes
        Number of spawned processes. A script that calls this function must guard its main part
        (``if __name__ == "__main__":``), as :mod:`multiprocessing` requires.
    scheduler
        Address of a Dask scheduler whose workers do the runs instead.
    workers
        Number of workers of a Dask cluster on this machine that do the runs instead.
    force
        Whether to remove what another study has left in the folder.
    command
        Words of the user's command line, if any.
    progress
        Called after each batch.

    Returns
    -------
    SweepResult
        Its table is the same, bit for bit, whatever the workers.

    Raises
    ------
    SetupError
        If something is wrong that can be seen before a run, or another sweep writes to the folder.
    RunError
        If the table cannot be written. A run that fails is a row of the table.
    """
    folder, plan = Path(folder), make_plan(study)
    with deferring_signals(), locked_folder(folder):
        dataset = Dataset(folder, plan.columns, study.design.runs, about(study, plan))
        with writing_to(folder):
            is_complete = dataset.prepare(force)
            if study.source and not is_complete:
                (folder / STUDY).write_text(study.source, encoding="utf-8")
        missing = [] if is_complete else list(dataset.missing())
        resumed = study.design.runs - sum(stop - start for start, stop in missing)
        totals = _Totals(study.design.runs, resumed)
        if missing:
            with _workers(plan, processes, scheduler, workers, missing) as doing:
                for rows in _run(plan, _Batches(study.design, missing, doing), doing):
                    dataset.add(rows)
                    progress(totals.after(rows))
        if not is_complete:
            dataset.write_table()
        failed, failures = dataset.failures()
        if not is_complete:
            dataset.complete(command=list(command), platform=platform.platform(), failed=failed, **totals.as_json())
    times = (totals.elapsed, totals.seconds, totals.metrics)
    metrics = [column for column in plan.columns if column.name in plan.metrics]
    return SweepResult(folder, dataset.path, study.design.runs, resumed, failed, failures, *times, metrics)


class _Totals:
    """Sums over the batches of a sweep.

    Parameters
    ----------
    runs
        Number of all runs.
    done
        Number of those that are done before.
    """

    def __init__(self, runs: int, done: int) -> None:
        self._runs, self._done, self._before, self._failed = runs, done, done, 0
        self.seconds = self.metrics = self.elapsed = 0.0
        self._begin = monotonic()

    def after(self, rows: Rows) -> Progress:
        """Add a batch.

        Parameters
        ----------
        rows
            Its rows.
        """
        self._done, self._failed = self._done + rows.runs, self._failed + rows.failed
        self.seconds, self.metrics = self.seconds + rows.seconds, self.metrics + rows.metrics
        self.elapsed = monotonic() - self._begin
        left = self.elapsed / (self._done - self._before) * (self._runs - self._done)
        return Progress(self._done, self._runs, self._failed, self.elapsed, left)

    def as_json(self) -> Mapping[str, Any]:
        """Return what ``sweep.json`` says of the last part of the sweep."""
        return {"resumed": self._before, "elapsed": round(self.elapsed, 3)}


def _workers(
    plan: Plan, processes: int, scheduler: str | None, workers: int | None, missing: Sequence[tuple[int, int]]
) -> AbstractContextManager[Any]:
    """Choose what does the runs."""
    if scheduler is not None or workers is not None:
        return Cluster(plan, scheduler, workers, is_whole=lambda batch: len(batch.points) == 1)
    return Processes(plan, min(processes, sum(stop - start for start, stop in missing)))


def _run(plan: Plan, batches: _Batches, workers: Workers[Batch, Rows]) -> Iterator[Rows]:
    """Yield the rows of all batches; one that brings its worker down is halved until the run is found."""
    for batch, found in workers.run(batches.take):
        if not isinstance(found, WorkerDied):
            batches.learn(found)
            yield found
        elif len(batch.points) > 1:
            batches.split(batch)
        else:
            yield _brought_down(plan, batch, found)


def _brought_down(plan: Plan, batch: Batch, died: WorkerDied) -> Rows:
    """Return the row of a run that brought its worker down."""
    return plan.failed(batch, f"its FMUs brought the process down ({died.how})")


class Estimate(NamedTuple):
    """What a sweep will take.

    Attributes
    ----------
    runs
        Number of runs.
    measured
        Number of runs that were done for it.
    seconds, metrics
        Mean time in s of a run on one worker, and the part of it for metrics.
    loading
        Time in s until a worker has loaded its FMUs.
    failures
        Index and reason of the measured runs that failed.
    """

    runs: int
    measured: int
    seconds: float
    metrics: float
    loading: float
    failures: Sequence[tuple[int, str]]

    def total(self, workers: int) -> float:
        """Return the time in s that all runs take.

        Parameters
        ----------
        workers
            Number of workers, each with a core of its own.
        """
        return self.loading + self.runs * self.seconds / max(1, min(workers, self.runs))


def estimate(study: Study, samples: int = 8, at_most: float = 10.0) -> Estimate:
    """Measure a few runs of a study, spread over its design, in one spawned process.

    Parameters
    ----------
    study
        The study.
    samples
        How many.
    at_most
        Time in s after which no further one begins.

    Returns
    -------
    Estimate
        What the runs will take.

    Raises
    ------
    SetupError
        If something is wrong that can be seen before a run.
    """
    plan, design = make_plan(study), study.design
    count = min(samples, design.runs)
    indices = [0, *(i * (design.runs - 1) // max(1, count - 1) for i in range(count))]
    waiting = deque(Batch(index, design.points([index])) for index in indices)
    begin = monotonic()
    loading, found, failures = 0.0, list[Rows](), list[tuple[int, str]]()

    def take() -> Batch | None:
        return waiting.popleft() if waiting and (len(found) < 1 or monotonic() - begin < loading + at_most) else None

    with Processes[Batch, Rows](plan, 1) as workers:
        for batch, rows in workers.run(take):
            if isinstance(rows, WorkerDied):
                rows = _brought_down(plan, batch, rows)
            if not loading:
                loading = monotonic() - begin  # the first run loads the FMUs, and is done again
                continue
            found.append(rows)
            failures += [(rows.start, error) for error in rows.columns["error"] if error is not None]
    seconds = sum(rows.seconds for rows in found) / len(found)
    metrics = sum(rows.metrics for rows in found) / len(found)
    return Estimate(design.runs, len(found), seconds, metrics, loading, failures)
