"""How much isolation a delay margin costs: sets of gains over observer and state feedback, judged by two numbers.

Both numbers are linear, so that many sets can be judged at once: the smallest delay margin over the driver's mass, and
the driver's RMS acceleration under a broad-band floor and friction, relative to the published gains. Friction is what
the observer is for; it enters as a random telegraph signal between plus and minus its plateau.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from seat_controller_fmu.design.certificate import DRIVER_MASSES, delay_margins
from seat_controller_fmu.design.gains import Gains
from seat_controller_fmu.design.sampled_loop import SeatFor, loop, response
from seat_controller_fmu.design.synthesis import design

Array = np.ndarray[Any, Any]

FLOOR_RMS = 1.2
"""RMS of the floor's acceleration in m/s2, white over :data:`BAND`."""

BAND = (0.9, 11.0)
"""Band of the floor in Hz, about that of the ISO 7096 classes."""

REVERSALS = 6.0
"""Sign changes of the friction per second: twice a motion of 3 Hz."""

_FREQUENCIES = np.logspace(-2, np.log10(50.0), 400)


class Judged(NamedTuple):
    """A set of gains and the two numbers it is judged by.

    Attributes
    ----------
    gains
        The set.
    scale
        Its observer gains relative to the request's.
    follow
        f_x of its trade-off, in Hz.
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
    """Evaluate driver over floor acceleration, sampled loop without friction; mass in kg, frequencies in Hz."""
    closed = loop(gains.controller(mass), seat_for(mass), delay=0)
    return np.abs(response(closed, closed.B_floor, frequencies))


def driver_rms(gains: Gains, seat_for: SeatFor, friction_force: float, mass: float) -> float:
    """Evaluate the driver's RMS acceleration under floor and friction.

    Parameters
    ----------
    gains
        The set.
    seat_for
        The seat, by driver's mass.
    friction_force
        The friction's plateau, in N.
    mass
        The driver's, in kg.

    Returns
    -------
    float
        In m/s2.
    """
    closed = loop(gains.controller(mass), seat_for(mass), delay=0)
    f = _FREQUENCIES
    inside = (f >= BAND[0]) & (f <= BAND[1])
    floor = np.where(inside, FLOOR_RMS**2 / (BAND[1] - BAND[0]), 0.0)
    rate = 2.0 * REVERSALS
    friction = (
        4.0 * friction_force**2 * rate / (rate**2 + (2.0 * np.pi * f) ** 2)
    )  # one-sided density of a telegraph signal
    density = np.abs(response(closed, closed.B_floor, f)) ** 2 * floor
    density += np.abs(response(closed, closed.B_force, f)) ** 2 * friction
    return float(np.sqrt(np.trapezoid(density, f)))


class Judge(NamedTuple):
    """What sets of gains are judged on.

    Attributes
    ----------
    seat_for
        The seat, by driver's mass.
    friction_force
        The friction's plateau, in N.
    reference
        Driver's RMS acceleration in m/s2 by mass in kg, of the gains that others are compared with.
    """

    seat_for: SeatFor
    friction_force: float
    reference: Mapping[float, float]

    @classmethod
    def against(cls, gains: Gains, seat_for: SeatFor, friction_force: float) -> Judge:
        """Compare with a set of gains, over :data:`~seat_controller_fmu.design.certificate.DRIVER_MASSES`."""
        rms = {mass: driver_rms(gains, seat_for, friction_force, mass) for mass in DRIVER_MASSES}
        return cls(seat_for, friction_force, rms)

    def judge(self, gains: Gains, scale: float, follow: float) -> Judged:
        """Judge a set of gains; ``scale`` and ``follow`` as of :class:`Judged`."""
        margin = min(delay_margins(gains, self.seat_for, tuple(self.reference)).values())
        ratios = [
            driver_rms(gains, self.seat_for, self.friction_force, mass) / rms for mass, rms in self.reference.items()
        ]
        return Judged(gains, scale, follow, margin, float(np.mean(ratios)))


def survey(
    start: Gains,
    judge: Judge,
    scales: Sequence[float],
    follows: Sequence[float],
    report: Callable[[float], None] = lambda share: None,
) -> list[Judged]:
    """Design and judge a grid of sets around a request.

    Parameters
    ----------
    start
        Mass range, weights, lambda and observer gains of the request.
    judge
        What they are judged on.
    scales
        Factors on its observer gains.
    follows
        Values of f_x in Hz.
    report
        Called with the share that is done.
    """
    found = []
    for i, scale in enumerate(scales):
        setting = replace(start.setting, L1=scale * start.setting.L1, L2=scale * start.setting.L2, observer_gamma=None)
        for follow in follows:
            gains = design(setting, "trade-off", start.lambda_, follow=follow)
            found.append(judge.judge(gains, scale, follow))
        report((i + 1) / len(scales))
    return found


def front(sets: Sequence[Judged]) -> list[Judged]:
    """Return the sets that no other beats in both numbers, by falling margin; unstable ones are left out."""
    stable = [s for s in sets if np.isfinite(s.margin)]
    return sorted(
        (s for s in stable if not any(o.margin >= s.margin and o.rms <= s.rms and o != s for o in stable)),
        key=lambda s: -s.margin,
    )
