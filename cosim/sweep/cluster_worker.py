"""What a Dask cluster keeps for its workers: each gets the task when it joins the cluster."""

from __future__ import annotations

from typing import Any

from distributed import WorkerPlugin

from cosim.sweep.cluster import forget, receive


class SendTask(WorkerPlugin):  # type: ignore[misc]  # distributed has no types
    """Brings a task and its files to each worker.

    Parameters
    ----------
    fingerprint
        Of the task.
    task
        The pickled task.
    assets
        SHA-256 of each file to its suffix and bytes.
    versions
        Packages that the results depend on, and their versions.
    """

    def __init__(
        self, fingerprint: str, task: bytes, assets: dict[str, tuple[str, bytes]], versions: dict[str, str]
    ) -> None:
        self._given = fingerprint, task, assets, versions
        self.name = f"seat-cosim-{fingerprint}"

    def setup(self, worker: Any) -> None:
        """Receive the task; called by Dask in each worker.

        Parameters
        ----------
        worker
            Dask's worker.
        """
        receive(*self._given)

    def teardown(self, worker: Any) -> None:
        """Free the task's FMUs.

        Parameters
        ----------
        worker
            Dask's worker.
        """
        forget(self._given[0])
