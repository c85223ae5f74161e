"""Metrics of whole-body vibration: RMS, the metrics of ISO 2631-1, SEAT factors.

An argument ``weighted`` is an acceleration that was weighted by :func:`cosim.metrics.weighting.weighted`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cosim.errors import SignalError
from cosim.metrics.samples import Samples, check_positive, check_samples, trim
from cosim.metrics.weighting import weighted as weight

MTVV_TIME = 1.0
"""Integration time of the running RMS in s; recommended by ISO 2631-1, 6.3.1."""

CREST_LIMIT = 9.0
"""Crest factor up to which the weighted RMS is normally sufficient; ISO 2631-1, 6.2.2."""


def rms(signal: npt.ArrayLike) -> float:
    """Calculate the root mean square sqrt(mean(x^2)); of a weighted acceleration it is a_w (ISO 2631-1, 6.1).

    Parameters
    ----------
    signal
        The samples, shape (samples,).

    Returns
    -------
    float
        In the signal's unit.

    Raises
    ------
    SignalError
        If the samples are invalid.

    Examples
    --------
    >>> rms([3.0, -3.0])
    3.0
    """
    x = check_samples("signal", signal)
    return float(np.sqrt(np.mean(x**2)))


def peak(signal: npt.ArrayLike) -> float:
    """Calculate the largest magnitude max(abs(x)).

    Parameters
    ----------
    signal
        The samples, shape (samples,).

    Returns
    -------
    float
        In the signal's unit.

    Raises
    ------
    SignalError
        If the samples are invalid.
    """
    return float(np.max(np.abs(check_samples("signal", signal))))


def vdv(weighted: npt.ArrayLike, rate: float) -> float:
    """Calculate the vibration dose value (integral of a_w(t)^4 dt)^(1/4), ISO 2631-1, 6.3.2.

    Parameters
    ----------
    weighted
        Weighted acceleration in m/s2, shape (samples,).
    rate
        Sampling rate in Hz.

    Returns
    -------
    float
        In m/s^1.75.

    Raises
    ------
    SignalError
        If the samples or the rate are invalid.
    """
    x = trim(weighted, rate, 0.0, name="weighted")
    return float((np.sum(x**4) / rate) ** 0.25)


def running_rms(weighted: npt.ArrayLike, rate: float, time: float = MTVV_TIME) -> Samples:
    """Calculate the running RMS sqrt(1/tau times the integral of a_w^2 from t - tau to t), ISO 2631-1, 6.3.1.

    The window is linear, not the exponential one that the standard also allows. The first value is that of the first
    full window.

    Parameters
    ----------
    weighted
        Weighted acceleration in m/s2, shape (samples,).
    rate
        Sampling rate in Hz.
    time
        Integration time tau in s; rounded to whole samples.

    Returns
    -------
    ndarray
        In m/s2, shape (samples - time * rate + 1,).

    Raises
    ------
    SignalError
        If the signal is shorter than tau, or the samples are invalid.
    """
    window = max(1, round(check_positive("time", time, "s") * check_positive("rate", rate, "Hz")))
    x = trim(weighted, rate, 0.0, name="weighted", at_least=window)
    energy = np.concatenate(([0.0], np.cumsum(x**2)))
    return np.asarray(np.sqrt((energy[window:] - energy[:-window]) / window))


def mtvv(weighted: npt.ArrayLike, rate: float) -> float:
    """Calculate the maximum transient vibration value, the maximum of :func:`running_rms` over 1 s, ISO 2631-1, 6.3.1.

    Parameters
    ----------
    weighted
        Weighted acceleration in m/s2, shape (samples,).
    rate
        Sampling rate in Hz.

    Returns
    -------
    float
        In m/s2.

    Raises
    ------
    SignalError
        If the signal is shorter than 1 s, or the samples are invalid.
    """
    return float(np.max(running_rms(weighted, rate)))


def crest_factor(weighted: npt.ArrayLike) -> float:
    """Calculate the crest factor, the ratio of peak to RMS of the weighted acceleration, ISO 2631-1, 6.2.1.

    Parameters
    ----------
    weighted
        Weighted acceleration in m/s2, shape (samples,).

    Returns
    -------
    float
        NaN if all samples are zero.

    Raises
    ------
    SignalError
        If the samples are invalid.
    """
    mean = rms(weighted)
    return peak(weighted) / mean if mean > 0.0 else math.nan


@dataclass(frozen=True)
class Ride:
    """Metrics of a vertical acceleration by ISO 2631-1.

    Attributes
    ----------
    a_w
        Weighted RMS acceleration in m/s2.
    vdv
        Vibration dose value in m/s^1.75 of the whole duration.
    mtvv
        Maximum transient vibration value in m/s2.
    crest_factor
        Crest factor of the weighted acceleration.
    duration
        Duration in s, without the warm-up.
    """

    a_w: float
    vdv: float
    mtvv: float
    crest_factor: float
    duration: float

    @property
    def rms_suffices(self) -> bool:
        """Whether a_w is sufficient: crest factor up to 9, MTVV up to 1.5 a_w, VDV up to 1.75 a_w T^(1/4).

        By ISO 2631-1, 6.2.2 and 6.3.3; beyond these limits, MTVV or VDV must be reported, too.
        """
        transients = self.mtvv > 1.5 * self.a_w or self.vdv > 1.75 * self.a_w * self.duration**0.25
        return not (self.crest_factor > CREST_LIMIT or transients)


def ride(acceleration: npt.ArrayLike, rate: float, warm_up: float = 0.0) -> Ride:
    """Calculate the metrics of ISO 2631-1 of a vertical acceleration.

    Parameters
    ----------
    acceleration
        *Unweighted* acceleration in m/s2, shape (samples,).
    rate
        Sampling rate in Hz, at least 160.
    warm_up
        Duration to remove at the beginning of the weighted acceleration, in s.

    Returns
    -------
    Ride
        The metrics.

    Raises
    ------
    SignalError
        If less than 1 s remains, the rate is too low, or the samples are invalid.
    """
    return weighted_ride(weight(acceleration, rate, warm_up), rate)


def weighted_ride(weighted: npt.ArrayLike, rate: float) -> Ride:
    """Calculate the metrics of ISO 2631-1 of an acceleration that was weighted already.

    Parameters
    ----------
    weighted
        Weighted acceleration in m/s2, shape (samples,).
    rate
        Sampling rate in Hz.

    Returns
    -------
    Ride
        The metrics.

    Raises
    ------
    SignalError
        If it is shorter than 1 s, or the samples are invalid.
    """
    w = check_samples("weighted", weighted)
    return Ride(rms(w), vdv(w, rate), mtvv(w, rate), crest_factor(w), w.size / rate)


@dataclass(frozen=True)
class SeatFactor:
    """Seat effective amplitude transmissibility (SEAT); below 1, the seat reduces the vibration.

    Attributes
    ----------
    rms
        Ratio of a_w on the seat to a_w on the floor, ISO 10326-1.
    vdv
        Ratio of VDV on the seat to VDV on the floor, for rides with shocks.
    """

    rms: float
    vdv: float


def seat_factor(seat: Ride, floor: Ride) -> SeatFactor:
    """Calculate the SEAT factors of a seat.

    Seat and floor are both weighted with Wk, as in ISO 7096 for the vertical direction.

    Parameters
    ----------
    seat, floor
        Metrics of seat and floor from :func:`ride`, of the same duration.

    Returns
    -------
    SeatFactor
        The ratios.

    Raises
    ------
    SignalError
        If the floor does not move, or the durations differ.
    """
    if not math.isclose(seat.duration, floor.duration):
        raise SignalError(f"seat and floor: expected one duration, got {seat.duration:g} s and {floor.duration:g} s")
    if not floor.vdv > 0.0:
        raise SignalError("floor: expected a weighted acceleration above 0, got 0")
    return SeatFactor(seat.a_w / floor.a_w, seat.vdv / floor.vdv)
