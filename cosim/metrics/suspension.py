"""What a suspension and its actuator spend on a ride: stroke, contacts with the end stops, force, power, energy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cosim.metrics.samples import positive, settled, together
from cosim.metrics.whole_body import peak, rms


@dataclass(frozen=True)
class Deflection:
    """Which room a suspension took, in m.

    Attributes
    ----------
    lowest, highest
        Ends of its range, from static equilibrium.
    rms
        About static equilibrium, not about its mean.
    """

    lowest: float
    highest: float
    rms: float

    @property
    def peak(self) -> float:
        """Largest magnitude."""
        return max(-self.lowest, self.highest)

    @property
    def peak_to_peak(self) -> float:
        """Stroke used."""
        return self.highest - self.lowest


def deflection_range(deflection: npt.ArrayLike, rate: float, settle: float = 0.0) -> Deflection:
    """Measure the range of a deflection.

    Parameters
    ----------
    deflection
        In m, from static equilibrium, shape (samples,).
    rate
        Sampling rate in Hz.
    settle
        What to leave out at the beginning, in s.

    Raises
    ------
    SignalError
        If nothing is left; for wrong samples.
    """
    x = settled(deflection, rate, settle, name="deflection")
    return Deflection(float(x.min()), float(x.max()), rms(x))


@dataclass(frozen=True)
class EndStops:
    """What the end stops had to do.

    Attributes
    ----------
    upper, lower
        Separate contacts with each.
    time
        In contact, in s.
    deepest
        How far beyond the travel, in m; 0 without contact.
    """

    upper: int
    lower: int
    time: float
    deepest: float

    @property
    def hits(self) -> int:
        """Contacts with either."""
        return self.upper + self.lower


def end_stops(deflection: npt.ArrayLike, rate: float, travel: float, settle: float = 0.0) -> EndStops:
    """Count contacts with the end stops.

    A contact lasts while the magnitude of the deflection is at or beyond the travel; one that is under way at the
    beginning counts. Give the true deflection: noise about the travel would count as many contacts.

    Parameters
    ----------
    deflection
        In m, from static equilibrium, shape (samples,).
    rate
        Sampling rate in Hz.
    travel
        To either stop, in m.
    settle
        What to leave out at the beginning, in s.

    Raises
    ------
    SignalError
        If the travel is not above 0; if nothing is left; for wrong samples.
    """
    x = settled(deflection, rate, settle, name="deflection")
    limit = positive("travel", travel, "m")

    def contacts(touching: npt.NDArray[np.bool_]) -> int:
        return int(touching[0]) + int(np.count_nonzero(touching[1:] & ~touching[:-1]))

    beyond = np.abs(x) - limit
    return EndStops(
        contacts(x >= limit),
        contacts(x <= -limit),
        float(np.count_nonzero(beyond >= 0.0)) / rate,
        max(0.0, float(beyond.max())),
    )


@dataclass(frozen=True)
class Actuator:
    """What an actuator gave; power is positive where it drives the suspension, negative where it brakes it.

    Attributes
    ----------
    force_rms, force_peak
        In N.
    power_mean
        Net, in W.
    power_positive
        Mean of the power while it drives, 0 while it brakes, in W: the supply's, if nothing is fed back.
    power_absolute
        Mean of its magnitude, in W.
    power_peak
        Largest magnitude, in W.
    energy
        Delivered to the suspension, net, in J.
    """

    force_rms: float
    force_peak: float
    power_mean: float
    power_positive: float
    power_absolute: float
    power_peak: float
    energy: float


def actuator(force: npt.ArrayLike, deflection: npt.ArrayLike, rate: float, settle: float = 0.0) -> Actuator:
    """Account for an actuator between floor and seat.

    Its force u acts on the seat and -u on the floor, so it delivers u (z_s' - z_v') = u times the deflection's rate.
    A force held from sample to sample does exactly u_k (delta_(k+1) - delta_k) of work in between. Force times
    sampled rate would be half a sample late, which matters where the force is nearly in phase with the deflection,
    as when it cancels the spring: 1.6 % too much energy on the paper's bump. The power is the suspension's, without
    losses of motor and gear; with an actuator that lags, it is that of what the actuator was told.

    Parameters
    ----------
    force
        u in N, on the seat, up positive, held until the next sample; shape (samples,). The last acts no more.
    deflection
        delta = z_s - z_v in m, shape (samples,).
    rate
        Sampling rate in Hz.
    settle
        What to leave out at the beginning, in s.

    Raises
    ------
    SignalError
        If less than two samples are left; if lengths differ; for wrong samples.
    """
    u, delta = (
        settled(values, rate, settle, name=name, at_least=2)
        for name, values in zip(("force", "deflection"), together(force=force, deflection=deflection), strict=True)
    )
    held = u[:-1]
    work = held * np.diff(delta)
    power = work * rate
    return Actuator(
        rms(held),
        peak(held),
        float(power.mean()),
        float(np.maximum(power, 0.0).mean()),
        float(np.abs(power).mean()),
        peak(power),
        float(work.sum()),
    )
