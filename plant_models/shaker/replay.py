"""Recorded samples as a smooth motion: a cubic spline of the displacement, with its velocity and acceleration.

A recorded displacement is followed as it is, from its first value. A recorded acceleration becomes a displacement:

- it is integrated twice, exactly for the cubic spline through it;
- the cubic polynomial that fits best is subtracted, weighted by (1 - x^2)^2 over the recording, -1 < x < 1. That
  removes what is not recorded, position and velocity at the begin, and a bias of the sensor with its trend. Vibrations
  lose a share that falls with the cube of their number of periods, 0.4 % for 20, as the weight fades at both ends;
- a second-order Butterworth high-pass, once forward and once backward, so without a phase shift, removes what is below
  a corner frequency: the slow drift that double integration makes of noise;
- it is faded in and out.

The spline begins and ends with zero velocity. Before its begin the floor is at rest at 0, and after its end where it
has ended.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from cmath import exp
from typing import NamedTuple

from fmus.component import ParameterError
from plant_models.recording import MIN_ROWS, Samples, read
from plant_models.shaker.interface import Outputs
from plant_models.shaker.profiles import TIME_TOLERANCE, envelope

_DEGREE = 3
_MEMORY = 2.0
"""Memory of the high-pass, in periods of its corner frequency: then 1e-4 of a state remains."""


class Spline(NamedTuple):
    """Motion at the knots; between them the acceleration is linear.

    Attributes
    ----------
    times
        In s, rising from 0.
    displacements, velocities, accelerations
        In m, m/s, m/s2.
    """

    times: list[float]
    displacements: list[float]
    velocities: list[float]
    accelerations: list[float]


def _curvatures(x: list[float], y: list[float]) -> list[float]:
    """Return the second derivatives at the knots of the cubic spline with zero slope at both ends."""
    last = len(x) - 1
    above = curvature = left = slope = 0.0
    ratios, curvatures = [], []
    for i in range(last + 1):
        right = x[i + 1] - x[i] if i < last else 0.0
        next_slope = (y[i + 1] - y[i]) / right if i < last else 0.0
        pivot = 2.0 * (left + right) - left * above
        curvature = (6.0 * (next_slope - slope) - left * curvature) / pivot
        above = right / pivot
        ratios.append(above)
        curvatures.append(curvature)
        left, slope = right, next_slope
    for i in range(last - 1, -1, -1):
        curvatures[i] -= ratios[i] * curvatures[i + 1]
    return curvatures


def _integrate_twice(t: list[float], a: list[float]) -> list[float]:
    """Integrate the spline through accelerations twice, from rest."""
    curvatures = _curvatures(t, a)
    velocity = displacement = 0.0
    displacements = [0.0]
    for i in range(len(t) - 1):
        h = t[i + 1] - t[i]
        linear = h * h * (2.0 * a[i] + a[i + 1]) / 6.0
        displacement += h * velocity + linear - h * h * h * h * (8.0 * curvatures[i] + 7.0 * curvatures[i + 1]) / 360.0
        velocity += 0.5 * h * (a[i] + a[i + 1]) - h * h * h * (curvatures[i] + curvatures[i + 1]) / 24.0
        displacements.append(displacement)
    return displacements


def _detrend(t: list[float], d: list[float]) -> list[float]:
    """Subtract the best cubic polynomial, one orthogonal polynomial after the other."""
    last = len(t) - 1
    x = [2.0 * time / t[last] - 1.0 for time in t]
    weights = [
        (1.0 - x[i] * x[i]) * (1.0 - x[i] * x[i]) * (t[min(i + 1, last)] - t[max(i - 1, 0)]) for i in range(last + 1)
    ]
    d = list(d)
    before, polynomial, norm_before = [0.0] * (last + 1), [1.0] * (last + 1), 1.0
    for _ in range(_DEGREE + 1):
        norm = share = middle = 0.0
        for w, p, z, y in zip(weights, polynomial, x, d, strict=True):
            norm += w * p * p
            share += w * p * y
            middle += w * p * p * z
        share, middle, carry = share / norm, middle / norm, norm / norm_before
        for i, p in enumerate(polynomial):
            d[i] -= share * p
            polynomial[i] = (x[i] - middle) * p - carry * before[i]
            before[i] = p
        norm_before = norm
    return d


def _high_pass(t: list[float], u: list[float], corner: float) -> list[float]:
    """Apply the high-pass s^2/(s^2 + sqrt 2 omega s + omega^2): u - sqrt 2 omega Re x with x' = pole x + u.

    It starts from the steady state under u mirrored at the begin of its trend, over the memory of the filter.
    """
    omega = 2.0 * math.pi * corner
    part = omega * math.sqrt(0.5)
    pole, x = complex(-part, part), complex(0.0, 0.0)
    elapsed = [abs(time - t[0]) for time in t]
    count = max(MIN_ROWS, bisect_left(elapsed, _MEMORY / corner))
    trend = u[0] - _detrend(elapsed[:count], u[:count])[0]
    mirrored = [2.0 * trend - value for value in u[count - 1 : 0 : -1]]
    u, elapsed = mirrored + u, [-time for time in elapsed[count - 1 : 0 : -1]] + elapsed
    passed = [u[0]]
    for i in range(len(u) - 1):
        h = elapsed[i + 1] - elapsed[i]
        half = exp(pole * (0.5 * h))
        # Simpson's rule for the response to u, linear in between
        x = half * (half * (x + h / 6.0 * u[i]) + h / 3.0 * (u[i] + u[i + 1])) + h / 6.0 * u[i + 1]
        passed.append(u[i + 1] - 2.0 * part * x.real)
    return passed[len(mirrored) :]


def _displacements(samples: Samples, high_pass: float, fade: float) -> list[float]:
    """Return the displacements of the samples in m."""
    t, values = samples.axis, samples.values
    if samples.quantity == "displacement":
        return [value - values[0] for value in values]
    d = _detrend(t, _integrate_twice(t, values))
    if high_pass > 0.0:
        forward = _high_pass(t, d, high_pass)
        d = _high_pass(t[::-1], forward[::-1], high_pass)[::-1]
    return [envelope(time, t[-1], fade)[0] * x for time, x in zip(t, d, strict=True)]


def load(path: str, high_pass: float, fade: float) -> Spline:
    """Read a recording and make a motion of it.

    Parameters
    ----------
    path
        Path of the CSV file, see :mod:`plant_models.recording`.
    high_pass
        Corner frequency in Hz for recorded accelerations, 0 for none.
    fade
        Duration in s of fade-in and fade-out of recorded accelerations.

    Returns
    -------
    Spline
        With its knots at the times of the samples.

    Raises
    ------
    ParameterError
        If the file cannot be used, or is too short for the fades.
    """
    samples = read(path)
    t = samples.axis
    if samples.quantity == "acceleration" and not t[-1] >= 2.0 * fade:
        expected = f"a recording as long as two fades, {2.0 * fade:.10g} s"
        raise ParameterError(f"{path}: expected {expected}, got {t[-1]:.10g} s")
    d = _displacements(samples, high_pass, fade)
    accelerations = _curvatures(t, d)
    velocities = []
    for i in range(len(t) - 1):
        h = t[i + 1] - t[i]
        velocities.append((d[i + 1] - d[i]) / h - h * (2.0 * accelerations[i] + accelerations[i + 1]) / 6.0)
    return Spline(t, d, [*velocities, 0.0], accelerations)


def motion(spline: Spline, time: float) -> Outputs:
    """Evaluate the motion of a recording.

    Parameters
    ----------
    spline
        Motion from :func:`load`.
    time
        Time since the begin of the recording, in s.

    Returns
    -------
    Outputs
        Motion of the floor.
    """
    t, d, v, a = spline
    if time < -TIME_TOLERANCE:
        return Outputs()
    if time >= t[-1] - TIME_TOLERANCE:
        return Outputs(floor_displacement=d[-1])
    i = max(0, bisect_right(t, time) - 1)
    elapsed = time - t[i]
    jerk = (a[i + 1] - a[i]) / (t[i + 1] - t[i])
    return Outputs(
        floor_displacement=d[i] + elapsed * (v[i] + elapsed * (0.5 * a[i] + elapsed * jerk / 6.0)),
        floor_velocity=v[i] + elapsed * (a[i] + 0.5 * elapsed * jerk),
        floor_acceleration=a[i] + elapsed * jerk,
    )
