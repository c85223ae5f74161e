"""Times of samples in s: numbers with a unit, epochs, times of day, dates."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from cosim.errors import SetupError
from cosim.recordings.columns import Column
from cosim.recordings.measurement_file import Floats, MeasurementFile, package
from cosim.recordings.quantities import TIME, find_unit
from cosim.recordings.text_format import DATE, TIME_OF_DAY, ZONE

USUAL_NAMES = (
    "time",
    "t",
    "timestamp",
    "zeit",
    "temps",
    "tiempo",
    "tempo",
    "date time",
    "datetime",
    "date/time",
    "x-axis",
)
"""Names of columns of times, in lower case."""

DAY = 86400.0

_EPOCHS = (
    # from, to, unit, its length in s; 1973 to 2100
    (1e8, 4.2e9, "s", 1.0),
    (1e11, 4.2e12, "ms", 1e-3),
    (1e14, 4.2e15, "µs", 1e-6),
    (1e17, 4.2e18, "ns", 1e-9),
)
"""Ranges of times since an epoch by their unit."""

_SPREADSHEET = (20_000.0, 80_000.0, 1e-4)
"""Range of the days that spreadsheets count, and the longest step between rows that are counted so."""


class Times(NamedTuple):
    """Times of all rows.

    Attributes
    ----------
    seconds
        In s from the first row; NaN where a row has none.
    resolution
        Last place of the written times in s; 0 where it is not known.
    notes
        What was recognized.
    is_assumed
        Whether neither the file nor the caller says the unit, and nothing in the values does.
    """

    seconds: Floats
    resolution: float
    notes: tuple[str, ...] = ()
    is_assumed: bool = False


def is_usual_name(column: Column) -> bool:
    """Whether a column is named as columns of times are."""
    return column.name.casefold().rstrip(":") in USUAL_NAMES


def read_times(file: MeasurementFile, index: int, column: Column, unit: str | None) -> Times:
    """Convert a column to times.

    Parameters
    ----------
    file
        The file; the column is loaded.
    index, column
        The column.
    unit
        Unit that the caller gives; None for the file's.

    Returns
    -------
    Times
        In s.

    Raises
    ------
    SetupError
        If the column holds no times, or its unit is none of time.
    """
    values = file.values(index)
    where = f"{file.path}, {column.text}"
    if values.dtype.kind == "M":
        return _from_start(np.asarray((values - values[0]) / np.timedelta64(1, "ns"), dtype=np.float64) * 1e-9)
    if values.dtype.kind != "f" and _begins_with_a_number(values):
        values = _as_numbers(file, values)
    if values.dtype.kind == "f":
        return _numbers(where, values, unit or column.unit, given=unit is not None)
    return _texts(file, where, values)


def _begins_with_a_number(values: np.ndarray[Any, Any]) -> bool:
    first = next((value for value in values if value is not None and value == value), None)
    return as_number(first) is not None


def as_number(value: object) -> float | None:
    """Return a value as a number; NaN for a missing one, None for one that is no number.

    Parameters
    ----------
    value
        A number, a text, or None.
    """
    try:
        return float("nan") if value is None else float(value)  # type: ignore[arg-type]  # others raise
    except (TypeError, ValueError):
        return None


def _as_numbers(file: MeasurementFile, values: np.ndarray[Any, Any]) -> Floats:
    """Convert a column of numbers, of which at least one is none."""
    numbers = [as_number(value) for value in values]
    if None in numbers:
        row = numbers.index(None)
        raise _no_time(file, row, values)
    return np.array(numbers, dtype=np.float64)


def _no_time(file: MeasurementFile, row: int, values: np.ndarray[Any, Any]) -> SetupError:
    return SetupError(
        f"{file.path}, {file.place(row)}: expected a time as a number, as hours:minutes:seconds or with a date, got "
        f"{str(values[row])[:40]}"
    )


def _from_start(seconds: Floats, notes: Sequence[str] = ()) -> Times:
    present = seconds[~np.isnan(seconds)]
    first = present[0] if len(present) else 0.0
    seconds = seconds - first
    return Times(seconds, last_place(present - first, float(np.abs(present).max(initial=0.0))), tuple(notes))


def last_place(values: Floats, largest: float) -> float:
    """Return the power of ten of which all values are multiples; 0 where there is none from 1 down to 1e-9.

    Parameters
    ----------
    values
        Differences of the numbers in a file from the first one.
    largest
        Largest of these numbers, which sets the rounding of the differences.
    """
    for digits in range(10):
        scaled = values * 10.0**digits
        tolerance = max(1e-5, 4e-16 * largest * 10.0**digits)
        if tolerance < _CLEAR and np.all(np.abs(scaled - np.rint(scaled)) <= tolerance):
            return float(10.0**-digits)
    return 0.0


_CLEAR = 0.1
"""Share of a place up to which rounding of floats leaves no doubt about it."""


def _numbers(where: str, values: Floats, unit: str | None, given: bool) -> Times:
    """Convert numbers by their unit, or as an epoch where none is known."""
    first = float(values[~np.isnan(values)][0]) if not np.all(np.isnan(values)) else 0.0
    if unit is not None:
        found = find_unit(unit, TIME)
        if found is None:
            hint = "" if given else "; --time-unit says what it is"
            raise SetupError(f"{where}: expected a unit of time, got {unit}{hint}")
        if found.factor < 1000.0 or given:
            return _scaled(values, first, found.factor)
    for low, high, name, length in _EPOCHS:
        if unit is None and low <= first < high:
            return _scaled(values, first, length, [f"{where}: times are read as {name} since an epoch"])
    step = float(np.nanmedian(np.diff(values[:10_000]))) if len(values) > 1 else 0.0
    low, high, longest = _SPREADSHEET
    if low <= first < high and 0.0 < step < longest:
        return _scaled(values, first, DAY, [f"{where}: times are read as days of a spreadsheet"])
    if unit is not None and found is not None:
        return _scaled(values, first, found.factor)
    return _scaled(values, first, 1.0, [f"{where}: no unit is declared; times are read as s"])._replace(is_assumed=True)


def _scaled(values: Floats, first: float, factor: float, notes: Sequence[str] = ()) -> Times:
    counts = values - first
    place = last_place(counts[~np.isnan(counts)], float(np.nanmax(np.abs(values), initial=0.0)))
    return Times(counts * factor, place * factor, tuple(notes))


_OF_DAY, _WITH_DATES = "times are read as times of day", "times are read as dates with times"


def _texts(file: MeasurementFile, where: str, values: np.ndarray[Any, Any]) -> Times:
    """Convert times of day, with or without dates."""
    pandas = package("pandas")
    if (quick := _same_layout(values)) is not None:
        seconds, dates = quick
        if dates is None:
            return _from_start(_past_midnight(seconds), [f"{where}: {_OF_DAY}"])
        return _from_start(seconds + DAY * _days(pandas, where, dates), [f"{where}: {_WITH_DATES}"])
    series = pandas.Series(values, dtype=object)
    missing = series.isna()
    words = series.where(~missing, "").astype(str).str.strip()
    zone = f"(?:{ZONE.pattern})$"
    date = words.str.extract(rf"^({DATE.pattern})(?:[T\s]|$)", expand=False)
    rest = words.str.replace(rf"^(?:{DATE.pattern})[T\s]*", "", regex=True)
    zones = rest.str.extract(rf"({zone})", expand=False).dropna().unique()
    if len(zones) > 1:
        raise SetupError(f"{where}: expected one time zone, got {' and '.join(map(str, zones[:2]))}")
    clock = rest.str.replace(zone, "", regex=True).str.strip()
    good = clock.str.fullmatch(TIME_OF_DAY.pattern) | missing | ((clock == "") & date.notna())
    if not good.all():
        row = int(np.flatnonzero(~good.to_numpy(dtype=bool))[0])
        raise _no_time(file, row, values)
    seconds = _seconds_of_day(pandas, clock)
    seconds[missing.to_numpy(dtype=bool)] = np.nan
    if date.notna().any():
        return _from_start(seconds + DAY * _days(pandas, where, date), [f"{where}: {_WITH_DATES}"])
    return _from_start(_past_midnight(seconds), [f"{where}: {_OF_DAY}"])


_LAYOUT = re.compile(rf"((?:{DATE.pattern})[T ]|)(\d\d):(\d\d):(\d\d)(?:[.,:](\d+))?((?:{ZONE.pattern})?)")


def _same_layout(values: np.ndarray[Any, Any]) -> tuple[Floats, np.ndarray[Any, Any] | None] | None:
    """Return seconds since midnight, and dates, of times that are all written alike, digit by digit.

    A million texts take a tenth of the time that they take one by one. None where the texts are not alike.
    """
    found = _LAYOUT.fullmatch(values[0]) if len(values) and isinstance(values[0], str) else None
    if found is None:
        return None
    width = len(values[0])
    try:
        characters = np.array(values.tolist(), dtype=f"S{width + 1}").view(np.uint8).reshape(len(values), width + 1)
    except (TypeError, UnicodeEncodeError):
        return None
    spans = [found.span(group) for group in (2, 3, 4, 5) if found[group] is not None]
    is_digit = np.zeros(width + 1, dtype=bool)
    for begin, end in spans:
        is_digit[begin:end] = True
    is_date = np.arange(width + 1) < found.end(1)
    digits = characters[:, is_digit].astype(np.int64) - ord("0")
    same = characters[:, ~(is_digit | is_date)]  # the last one is 0, unless a text is longer
    if np.any(digits < 0) or np.any(digits > 9) or np.any(same != same[0]):
        return None
    seconds, column = np.zeros(len(values)), 0
    units = (3600.0, 60.0, 1.0, 10.0 ** -(spans[-1][1] - spans[-1][0]))
    for (begin, end), unit in zip(spans, units, strict=False):
        places = 10.0 ** np.arange(end - begin - 1, -1, -1)
        seconds += unit * (digits[:, column : column + end - begin] @ places)
        column += end - begin
    if not found[1]:
        return seconds, None
    dates = np.ascontiguousarray(characters[:, is_date]).view(f"S{found.end(1)}").ravel()
    names, codes = np.unique(dates, return_inverse=True)
    texts = np.array([name.decode("ascii").rstrip("T ") for name in names], dtype=object)
    return (seconds, texts[codes]) if all(re.fullmatch(DATE.pattern, text) for text in texts) else None


def _seconds_of_day(pandas: Any, clock: Any) -> Floats:
    """Return the seconds since midnight of texts such as 23:59:59.5, 23:59:59,5 and 11:59:59.5 PM."""
    half = clock.str.extract(r"([AaPp])[Mm]$", expand=False).str.lower()
    plain = clock.str.replace(r"\s*[AaPp][Mm]$", "", regex=True).str.replace(",", ".", regex=False)
    plain = plain.str.replace(r"^(\d+:\d+:\d+):", r"\1.", regex=True).str.replace(r"^(\d+:\d+)$", r"\1:00", regex=True)
    spans = pandas.to_timedelta(plain.replace("", "0:00:00"))
    seconds = np.array(spans.dt.total_seconds(), dtype=np.float64)
    is_half = half.notna().to_numpy(dtype=bool)
    if is_half.any():
        seconds[is_half] = np.mod(seconds[is_half], DAY / 2.0)
        seconds[(half == "p").to_numpy(dtype=bool)] += DAY / 2.0
    return seconds


def _days(pandas: Any, where: str, date: Any) -> Floats:
    """Return the days of dates, from any day on; of ambiguous ones, those that are closest together."""
    codes, names = pandas.factorize(date)
    parts = [[int(number) for number in re.split(r"[-/.]", name)] for name in names]
    is_iso = parts[0][0] > 31
    orders = ("%Y %m %d",) if is_iso else ("%d %m %Y", "%m %d %Y")
    parts = [each if is_iso or each[2] > 99 else [*each[:2], each[2] + 2000] for each in parts]
    choices = []
    for order in orders:
        texts = [" ".join(map(str, each)) for each in parts]
        try:
            found = pandas.to_datetime(pandas.Series(texts), format=order)
        except ValueError:
            continue
        days = (found - found.min()).dt.days.to_numpy(dtype=np.float64)
        choices.append((days.max(), days))
    if not choices:
        raise SetupError(f"{where}: expected dates, got {names[0]}")
    days = min(choices, key=lambda choice: choice[0])[1]
    return np.where(codes < 0, np.nan, days[codes])


def _past_midnight(seconds: Floats) -> Floats:
    """Count on where times of day begin again at midnight."""
    steps = np.diff(seconds, prepend=seconds[:1])
    with np.errstate(invalid="ignore"):
        return seconds + DAY * np.cumsum(steps < -DAY / 2.0)
