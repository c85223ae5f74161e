"""The sensors: low-pass, noise, bias and resolution, in this order.

Noise is held over ticks of 2 ms from time 0, whatever the communication step and however often it is read, and follows
from seed and tick alone. The low-pass is exact for signals that are straight over a substep.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from fmus.subnormal import flush_subnormal
from plant_models.random_numbers import normal
from plant_models.seat.actuator import SAME_INSTANT

TICK = 0.002
"""How long noise is held, in s."""

_WHOLE = 2.0**52
"""Numbers from here on have no fraction."""


class Sensor(NamedTuple):
    """What a sensor does to its signal, in the signal's unit; ``stream`` of random numbers."""

    noise: float
    bias: float
    resolution: float
    stream: int


def reading(value: float, sensor: Sensor, time: float) -> float:
    """Return what a sensor reports.

    Parameters
    ----------
    value
        The signal, after the low-pass.
    sensor
        Which.
    time
        In s.
    """
    if sensor.noise > 0.0:
        value += sensor.noise * normal(sensor.stream, math.floor((time + SAME_INSTANT) / TICK))
    if sensor.bias != 0.0:
        value += sensor.bias
    if sensor.resolution > 0.0:
        steps = value / sensor.resolution
        if abs(steps) < _WHOLE:
            value = sensor.resolution * math.floor(steps + 0.5)
    return value


def low_passed(filtered: float, begin: float, end: float, angle: float) -> float:
    """Move a first-order low-pass over a substep.

    Parameters
    ----------
    filtered
        Before.
    begin, end
        The signal at both ends, straight in between.
    angle
        Corner in rad/s times length of the substep.
    """
    gain = -math.expm1(-angle)
    return flush_subnormal(filtered + (begin - filtered) * gain + (end - begin) * (1.0 - gain / angle))
