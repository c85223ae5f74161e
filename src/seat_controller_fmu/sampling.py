"""What a sampled law needs beside its equations: when samples are due, and the rate of a measured signal."""

from __future__ import annotations

import math

SAMPLE_TOLERANCE = 1e-3
"""A sample is due if its time is reached within this share of the sample time: hosts accumulate rounding errors."""


def samples_before(time: float, sample_time: float) -> int:
    """Return the number of the first sample that is not before a time; sample k is due at k times the sample time.

    Parameters
    ----------
    time, sample_time
        In s.

    Returns
    -------
    int
        Samples of smaller numbers are due before the time.

    Examples
    --------
    >>> samples_before(0.004, 0.002), samples_before(0.0041, 0.002), samples_before(0.0040000001, 0.002)
    (2, 3, 2)
    """
    return math.ceil(time / sample_time - SAMPLE_TOLERANCE)


def next_exchange(time: float, interval: float) -> float:
    """Return the first multiple of an interval after a time.

    Parameters
    ----------
    time, interval
        In s.

    Returns
    -------
    float
        In s; a time that is a multiple within :data:`SAMPLE_TOLERANCE` gives the next one.

    Examples
    --------
    >>> next_exchange(0.003, 0.002), next_exchange(0.0039999999, 0.002)
    (0.004, 0.006)
    """
    return (math.floor(time / interval + SAMPLE_TOLERANCE) + 1) * interval


def rate_filter(cutoff: float, sample_time: float) -> tuple[float, float]:
    """Derive the factors of the filtered rate v_k = (tau v_(k-1) + delta_k - delta_(k-1)) / (tau + h).

    Parameters
    ----------
    cutoff
        f_c of tau = 1/(2 pi f_c), in Hz.
    sample_time
        h, in s.

    Returns
    -------
    decay : float
        tau/(tau + h).
    gain : float
        1/(tau + h), in 1/s.
    """
    tau = 1.0 / (2.0 * math.pi * cutoff)
    return tau / (tau + sample_time), 1.0 / (tau + sample_time)


def filtered_rate(rate: float, before: float, value: float, decay: float, gain: float) -> float:
    """Return v_k of a signal delta.

    Parameters
    ----------
    rate
        v_(k-1), in units of the signal per s.
    before, value
        delta_(k-1) and delta_k.
    decay, gain
        From :func:`rate_filter`.

    Returns
    -------
    float
        In units of the signal per s.
    """
    return decay * rate + gain * (value - before)
