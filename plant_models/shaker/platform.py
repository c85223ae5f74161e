"""A platform that follows a profile: second-order lag with limits of stroke, velocity and acceleration.

    z'' = omega^2 (r - z) - 2 zeta omega z',

r the profile. The acceleration is held over ticks, computed by the implicit midpoint rule: displacement and velocity
are its exact integrals at any time, and the lag is stable and second-order accurate whatever its bandwidth. Limits
bound the held acceleration: to its own limit, to what keeps the velocity within its limit until the tick's end, and to
what still lets the platform brake before the end of its stroke. So they hold always, not at ticks only.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from fmus.component import ParameterError
from plant_models.shaker.interface import Outputs, Parameters


class Platform(NamedTuple):
    """Coefficients.

    Attributes
    ----------
    stiffness, damping
        omega^2 in 1/s2, 2 zeta omega in 1/s.
    tick
        In s.
    stroke, velocity_limit, acceleration_limit
        In m, m/s, m/s2; infinite where there is none. The stroke is what is left of it for ends of ticks.
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


def platform(p: Parameters, tick: float) -> Platform | None:
    """Derive the coefficients for ticks of a length in s; None where the platform follows exactly.

    Raises
    ------
    ParameterError
        If there are limits, but no platform.
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
        stroke = stroke - braking * tick * tick / 8.0  # between two ticks the platform may go that much further
    return Platform(
        omega * omega, 2.0 * p.platform_damping * omega, tick, stroke, velocity_limit, acceleration_limit, braking
    )


def _fastest(room: float, c: Platform) -> float:
    """Velocity at a tick's end from which the platform can still brake; the room is what is left if that is 0."""
    half = 0.5 * c.braking * c.tick
    return math.sqrt(max(0.0, half * half + 2.0 * c.braking * room)) - half


def acceleration(displacement: float, velocity: float, command: Outputs, c: Platform) -> float:
    """Return the acceleration over a tick, in m/s2.

    Parameters
    ----------
    displacement, velocity
        Of the platform at the tick's begin, in m and m/s.
    command
        The profile at the tick's begin.
    c
        From :func:`platform`.
    """
    half = 0.5 * c.tick
    target = command.floor_displacement + half * (command.floor_velocity + 0.5 * half * command.floor_acceleration)
    wanted = (c.stiffness * (target - displacement - half * velocity) - c.damping * velocity) / (
        1.0 + half * c.damping + half * half * c.stiffness
    )
    highest = (c.velocity_limit - velocity) / c.tick
    lowest = (-c.velocity_limit - velocity) / c.tick
    if c.stroke < math.inf:
        reached = displacement + half * velocity
        highest = min(highest, (_fastest(c.stroke - reached, c) - velocity) / c.tick)
        lowest = max(lowest, (-_fastest(c.stroke + reached, c) - velocity) / c.tick)
    return max(-c.acceleration_limit, min(c.acceleration_limit, max(lowest, min(highest, wanted))))
