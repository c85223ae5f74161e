"""Result files: the same numbers in each format, rows on disk as they come, the same bytes for any pieces of rows."""

from __future__ import annotations

import resource
import subprocess
import sys
import time
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from cosim import Result, RunError, SetupError, System
from cosim.results.file_sink import BLOCK_ROWS, result_file_name
from cosim.results.formats import FORMATS, FileSink, create_sinks, read_table
from seat_cosim.scenarios import seat_suspension

H = 0.002
NAMES = ["seat.driver_acceleration", "controller.saturated", "other.table[1,2]"]
UNITS = ["m/s2", None, "N"]
ROWS = 2 * BLOCK_ROWS + 123
"""More than two blocks, so that formats with blocks write full ones and a remainder."""


@pytest.fixture(scope="module")
def rows() -> np.ndarray:
    """Numbers of all magnitudes, a Boolean, and floats that need many digits."""
    random = np.random.default_rng(1)
    table = np.empty((ROWS, 1 + len(NAMES)))
    table[:, 0] = np.arange(ROWS) * H
    table[:, 1] = random.standard_normal(ROWS) * 10.0 ** random.integers(-300, 300, ROWS)
    table[:, 2] = random.integers(0, 2, ROWS)
    table[:, 3] = random.standard_normal(ROWS)
    table[:5, 3] = [0.1 + 0.2, -0.0, 5e-324, np.finfo(float).max, 1e16]
    return table


def write_all(sink: FileSink, rows: np.ndarray, cuts: list[int], complete: bool = True) -> Path:
    """Write rows to a sink in pieces, in an array that is reused, as in a run."""
    sink.begin(NAMES, UNITS)
    for begin, end in pairwise([0, *cuts, len(rows)]):
        piece = rows[begin:end].copy()
        sink.write(piece)
        piece[:] = np.nan
    sink.end(complete)
    return sink.path


@pytest.mark.parametrize("name", FORMATS)
def test_a_file_reads_back_to_the_same_bits(rows: np.ndarray, tmp_path: Path, name: str):
    path = write_all(FORMATS[name](tmp_path), rows, [1, 500, 20_000])
    table = read_table(path)
    assert path.name == f"result{FORMATS[name].suffix}"
    assert table.names == ["time", *NAMES]
    assert table.rows.tobytes() == rows.tobytes()
    assert table.units == ([None] * 4 if name == "csv" else ["s", *UNITS])
    result = Result.read(path)
    assert result.complete
    assert np.array_equal(result[NAMES[1]], rows[:, 2])
    assert result.units == dict(zip(NAMES, table.units[1:], strict=True))


@pytest.mark.parametrize("name", FORMATS)
def test_bytes_depend_neither_on_pieces_nor_on_the_time_zone(
    rows: np.ndarray, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
):
    contents = []
    cuts: tuple[list[int], ...] = ([], [1, 2, 3, BLOCK_ROWS], list(range(500, ROWS, 500)))
    for cut, zone in zip(cuts, ("UTC", "Asia/Tokyo", "America/New_York"), strict=True):
        monkeypatch.setenv("TZ", zone)
        time.tzset()
        folder = tmp_path / zone.replace("/", "-")
        folder.mkdir()
        contents.append(write_all(FORMATS[name](folder), rows, cut).read_bytes())
    monkeypatch.undo()
    time.tzset()
    assert len(set(contents)) == 1


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize("count", [0, 7])
def test_an_incomplete_run_keeps_its_name_and_is_readable(rows: np.ndarray, tmp_path: Path, name: str, count: int):
    path = write_all(FORMATS[name](tmp_path), rows[:count], [], complete=False)
    assert [found.name for found in tmp_path.iterdir()] == [path.name] == [f"result.partial{FORMATS[name].suffix}"]
    result = Result.read(path)
    assert not result.complete
    assert list(result.values) == NAMES
    assert result.rows.tobytes() == rows[:count].tobytes()


def test_csv_rows_are_on_disk_as_they_come(rows: np.ndarray, tmp_path: Path):
    (sink,) = create_sinks(tmp_path)
    sink.begin(NAMES, UNITS)
    for end in (3, 10):
        sink.write(rows[sink.rows : end])
        assert sink.path == tmp_path / "result.partial.csv"
        assert np.array_equal(read_table(sink.path).rows, rows[:end])
    sink.end(True)
    assert (sink.rows, sink.reached) == (10, 9 * H)


def test_an_incomplete_last_line_is_ignored(rows: np.ndarray, tmp_path: Path):
    path = write_all(create_sinks(tmp_path)[0], rows[:10], [], complete=False)
    path.write_bytes(path.read_bytes()[:-5])
    assert np.array_equal(read_table(path).rows, rows[:9])


def test_the_sinks_of_a_run_write_what_its_result_saves(system: System, tmp_path: Path):
    for folder in ("streamed", "saved"):
        (tmp_path / folder).mkdir()
    files = create_sinks(tmp_path / "streamed", FORMATS)
    with system.open() as session:
        result = session.run(0.5, H, sinks=files)
    assert result.save(tmp_path / "saved", FORMATS) == tmp_path / "saved" / "result.csv"
    result.to_csv(tmp_path / "saved" / "mine.csv")
    for file in files:
        assert file.rows == 251
        assert file.path.read_bytes() == (tmp_path / "saved" / file.path.name).read_bytes()
    assert (tmp_path / "saved" / "mine.csv").read_bytes() == files[0].path.read_bytes()
    assert Result.read(files[1].path).units == dict(result.units)


def test_earlier_results_of_all_formats_are_removed(system: System, tmp_path: Path):
    result = system.simulate(0.01, H)
    for kind in FORMATS.values():
        for complete in (True, False):
            (tmp_path / result_file_name(kind.suffix, complete)).write_text("of an earlier run")
    (tmp_path / "run.json").write_text("of an earlier run")
    (tmp_path / "notes.txt").write_text("the user's")
    result.save(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"result.csv", "notes.txt"}


@pytest.mark.parametrize("name", FORMATS)
def test_a_full_disk_is_a_failure_of_the_run(rows: np.ndarray, tmp_path: Path, name: str):
    sink = FORMATS[name](tmp_path)
    (tmp_path / result_file_name(sink.suffix, complete=False)).symlink_to("/dev/full")
    with pytest.raises(RunError, match=rf"result\.partial\{sink.suffix}: expected to write the result, got: "):
        write_all(sink, rows, [])
    sink.end(False)
    assert not (tmp_path / result_file_name(sink.suffix, complete=True)).exists()


@pytest.mark.parametrize("name", ["csv", "parquet"])
def test_a_file_that_cannot_be_opened_is_a_failure_of_the_run(tmp_path: Path, name: str):
    sink = FORMATS[name](tmp_path / "nowhere")
    with pytest.raises(RunError, match=rf"nowhere/result\.partial\{sink.suffix}: expected to write the result, got: "):
        sink.begin(NAMES, UNITS)
    sink.end(False)


@pytest.mark.parametrize("stepper", ["c", "python"])
def test_a_disk_that_fills_up_ends_the_run_and_loses_nothing(native: Path, tmp_path: Path, stepper: str):
    room = 20_000
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    with seat_suspension(native / "fmi2").open() as session:
        resource.setrlimit(resource.RLIMIT_FSIZE, (room, limits[1]))
        try:
            result = session.run(1.0, H, sinks=create_sinks(tmp_path), stepper=stepper)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert not result.complete
    assert str(result.error) == f"{tmp_path}/result.partial.csv: expected to write the result, got: File too large"
    written = Result.read(tmp_path / "result.partial.csv")
    assert (tmp_path / "result.partial.csv").stat().st_size == room
    assert np.array_equal(written.rows, result.rows[: len(written.time)])
    assert 0 < len(written.time) < len(result.time)


def test_a_missing_package_is_an_error_before_the_run_that_names_its_extra(tmp_path: Path):
    script = (
        "import sys; sys.modules.update(asammdf=None, pyarrow=None)\n"
        "from pathlib import Path; from cosim import SetupError\n"
        "from cosim.results.formats import FORMATS, create_sinks\n"
        "try: create_sinks(Path('nowhere'), FORMATS)\n"
        "except SetupError as error: print(*error.problems, sep='\\n')"
    )
    process = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert process.stdout.splitlines() == [
        f"{extra} files: expected the package {package}, got: import of {package} halted; None in sys.modules; "
        f'run: pip install "seat-cosim[{extra}]"'
        for extra, package in (("parquet", "pyarrow"), ("mdf", "asammdf"))
    ]
    assert not list(tmp_path.iterdir())


def test_the_packages_of_other_formats_are_not_loaded_without_need():
    script = "import sys, seat_cosim.cli.main; assert not {'asammdf', 'pandas', 'pyarrow'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", script], check=True)


def test_unknown_formats_are_errors(tmp_path: Path):
    with pytest.raises(SetupError, match="format: expected one of csv, parquet, mdf4, got xlsx"):
        create_sinks(tmp_path, ["xlsx"])


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("result.csv", "", "expected a first column time, got no column"),
        ("result.csv", "a,b\n1.0,2.0\n", "expected a first column time, got a"),
        ("result.csv", "time,b\n1.0,x\n", "expected a CSV table of numbers, got: could not convert string 'x'"),
        ("result.csv", "time,b\n1.0\n", "expected rows of 2 numbers, got 1"),
        ("result.csv", "time,b\n1.0,2.0\n3.0\n", "expected a CSV table of numbers, got: "),
        ("result.parquet", "PAR1 and no more", "expected a Parquet table of numbers, got: "),
        ("result.mf4", "MDF and no more", "expected an MDF4 file with a channel group, got: "),
        ("result.txt", "", r"expected a file named \*\.csv, \*\.parquet, \*\.mf4, got result\.txt"),
        ("result.csv", None, "expected the result of a run, got no such file"),
    ],
)
def test_a_file_that_is_no_result_is_an_error(tmp_path: Path, name: str, content: str | None, message: str):
    if content is not None:
        (tmp_path / name).write_text(content)
    with pytest.raises(SetupError, match=message) as error:
        Result.read(tmp_path / name)
    assert str(tmp_path / name) in str(error.value)
