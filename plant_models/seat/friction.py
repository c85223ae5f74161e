"""Bouc-Wen friction (35)-(36) as an exact function of the deflection.

The equation as solved here, with v the deflection rate,

    z_d' = A_d v - gamma_d |v| |z_d| z_d - beta_d v z_d^2                                   (36, erratum below)

is rate independent: dividing by v leaves z_d as a function of the deflection alone. While the deflection moves one way
by y = |dx|, with s = sgn(dx) and zeta = s z_d,

    d zeta/dy = A_d - (gamma_d + beta_d) zeta^2      for zeta >= 0, solved by tanh
    d zeta/dy = A_d + (gamma_d - beta_d) zeta^2      for zeta <  0, solved by tan until it crosses zero

each written so that it costs one exponential or one tangent. So a step needs no time integration, is exact for any
length, and stays within the plateau +-sqrt(A_d/(gamma_d + beta_d)). (Integrating (36) in time needs about 41 |v|
explicit substeps per 2 ms; just below that it is finite and wrong.)

Erratum: the paper prints |v||z_d||z_d|, which has no plateau for v < 0. The usual Bouc-Wen form is meant: it saturates
at 75.3 N both ways, the paper's "around 80 N".
"""

from __future__ import annotations

import math
from typing import NamedTuple

from fmus.component import ParameterError

_QUARTER_TURN = 0.5 * math.pi

SETTLED = 1e-12
"""A state within this share of the plateau is on it, and stays there as long as the deflection moves on."""


class BoucWen(NamedTuple):
    """Coefficients of the closed-form step, see :func:`bouc_wen`.

    Attributes
    ----------
    plateau
        sqrt(A_d/(gamma_d + beta_d)), in m: the largest z_d the friction reaches when loading.
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


def bouc_wen(gamma: float, beta: float, amplitude: float) -> BoucWen:
    """Prepare the closed-form step of (36).

    Parameters
    ----------
    gamma, beta
        gamma_d and beta_d, in 1/m2.
    amplitude
        A_d, dimensionless.

    Raises
    ------
    ParameterError
        Unless A_d > 0, gamma_d + beta_d > 0 and gamma_d - beta_d > 0: otherwise (36) has no plateau.
    """
    loading, unloading = gamma + beta, gamma - beta
    if not (amplitude > 0 and loading > 0 and unloading > 0):
        raise ParameterError(
            "friction: expected friction.A > 0 and friction.gamma > |friction.beta|, got "
            f"friction.A = {amplitude}, friction.gamma = {gamma} 1/m2, friction.beta = {beta} 1/m2"
        )
    return BoucWen(
        plateau=math.sqrt(amplitude / loading),
        loading_rate=math.sqrt(amplitude * loading),
        unloading_scale=math.sqrt(amplitude / unloading),
        unloading_rate=math.sqrt(amplitude * unloading),
    )


def friction_state(state: float, increment: float, coefficients: BoucWen) -> float:
    """Move the friction state z_d along a one-way change of the deflection.

    Parameters
    ----------
    state
        z_d before, in m; may lie beyond the plateau, from where it decays to it.
    increment
        Change of the deflection, in m, either sign, monotonic.
    coefficients
        From :func:`bouc_wen`.

    Returns
    -------
    float
        z_d after, in m. The friction force is alpha z_d (35).
    """
    if increment == 0.0:
        return state
    plateau, loading_rate, unloading_scale, unloading_rate = coefficients
    distance = abs(increment)
    sign = 1.0 if increment >= 0.0 else -1.0
    zeta = sign * state
    if zeta < 0.0:  # unloading, up to zeta = 0 at most
        depth = -zeta / unloading_scale
        angle = unloading_rate * distance
        if angle < _QUARTER_TURN and (climb := math.tan(angle)) <= depth:
            return sign * unloading_scale * (climb - depth) / (1.0 + climb * depth)  # tan(angle - atan(depth))
        distance -= math.atan(depth) / unloading_rate
        zeta = 0.0
    if abs(zeta - plateau) <= SETTLED * plateau:
        return sign * plateau
    fading = math.exp(-2.0 * loading_rate * distance)  # the step's tanh is (1 - fading)/(1 + fading)
    rest, rise = 1.0 + fading, 1.0 - fading
    return sign * (zeta * rest + plateau * rise) / (rest + zeta / plateau * rise)


def friction_through_reversal(
    friction: float, start: tuple[float, float], end: tuple[float, float], h: float, coefficients: BoucWen
) -> float:
    """Move the friction state over a substep, by way of the turning point if the rate changes sign.

    The rate is taken as linear over the substep, so the turning point divides it in the ratio of the two rates.

    Parameters
    ----------
    friction
        z_d before, in m.
    start, end
        Deflection in m and its rate in m/s, at both ends of the substep.
    h
        Length of the substep, in s.
    coefficients
        From :func:`bouc_wen`.

    Returns
    -------
    float
        z_d after, in m.
    """
    (x_0, v_0), (x_1, v_1) = start, end
    if v_0 * v_1 < 0.0:
        share = v_0 / (v_0 - v_1)
        turning = 0.5 * (x_0 + x_1 + h * (v_0 * share - v_1 * (1.0 - share)) * 0.5)
        friction = friction_state(friction, turning - x_0, coefficients)
        x_0 = turning
    return friction_state(friction, x_1 - x_0, coefficients)
