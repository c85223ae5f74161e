"""What a ride is worth: RMS, the metrics of ISO 2631-1, SEAT.

Functions take samples and a sampling rate; those whose argument is called ``weighted`` take what
:func:`cosim.metrics.weighting.weighted` returns.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cosim.errors import SignalError
from cosim.metrics.samples import Samples, positive, samples, settled
from cosim.metrics.weighting import weighted as weight

MTVV_TIME = 1.0
"""s, over which the running RMS is taken; recommended by ISO 2631-1, 6.3.1."""

CREST_LIMIT = 9.0
"""Up to this crest factor the weighted RMS is normally sufficient; ISO 2631-1, 6.2.2."""


def rms(signal: npt.ArrayLike) -> float:
    """Root mean square, sqrt(mean(x^2)), in the signal's unit; of a weighted acceleration a_w (ISO 2631-1, 6.1).

    Parameters
    ----------
    signal
        Shape (samples,); a leading transient is left out by :func:`cosim.metrics.samples.settled`.

    Raises
    ------
    SignalError
        For no samples or wrong ones.
    """
    x = samples("signal", signal)
    return float(np.sqrt(np.mean(x**2)))


def peak(signal: npt.ArrayLike) -> float:
    """Largest magnitude, in the signal's unit; arguments and errors as :func:`rms`."""
    return float(np.max(np.abs(samples("signal", signal))))


def vdv(weighted: npt.ArrayLike, rate: float) -> float:
    """Vibration dose value, (integral of a_w(t)^4 dt)^(1/4), in m/s^1.75 (ISO 2631-1, 6.3.2).

    Parameters
    ----------
    weighted
        Weighted acceleration in m/s2, shape (samples,).
    rate
        Sampling rate in Hz.

    Raises
    ------
    SignalError
        For no samples or wrong ones, and a rate that is none.
    """
    x = settled(weighted, rate, 0.0, name="weighted")
    return float((np.sum(x**4) / rate) ** 0.25)


def running_rms(weighted: npt.ArrayLike, rate: float, time: float = MTVV_TIME) -> Samples:
    """RMS over the last second at each time: sqrt(1/tau times the integral of a_w^2 from t - tau to t).

    A linear window (ISO 2631-1, 6.3.1), not the exponential one the standard also allows; it starts when it is full.

    Parameters
    ----------
    weighted
        Weighted acceleration in m/s2, shape (samples,).
    rate
        Sampling rate in Hz.
    time
        tau in s; rounded to whole samples.

    Returns
    -------
    ndarray
        In m/s2, shape (samples - time * rate + 1,).

    Raises
    ------
    SignalError
        If the signal is shorter than tau; for wrong samples.
    """
    window = max(1, round(positive("time", time, "s") * positive("rate", rate, "Hz")))
    x = settled(weighted, rate, 0.0, name="weighted", at_least=window)
    energy = np.concatenate(([0.0], np.cumsum(x**2)))
    return np.asarray(np.sqrt((energy[window:] - energy[:-window]) / window))


def mtvv(weighted: npt.ArrayLike, rate: float) -> float:
    """Maximum transient vibration value in m/s2: the maximum of :func:`running_rms` over 1 s (ISO 2631-1, 6.3.1)."""
    return float(np.max(running_rms(weighted, rate)))


def crest_factor(weighted: npt.ArrayLike) -> float:
    """Peak over RMS of the weighted acceleration (ISO 2631-1, 6.2.1); NaN if it is zero throughout."""
    mean = rms(weighted)
    return peak(weighted) / mean if mean > 0.0 else math.nan


@dataclass(frozen=True)
class Ride:
    """A vertical acceleration as ISO 2631-1 sees it.

    Attributes
    ----------
    a_w
        Weighted RMS acceleration in m/s2.
    vdv
        Vibration dose value in m/s^1.75, over ``duration``.
    mtvv
        Maximum transient vibration value in m/s2.
    crest_factor
        Of the weighted acceleration.
    duration
        In s, without what was left out to settle.
    """

    a_w: float
    vdv: float
    mtvv: float
    crest_factor: float
    duration: float

    @property
    def rms_suffices(self) -> bool:
        """Whether a_w alone describes it: crest factor up to 9, MTVV up to 1.5 a_w, VDV up to 1.75 a_w T^(1/4).

        ISO 2631-1, 6.2.2 and 6.3.3; beyond them MTVV or VDV are to be reported too.
        """
        transients = self.mtvv > 1.5 * self.a_w or self.vdv > 1.75 * self.a_w * self.duration**0.25
        return not (self.crest_factor > CREST_LIMIT or transients)


def ride(acceleration: npt.ArrayLike, rate: float, settle: float = 0.0) -> Ride:
    """Assess a vertical acceleration by ISO 2631-1.

    Parameters
    ----------
    acceleration
        As it is, *not* weighted, in m/s2, shape (samples,).
    rate
        Sampling rate in Hz, at least 160.
    settle
        What to leave out at the beginning, in s.

    Raises
    ------
    SignalError
        If less than 1 s is left; for a rate too low, wrong samples.
    """
    w = weight(acceleration, rate, settle)
    return Ride(rms(w), vdv(w, rate), mtvv(w, rate), crest_factor(w), w.size / rate)


@dataclass(frozen=True)
class SeatFactor:
    """Seat effective amplitude transmissibility: what the seat makes of the floor's vibration; below 1 it helps.

    Attributes
    ----------
    rms
        a_w on the seat over a_w on the floor (ISO 10326-1).
    vdv
        VDV on the seat over VDV on the floor: for rides with shocks.
    """

    rms: float
    vdv: float


def seat_factor(seat: Ride, floor: Ride) -> SeatFactor:
    """Divide what arrives on the seat by what the floor does.

    Both by Wk, as ISO 7096 does for the vertical direction.

    Parameters
    ----------
    seat, floor
        From :func:`ride`, over the same time.

    Raises
    ------
    SignalError
        If the floor is at rest, or the durations differ.
    """
    if not math.isclose(seat.duration, floor.duration):
        raise SignalError(f"seat and floor: expected one duration, got {seat.duration:g} s and {floor.duration:g} s")
    if not floor.vdv > 0.0:
        raise SignalError("floor: expected a weighted acceleration above 0, got 0")
    return SeatFactor(seat.a_w / floor.a_w, seat.vdv / floor.vdv)
