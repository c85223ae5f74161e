"""Workers on this machine: spawned processes that get one task, and do one job after the other.

Processes are spawned, not forked: threads of an FMU do not survive a fork. A worker that an FMU brings down costs its
job alone; another worker takes its place.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from cosim.errors import CosimError, RunError
from cosim.fmi.interrupts import deferring_signals
from cosim.sweep.loaded import LoadedSystem

Job = TypeVar("Job")
Found = TypeVar("Found")
_Job = TypeVar("_Job", contravariant=True)
_Found = TypeVar("_Found", covariant=True)

_PATIENCE = 5.0
"""Time in s that a worker has to free its FMUs before it is killed."""


class Task(Protocol[_Job, _Found]):
    """What workers do; it is pickled and sent to each of them once."""

    def __call__(self, loaded: LoadedSystem, job: _Job, /) -> _Found:
        """Do a job.

        Parameters
        ----------
        loaded
            The worker's loaded system.
        job
            What to do.
        """


class WorkerDied:
    """Takes the place of a result where the worker's process ended.

    Parameters
    ----------
    how
        How it ended.
    """

    def __init__(self, how: str) -> None:
        self.how = how


class Workers(Protocol[Job, _Found]):
    """What does jobs: processes of this machine, or a cluster."""

    count: int
    """Number of jobs that it does at the same time."""

    def run(self, take: Callable[[], Job | None]) -> Iterator[tuple[Job, _Found | WorkerDied]]:
        """Do jobs until there are none.

        Parameters
        ----------
        take
            Returns the next job; None where there is none at present. It is called again after each result.

        Yields
        ------
        tuple
            Each job with its result, as they end.
        """


class ThisProcess(Generic[Job, Found]):
    """Does jobs in the calling process.

    Parameters
    ----------
    task
        What to do.
    """

    count = 1

    def __init__(self, task: Task[Job, Found]) -> None:
        self._task = task

    def __enter__(self) -> ThisProcess[Job, Found]:
        return self

    def __exit__(self, *exception: object) -> None:
        pass

    def run(self, take: Callable[[], Job | None]) -> Iterator[tuple[Job, Found | WorkerDied]]:
        """Do jobs, see :meth:`Workers.run`.

        Parameters
        ----------
        take
            Returns the next job; None where there is none at present.

        Yields
        ------
        tuple
            Each job with its result, as they end.
        """
        with LoadedSystem() as loaded:
            while (job := take()) is not None:
                yield job, self._task(loaded, job)


class Processes(Generic[Job, Found]):
    """Does jobs in spawned processes; a context manager.

    A script that uses it must guard its main part (``if __name__ == "__main__":``), as :mod:`multiprocessing` requires.

    Parameters
    ----------
    task
        What to do; sent to each process once.
    count
        Number of processes.
    """

    def __init__(self, task: Task[Job, Found], count: int) -> None:
        self.count = count
        self._task = pickle.dumps(task, protocol=pickle.HIGHEST_PROTOCOL)
        self._workers: dict[Connection, multiprocessing.process.BaseProcess] = {}
        self._starting: set[Connection] = set()

    def __enter__(self) -> Processes[Job, Found]:
        """Start the processes."""
        try:
            for connection in [self._start() for _ in range(self.count)]:
                self._send_task(connection)
        except BaseException:
            self._stop(gently=False)
            raise
        return self

    def __exit__(self, kind: type[BaseException] | None, *rest: object) -> None:
        """End the processes: their FMUs are freed; after an error, at once."""
        self._stop(gently=kind is None)

    def _start(self) -> Connection:
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=_work, args=(theirs,))
        with _without_missing_main():
            process.start()
        theirs.close()  # so that its end is seen here
        self._workers[ours] = process
        self._starting.add(ours)
        return ours

    def _send_task(self, connection: Connection) -> None:
        """Send the task, not as an argument of the process: that would wait without end for one that does not start."""
        with suppress(OSError):  # a worker that has died is found when it is waited for
            connection.send_bytes(self._task)

    def _stop(self, gently: bool) -> None:
        for connection, process in self._workers.items():
            connection.close()
            if not gently:
                process.terminate()
        for process in self._workers.values():
            process.join(None if gently else _PATIENCE)
            if process.is_alive():
                process.kill()
                process.join()
            process.close()
        self._workers.clear()
        self._starting.clear()

    def run(self, take: Callable[[], Job | None]) -> Iterator[tuple[Job, Found | WorkerDied]]:
        """Do jobs, see :meth:`Workers.run`.

        Parameters
        ----------
        take
            Returns the next job; None where there is none at present.

        Yields
        ------
        tuple
            Each job with its result, as they end.

        Raises
        ------
        CosimError
            What a job raised.
        RunError
            If a worker does not start.
        """
        idle, busy = [each for each in self._workers if each not in self._starting], dict[Connection, Job]()
        while True:
            while idle and (job := take()) is not None:
                connection = idle.pop()
                with suppress(OSError):  # a worker that has died is found below
                    connection.send(job)
                busy[connection] = job
            if not busy and idle:  # there was no further job
                return
            ready = set(wait([*busy, *self._starting]))
            for connection in [each for each in self._starting if each in ready]:
                self._has_started(connection)
                idle.append(connection)
            for connection in [each for each in busy if each in ready]:
                job = busy.pop(connection)
                found: Any
                try:
                    found = connection.recv()
                    idle.append(connection)
                except (EOFError, OSError, pickle.UnpicklingError):
                    found = self._died(connection)
                    self._send_task(self._start())
                if isinstance(found, BaseException):
                    raise found
                yield job, found

    def _has_started(self, connection: Connection) -> None:
        """Receive the sign that a worker has the task."""
        self._starting.discard(connection)
        try:
            connection.recv()
        except (EOFError, OSError):
            how = self._died(connection).how
            raise RunError(
                f"worker: expected a process that starts, got one that ended ({how}); a script must guard its main "
                'part: if __name__ == "__main__":'
            ) from None

    def _died(self, connection: Connection) -> WorkerDied:
        """Remove a worker whose connection has ended."""
        process = self._workers.pop(connection)
        connection.close()
        process.join(_PATIENCE)
        if process.is_alive():
            process.kill()
            process.join()
        code = process.exitcode or 0
        process.close()
        return WorkerDied(f"signal {signal.Signals(-code).name}" if code < 0 else f"exit code {code}")


@contextmanager
def _without_missing_main() -> Iterator[None]:
    """Hide that the program came from standard input: a worker would look for a file of this name."""
    main = sys.modules["__main__"]
    file = getattr(main, "__file__", None)
    if file is None or Path(file).exists():
        yield
        return
    del main.__file__
    try:
        yield
    finally:
        main.__file__ = file


def _work(connection: Connection) -> None:
    """Do jobs until the other end closes: the main function of a worker."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # a terminal sends it to all; the parent ends its workers
    limit_threads()
    with deferring_signals(), suppress(EOFError, BrokenPipeError, ConnectionResetError), LoadedSystem() as loaded:
        do = pickle.loads(connection.recv_bytes())
        connection.send(None)  # it has started
        while True:
            job = connection.recv()
            try:
                found = do(loaded, job)
            except Exception as error:
                found = error if isinstance(error, CosimError) else RunError(f"{type(error).__name__}: {error}")
            connection.send(found)


def limit_threads() -> None:
    """Let linear algebra use one thread: there is a worker for each core."""
    from threadpoolctl import threadpool_limits

    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"  # for libraries that are not loaded yet
    threadpool_limits(1)
