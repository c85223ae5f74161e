"""How commands end on any host: signals, two runs at once, leftovers, consoles of any encoding, pipes that close."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

from cosim.fmi import temporary_folders
from seat_cosim.cli import streams
from seat_cosim.scenarios import seat_suspension
from tests.helpers.files import read_csv
from tests.helpers.waiting import wait_until

pytestmark = [pytest.mark.skipif(os.name != "posix", reason="signals and locks of POSIX"), pytest.mark.builds]

COMMAND = [sys.executable, "-m", "seat_cosim"]
UNIGNORED = ["env", "--default-signal=HUP,INT,TERM"]
"""Before a command: a job in the background, as these tests may be one, ignores some signals."""

LONG = ("run", "random", "--stop-time", "100000", "--record-every", "50", "--no-figure")


@pytest.fixture
def environment(tmp_path: Path) -> dict[str, str]:
    (tmp_path / "temporary").mkdir()
    return {**os.environ, "TMPDIR": str(tmp_path / "temporary"), "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}


@pytest.fixture
def running(native: Path, tmp_path: Path, environment: dict[str, str]) -> Iterator[subprocess.Popen[str]]:
    """A long run whose rows have begun to come."""
    command = [*UNIGNORED, *COMMAND, *LONG, "--fmus", str(native), "--output", "out"]
    with subprocess.Popen(command, cwd=tmp_path, env=environment, stderr=subprocess.PIPE, text=True) as process:
        partial = tmp_path / "out" / "result.partial.csv"
        try:
            wait_until(lambda: process.poll() is not None or (partial.exists() and partial.stat().st_size > 10_000))
            yield process
        finally:
            if process.poll() is None:
                process.kill()


def execute(
    words: Sequence[str], folder: Path, environment: dict[str, str], native: Path
) -> subprocess.CompletedProcess[bytes]:
    """Run a command to its end."""
    command = [*COMMAND, *words, *(["--fmus", str(native)] if words[0] in ("run", "reproduce") else [])]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, check=False)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_signal_leaves_rows_a_true_manifest_and_no_folders(
    running: subprocess.Popen[str], tmp_path: Path, number: signal.Signals
):
    running.send_signal(number)
    _, err = running.communicate()
    ends = number is not signal.SIGINT
    assert running.returncode == (-number if ends else 1)
    assert "Traceback" not in err
    record = json.loads((tmp_path / "out" / "run.json").read_text())
    table = read_csv(tmp_path / "out" / "result.partial.csv")
    assert record["complete"] is False
    assert record["rows"] == len(table["time"]) > 100
    assert record["reached"] == table["time"][-1]
    assert re.fullmatch(rf"{f'ended by {number.name}' if ends else 'interrupted'} at t = \S+ s", record["error"])
    assert list((tmp_path / "temporary").iterdir()) == []
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["result.partial.csv", "run.json"]


def test_a_killed_run_leaves_rows_and_the_next_run_cleans_up(
    running: subprocess.Popen[str],
    tmp_path: Path,
    environment: dict[str, str],
    native: Path,
    monkeypatch: pytest.MonkeyPatch,
):
    record = tmp_path / "out" / "run.json"
    wait_until(lambda: json.loads(record.read_text())["rows"] > 0)
    running.kill()
    running.communicate()
    found = json.loads(record.read_text())
    assert found["error"] == "has not ended: it goes on, or its process was killed"
    assert found["reached"] > 0.0
    (folder,) = (tmp_path / "temporary").iterdir()
    monkeypatch.setattr(temporary_folders.tempfile, "tempdir", str(tmp_path / "temporary"))
    assert temporary_folders.leftovers() == []  # too young
    age(folder, 3600.0)
    assert temporary_folders.leftovers() == [folder]
    again = execute(
        ["run", "bump", "--stop-time", "0.1", "--output", "out", "--force", "--no-figure"],
        tmp_path,
        environment,
        native,
    )
    assert (again.returncode, json.loads(record.read_text())["complete"]) == (0, True)
    assert list((tmp_path / "temporary").iterdir()) == []


def age(folder: Path, seconds: float) -> None:
    then = time.time() - seconds
    os.utime(folder, (then, then))


def test_doctor_cleans_what_killed_runs_left_and_nothing_else(
    tmp_path: Path, environment: dict[str, str], native: Path, monkeypatch: pytest.MonkeyPatch
):
    temporary = tmp_path / "temporary"
    monkeypatch.setattr(temporary_folders.tempfile, "tempdir", str(temporary))
    (temporary / "mine").mkdir()
    (temporary / "seat-cosim-link").symlink_to(temporary / "mine")
    for name, seconds in {"dead": 3600.0, "young": 1.0, "unlocked": 3600.0, "old": 2 * 86400.0}.items():
        folder = temporary / f"seat-cosim-{name}"
        folder.mkdir()
        (folder / "content").write_text("content")
        if name in ("dead", "young"):
            (folder / "lock").write_text("123")
        age(folder, seconds)
    monkeypatch.setattr(temporary_folders, "_own", temporary_folders._ProcessFolder())  # as in a process of its own
    with seat_suspension(native / "fmi3").open() as session:
        (live,) = temporary.glob(f"seat-cosim-{os.getpid()}-*")
        (temporary / "seat-cosim-dead").mkdir(exist_ok=True)  # the session has removed it already
        (temporary / "seat-cosim-dead" / "lock").touch()
        age(temporary / "seat-cosim-dead", 3600.0)
        age(live, 3600.0)
        shown = execute(["doctor", "--json"], tmp_path, environment, native)
        assert b"1 of killed runs there" in shown.stdout
        execute(["doctor", "--clean"], tmp_path, environment, native)
        assert session.run(0.1, 0.002).complete
        left = sorted(path.name for path in temporary.iterdir())
    assert left == sorted([live.name, "mine", "seat-cosim-link", "seat-cosim-unlocked", "seat-cosim-young"])


def test_a_folder_is_one_runs(
    running: subprocess.Popen[str], tmp_path: Path, environment: dict[str, str], native: Path
):
    words = ["run", "bump", "--stop-time", "0.1", "--output", "out", "--force", "--no-figure"]
    second = execute(words, tmp_path, environment, native)
    assert second.returncode == 2
    expected = "seat-cosim: error: out: expected a folder that no other run writes to, got that of a run in process"
    assert second.stderr.decode().startswith(f"{expected} {running.pid} on ")
    assert running.poll() is None
    running.kill()
    running.communicate()
    third = execute(words, tmp_path, environment, native)
    assert third.returncode == 0
    assert not (tmp_path / "out" / ".lock").exists()


def test_many_runs_into_one_folder_at_once_leave_one_whole_result(
    tmp_path: Path, environment: dict[str, str], native: Path
):
    commands = [
        [
            *COMMAND,
            "run",
            "bump",
            "--stop-time",
            "1",
            "--output",
            "out",
            "--fmus",
            str(native),
            "--driver-mass",
            mass,
            "--no-figure",
        ]
        for mass in ("55", "60", "70")
    ]
    processes = [
        subprocess.Popen(command, cwd=tmp_path, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        for command in commands
    ]
    found = [(process.communicate()[1].decode(), process.returncode) for process in processes]
    assert {code for _, code in found} <= {0, 2}
    assert all(code == 0 or "expected a folder that no other run writes to" in err for err, code in found)
    record = json.loads((tmp_path / "out" / "run.json").read_text())
    assert record["complete"] is True
    again = execute(["rerun", "out/run.json"], tmp_path, environment, native)
    assert (again.returncode, again.stderr) == (0, b"")


ENCODINGS = {
    "C": {"LANG": "C", "LC_ALL": "C"},
    "ascii": {"PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"},
    "latin": {"PYTHONIOENCODING": "latin-1"},
    "narrow": {"COLUMNS": "5", "PYTHONIOENCODING": "ascii"},
    "dumb": {"TERM": "dumb", "NO_COLOR": "1"},
}
SOME = ("C", "narrow")
"""Those for every run of the tests."""


@pytest.mark.parametrize(
    "name", [*SOME, *(pytest.param(name, marks=pytest.mark.long) for name in ENCODINGS if name not in SOME)]
)
@pytest.mark.parametrize("words", [("run", "bump", "--stop-time", "0.1", "--no-figure"), ("doctor",)])
def test_no_console_makes_a_traceback(
    words: tuple[str, ...], name: str, tmp_path: Path, environment: dict[str, str], native: Path
):
    found = execute(words, tmp_path, {**environment, **ENCODINGS[name]}, native)
    assert b"Traceback" not in found.stderr
    assert found.returncode == 0 or words == ("doctor",)
    assert b"\x1b" not in found.stdout + found.stderr


@pytest.mark.long
def test_a_table_with_signs_beyond_ascii_is_printed_in_ascii(tmp_path: Path, environment: dict[str, str], native: Path):
    found = execute(["reproduce", "table2"], tmp_path, {**environment, **ENCODINGS["ascii"]}, native)
    assert (found.returncode, found.stderr) == (0, b"")
    assert found.stdout.isascii()


def test_characters_that_an_encoding_has_not_are_replaced_by_similar_ones():
    streams.prepare()
    text = "m/s² – 5 µm × 2 … naïve α ☺"
    assert text.encode("ascii", streams.ERRORS) == rb"m/s2 - 5 um x 2 ... naive \u03b1 \u263a"


@pytest.mark.parametrize(
    "closed", ["both", *(pytest.param(name, marks=pytest.mark.long) for name in ("stdout", "stderr"))]
)
def test_pipes_that_nobody_reads_and_closed_streams_make_no_traceback(
    closed: str, tmp_path: Path, environment: dict[str, str], native: Path
):
    words = " ".join([*COMMAND, "run", "bump", "--stop-time", "0.1", "--no-figure", "--fmus", str(native)])
    redirections = {"stdout": ">&-", "stderr": "2>&-", "both": ">&- 2>&-"}[closed]
    found = subprocess.run(
        f"{words} {redirections}", shell=True, cwd=tmp_path, env=environment, capture_output=True, check=False
    )
    assert (found.returncode, found.stderr) == (0, b"")
    piped = subprocess.run(
        ["bash", "-c", f"{words} {'2>&1' if closed != 'stdout' else ''} | true; exit ${{PIPESTATUS[0]}}"],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        check=False,
    )
    assert piped.returncode in (0, 1)
    assert piped.stderr == b""


def test_a_full_disk_behind_standard_output_is_exit_code_1(tmp_path: Path, environment: dict[str, str], native: Path):
    with Path("/dev/full").open("wb") as full:
        command = [*COMMAND, "run", "bump", "--stop-time", "0.1", "--no-figure", "--fmus", str(native)]
        found = subprocess.run(command, cwd=tmp_path, env=environment, stdout=full, stderr=subprocess.PIPE, check=False)
    assert found.returncode == 1
    assert b"Traceback" not in found.stderr
    assert b"Exception ignored" not in found.stderr
