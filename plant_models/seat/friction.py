"""Bouc-Wen friction (35)-(36) as an exact function of the deflection.

The equation that is solved here, with the deflection rate v,

    z_d' = A_d v - gamma_d |v| |z_d| z_d - beta_d v z_d^2                                   (36, erratum below)

is rate independent: divided by v, it gives z_d as a function of the deflection alone. While the deflection moves in one
direction by y = |dx|, with s = sgn(dx) and zeta = s z_d,

    d zeta/dy = A_d - (gamma_d + beta_d) zeta^2      for zeta >= 0, solved by tanh
    d zeta/dy = A_d + (gamma_d - beta_d) zeta^2      for zeta <  0, solved by tan until it crosses zero

each written so that it costs one exponential or one tangent. So a step needs no time integration, is exact for any
length, and stays within the plateau +-sqrt(A_d/(gamma_d + beta_d)). (Explicit integration of (36) in time needs about
41 |v| substeps per 2 ms, with v in m/s; with slightly fewer the result is finite and wrong.)

Erratum: the paper prints |v||z_d||z_d|, which has no plateau for v < 0. The usual Bouc-Wen form saturates at 75.3 N in
both directions, the paper's "around 80 N".
"""

from __future__ import annotations

import math
from typing import NamedTuple

from fmus.component import ParameterError

_QUARTER_TURN = 0.5 * math.pi

PLATEAU_TOLERANCE = 1e-12
"""A state within this share of the plateau is on it, and stays there while the deflection moves on."""


class FrictionCoefficients(NamedTuple):
    """Coefficients of the closed-form step, see :func:`prepare`.

    Attributes
    ----------
    plateau
        sqrt(A_d/(gamma_d + beta_d)), in m: the largest z_d that loading reaches.
    loading_rate
        sqrt(A_d (gamma_d + beta_d)), in 1/m.
    unloading_scale
        sqrt(A_d/(gamma_d - beta_d)), in m.
    unloading_rate
        sqrt(A_d (gamma_d - beta_d)), in 1/m.
    """

    plateau: float
    loading_rate: float
    unloading_scale: float
    unloading_rate: float


def prepare(gamma: float, beta: float, amplitude: float) -> FrictionCoefficients:
    """Derive the coefficients of the closed-form step of (36).

    Parameters
    ----------
    gamma, beta
        gamma_d and beta_d, in 1/m2.
    amplitude
        A_d, dimensionless.

    Returns
    -------
    FrictionCoefficients
        For :func:`after_slip` and :func:`through_reversal`.

    Raises
    ------
    ParameterError
        Unless A_d > 0, gamma_d + beta_d > 0 and gamma_d - beta_d > 0: otherwise (36) has no plateau.

    Examples
    --------
    >>> f"{prepare(2.1617e8, -9.8889e7, 6.9321).plateau:.4g} m"
    '0.0002431 m'
    """
    loading, unloading = gamma + beta, gamma - beta
    if not (amplitude > 0 and loading > 0 and unloading > 0):
        raise ParameterError(
            "friction: expected friction.A > 0 and friction.gamma > |friction.beta|, got "
            f"friction.A = {amplitude}, friction.gamma = {gamma} 1/m2, friction.beta = {beta} 1/m2"
        )
    return FrictionCoefficients(
        plateau=math.sqrt(amplitude / loading),
        loading_rate=math.sqrt(amplitude * loading),
        unloading_scale=math.sqrt(amplitude / unloading),
        unloading_rate=math.sqrt(amplitude * unloading),
    )


def after_slip(z_d: float, increment: float, c: FrictionCoefficients) -> float:
    """Advance the friction state along a change of the deflection in one direction, exactly.

    Parameters
    ----------
    z_d
        Friction state before, in m; beyond the plateau it decays to it.
    increment
        Change of the deflection, in m, of either sign, monotonic.
    c
        Coefficients from :func:`prepare`.

    Returns
    -------
    float
        z_d after, in m. The friction force is alpha z_d (35).
    """
    if increment == 0.0:
        return z_d
    distance = abs(increment)
    sign = 1.0 if increment >= 0.0 else -1.0
    zeta = sign * z_d
    if zeta < 0.0:  # unloading, up to zeta = 0 at most
        depth = -zeta / c.unloading_scale
        angle = c.unloading_rate * distance
        if angle < _QUARTER_TURN and (climb := math.tan(angle)) <= depth:
            return sign * c.unloading_scale * (climb - depth) / (1.0 + climb * depth)  # tan(angle - atan(depth))
        distance -= math.atan(depth) / c.unloading_rate
        zeta = 0.0
    if abs(zeta - c.plateau) <= PLATEAU_TOLERANCE * c.plateau:
        return sign * c.plateau
    decay = math.exp(-2.0 * c.loading_rate * distance)  # the tanh of the step is (1 - decay)/(1 + decay)
    total, rise = 1.0 + decay, 1.0 - decay
    return sign * (zeta * total + c.plateau * rise) / (total + zeta / c.plateau * rise)


def through_reversal(
    z_d: float, start: tuple[float, float], end: tuple[float, float], h: float, c: FrictionCoefficients
) -> float:
    """Advance the friction state over a substep, through the turning point if the rate changes its sign.

    The rate is linear over the substep, so the turning point divides the substep in the ratio of the two rates.

    Parameters
    ----------
    z_d
        Friction state before, in m.
    start, end
        Deflection in m and its rate in m/s, at both ends of the substep.
    h
        Length of the substep, in s.
    c
        Coefficients from :func:`prepare`.

    Returns
    -------
    float
        z_d after, in m.
    """
    (x_0, v_0), (x_1, v_1) = start, end
    if v_0 * v_1 < 0.0:
        share = v_0 / (v_0 - v_1)
        turning = 0.5 * (x_0 + x_1 + h * (v_0 * share - v_1 * (1.0 - share)) * 0.5)
        z_d = after_slip(z_d, turning - x_0, c)
        x_0 = turning
    return after_slip(z_d, x_1 - x_0, c)
