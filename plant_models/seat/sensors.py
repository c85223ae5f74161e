"""The sensors: low-pass, noise, bias and resolution, in this order.

The noise is held over ticks of 2 ms from time 0 and follows from seed and tick alone. It depends neither on the
communication step nor on how often the sensor is read. The low-pass is exact for signals that are linear over a
substep.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from fmus.subnormal import flush_subnormal
from plant_models.random_numbers import random_normal, random_stream
from plant_models.seat.actuator import TIME_TOLERANCE

TICK = 0.002
"""Hold time of the noise, in s."""

_MIN_INTEGER = 2.0**52
"""Numbers of at least this magnitude have no fraction."""


class SensorCoefficients(NamedTuple):
    """Errors that a sensor adds to its signal.

    Attributes
    ----------
    noise
        RMS of the noise, in the unit of the signal.
    bias
        Offset, in the unit of the signal.
    resolution
        Smallest step of the measurement, in the unit of the signal; 0 for none.
    stream
        Stream of random numbers, see :func:`plant_models.random_numbers.random_stream`.
    """

    noise: float
    bias: float
    resolution: float
    stream: int


def prepare(noise: float, bias: float, resolution: float, seed: int, number: int) -> SensorCoefficients:
    """Derive the coefficients of a sensor.

    Parameters
    ----------
    noise, bias, resolution
        As of :class:`SensorCoefficients`.
    seed
        Seed of the noise.
    number
        Number of the sensor; sensors of different numbers have independent noise.

    Returns
    -------
    SensorCoefficients
        With the stream of this seed and number.
    """
    return SensorCoefficients(noise, bias, resolution, random_stream(seed, number))


def measure(value: float, c: SensorCoefficients, time: float) -> float:
    """Add noise and bias to a signal and round it to the resolution.

    Parameters
    ----------
    value
        Signal after the low-pass.
    c
        Coefficients of the sensor.
    time
        In s.

    Returns
    -------
    float
        The measurement, in the unit of the signal.
    """
    if c.noise > 0.0:
        value += c.noise * random_normal(c.stream, math.floor((time + TIME_TOLERANCE) / TICK))
    if c.bias != 0.0:
        value += c.bias
    if c.resolution > 0.0:
        steps = value / c.resolution
        if abs(steps) < _MIN_INTEGER:
            value = c.resolution * math.floor(steps + 0.5)
    return value


def low_pass(filtered: float, begin: float, end: float, angle: float) -> float:
    """Advance a first-order low-pass over a substep.

    Parameters
    ----------
    filtered
        Output of the low-pass before.
    begin, end
        Signal at both ends of the substep, linear in between.
    angle
        Corner frequency in rad/s times length of the substep in s.

    Returns
    -------
    float
        Output of the low-pass after.
    """
    gain = -math.expm1(-angle)
    ratio = gain / angle if angle > 0.0 else 1.0  # 0 where the product of corner and substep is too small for a number
    return flush_subnormal(filtered + (begin - filtered) * gain + (end - begin) * (1.0 - ratio))
