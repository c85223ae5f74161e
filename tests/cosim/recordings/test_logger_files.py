"""Files of many kinds of loggers are read to the same numbers; the others end in one line that says what helps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cosim.errors import SetupError
from cosim.recordings import (
    ACCELERATION,
    DISPLACEMENT,
    ChannelRequest,
    ClockRequest,
    ReadOptions,
    Recording,
    read_recording,
)
from tests.helpers.loggers import KINDS, RATE, Logged, Ride, ride, text


def read(path: Path, options: ReadOptions | None = None, unit: str | None = None, **names: str) -> Recording:
    requests = {key: ChannelRequest(name, f"--{key}", unit=unit) for key, name in names.items()}
    return read_recording(path, requests, options)


def logged(found: Logged) -> Recording:
    return read(found.path, found.options, found.unit, floor=found.floor, seat=found.seat)


@pytest.mark.parametrize("name", KINDS)
def test_every_kind_gives_the_same_numbers(name: str, tmp_path: Path):
    expected = ride()
    found = KINDS[name](tmp_path, expected)
    recording = logged(found)
    assert recording.rate == pytest.approx(RATE, rel=1e-6)
    for key, values in (("floor", expected.floor), ("seat", expected.seat)):
        np.testing.assert_allclose(recording.samples(key), values, rtol=0.0, atol=0.51 * found.resolution + 1e-12)


def test_there_are_kinds_enough():
    assert len(KINDS) >= 15


def simple(path: Path, head: str = "time [s],acc [m/s2]", row: str = "{:.3f},{:.5f}", tail: str = "") -> Path:
    return text(path, head, ride(), lambda t, x, _: row.format(t, x), tail=tail)


@pytest.mark.parametrize(
    ("head", "row", "message"),
    [
        ("time [s],acc [mm]", "{:.3f},{:.5f}", "acc [mm]: expected a unit of acceleration (m/s2), got mm; --unit"),
        ("time [s],acc [EU]", "{:.3f},{:.5f}", "got EU; --unit says what it is"),
        ("time [kg],acc [g]", "{:.3f},{:.5f}", "time [kg]: expected a unit of time, got kg; --time-unit says"),
        ("time [s],acc_x,acc_z", "{:.3f},1,{:.5f}", "one of the columns time [s], acc_x, acc_z, got none of that name"),
        ("time [s],acc,acc", "{:.3f},1,{:.5f}", "expected one column, got 2 of that name; use #2 and #3"),
        ("time [s],ACC,acc ", "{:.3f},1,{:.5f}", None),
        ("time,acc", "{:.3f},0,{:.5f},7", "the line above the values has 2 cells, the rows have 4"),
        ("when,acc [g]", "{:.3f},{:.5f}", "expected --time NAME with one of the columns when, acc [g], or --rate HZ"),
    ],
)
def test_what_is_ambiguous_is_refused(head: str, row: str, message: str | None, tmp_path: Path):
    path = simple(tmp_path / "a.csv", head, row)
    if message is None:  # the exact spelling wins
        assert read(path, a="acc").samples("a") == pytest.approx(ride().floor, abs=1e-5)
        return
    with pytest.raises(SetupError) as error:
        read(path, a="acc")
    assert message in str(error.value)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


def test_the_nearest_names_are_in_the_message(tmp_path: Path):
    path = simple(tmp_path / "a.csv", "time [s],Acc_Seat_Z [g]")
    with pytest.raises(SetupError, match="did you mean Acc_Seat_Z"):
        read(path, seat="Acc_SeatZ")


def test_times_in_ms_without_a_unit_are_refused(tmp_path: Path):
    path = text(tmp_path / "a.csv", "time,acc", ride(), lambda t, x, _: f"{1e3 * t:.0f},{x:.5f}")
    with pytest.raises(SetupError, match=r"expected a unit of the times, got none and 2 between rows; --time-unit ms"):
        read(path, a="acc")
    assert read(path, ReadOptions(ClockRequest(unit="ms")), a="acc").rate == RATE


@pytest.mark.parametrize(
    ("row", "cell", "message"),
    [
        (700, "0.699,abc", "line 702: expected a number as acc, got abc"),
        (700, "x,1.0", "line 702: expected a time as a number, as hours:minutes:seconds or with a date, got x"),
        (700, "0.699,1.0,2.0", "expected rows of 2 cells, got: Expected 2 fields in line 702, saw 3"),
        (700, "0.699,inf", "line 702: expected finite numbers as acc, got inf"),
        (700, "0.1,1.0", "expected times that rise"),
    ],
)
def test_a_wrong_row_is_named(row: int, cell: str, message: str, tmp_path: Path):
    path = simple(tmp_path / "a.csv", "time,acc")
    lines = path.read_text().splitlines()
    lines[row + 1] = cell
    path.write_text("\n".join(lines))
    with pytest.raises(SetupError) as error:
        read(path, a="acc")
    assert message in str(error.value)


def test_wrong_rows_near_the_top_are_no_header(tmp_path: Path):
    path = simple(tmp_path / "a.csv", "time,acc")
    lines = path.read_text().splitlines()
    lines[12] = "0.022,abc"
    path.write_text("\n".join(lines))
    with pytest.raises(SetupError, match="line 13: expected a number as acc, got abc"):
        read(path, a="acc")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "got an empty one"),
        (b"hello\nworld\n", "expected rows of numbers"),
        (b"PK\x03\x04" + bytes(100), "an Excel workbook; unpack it, or save the sheet as CSV"),
        (b"TDSm" + bytes(100), "a TDMS file; export it as CSV, MDF4, MAT or Parquet"),
        (b"\x89HDF\r\n\x1a\n" + bytes(100), "save it as MAT version 7"),
        (b"MATLAB 7.3 MAT-file" + bytes(100), 'save it with "-v7"'),
        (b"MATLAB 5.0 MAT-file" + bytes(200), "expected a MAT file"),
        (b"MDF     4.10    " + bytes(20), "expected an MDF file"),
        (b"PAR1" + bytes(20), "expected a Parquet file"),
        (bytes(range(256)) * 8, "unknown binary file"),
        (b"time,acc\n0,1\n0.1,2\n0.2,3\n", "expected at least 10 samples, got 3"),
    ],
)
def test_other_files_end_in_one_line(content: bytes, message: str, tmp_path: Path):
    path = tmp_path / "file"
    path.write_bytes(content)
    with pytest.raises(SetupError) as error:
        read(path, a="acc")
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_a_missing_file_and_a_missing_package_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    with pytest.raises(SetupError, match="got no such file"):
        read(tmp_path / "no.csv", a="acc")
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    with pytest.raises(SetupError, match=r'measurement files: .*pip install "seat-cosim\[measurements\]"'):
        read(simple(tmp_path / "a.csv"), a="acc")


def test_an_option_wins_over_the_unit_of_the_file(tmp_path: Path):
    path = simple(tmp_path / "a.csv", "time [s],acc [g]")
    found = read(path, unit="m/s2", a="acc")
    assert found.samples("a") == pytest.approx(ride().floor, abs=1e-5)
    assert any("read in m/s2 as asked for, not in g of the file" in note for note in found.notes)


def test_what_is_assumed_is_in_the_notes(tmp_path: Path):
    notes = " ".join(read(simple(tmp_path / "a.csv", "time,acc"), a="acc").notes)
    assert "times are read as s" in notes
    assert "values are read as m/s2" in notes
    path = simple(tmp_path / "b.csv")
    assert read(path, a="acc").notes == (f"{path}: text in utf-8, commas between columns, decimal point",)


def test_a_displacement_is_known_by_its_unit(tmp_path: Path):
    path = simple(tmp_path / "a.csv", "time [s],z [mm]")
    found = read_recording(path, {"z": ChannelRequest("z", "--channel", (ACCELERATION, DISPLACEMENT))})
    assert found.channels["z"].quantity == DISPLACEMENT
    assert found.samples("z") == pytest.approx(1e-3 * ride().floor, abs=1e-8)


def test_a_row_that_was_cut_off_is_left_out(tmp_path: Path):
    found = read(simple(tmp_path / "a.csv", tail="4.0"), a="acc")
    assert len(found.samples("a")) == len(ride().time)
    assert any("1 rows have no value and are left out" in note for note in found.notes)


def test_channels_of_an_mdf_file_have_their_own_rates(tmp_path: Path):
    import asammdf

    fast, slow = ride(2000, 500.0), ride(800, 200.0)
    with asammdf.MDF(version="4.10") as mdf:
        for data, name in ((fast, "floor"), (slow, "seat")):
            mdf.append([asammdf.Signal(getattr(data, name), data.time, name=name, unit="m/s^2")])
        mdf.save(tmp_path / "a.mf4")
    found = read(tmp_path / "a.mf4", floor="floor", seat="seat")
    assert found.rate == 500.0
    assert [info.rate for info in found.channels.values()] == [500.0, 200.0]
    seat = found.samples("seat")
    assert np.abs(seat - fast.seat[: len(seat)])[50:-50].max() < 2e-4
    assert any("channels have several rates" in note for note in found.notes)


def test_reading_changes_nothing_of_times_that_are_even(tmp_path: Path):
    data = Ride(*(column[:100] for column in ride()))
    path = text(tmp_path / "a.csv", "time,acc", data, lambda t, x, _: f"{t!r},{x!r}")
    np.testing.assert_array_equal(read(path, a="acc").samples("a"), data.floor)
