"""Workers of a Dask cluster: the same jobs in tasks of a second or so, on any number of machines.

The task, with the FMUs and files that it needs, travels to each worker once; their names are hashes of their content,
so that a worker which has them already keeps them. The cluster's workers need this package and ``distributed``.
"""

from __future__ import annotations

import os
import pickle
import platform
import tempfile
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, suppress
from importlib import import_module
from pathlib import Path
from time import monotonic
from typing import Any, Generic, Protocol, TypeVar

from cosim.errors import CosimError, RunError, SetupError
from cosim.manifest import package_versions, sha256
from cosim.results.file_sink import import_optional
from cosim.sweep.loaded import LoadedSystem
from cosim.sweep.pool import WorkerDied, limit_threads

Job = TypeVar("Job")
Found = TypeVar("Found")

_IN_FLIGHT = 4
"""Tasks that are submitted for each thread of the cluster, so that no worker waits for the client."""

_COUNT_EVERY = 2.0
"""Time in s after which the threads of the cluster are counted again."""


class MovableTask(Protocol):
    """A task that says which files it needs."""

    fingerprint: str

    @property
    def versions(self) -> Mapping[str, str]:
        """Packages that the results depend on, and their versions."""

    def __call__(self, loaded: LoadedSystem, job: Any, /) -> Any:
        """Do a job."""

    def assets(self) -> Mapping[str, tuple[str, bytes]]:
        """Return SHA-256 of each file to its suffix and bytes."""

    def hashed(self) -> MovableTask:
        """Return the task with hashes in the place of paths."""

    def located(self, folder: Path) -> MovableTask:
        """Return the same with paths in a folder of assets.

        Parameters
        ----------
        folder
            The folder.
        """


class Cluster(Generic[Job, Found]):
    """Does jobs on a Dask cluster; a context manager.

    Parameters
    ----------
    task
        What to do.
    scheduler
        Address of the scheduler, such as ``tcp://host:8786``; a cluster on this machine where None.
    workers
        Number of workers of that cluster.
    is_whole
        Whether a job cannot be divided. Dask blames a dead worker on all jobs that it had, so such a job is done again,
        alone on the cluster, before it is blamed.

    Raises
    ------
    SetupError
        If ``distributed`` is not installed, or nothing answers at the address.
    """

    def __init__(
        self,
        task: MovableTask,
        scheduler: str | None = None,
        workers: int | None = None,
        is_whole: Callable[[Job], bool] = lambda job: True,
    ) -> None:
        self._distributed = import_optional("distributed", "cluster", "a cluster")
        self._is_whole = is_whole
        self._task, self._scheduler, self._workers = task, scheduler, workers
        self._stack = ExitStack()
        self._counted = -_COUNT_EVERY
        self.count = workers or 1

    def __enter__(self) -> Cluster[Job, Found]:
        """Connect, and send the task to all workers."""
        try:
            self._client = self._stack.enter_context(self._connect())
            plugin = import_module("cosim.sweep.cluster_worker").SendTask(
                self._task.fingerprint,
                pickle.dumps(self._task.hashed()),
                dict(self._task.assets()),
                dict(self._task.versions),
            )
            self._client.register_plugin(plugin, name=plugin.name)
            self._stack.callback(self._forget, plugin.name)
            self._count()
        except BaseException:
            self._stack.close()
            raise
        return self

    def _connect(self) -> Any:
        if self._scheduler is None:
            cluster = self._distributed.LocalCluster(
                n_workers=self._workers or os.cpu_count(),
                threads_per_worker=1,
                processes=True,
                dashboard_address=None,
                silence_logs=50,
            )
            self._stack.enter_context(cluster)
            return self._distributed.Client(cluster)
        try:
            return self._distributed.Client(self._scheduler, timeout="10s")
        except (OSError, ValueError, TypeError) as error:
            raise SetupError(
                f"--scheduler {self._scheduler}: expected the address of a Dask scheduler, got: {error or 'no answer'}"
            ) from None

    def _forget(self, name: str) -> None:
        with suppress(Exception):  # the cluster may have gone
            self._client.unregister_worker_plugin(name)

    def __exit__(self, *exception: object) -> None:
        """Free the workers' FMUs and disconnect."""
        self._stack.close()

    def _count(self) -> int:
        """Return the number of threads of the cluster."""
        if monotonic() - self._counted > _COUNT_EVERY:
            self.count = max(1, sum(self._client.nthreads().values()))
            self._counted = monotonic()
        return self.count

    def run(self, take: Callable[[], Job | None]) -> Iterator[tuple[Job, Found | WorkerDied]]:
        """Do jobs, see :meth:`cosim.sweep.pool.Workers.run`; a job whose worker is lost is done by another one.

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
        """
        ended = self._distributed.as_completed()
        jobs: dict[str, Job] = {}
        suspects: list[Job] = []

        def submit(job: Job) -> None:
            future = self._client.submit(_do, self._task.fingerprint, job, pure=False)
            jobs[future.key] = job
            ended.add(future)

        while True:
            while len(jobs) < _IN_FLIGHT * self._count() and (job := take()) is not None:
                submit(job)
            alone = not jobs and bool(suspects)
            if alone:
                submit(suspects.pop())
            if not jobs:
                return
            future = next(ended)
            job, found = jobs.pop(future.key), self._result(future)
            if isinstance(found, WorkerDied) and self._is_whole(job) and not alone:
                suspects.append(job)
            else:
                yield job, found

    def _result(self, future: Any) -> Any:
        error = future.exception()
        if error is None:
            return future.result()
        if isinstance(error, self._distributed.KilledWorker):
            return WorkerDied("a worker of the cluster, more often than Dask allows")
        if isinstance(error, CosimError):
            raise error
        raise RunError(f"cluster: {type(error).__name__}: {error}")


# ---- in the worker ---------------------------------------------------------------------------------------------------

_one_at_a_time = threading.Lock()
"""FMUs run one after the other, also where a worker has several threads."""

_tasks: dict[str, tuple[MovableTask, LoadedSystem]] = {}
"""Fingerprint of a task to the task, and its loaded system."""


def cache_folder() -> Path:
    """Return the folder of this user in which a worker keeps FMUs and files by their hashes."""
    user = os.getuid() if hasattr(os, "getuid") else os.environ.get("USERNAME", "user")
    return Path(tempfile.gettempdir(), f"cosim-cache-{user}")


def receive(
    fingerprint: str, task: bytes, assets: Mapping[str, tuple[str, bytes]], versions: Mapping[str, str]
) -> None:
    """Keep a task and its files; called in a worker before its first job.

    Parameters
    ----------
    fingerprint
        Of the task.
    task
        The pickled task, with hashes in the place of paths.
    assets
        SHA-256 of each file to its suffix and bytes.
    versions
        Packages that the results depend on, and their versions at the client.

    Raises
    ------
    RunError
        If they differ here: the dataset would mix the results of two versions.
    """
    own = package_versions(versions.keys() - {"python"})
    for name, version in versions.items():
        if own[name] != version:
            raise RunError(f"worker on {platform.node()}: expected {name} {version}, as at the client, got {own[name]}")
    folder = cache_folder()
    folder.mkdir(mode=0o700, exist_ok=True)
    if hasattr(os, "getuid") and folder.stat().st_uid != os.getuid():
        raise RunError(f"{folder}: expected a folder of this user, got another's")
    for name, (suffix, content) in assets.items():
        path = folder / f"{name}{suffix}"
        if not path.is_file() or sha256(path) != name:
            unfinished = path.with_name(f"{path.name}.{os.getpid()}")
            unfinished.write_bytes(content)
            unfinished.replace(path)
    limit_threads()
    with _one_at_a_time:
        _tasks[fingerprint] = pickle.loads(task).located(folder), LoadedSystem()


def forget(fingerprint: str) -> None:
    """Free what a task has loaded.

    Parameters
    ----------
    fingerprint
        Of the task.
    """
    with _one_at_a_time:
        if fingerprint in _tasks:
            _tasks.pop(fingerprint)[1].free()


def _do(fingerprint: str, job: Any) -> Any:
    with _one_at_a_time:
        task, loaded = _tasks[fingerprint]
        return task(loaded, job)
