"""Metrics of a suspension and its actuator: stroke, contacts with the end stops, force, power, energy."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cosim.errors import SignalError
from cosim.metrics.samples import check_equal_length, check_positive, trim
from cosim.metrics.whole_body import peak, rms


@dataclass(frozen=True)
class Deflection:
    """Range of a suspension's deflection.

    Attributes
    ----------
    lowest, highest
        Smallest and largest deflection in m, from static equilibrium, up positive.
    rms
        RMS in m, about static equilibrium, not about the mean.
    """

    lowest: float
    highest: float
    rms: float

    @property
    def peak(self) -> float:
        """Largest magnitude in m."""
        return max(-self.lowest, self.highest)

    @property
    def peak_to_peak(self) -> float:
        """Stroke, the whole range, in m."""
        return self.highest - self.lowest


def deflection_range(deflection: npt.ArrayLike, rate: float, warm_up: float = 0.0) -> Deflection:
    """Determine the range of a suspension's deflection.

    Parameters
    ----------
    deflection
        Deflection in m, from static equilibrium, up positive, shape (samples,).
    rate
        Sampling rate in Hz.
    warm_up
        Duration to remove at the beginning, in s.

    Returns
    -------
    Deflection
        The range.

    Raises
    ------
    SignalError
        If no samples remain, or they are invalid.
    """
    x = trim(deflection, rate, warm_up, name="deflection")
    return Deflection(float(x.min()), float(x.max()), rms(x))


@dataclass(frozen=True)
class EndStops:
    """Contacts of a suspension with its end stops.

    Attributes
    ----------
    upper, lower
        Number of contacts with the upper and the lower end stop.
    time
        Duration of all contacts in s.
    deepest
        Largest compression of an end stop in m; 0 without contact.
    """

    upper: int
    lower: int
    time: float
    deepest: float

    @property
    def hits(self) -> int:
        """Number of contacts with either end stop."""
        return self.upper + self.lower


def end_stops(
    deflection: npt.ArrayLike, rate: float, travel: float, warm_up: float = 0.0, height: float = 0.0
) -> EndStops:
    """Count contacts with the end stops.

    A contact lasts while the deflection from the middle of the travel has at least the magnitude of the travel. A
    contact at the first sample counts.
    The deflection must be without measurement noise, which would split a contact into many.

    Parameters
    ----------
    deflection
        Deflection in m, from static equilibrium, up positive, shape (samples,).
    rate
        Sampling rate in Hz.
    travel
        Travel from its middle to either end stop, in m.
    warm_up
        Duration to remove at the beginning, in s.
    height
        Height of static equilibrium above the middle of the travel, in m.

    Returns
    -------
    EndStops
        The contacts.

    Raises
    ------
    SignalError
        If the travel is not above 0, the height is not finite, no samples remain, or they are invalid.
    """
    x = trim(deflection, rate, warm_up, name="deflection") + height
    limit = check_positive("travel", travel, "m")
    if not math.isfinite(height):
        raise SignalError(f"height: expected a finite number, got {height:g} m")

    def contacts(touching: npt.NDArray[np.bool_]) -> int:
        return int(touching[0]) + int(np.count_nonzero(touching[1:] & ~touching[:-1]))

    beyond = np.abs(x) - limit
    return EndStops(
        contacts(x >= limit),
        contacts(x <= -limit),
        float(np.count_nonzero(beyond >= 0.0)) / rate,
        max(0.0, float(beyond.max())),
    )


RINGING = 0.25
"""Duration in s after a contact with an end stop that :func:`impact_share` counts as part of the impact."""


def impact_share(
    weighted: npt.ArrayLike,
    deflection: npt.ArrayLike,
    rate: float,
    travel: float,
    warm_up: float = 0.0,
    height: float = 0.0,
) -> float:
    """Calculate the share of the vibration dose value that impacts on the end stops have.

    It is 1 - VDV_0 / VDV, with VDV_0 the dose without the samples in contact and those up to :data:`RINGING` later: the
    share by which the dose would be lower without impacts.

    Parameters
    ----------
    weighted
        Weighted acceleration of the driver in m/s2, already without the warm-up, shape (samples - warm_up * rate,).
    deflection
        Deflection in m, from static equilibrium, shape (samples,).
    rate
        Sampling rate in Hz.
    travel
        Travel from its middle to either end stop, in m.
    warm_up
        Duration to remove at the beginning of the deflection, in s.
    height
        Height of static equilibrium above the middle of the travel, in m.

    Returns
    -------
    float
        From 0 to 1; 0 without contact, and for a driver who does not move.

    Raises
    ------
    SignalError
        If the travel is not above 0, the lengths differ, or the samples are invalid.

    Examples
    --------
    >>> impact_share([1.0, 1.0], [0.0, 0.0], rate=2.0, travel=0.04)
    0.0
    """
    signals = check_equal_length(weighted=weighted, deflection=trim(deflection, rate, warm_up, name="deflection"))
    touching = np.abs(signals["deflection"] + height) >= check_positive("travel", travel, "m")
    if not touching.any():
        return 0.0
    dose = signals["weighted"] ** 4
    window = 1 + round(RINGING * rate)
    during = np.convolve(touching, np.ones(window))[: touching.size] > 0.5
    total = float(dose.sum())
    return 1.0 - float((dose[~during].sum() / total) ** 0.25) if total > 0.0 else 0.0


@dataclass(frozen=True)
class ActuatorEffort:
    """Force, power and energy of an actuator; power is positive where it drives the suspension.

    Attributes
    ----------
    force_rms, force_peak
        RMS and largest magnitude of the force, in N.
    power_mean
        Mean power in W.
    power_positive
        Mean of the positive part of the power in W: the power of a supply without recuperation.
    power_absolute
        Mean magnitude of the power in W.
    power_peak
        Largest magnitude of the power in W.
    energy
        Net energy delivered to the suspension in J.
    """

    force_rms: float
    force_peak: float
    power_mean: float
    power_positive: float
    power_absolute: float
    power_peak: float
    energy: float


def actuator(force: npt.ArrayLike, deflection: npt.ArrayLike, rate: float, warm_up: float = 0.0) -> ActuatorEffort:
    """Calculate force, power and energy of an actuator between floor and seat.

    The force u acts on the seat and -u on the floor, so the power delivered is u (z_s' - z_v'), the force times the
    rate of the deflection delta. A force that is held between samples does the work u_k (delta_(k+1) - delta_k) in a
    step, exactly. Force times sampled rate would be half a sample late, which matters where the force is nearly in
    phase with the deflection: 1.6 % too much energy on the paper's bump, where the force cancels the spring.

    The power is that delivered to the suspension, without losses of motor and gear. For an actuator with lag, pass its
    actual force; the force demand would give the power of an ideal actuator.

    Parameters
    ----------
    force
        Force u on the seat in N, up positive, held until the next sample; shape (samples,). The last sample is not
        used.
    deflection
        Deflection delta = z_s - z_v in m, shape (samples,).
    rate
        Sampling rate in Hz.
    warm_up
        Duration to remove at the beginning, in s.

    Returns
    -------
    ActuatorEffort
        Force, power and energy.

    Raises
    ------
    SignalError
        If less than two samples remain, the lengths differ, or the samples are invalid.
    """
    u, delta = (
        trim(values, rate, warm_up, name=name, at_least=2)
        for name, values in check_equal_length(force=force, deflection=deflection).items()
    )
    held = u[:-1]
    work = held * np.diff(delta)
    power = work * rate
    return ActuatorEffort(
        rms(held),
        peak(held),
        float(power.mean()),
        float(np.maximum(power, 0.0).mean()),
        float(np.abs(power).mean()),
        peak(power),
        float(work.sum()),
    )
