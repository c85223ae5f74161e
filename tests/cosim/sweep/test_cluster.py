"""Sweeps on a Dask cluster: the table of this machine, bit for bit, whatever worker or client is lost on the way."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from cosim.errors import RunError, SetupError
from cosim.sweep import cluster
from cosim.sweep.plan import make_plan
from cosim.sweep.sweep import Progress, SweepResult, sweep
from tests.cosim.sweep.test_sweep import grid, kill_client, many, study

distributed = pytest.importorskip("distributed")
pytestmark = [pytest.mark.builds, pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")]


@pytest.fixture(scope="module")
def dask(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """A cluster of two workers, in a folder of its own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("dask"))
        patch.setenv("TMPDIR", str(tmp_path_factory.mktemp("workers")))
        with distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50
        ) as made:
            yield made


@pytest.fixture(scope="module")
def expected(faulty_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> SweepResult:
    """The table of two processes of this machine."""
    return sweep(many(faulty_folder), tmp_path_factory.mktemp("local") / "out", processes=2)


def test_a_cluster_gives_the_same_table_although_a_worker_is_killed(
    dask: Any, faulty_folder: Path, tmp_path: Path, expected: SweepResult
):
    killed: list[int] = []

    def kill_one(progress: Progress) -> None:
        if not killed:
            killed.append(dask.workers[0].process.pid)
            os.kill(killed[0], signal.SIGKILL)

    result = sweep(many(faulty_folder), tmp_path / "out", scheduler=dask.scheduler_address, progress=kill_one)
    assert killed
    assert result.failed == 0
    assert result.path.read_bytes() == expected.path.read_bytes()


def test_a_killed_client_repeats_only_what_was_not_finished(
    dask: Any, faulty_folder: Path, tmp_path: Path, expected: SweepResult
):
    finished = kill_client(faulty_folder, tmp_path / "out", tmp_path / "script.py", dask.scheduler_address)
    result = sweep(many(faulty_folder), tmp_path / "out", scheduler=dask.scheduler_address)
    assert 2 <= finished < result.runs
    assert result.resumed == finished
    assert result.path.read_bytes() == expected.path.read_bytes()


def test_no_scheduler_is_an_error_of_one_line(faulty_folder: Path, tmp_path: Path):
    for address in ("nonsense", "tcp://"):
        with pytest.raises(SetupError, match="expected the address of a Dask scheduler, got"):
            sweep(study(faulty_folder, vary=[grid(cab__u=(1.0,))]), tmp_path / "out", scheduler=address)


def test_workers_of_another_version_are_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setattr(cluster, "cache_folder", lambda: tmp_path)
    with pytest.raises(RunError, match="expected numpy 0.1, as at the client, got"):
        cluster.receive("fingerprint", b"", {}, {"numpy": "0.1"})


def test_a_plan_moves_to_a_machine_that_has_none_of_its_files(faulty_folder: Path, tmp_path: Path):
    plan = make_plan(study(faulty_folder, vary=[grid(cab__u=(1.0, 2.0))]))
    moved = plan.hashed()
    assert not any(str(faulty_folder) in str(model.path) for s in moved.systems.values() for model in s.models.values())
    cache = tmp_path / "cache"
    cache.mkdir()
    for digest, (suffix, content) in plan.assets().items():
        (cache / f"{digest}{suffix}").write_bytes(content)
    located = moved.located(cache)
    assert {model.content() for s in located.systems.values() for model in s.models.values()} == {
        model.content() for s in plan.systems.values() for model in s.models.values()
    }


@pytest.mark.long
def test_a_run_that_brings_workers_down_is_a_row_on_a_cluster_too(faulty_folder: Path, tmp_path: Path):
    given = study(faulty_folder, "segfault", vary=[grid(seat__strikes_at=(9.0, 0.5, 8.0))])
    result = sweep(given, tmp_path / "out", workers=2)
    assert [index for index, _ in result.failures] == [1]
    assert "a worker of the cluster, more often than Dask allows" in result.failures[0][1]
    assert result.columns()["final(seat.y)"][[0, 2]].tolist() == [3.0, 3.0]
