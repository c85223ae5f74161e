"""Sampling of recorded channels: rounded times, jitter, gaps, and samples at one constant rate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from cosim.errors import SetupError
from cosim.recordings.measurement_file import Floats

GAP = 2.5
"""Longest step that is not a gap, in mean steps: a single missing sample is interpolated."""

EVEN = 1e-3
"""Largest deviation of a time from an even one, in steps, that is no jitter."""

_ROUNDING = 0.75
"""Largest deviation of a rounded time from an even one, in last places."""


_LOST = 0.1
"""RMS scatter of steps, in mean steps, below which a double step is a lost sample and no jitter."""


class Gap(NamedTuple):
    """A time without samples.

    Attributes
    ----------
    begin, duration
        In s, the begin from the first sample.
    """

    begin: float
    duration: float


class Stretch(NamedTuple):
    """Samples without a gap.

    Attributes
    ----------
    times
        Times of the samples in s; even ones where those of the file are rounded.
    values
        Values at these times.
    is_even
        Whether the times are evenly spaced.
    """

    times: Floats
    values: Floats
    is_even: bool


@dataclass(frozen=True)
class Sampling:
    """Samples of a channel.

    Attributes
    ----------
    rate
        Mean sampling rate in Hz, without gaps.
    stretches
        Samples between gaps.
    gaps
        The gaps.
    rounding
        Last place of times that are rounded, in s; 0 where they are not.
    jitter
        RMS deviation of the times from even ones, in s; 0 where they are even or rounded.
    lost
        Number of single missing samples.
    """

    rate: float
    stretches: tuple[Stretch, ...]
    gaps: tuple[Gap, ...]
    rounding: float = 0.0
    jitter: float = 0.0
    lost: int = 0


def sample(where: str, times: Floats, values: Floats, resolution: float, rows: np.ndarray[Any, Any]) -> Sampling:
    """Determine how a channel is sampled.

    Parameters
    ----------
    where
        File and channel, for messages.
    times, values
        Finite times in s and values, shape (samples,).
    resolution
        Last place of the written times in s; 0 where it is not known.
    rows
        Numbers of the rows in the file from 0, for messages.

    Returns
    -------
    Sampling
        Rate, samples between gaps, and what is uneven.

    Raises
    ------
    SetupError
        If there are too few samples, or times go back or stand still.
    """
    if len(times) < 10:
        raise SetupError(f"{where}: expected at least 10 samples, got {len(times)}")
    steps = np.diff(times)
    back = np.flatnonzero(steps < 0.0)
    if len(back):
        at = int(back[0])
        raise SetupError(
            f"{where}: expected times that rise, got {times[at + 1]:.9g} s after {times[at]:.9g} s in row "
            f"{rows[at + 1] + 1}"
        )
    step = _mean_step(steps, resolution)
    if not step > 0.0:
        raise SetupError(f"{where}: expected times that rise, got {times[0]:.9g} s throughout")
    is_gap = steps > GAP * step + (resolution if resolution > step else 0.0)
    ends = np.flatnonzero(is_gap)
    gaps = tuple(Gap(float(times[at] - times[0]), float(steps[at])) for at in ends)
    cuts = [0, *(int(at) + 1 for at in ends), len(times)]
    spans = [slice(begin, end) for begin, end in pairwise(cuts)]
    fits = [_fit(times[span], step) for span in spans]
    worst = max(float(np.abs(times[span] - fit).max()) for span, fit in zip(spans, fits, strict=True))
    if worst <= EVEN * step:
        return Sampling(_rate(fits), _stretches(spans, fits, values, True), gaps)
    if resolution and worst <= _ROUNDING * resolution:
        return Sampling(_rate(fits), _stretches(spans, fits, values, True), gaps, rounding=resolution)
    still = np.flatnonzero(steps <= 0.0)
    if len(still):
        at = int(still[0])
        raise SetupError(
            f"{where}: expected times that rise, got {times[at]:.9g} s twice, in rows {rows[at] + 1} and "
            f"{rows[at + 1] + 1}"
        )
    inside = steps[~is_gap]
    single = inside[inside <= 1.5 * step]
    jitter = float(np.sqrt(np.mean(np.square(single - step))))
    lost = len(inside) - len(single) if jitter < _LOST * step else 0
    if not lost:
        jitter = float(np.sqrt(np.mean(np.square(inside - step))))
    own = [times[span] for span in spans]
    rate = float(f"{1.0 / step:.3g}")
    return Sampling(rate, _stretches(spans, own, values, False), gaps, jitter=jitter, lost=lost)


def _mean_step(steps: Floats, resolution: float) -> float:
    """Return the mean step between samples, without gaps and lost samples."""
    step = float(np.median(steps))
    for _ in range(5):  # the median of rounded times is rounded, and 0 where several share one
        inside = steps[steps <= max(GAP * step, 2.0 * resolution)]
        mean = float(inside.mean()) if len(inside) else step
        if mean == step:
            break
        step = mean
    single = steps[steps <= 1.5 * step]
    if len(single) and float(np.std(single)) < _LOST * step and resolution < _LOST * step:
        return float(single.mean())
    return step


def _fit(times: Floats, step: float) -> Floats:
    """Return the evenly spaced times that are closest to those of a stretch."""
    count = np.arange(len(times), dtype=np.float64)
    if len(times) < 10:
        return np.asarray(times[0] + step * count)
    centred = count - count.mean()
    slope = float(centred @ (times - times[0]) / (centred @ centred))
    return np.asarray(times.mean() + slope * centred)


def _rate(stretches: Sequence[Floats]) -> float:
    """Return the rate of evenly spaced times; a whole number where that moves no sample."""
    count = sum(len(times) - 1 for times in stretches)
    rate = count / sum(float(times[-1] - times[0]) for times in stretches)
    whole = float(np.rint(rate))
    return whole if abs(whole - rate) * count <= EVEN * rate else float(rate)


def _stretches(spans: Sequence[slice], times: Sequence[Floats], values: Floats, is_even: bool) -> tuple[Stretch, ...]:
    return tuple(Stretch(time, values[span], is_even) for span, time in zip(spans, times, strict=True))


def common_spans(samplings: Sequence[Sampling]) -> list[tuple[float, float]]:
    """Return the spans of time in which all channels have samples.

    Parameters
    ----------
    samplings
        Samplings of the channels.

    Returns
    -------
    list of tuple of float
        Begin and end of each span in s.
    """
    spans = [(-np.inf, np.inf)]
    for sampling in samplings:
        own = [(float(each.times[0]), float(each.times[-1])) for each in sampling.stretches]
        spans = [
            (max(a, c), min(b, d)) for a, b in spans for c, d in own if min(b, d) - max(a, c) > 0.5 / sampling.rate
        ]
    return [(float(a), float(b)) for a, b in spans]


def resample(sampling: Sampling, begin: float, count: int, rate: float) -> Floats:
    """Return samples at a constant rate.

    Samples that are evenly spaced at that rate are taken as they are. Others are interpolated by a cubic spline.

    Parameters
    ----------
    sampling
        Samples of a channel, without a gap from the begin to the end.
    begin
        Time of the first sample in s.
    count
        Number of samples.
    rate
        In Hz.

    Returns
    -------
    ndarray
        Shape (count,).
    """
    stretch = next(
        each for each in sampling.stretches if each.times[0] <= begin + 0.5 / rate <= each.times[-1] + 1.0 / rate
    )
    first = (begin - stretch.times[0]) * rate
    end = (stretch.times[-1] - stretch.times[0]) * rate
    same_rate = abs(end - (len(stretch.times) - 1)) < 20.0 * EVEN
    offset = round(first)
    if stretch.is_even and same_rate and abs(first - offset) < 20.0 * EVEN and offset + count <= len(stretch.values):
        return stretch.values[offset : offset + count]
    from scipy.interpolate import CubicSpline

    wanted = np.clip(begin + np.arange(count) / rate, stretch.times[0], stretch.times[-1])
    return np.asarray(CubicSpline(stretch.times, stretch.values)(wanted), dtype=np.float64)
