"""Endings of a run that writes a folder, and the lock of the folder."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import threading
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cosim import System, run_to_folder
from cosim.engine.run_options import RunOptions
from cosim.errors import SetupError
from cosim.file_lock import FileLock
from cosim.results.folder_lock import LOCK, locked_folder
from cosim.results.result import Result
from seat_cosim.scenarios import seat_suspension

pytestmark = pytest.mark.builds
H = 0.002


@pytest.fixture
def seats(native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> System:
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    return seat_suspension(native / "fmi2")


class Broken:
    """A sink that fails in one of its calls."""

    def __init__(self, where: str) -> None:
        self._where = where

    def _fail(self, where: str) -> None:
        if where == self._where:
            raise ValueError(f"broken in {where}")

    def begin(self, names: Sequence[str], units: Sequence[str | None]) -> None:
        self._fail("begin")

    def write(self, rows: np.ndarray[Any, Any]) -> None:
        self._fail("write")

    def end(self, complete: bool) -> None:
        self._fail("end")


class Counting(Broken):
    rows = 0
    ended = False

    def write(self, rows: np.ndarray[Any, Any]) -> None:
        self.rows += len(rows)

    def end(self, complete: bool) -> None:
        self.ended = True


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, SystemExit, MemoryError])
@pytest.mark.parametrize("where", ["begin", "write", "end", "progress"])
def test_an_exception_of_the_callers_code_leaves_rows_and_a_true_manifest(
    seats: System, tmp_path: Path, where: str, error: type[BaseException], monkeypatch: pytest.MonkeyPatch
):
    def fail(_: Broken, at: str) -> None:
        if at == where:
            raise error(f"broken in {at}")

    def progress(time: float) -> None:
        if where == "progress" and time > 0.5:
            raise error("broken in progress")

    monkeypatch.setattr(Broken, "_fail", fail)
    after = Counting("never")
    options = RunOptions(20.0, H, progress=progress, sinks=[Broken(where), after])
    with suppress(error):
        run_to_folder(seats, tmp_path / "out", options)
    record = json.loads((tmp_path / "out" / "run.json").read_text())
    name = "result.csv" if (tmp_path / "out" / "result.csv").exists() else "result.partial.csv"
    rows = len(Result.read(tmp_path / "out" / name).time)
    assert record["complete"] is False
    assert record["rows"] == rows
    assert after.rows == rows
    assert after.ended or where == "begin"
    assert rows > 250 or where in ("begin", "write")
    assert record["reached"] == (Result.read(tmp_path / "out" / name).time[-1] if rows else None)
    assert "interrupted" in record["error"] if error is KeyboardInterrupt else f"broken in {where}" in record["error"]
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == sorted([name, "run.json"])
    assert list((tmp_path / "temporary").iterdir()) == []


def test_threads_and_processes_exclude_each_other_from_a_folder(tmp_path: Path):
    folder = tmp_path / "a" / "b"
    script = (
        "import sys; from pathlib import Path; from cosim.results.folder_lock import locked_folder\n"
        "with locked_folder(Path(sys.argv[1])): pass"
    )

    def in_another_process() -> str:
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
        command = [sys.executable, "-c", script, str(folder)]
        return subprocess.run(command, env=environment, capture_output=True, text=True, check=False).stderr

    problems: list[str] = []

    def in_another_thread() -> None:
        try:
            with locked_folder(folder):
                pass
        except SetupError as error:
            problems.append(str(error))

    expected = f"{folder}: expected a folder that no other run writes to, got that of a run in process {os.getpid()} on"
    with locked_folder(folder), locked_folder(folder / ".." / "b"):
        assert expected in in_another_process()
        thread = threading.Thread(target=in_another_thread)
        thread.start()
        thread.join()
        assert problems[0].startswith(expected)
    assert in_another_process() == ""
    assert not (tmp_path / "a").exists()  # nothing was written


def test_the_lock_of_a_dead_process_is_taken_over(tmp_path: Path):
    (tmp_path / LOCK).write_text("process 99999999 on elsewhere")
    with locked_folder(tmp_path):
        assert str(os.getpid()) in (tmp_path / LOCK).read_text()
    assert not (tmp_path / LOCK).exists()


def test_a_lock_whose_file_was_removed_by_the_one_before_excludes(tmp_path: Path):
    """Who waits at the file of the one before gets a lock that the next one does not see, unless it looks again."""
    first, second, third = (FileLock(tmp_path / "lock") for _ in range(3))
    assert first.acquire()
    assert not second.acquire()
    first.release()
    assert second.acquire("second")
    assert not third.acquire()
    assert third.holder() == "second"
    second.release()


def test_results_saved_from_memory_respect_the_lock(seats: System, tmp_path: Path):
    result = seats.simulate(0.1, H)
    found: list[Exception] = []

    def save() -> None:
        try:
            result.save(tmp_path / "out")
        except SetupError as error:
            found.append(error)

    with locked_folder(tmp_path / "out"):
        thread = threading.Thread(target=save)
        thread.start()
        thread.join()
    assert len(found) == 1
    assert result.save(tmp_path / "out").exists()
