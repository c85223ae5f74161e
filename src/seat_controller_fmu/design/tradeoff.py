"""Trade-off between isolation and delay margin over observer and state feedback gains.

Two criteria rate a set of gains: the smallest delay margin over the driver's mass, and the driver's RMS acceleration
under a broad-band floor motion and friction, relative to the published gains. Both are computed from linear models, so
many sets can be rated. The friction, which the observer compensates, is modelled as a random telegraph signal between
plus and minus its plateau.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from seat_controller_fmu.design.certificate import DRIVER_MASSES, delay_margins
from seat_controller_fmu.design.gains import Gains
from seat_controller_fmu.design.sampled_loop import SeatFor, closed_loop, response
from seat_controller_fmu.design.synthesis import design

Array = np.ndarray[Any, Any]

FLOOR_RMS = 1.2
"""RMS of the floor acceleration in m/s2, white over :data:`BAND`."""

BAND = (0.9, 11.0)
"""Band of the floor acceleration in Hz, similar to that of the ISO 7096 classes."""

REVERSALS = 6.0
"""Sign changes of the friction per second: twice a motion of 3 Hz."""

_FREQUENCIES = np.logspace(-2, np.log10(50.0), 400)


class TradeOffPoint(NamedTuple):
    """A set of gains with its two criteria.

    Attributes
    ----------
    gains
        Set of gains.
    scale
        Observer gains relative to those of the first set.
    follow
        f_x of the trade-off, in Hz.
    margin
        Smallest delay margin over the driver's mass, in ms.
    rms
        Driver's RMS acceleration relative to the published gains, mean over the driver's mass.
    """

    gains: Gains
    scale: float
    follow: float
    margin: float
    rms: float


def transmissibility(gains: Gains, seat_for: SeatFor, mass: float, frequencies: Array) -> Array:
    """Evaluate the magnitude of driver over floor acceleration of the sampled loop without friction.

    Parameters
    ----------
    gains
        Set of gains.
    seat_for
        Function from the driver's mass in kg to the seat.
    mass
        Driver's mass, in kg.
    frequencies
        In Hz, shape (n,).

    Returns
    -------
    array
        Dimensionless, shape (n,).
    """
    loop = closed_loop(gains.controller(mass), seat_for(mass), delay=0)
    return np.abs(response(loop, loop.B_floor, frequencies))


def driver_rms(gains: Gains, seat_for: SeatFor, friction_force: float, mass: float) -> float:
    """Evaluate the driver's RMS acceleration under floor motion and friction.

    Parameters
    ----------
    gains
        Set of gains.
    seat_for
        Function from the driver's mass in kg to the seat.
    friction_force
        Plateau of the friction force, in N.
    mass
        Driver's mass, in kg.

    Returns
    -------
    float
        In m/s2.
    """
    loop = closed_loop(gains.controller(mass), seat_for(mass), delay=0)
    f = _FREQUENCIES
    inside = (f >= BAND[0]) & (f <= BAND[1])
    floor = np.where(inside, FLOOR_RMS**2 / (BAND[1] - BAND[0]), 0.0)
    rate = 2.0 * REVERSALS
    friction = (
        4.0 * friction_force**2 * rate / (rate**2 + (2.0 * np.pi * f) ** 2)
    )  # one-sided density of a telegraph signal
    density = np.abs(response(loop, loop.B_floor, f)) ** 2 * floor
    density += np.abs(response(loop, loop.B_force, f)) ** 2 * friction
    return float(np.sqrt(np.trapezoid(density, f)))


class TradeOffCriteria(NamedTuple):
    """Plant and reference for the criteria.

    Attributes
    ----------
    seat_for
        Function from the driver's mass in kg to the seat.
    friction_force
        Plateau of the friction force, in N.
    reference
        Driver's mass in kg to the driver's RMS acceleration in m/s2 with the reference gains.
    """

    seat_for: SeatFor
    friction_force: float
    reference: Mapping[float, float]

    @classmethod
    def relative_to(cls, gains: Gains, seat_for: SeatFor, friction_force: float) -> TradeOffCriteria:
        """Return criteria relative to a set of gains, over ``DRIVER_MASSES`` of the certificate.

        Parameters
        ----------
        gains
            Reference gains.
        seat_for
            Function from the driver's mass in kg to the seat.
        friction_force
            Plateau of the friction force, in N.

        Returns
        -------
        TradeOffCriteria
            With the RMS accelerations of the reference gains.
        """
        rms = {mass: driver_rms(gains, seat_for, friction_force, mass) for mass in DRIVER_MASSES}
        return cls(seat_for, friction_force, rms)

    def rate(self, gains: Gains, scale: float, follow: float) -> TradeOffPoint:
        """Evaluate the criteria of a set of gains.

        Parameters
        ----------
        gains
            Set of gains.
        scale, follow
            As of :class:`TradeOffPoint`.

        Returns
        -------
        TradeOffPoint
            The set with its criteria.
        """
        margin = min(delay_margins(gains, self.seat_for, tuple(self.reference)).values())
        ratios = [
            driver_rms(gains, self.seat_for, self.friction_force, mass) / rms for mass, rms in self.reference.items()
        ]
        return TradeOffPoint(gains, scale, follow, margin, float(np.mean(ratios)))


def survey(
    start: Gains,
    criteria: TradeOffCriteria,
    scales: Sequence[float],
    follows: Sequence[float],
    report: Callable[[float], None] = lambda share: None,
) -> list[TradeOffPoint]:
    """Design and rate a grid of sets of gains.

    Parameters
    ----------
    start
        First set: mass range, weights, lambda and observer gains.
    criteria
        Criteria of the rating.
    scales
        Factors on the observer gains.
    follows
        Values of f_x, in Hz.
    report
        Progress callback, called with the completed share.

    Returns
    -------
    list of TradeOffPoint
        One for each pair of ``scales`` and ``follows``.
    """
    points = []
    for i, scale in enumerate(scales):
        setting = replace(start.setting, L1=scale * start.setting.L1, L2=scale * start.setting.L2, observer_gamma=None)
        for follow in follows:
            gains = design(setting, "trade-off", start.lambda_, follow=follow)
            points.append(criteria.rate(gains, scale, follow))
        report((i + 1) / len(scales))
    return points


def front(sets: Sequence[TradeOffPoint]) -> list[TradeOffPoint]:
    """Return the Pareto front of sets of gains.

    Parameters
    ----------
    sets
        Rated sets; unstable ones are ignored.

    Returns
    -------
    list of TradeOffPoint
        Sets that no other one exceeds in both criteria, with decreasing margin.
    """
    stable = [s for s in sets if np.isfinite(s.margin)]
    return sorted(
        (s for s in stable if not any(o.margin >= s.margin and o.rms <= s.rms and o != s for o in stable)),
        key=lambda s: -s.margin,
    )
