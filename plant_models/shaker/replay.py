"""Recorded samples as a smooth motion: a cubic spline of the displacement, its velocity and its acceleration.

A recorded displacement is followed as it is, from where it begins. A recorded acceleration becomes a displacement:

- integrated twice, exactly for the cubic spline through it;
- freed of the cubic polynomial that fits it best, weighted by (1 - x^2)^2 over the recording, -1 < x < 1. That takes
  out what nobody has recorded, position and velocity at the begin, and a bias of the sensor with its trend; vibrations
  are left but for a share that falls with the cube of their periods, 0.4 % of 20, as the weight fades at both ends;
- freed of what lies below a corner frequency, by a second-order Butterworth high-pass once forward and once backward,
  so without a shift in phase: the slow wandering that double integration makes of noise;
- faded in and out.

The spline begins and ends with zero velocity. Before its begin the floor rests, and after its end where it has ended.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from cmath import exp
from typing import NamedTuple

from fmus.component import ParameterError
from plant_models.shaker.interface import Outputs
from plant_models.shaker.profiles import SAME_INSTANT, envelope
from plant_models.shaker.recording import FEWEST_ROWS, Samples, read

_DEGREE = 3
_MEMORY = 2.0
"""Of the high-pass, in periods of its corner frequency: then 1e-4 of a state is left."""


class Curve(NamedTuple):
    """The motion at its knots: times in s from 0, m, m/s, m/s2; the acceleration is linear between them."""

    times: list[float]
    displacements: list[float]
    velocities: list[float]
    accelerations: list[float]


def _bends(x: list[float], y: list[float]) -> list[float]:
    """Solve for the second derivatives at the knots of the cubic spline whose slope is zero at both ends."""
    last = len(x) - 1
    above = bend = left = rise = 0.0
    ratios, bends = [], []
    for i in range(last + 1):
        right = x[i + 1] - x[i] if i < last else 0.0
        next_rise = (y[i + 1] - y[i]) / right if i < last else 0.0
        pivot = 2.0 * (left + right) - left * above
        bend = (6.0 * (next_rise - rise) - left * bend) / pivot
        above = right / pivot
        ratios.append(above)
        bends.append(bend)
        left, rise = right, next_rise
    for i in range(last - 1, -1, -1):
        bends[i] -= ratios[i] * bends[i + 1]
    return bends


def _integrated_twice(t: list[float], a: list[float]) -> list[float]:
    """Integrate the spline through accelerations from rest."""
    bends = _bends(t, a)
    velocity = displacement = 0.0
    displacements = [0.0]
    for i in range(len(t) - 1):
        h = t[i + 1] - t[i]
        linear = h * h * (2.0 * a[i] + a[i + 1]) / 6.0
        displacement += h * velocity + linear - h * h * h * h * (8.0 * bends[i] + 7.0 * bends[i + 1]) / 360.0
        velocity += 0.5 * h * (a[i] + a[i + 1]) - h * h * h * (bends[i] + bends[i + 1]) / 24.0
        displacements.append(displacement)
    return displacements


def _detrended(t: list[float], d: list[float]) -> list[float]:
    """Subtract the best cubic polynomial, one orthogonal polynomial after the other."""
    last = len(t) - 1
    x = [2.0 * time / t[last] - 1.0 for time in t]
    weights = [
        (1.0 - x[i] * x[i]) * (1.0 - x[i] * x[i]) * (t[min(i + 1, last)] - t[max(i - 1, 0)]) for i in range(last + 1)
    ]
    d = list(d)
    before, polynomial, size_before = [0.0] * (last + 1), [1.0] * (last + 1), 1.0
    for _ in range(_DEGREE + 1):
        size = share = middle = 0.0
        for w, p, z, y in zip(weights, polynomial, x, d, strict=True):
            size += w * p * p
            share += w * p * y
            middle += w * p * p * z
        share, middle, carry = share / size, middle / size, size / size_before
        for i, p in enumerate(polynomial):
            d[i] -= share * p
            polynomial[i] = (x[i] - middle) * p - carry * before[i]
            before[i] = p
        size_before = size
    return d


def _high_passed(t: list[float], u: list[float], corner: float) -> list[float]:
    """Pass u through s^2/(s^2 + sqrt 2 omega s + omega^2): u - sqrt 2 omega Re x with x' = pole x + u.

    The filter has settled before: on u turned about the begin of its trend, for as long as the filter remembers.
    """
    omega = 2.0 * math.pi * corner
    part = omega * math.sqrt(0.5)
    pole, x = complex(-part, part), complex(0.0, 0.0)
    since = [abs(time - t[0]) for time in t]
    count = max(FEWEST_ROWS, bisect_left(since, _MEMORY / corner))
    trend = u[0] - _detrended(since[:count], u[:count])[0]
    before, start = (
        [2.0 * trend - value for value in u[count - 1 : 0 : -1]],
        [-time for time in since[count - 1 : 0 : -1]],
    )
    u, since = before + u, start + since
    passed = [u[0]]
    for i in range(len(u) - 1):
        h = since[i + 1] - since[i]
        half = exp(pole * (0.5 * h))
        # Simpson's rule for the response to u, linear in between
        x = half * (half * (x + h / 6.0 * u[i]) + h / 3.0 * (u[i] + u[i + 1])) + h / 6.0 * u[i + 1]
        passed.append(u[i + 1] - 2.0 * part * x.real)
    return passed[len(before) :]


def _displacements(samples: Samples, high_pass: float, fade: float) -> list[float]:
    t, values = samples.times, samples.values
    if samples.quantity == "displacement":
        return [value - values[0] for value in values]
    d = _detrended(t, _integrated_twice(t, values))
    if high_pass > 0.0:
        forward = _high_passed(t, d, high_pass)
        d = _high_passed(t[::-1], forward[::-1], high_pass)[::-1]
    return [envelope(time, t[-1], fade)[0] * x for time, x in zip(t, d, strict=True)]


def load(path: str, high_pass: float, fade: float) -> Curve:
    """Make a motion of a file.

    Parameters
    ----------
    path
        Of the file, see :mod:`plant_models.shaker.recording`.
    high_pass
        Corner frequency in Hz for recorded accelerations, 0 for none.
    fade
        Length in s of fade-in and fade-out of recorded accelerations.

    Raises
    ------
    ParameterError
        If the file is not as it should be, or too short for the fades.
    """
    samples = read(path)
    t = samples.times
    if samples.quantity == "acceleration" and not t[-1] >= 2.0 * fade:
        expected = f"a recording as long as two fades, {2.0 * fade:.10g} s"
        raise ParameterError(f"{path}: expected {expected}, got {t[-1]:.10g} s")
    d = _displacements(samples, high_pass, fade)
    accelerations = _bends(t, d)
    velocities = []
    for i in range(len(t) - 1):
        h = t[i + 1] - t[i]
        velocities.append((d[i + 1] - d[i]) / h - h * (2.0 * accelerations[i] + accelerations[i + 1]) / 6.0)
    return Curve(t, d, [*velocities, 0.0], accelerations)


def motion(curve: Curve, time: float) -> Outputs:
    """Evaluate the motion at a time in s."""
    t, d, v, a = curve
    if time < -SAME_INSTANT:
        return Outputs()
    if time >= t[-1] - SAME_INSTANT:
        return Outputs(floor_displacement=d[-1])
    i = max(0, bisect_right(t, time) - 1)
    since = time - t[i]
    jerk = (a[i + 1] - a[i]) / (t[i + 1] - t[i])
    return Outputs(
        floor_displacement=d[i] + since * (v[i] + since * (0.5 * a[i] + since * jerk / 6.0)),
        floor_velocity=v[i] + since * (a[i] + 0.5 * since * jerk),
        floor_acceleration=a[i] + since * jerk,
    )
