"""Files of the same ride as many kinds of data loggers write them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from cosim.recordings import ClockRequest, ReadOptions, TextOptions
from cosim.units import GRAVITY

RATE = 500.0


class Ride(NamedTuple):
    """Times in s and accelerations in m/s2."""

    time: np.ndarray
    floor: np.ndarray
    seat: np.ndarray


class Logged(NamedTuple):
    """A file, the names of its channels, the last place of its values in m/s2, and how to read it."""

    path: Path
    resolution: float
    floor: str = "acc_floor"
    seat: str = "acc_seat"
    options: ReadOptions = ReadOptions()
    unit: str | None = None


def ride(count: int = 2000, rate: float = RATE) -> Ride:
    """Return a ride of three sines on the floor, weaker and later on the seat."""
    t = np.arange(count) / rate
    parts = ((1.7, 1.1), (3.1, 0.8), (11.0, 0.3))
    floor = sum(a * np.sin(2.0 * np.pi * f * t) for f, a in parts)
    seat = sum(a / f * np.sin(2.0 * np.pi * f * t - 0.7) for f, a in parts)
    return Ride(t, floor, seat)


def comma(text: str) -> str:
    return text.replace(".", ",")


def clock(seconds: float, start: float = 36_000.0) -> str:
    milliseconds = round(1000.0 * (start + seconds)) % 86_400_000
    minutes, rest = divmod(milliseconds, 60_000)
    return f"{minutes // 60:02d}:{minutes % 60:02d}:{rest // 1000:02d}.{rest % 1000:03d}"


def text(
    path: Path,
    head: str,
    ride: Ride,
    row: Callable[[float, float, float], str],
    *,
    encoding: str = "utf-8",
    end: str = "\n",
    tail: str = "",
) -> Path:
    """Write a text file of a head and a row for each sample."""
    rows = (row(*values) for values in zip(*(column.tolist() for column in ride), strict=True))
    path.write_bytes((end.join([*head.split("\n"), *rows]) + end + tail).encode(encoding))
    return path


KINDS: dict[str, Callable[[Path, Ride], Logged]] = {}
"""Name of a kind of file to what writes one."""


def kind(write: Callable[[Path, Ride], Logged]) -> Callable[[Path, Ride], Logged]:
    KINDS[write.__name__] = write
    return write


@kind
def plain_commas(folder: Path, ride: Ride) -> Logged:
    path = text(folder / "a.csv", "time,acc_floor,acc_seat", ride, lambda t, x, y: f"{t:.3f},{x:.5f},{y:.5f}")
    return Logged(path, 1e-5)


@kind
def decimal_commas_with_mark(folder: Path, ride: Ride) -> Logged:
    head = "time [s];acc_floor [g];acc_seat [g]"
    path = text(
        folder / "a.csv",
        head,
        ride,
        lambda t, x, y: comma(f"{t:.3f};{x / GRAVITY:.6f};{y / GRAVITY:.6f}"),
        encoding="utf-8-sig",
        end="\r\n",
    )
    return Logged(path, 1e-6 * GRAVITY)


@kind
def row_of_units_in_latin_1(folder: Path, ride: Ride) -> Logged:
    head = "Messgerät;Nr. 12\nOrt;Kabine\n\nZeit;acc_floor;acc_seat\nms;m/s²;mm/s²"
    path = text(
        folder / "a.csv", head, ride, lambda t, x, y: comma(f"{1e3 * t:.0f};{x:.4f};{1e3 * y:.1f}"), encoding="latin-1"
    )
    return Logged(path, 1e-4)


@kind
def quoted_numbers(folder: Path, ride: Ride) -> Logged:
    head = '"time (ms)","acc_floor (g)","acc_seat (g)"'
    row = '"{:.0f}","{:.6f}","{:.6f}"'
    path = text(folder / "a.csv", head, ride, lambda t, x, y: row.format(1e3 * t, x / GRAVITY, y / GRAVITY))
    return Logged(path, 1e-6 * GRAVITY)


@kind
def quoted_decimal_commas_between_commas(folder: Path, ride: Ride) -> Logged:
    head = '"time [s]","acc_floor [m/s^2]","acc_seat [m/s^2]"'
    row = '"{:.3f}","{:.5f}","{:.5f}"'
    path = text(
        folder / "a.csv", head, ride, lambda t, x, y: comma(row.format(t, x, y).replace(",", "\0")).replace("\0", ",")
    )
    return Logged(path, 1e-5)


@kind
def upper_case_tabs_utf_16(folder: Path, ride: Ride) -> Logged:
    head = "TIME [MS]\tACC_FLOOR [G]\tACC_SEAT [M/S2]"
    path = text(
        folder / "a.txt", head, ride, lambda t, x, y: f"{1e3 * t:.0f}\t{x / GRAVITY:.6f}\t{y:.5f}", encoding="utf-16"
    )
    return Logged(path, 1e-5)


@kind
def utf_16_without_mark(folder: Path, ride: Ride) -> Logged:
    head = "time [s];acc_floor [m/s2];acc_seat [m/s2]"
    path = text(folder / "a.txt", head, ride, lambda t, x, y: comma(f"{t:.3f};{x:.5f};{y:.5f}"), encoding="utf-16-be")
    return Logged(path, 1e-5)


@kind
def comment_lines(folder: Path, ride: Ride) -> Logged:
    head = "# logger 3000, serial 12\n# cab, 2024-03-01\ntime [s],acc_floor [m/s2],acc_seat [m/s2]"
    path = text(folder / "a.csv", head, ride, lambda t, x, y: f"{t:.3f},{x:.5f},{y:.5f}", tail="# end\n")
    return Logged(path, 1e-5)


@kind
def header_in_a_comment(folder: Path, ride: Ride) -> Logged:
    head = "% made by a script\n% time [s], acc_floor [m/s2], acc_seat [m/s2]"
    path = text(folder / "a.dat", head, ride, lambda t, x, y: f"{t:.3f}, {x:.5f}, {y:.5f}")
    return Logged(path, 1e-5)


@kind
def units_behind_strokes(folder: Path, ride: Ride) -> Logged:
    head = "Time/ms;Acc_floor/m/s^2;Acc_seat/m/s^2;State;"
    path = text(folder / "a.csv", head, ride, lambda t, x, y: f"{1e3 * t:.0f};{x:.5f};{y:.5f};OK;")
    return Logged(path, 1e-5)


@kind
def units_at_the_end_of_names(folder: Path, ride: Ride) -> Logged:
    path = text(
        folder / "a.csv", "t_ms;acc_floor_g;acc_seat in m/s²", ride,
        lambda t, x, y: f"{1e3 * t:.0f};{x / GRAVITY:.6f};{y:.5f}",
    )  # fmt: skip
    return Logged(path, 1e-5)


@kind
def aligned_by_blanks(folder: Path, ride: Ride) -> Logged:
    head = "   time [s]    acc_floor [m/s2]  acc_seat [m/s2]"
    path = text(folder / "a.txt", head, ride, lambda t, x, y: f"  {t:10.3f}  {x:12.5f} {y:12.5f}")
    return Logged(path, 1e-5)


@kind
def strokes_and_milli_g(folder: Path, ride: Ride) -> Logged:
    head = "time [µs]|acc_floor [mg]|acc_seat [mg]"
    path = text(
        folder / "a.csv", head, ride, lambda t, x, y: f"{1e6 * t:.0f}|{1e3 * x / GRAVITY:.3f}|{1e3 * y / GRAVITY:.3f}"
    )
    return Logged(path, 1e-6 * GRAVITY)


@kind
def times_of_day_over_midnight(folder: Path, ride: Ride) -> Logged:
    head = "Time;acc_floor [m/s2];acc_seat [m/s2]"
    path = text(folder / "a.csv", head, ride, lambda t, x, y: comma(f"{clock(t, 86_398.0)};{x:.5f};{y:.5f}"))
    return Logged(path, 1e-5)


@kind
def dates_over_the_end_of_february(folder: Path, ride: Ride) -> Logged:
    def row(t: float, x: float, y: float) -> str:
        day = "2024-02-29" if t < 2.0 - 1e-9 else "2024-03-01"
        return f"{day}T{clock(t, 86_398.0)}Z,{x:.5f},{y:.5f}"

    return Logged(text(folder / "a.csv", "timestamp,acc_floor [m/s2],acc_seat [m/s2]", ride, row), 1e-5)


@kind
def german_dates(folder: Path, ride: Ride) -> Logged:
    def row(t: float, x: float, y: float) -> str:
        day = "31.01.24" if t < 2.0 - 1e-9 else "01.02.24"
        return f"{day} " + comma(f"{clock(t, 86_398.0)};{x:.5f};{y:.5f}")

    return Logged(text(folder / "a.csv", "Zeit;acc_floor [m/s2];acc_seat [m/s2]", ride, row), 1e-5)


@kind
def american_dates(folder: Path, ride: Ride) -> Logged:
    def row(t: float, x: float, y: float) -> str:
        return f"1/31/2024 {clock(t, 3600.0)[1:]} PM,{x:.5f},{y:.5f}"

    return Logged(text(folder / "a.csv", "time,acc_floor [m/s2],acc_seat [m/s2]", ride, row), 1e-5)


@kind
def epoch_in_s(folder: Path, ride: Ride) -> Logged:
    head = "time,acc_floor [m/s2],acc_seat [m/s2]"
    path = text(folder / "a.csv", head, ride, lambda t, x, y: f"{1.7e9 + t:.3f},{x:.5f},{y:.5f}")
    return Logged(path, 1e-5)


@kind
def epoch_in_ns(folder: Path, ride: Ride) -> Logged:
    head = "time,acc_floor [m/s2],acc_seat [m/s2]"
    path = text(folder / "a.csv", head, ride, lambda t, x, y: f"{17 * 10**17 + round(1e9 * t)},{x:.5f},{y:.5f}")
    return Logged(path, 1e-5)


@kind
def days_of_a_spreadsheet(folder: Path, ride: Ride) -> Logged:
    head = "time,acc_floor [m/s2],acc_seat [m/s2]"
    path = text(folder / "a.csv", head, ride, lambda t, x, y: f"{45_000.0 + t / 86_400.0:.11f},{x:.5f},{y:.5f}")
    return Logged(path, 1e-5)


@kind
def no_times(folder: Path, ride: Ride) -> Logged:
    path = text(folder / "a.csv", "acc_floor [m/s2];acc_seat [m/s2]", ride, lambda t, x, y: comma(f"{x:.5f};{y:.5f}"))
    return Logged(path, 1e-5, options=ReadOptions(ClockRequest(rate=RATE)))


@kind
def no_header(folder: Path, ride: Ride) -> Logged:
    first = "0.000 0.00000 0.00000"
    rest = Ride(*(column[1:] for column in ride))
    path = text(folder / "a.txt", first, rest, lambda t, x, y: f"{t:.3f} {x:.5f} {y:.5f}")
    first_seat = abs(ride.seat[0])
    return Logged(path, max(1e-5, 2.0 * first_seat), "2", "#3", ReadOptions(ClockRequest("1")), unit="m/s2")


@kind
def whole_numbers_with_the_unit_as_an_option(folder: Path, ride: Ride) -> Logged:
    head = "sample;time [s];acc_floor [counts];acc_seat [counts]"
    path = text(folder / "a.csv", head, ride, lambda t, x, y: f"{t * RATE:.0f};{t:.3f};{1e3 * x:.0f};{1e3 * y:.0f}")
    return Logged(path, 1e-3, unit="mm/s2")


@kind
def form_as_options(folder: Path, ride: Ride) -> Logged:
    head = "time [s]\tacc_floor [m/s2]\tacc_seat [m/s2]"
    path = text(folder / "a.csv", head, ride, lambda t, x, y: comma(f"{t:.3f}\t{x:.5f}\t{y:.5f}"), encoding="cp037")
    return Logged(path, 1e-5, options=ReadOptions(text=TextOptions("\t", ",", "cp037")))


@kind
def mdf_4(folder: Path, ride: Ride) -> Logged:
    import asammdf

    signals = [
        asammdf.Signal(ride.floor / GRAVITY, ride.time + 12.0, name="acc_floor", unit="g"),
        asammdf.Signal(ride.seat.astype(np.float32), ride.time + 12.0, name="acc_seat", unit="m/s^2"),
    ]
    with asammdf.MDF(version="4.10") as mdf:
        mdf.append(signals, common_timebase=True)
        mdf.save(folder / "a.mf4")
    return Logged(folder / "a.mf4", 1e-6)


def _mat(path: Path, content: dict[str, Any], resolution: float, floor: str, seat: str, time: str) -> Logged:
    import scipy.io

    scipy.io.savemat(path, content)
    return Logged(path, resolution, floor, seat, ReadOptions(ClockRequest(time)))


@kind
def mat_vectors(folder: Path, ride: Ride) -> Logged:
    content = {"t": ride.time, "floor": ride.floor / GRAVITY, "floor_unit": "g", "seat": ride.seat[:, None]}
    return _mat(folder / "a.mat", content, 1e-12, "floor", "seat", "t")


@kind
def mat_structures(folder: Path, ride: Ride) -> Logged:
    acc = {"data": np.column_stack([ride.floor, ride.seat]), "unit": "m/s^2"}
    content = {"run": {"time": 1e3 * ride.time, "time_unit": "ms", "acc": acc}}
    return _mat(folder / "a.mat", content, 1e-12, "run.acc.data(1)", "run.acc.data(2)", "run.time")


@kind
def parquet(folder: Path, ride: Ride) -> Logged:
    import pyarrow
    import pyarrow.parquet

    moments = pyarrow.array(
        np.datetime64("2024-03-01T10:00", "us") + np.rint(1e6 * ride.time).astype("timedelta64[us]")
    )
    columns = {"time": moments, "acc_floor [g]": ride.floor / GRAVITY, "acc_seat": ride.seat}
    pyarrow.parquet.write_table(pyarrow.table(columns), folder / "a.parquet")
    return Logged(folder / "a.parquet", 1e-12)
