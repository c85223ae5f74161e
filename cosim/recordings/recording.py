"""Channels of a measurement file in SI units, at one constant rate."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from cosim.errors import SetupError, listed
from cosim.recordings.clock import Times, as_number, is_usual_name, last_place, read_times
from cosim.recordings.columns import Column, choose_column
from cosim.recordings.files import open_file
from cosim.recordings.measurement_file import Floats, MeasurementFile
from cosim.recordings.quantities import TIME, Quantity, find_unit
from cosim.recordings.requests import ChannelRequest, ClockRequest, ReadOptions
from cosim.recordings.sampling import Sampling, common_spans, resample, sample
from cosim.units import Unit


class ChannelInfo(NamedTuple):
    """A channel that was read.

    Attributes
    ----------
    column
        Its name in the file.
    quantity
        Its quantity, in whose SI unit the values are.
    unit
        Unit of the values in the file; None where neither file nor caller says, and they were taken as in the SI unit.
    rate
        Its own sampling rate in Hz.
    """

    column: str
    quantity: Quantity
    unit: str | None
    rate: float


@dataclass(frozen=True, eq=False)
class Part:
    """Samples without a gap.

    Attributes
    ----------
    begin
        Time of the first sample in s, from that of the recording.
    values
        Channel to its samples in its SI unit, shape (samples,).
    """

    begin: float
    values: Mapping[str, Floats]

    @property
    def size(self) -> int:
        """Number of samples of each channel."""
        return len(next(iter(self.values.values())))


@dataclass(frozen=True)
class Recording:
    """Channels of a measurement file.

    Attributes
    ----------
    path
        The file.
    rate
        Sampling rate of all channels in Hz.
    parts
        Samples between gaps; one part where there are none.
    channels
        What each channel is in the file.
    notes
        What was recognized, converted or resampled.
    """

    path: Path
    rate: float
    parts: tuple[Part, ...]
    channels: Mapping[str, ChannelInfo]
    notes: tuple[str, ...]

    @property
    def duration(self) -> float:
        """Duration of all parts together, in s."""
        return sum(part.size for part in self.parts) / self.rate

    def samples(self, channel: str) -> Floats:
        """Return the samples of a channel, of all parts one after the other, shape (samples,)."""
        return np.concatenate([part.values[channel] for part in self.parts])


def read_recording(path: Path, channels: Mapping[str, ChannelRequest], options: ReadOptions | None = None) -> Recording:
    """Read channels of a measurement file.

    Separator, decimal sign, encoding, header, units and kind of times of a text file are found. Times that are rounded
    are made even, uneven ones lead to samples that are interpolated by a cubic spline; the notes say so.

    Parameters
    ----------
    path
        Text, MDF, MAT up to version 7, or Parquet.
    channels
        Key of each channel in the result to its request.
    options
        How to read.

    Returns
    -------
    Recording
        Samples in SI units at one rate.

    Raises
    ------
    SetupError
        If file, column, unit or samples are not what is expected; the message says what helps.
    """
    options = options or ReadOptions()
    file = open_file(path, options.text)
    chosen = {key: _choose(file, request) for key, request in channels.items()}
    clock = _choose_clock(file, options.clock, [index for index, _ in chosen.values()])
    file.load([index for index, _ in chosen.values()] + ([] if clock is None else [clock[0]]))
    times = None if clock is None else read_times(file, *clock, options.clock.unit)
    notes = [f"{path}: {file.description}", *([] if times is None else times.notes)]
    infos: dict[str, ChannelInfo] = {}
    samplings: dict[str, Sampling] = {}
    for key, (index, column) in chosen.items():
        unit, quantity = _unit(path, column, channels[key])
        own = times or _own_times(file, index, column, options.clock)
        values = _numbers(file, index, column) * (1.0 if unit is None else unit.factor)
        where = f"{path}, {column.text}"
        samplings[key] = _sampling(where, own, values, options)
        _check_rate(path, own, samplings[key].rate)
        notes += _missing_notes(where, own, values)
        name = channels[key].unit or column.unit
        infos[key] = ChannelInfo(column.text, quantity, None if unit is None else name, samplings[key].rate)
        notes += _unit_notes(path, column, channels[key], quantity)
    _check_gaps(path, samplings, options)
    notes += _sampling_notes(path, infos, samplings)
    rate, parts = _assemble(path, samplings)
    return Recording(path, rate, parts, infos, tuple(dict.fromkeys(notes)))


def _choose(file: MeasurementFile, request: ChannelRequest) -> tuple[int, Column]:
    """Choose a channel's column; a unit at the end of its name may be of any of its quantities."""
    found, errors = [], []
    for quantity in request.quantities:
        try:
            found.append(choose_column(file.columns, request.name, request.option, quantity))
        except SetupError as error:
            errors.append(error)
    if not found:
        raise SetupError(f"{file.path}, {errors[0]}{getattr(file, 'misfit', '')}")
    return next((each for each in found if each[1].unit is not None), found[0])


def _choose_clock(file: MeasurementFile, clock: ClockRequest, channels: Sequence[int]) -> tuple[int, Column] | None:
    """Choose the column of times; None where the file has times by channel, or the rate is given."""
    if clock.rate is not None:
        if clock.name is not None or clock.unit is not None:
            raise SetupError(f"--rate {clock.rate:g}: expected without --time and --time-unit, got both")
        if not 0.0 < clock.rate < np.inf:
            raise SetupError(f"--rate {clock.rate:g}: expected a number of samples per second above 0")
        return None
    own = getattr(file, "clocks", None)
    if own is not None and (clock.name is None or clock.name in own):
        return None
    if clock.name is not None:
        try:
            return choose_column(file.columns, clock.name, "--time", TIME)
        except SetupError as error:
            raise SetupError(f"{file.path}, {error}{getattr(file, 'misfit', '')}") from None
    read = [choose_column(file.columns, f"#{i + 1}", "--time", TIME) for i in range(len(file.columns))]
    usual = [each for each in read if is_usual_name(each[1]) and each[0] not in channels]
    if len(usual) != 1:
        names = listed([column.text for column in file.columns], 20)
        raise SetupError(
            f"{file.path}: expected --time NAME with one of the columns {names}, or --rate HZ for a file without times"
        )
    return usual[0]


def _unit(path: Path, column: Column, request: ChannelRequest) -> tuple[Unit | None, Quantity]:
    """Return the unit of a channel and the quantity that it is of."""
    text = request.unit or column.unit
    if text is None:
        return None, request.quantities[0]
    for quantity in request.quantities:
        if unit := find_unit(text, quantity):
            return unit, quantity
    expected = " or ".join(f"{quantity.name} ({quantity.unit})" for quantity in request.quantities)
    help_text = "" if request.unit else "; --unit says what it is"
    raise SetupError(f"{path}, {column.text}: expected a unit of {expected}, got {text}{help_text}")


def _unit_notes(path: Path, column: Column, request: ChannelRequest, quantity: Quantity) -> list[str]:
    if request.unit and column.unit and request.unit != column.unit:
        return [f"{path}, {column.text}: read in {request.unit} as asked for, not in {column.unit} of the file"]
    if request.unit or column.unit:
        return []
    return [f"{path}, {column.text}: no unit is declared; values are read as {quantity.unit}"]


def _own_times(file: MeasurementFile, index: int, column: Column, clock: ClockRequest) -> Times:
    """Return the times of a channel: those of the file, or those of the rate that is given."""
    if clock.rate is not None:
        return Times(np.arange(len(file.values(index)), dtype=np.float64) / clock.rate, 0.0)
    own = file.times(index)
    if own is None:
        raise SetupError(f"{file.path}, {column.text}: expected times, got none")
    return Times(own, last_place(own - own[0], float(np.abs(own).max())) if len(own) else 0.0)


def _numbers(file: MeasurementFile, index: int, column: Column) -> Floats:
    """Return a column's numbers, NaN for missing ones."""
    values = file.values(index)
    if values.dtype.kind != "f":
        found = [as_number(value) for value in values]
        if None in found:
            row = found.index(None)
            got = str(values[row])[:40]
            raise SetupError(f"{file.path}, {file.place(row)}: expected a number as {column.text}, got {got}")
        values = np.array(found, dtype=np.float64)
    infinite = np.flatnonzero(np.isinf(values))
    if len(infinite):
        raise SetupError(
            f"{file.path}, {file.place(int(infinite[0]))}: expected finite numbers as {column.text}, got inf"
        )
    return np.asarray(values, dtype=np.float64)


def _sampling(where: str, times: Times, values: Floats, options: ReadOptions) -> Sampling:
    """Determine the sampling of a channel between start and stop, without missing values."""
    if len(values) != len(times.seconds):
        raise SetupError(f"{where}: expected as many values as times, got {len(values)} and {len(times.seconds)}")
    good = np.isfinite(values) & np.isfinite(times.seconds)
    low, high = (-np.inf if options.start is None else options.start, np.inf if options.stop is None else options.stop)
    if not low < high:
        raise SetupError(f"--from {low:g} --to {high:g}: expected a begin before the end")
    origin = times.seconds[good][:1].sum()
    slack = 1e-9 * (abs(origin) + 1.0)
    with np.errstate(invalid="ignore"):
        good &= (times.seconds - origin >= low - slack) & (times.seconds - origin <= high + slack)
    rows = np.flatnonzero(good)
    if len(rows) == len(values):
        return sample(where, times.seconds, values, times.resolution, rows)
    return sample(where, times.seconds[good], values[good], times.resolution, rows)


SLOWEST = 20.0
"""Lowest rate in Hz at which times without a unit are read as s."""


def _check_rate(path: Path, times: Times, rate: float) -> None:
    """Raise an error where times without a unit are too far apart to be in s."""
    if times.is_assumed and rate < SLOWEST:
        raise SetupError(
            f"{path}: expected a unit of the times, got none and {1.0 / rate:.4g} between rows; --time-unit ms (or s) "
            "says what it is"
        )


def _missing_notes(where: str, times: Times, values: Floats) -> list[str]:
    missing = int(np.count_nonzero(~np.isfinite(values) | ~np.isfinite(times.seconds)))
    return [f"{where}: {missing} rows have no value and are left out"] if missing else []


def _check_gaps(path: Path, samplings: Mapping[str, Sampling], options: ReadOptions) -> None:
    """Raise an error for gaps, where they are not to be split at."""
    gaps = sorted({gap for sampling in samplings.values() for gap in sampling.gaps})
    if gaps and options.gaps == "error":
        places = listed([f"{gap.duration:.4g} s after {gap.begin:.6g} s" for gap in gaps], 5)
        raise SetupError(
            f"{path}: expected samples without gaps, got {len(gaps)}: {places}; choose a part by --from and --to, or "
            "use --gaps split"
        )


def _sampling_notes(path: Path, infos: Mapping[str, ChannelInfo], samplings: Mapping[str, Sampling]) -> list[str]:
    notes = []
    for key, sampling in samplings.items():
        step = 1.0 / sampling.rate
        if sampling.rounding:
            notes.append(
                f"{path}: times are rounded to {sampling.rounding:g} s; samples are taken as even at "
                f"{sampling.rate:.6g} Hz"
            )
        if sampling.jitter > 0.0:
            notes.append(
                f"{path}, {infos[key].column}: steps scatter by {sampling.jitter / step:.2%} RMS about "
                f"{1e3 * step:.4g} ms; resampled at {sampling.rate:.6g} Hz by a cubic spline"
            )
        if sampling.lost:
            notes.append(f"{path}, {infos[key].column}: {sampling.lost} single samples are missing and interpolated")
        if sampling.gaps:
            total = sum(gap.duration for gap in sampling.gaps)
            notes.append(f"{path}, {infos[key].column}: split at {len(sampling.gaps)} gaps, {total:.4g} s in all")
    rates = {infos[key].column: sampling.rate for key, sampling in samplings.items()}
    if max(rates.values()) > 1.001 * min(rates.values()):
        each = ", ".join(f"{name} {rate:.6g} Hz" for name, rate in rates.items())
        notes.append(f"{path}: channels have several rates ({each}); all are resampled at the highest by cubic splines")
    return notes


def _assemble(path: Path, samplings: Mapping[str, Sampling]) -> tuple[float, tuple[Part, ...]]:
    """Return the common rate and the parts in which all channels have samples."""
    rate = max(sampling.rate for sampling in samplings.values())
    origin = min(float(sampling.stretches[0].times[0]) for sampling in samplings.values())
    parts = []
    for begin, end in common_spans(list(samplings.values())):
        count = int(np.floor((end - begin) * rate + 0.01)) + 1
        values = {key: resample(sampling, begin, count, rate) for key, sampling in samplings.items()}
        parts.append(Part(begin - origin, values))
    if not parts:
        raise SetupError(f"{path}: expected channels with samples at the same time, got none")
    return rate, tuple(parts)
