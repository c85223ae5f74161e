"""Classical Runge-Kutta for masses that move along one line, and the length of its substeps."""

from __future__ import annotations

import math
from collections.abc import Callable

from fmus.subnormal import flush_subnormal

MAX_SUBSTEP = 0.5e-3
"""Longest Runge-Kutta substep, in s: a quarter of the 2 ms sample."""

SUBSTEPS_PER_RADIAN = 2.0
"""Substeps per radian of the fastest motion; explicit RK4 is stable down to 0.36 and within 1e-4 of exact at 2."""

MIN_SUBSTEP = 1e-5
"""Parameters that need a substep below this, in s, are refused: a step would take too long."""

Numbers = tuple[float, ...]
Slope = Callable[[Numbers, Numbers, float], Numbers]
"""Function of displacements, velocities and the share of the substep that has passed (0, 0.5, 1) to accelerations."""


def max_substep(fastest: float) -> float:
    """Return the longest substep for the fastest motion of a model.

    Parameters
    ----------
    fastest
        In rad/s, at least 0.

    Returns
    -------
    float
        In s; below :data:`MIN_SUBSTEP` where the model is too fast.
    """
    return min(MAX_SUBSTEP, 1.0 / (SUBSTEPS_PER_RADIAN * fastest)) if fastest > 0.0 else MAX_SUBSTEP


def substep_count(time: float, substep: float) -> int:
    """Return the number of substeps over a time.

    Parameters
    ----------
    time
        In s.
    substep
        Longest substep, in s.

    Returns
    -------
    int
        At least 1.
    """
    return max(1, math.ceil(time / substep - 1e-6))


def _moved(x: Numbers, slope: Numbers, h: float) -> Numbers:
    return tuple(x_i + h * slope_i for x_i, slope_i in zip(x, slope, strict=True))


def _combined(x: Numbers, sixth: float, slopes: tuple[Numbers, Numbers, Numbers, Numbers]) -> Numbers:
    stages = zip(x, *slopes, strict=True)
    return tuple(flush_subnormal(x_i + sixth * (s_1 + 2.0 * (s_2 + s_3) + s_4)) for x_i, s_1, s_2, s_3, s_4 in stages)


def step(z: Numbers, v: Numbers, h: float, slope: Slope) -> tuple[Numbers, Numbers]:
    """Take one step of classical Runge-Kutta over displacements and velocities.

    Parameters
    ----------
    z, v
        Displacements in m and velocities in m/s at the begin, of the same length.
    h
        Length of the step, in s.
    slope
        Accelerations in m/s2.

    Returns
    -------
    z, v : tuple of float
        At the end.
    """
    half = 0.5 * h
    a_1 = slope(z, v, 0.0)
    v_2 = _moved(v, a_1, half)
    a_2 = slope(_moved(z, v, half), v_2, 0.5)
    v_3 = _moved(v, a_2, half)
    a_3 = slope(_moved(z, v_2, half), v_3, 0.5)
    v_4 = _moved(v, a_3, h)
    a_4 = slope(_moved(z, v_3, h), v_4, 1.0)
    sixth = h / 6.0
    return _combined(z, sixth, (v, v_2, v_3, v_4)), _combined(v, sixth, (a_1, a_2, a_3, a_4))
