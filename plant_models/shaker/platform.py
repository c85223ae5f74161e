"""The platform of the shaker: second-order lag behind the profile, with limits of stroke, velocity and acceleration.

    z'' = omega^2 (r - z) - 2 zeta omega z',

with the profile r. The acceleration is held over ticks and computed by the implicit midpoint rule. Displacement and
velocity are its exact integrals at any time, and the lag is stable and second-order accurate at any bandwidth. The
limits bound the held acceleration: to its own limit, to what keeps the velocity within its limit until the end of the
tick, and to what still allows the platform to brake before the end of its stroke. So they hold at all times, not only
at ticks.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from fmus.component import ParameterError
from plant_models.shaker.interface import Outputs, Parameters


class PlatformCoefficients(NamedTuple):
    """Coefficients of the platform.

    Attributes
    ----------
    stiffness, damping
        omega^2 in 1/s2, 2 zeta omega in 1/s.
    tick
        Hold time of the acceleration, in s.
    stroke, velocity_limit, acceleration_limit
        In m, m/s, m/s2; infinite where there is no limit. The stroke is that at the ends of ticks.
    braking
        Deceleration before the end of the stroke, in m/s2.
    """

    stiffness: float
    damping: float
    tick: float
    stroke: float
    velocity_limit: float
    acceleration_limit: float
    braking: float


def _limit(value: float) -> float:
    return value if value > 0.0 else math.inf


def prepare(p: Parameters, tick: float) -> PlatformCoefficients | None:
    """Derive the coefficients of the platform.

    Parameters
    ----------
    p
        Parameters of the shaker.
    tick
        Hold time of the acceleration, in s.

    Returns
    -------
    PlatformCoefficients or None
        None without a lag: the floor is the profile.

    Raises
    ------
    ParameterError
        If there are limits, but no lag.
    """
    limits = (p.platform_stroke, p.platform_velocity_limit, p.platform_acceleration_limit)
    if not p.platform_bandwidth > 0.0:
        if any(limit > 0.0 for limit in limits):
            raise ParameterError(
                "expected platform.bandwidth above 0 where platform.stroke, platform.velocity_limit or "
                f"platform.acceleration_limit are, got {p.platform_bandwidth} Hz"
            )
        return None
    omega = 2.0 * math.pi * p.platform_bandwidth
    stroke, velocity_limit, acceleration_limit = map(_limit, limits)
    braking = min(acceleration_limit, omega * omega * stroke)
    if stroke < math.inf:
        stroke = stroke - braking * tick * tick / 8.0  # between two ticks the platform may exceed it by this much
    return PlatformCoefficients(
        omega * omega, 2.0 * p.platform_damping * omega, tick, stroke, velocity_limit, acceleration_limit, braking
    )


def _max_braking_velocity(room: float, c: PlatformCoefficients) -> float:
    """Return the largest velocity in m/s at the end of a tick from which the platform can brake within the stroke.

    ``room`` is the rest of the stroke in m if this velocity is 0.
    """
    half = 0.5 * c.braking * c.tick
    return math.sqrt(max(0.0, half * half + 2.0 * c.braking * room)) - half


def acceleration(displacement: float, velocity: float, command: Outputs, c: PlatformCoefficients) -> float:
    """Return the acceleration of the platform over a tick.

    Parameters
    ----------
    displacement, velocity
        Of the platform at the begin of the tick, in m and m/s.
    command
        Profile at the begin of the tick.
    c
        Coefficients from :func:`prepare`.

    Returns
    -------
    float
        In m/s2, within the limits.
    """
    half = 0.5 * c.tick
    target = command.floor_displacement + half * (command.floor_velocity + 0.5 * half * command.floor_acceleration)
    demand = (c.stiffness * (target - displacement - half * velocity) - c.damping * velocity) / (
        1.0 + half * c.damping + half * half * c.stiffness
    )
    highest = (c.velocity_limit - velocity) / c.tick
    lowest = (-c.velocity_limit - velocity) / c.tick
    if c.stroke < math.inf:
        middle = displacement + half * velocity
        highest = min(highest, (_max_braking_velocity(c.stroke - middle, c) - velocity) / c.tick)
        lowest = max(lowest, (-_max_braking_velocity(c.stroke + middle, c) - velocity) / c.tick)
    return max(-c.acceleration_limit, min(c.acceleration_limit, max(lowest, min(highest, demand))))
