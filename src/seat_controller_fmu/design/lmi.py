"""The matrix inequalities (30)-(32), for numbers and for unknowns of a solver.

Erratum: the paper defines the disturbance d = z_v'. With B_2 = [0, -1]' the equations hold for d = z_v'', the floor
acceleration. So lambda bounds alpha |z_s''| / |z_v''|, and lambda is at least alpha: a seat follows the cabin at 0 Hz.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from seat_controller_fmu.design.setting import Setting

B_2 = np.array([[0.0], [-1.0]])
"""Input matrix of the floor acceleration (7)."""

NAMES = ("Xi_11", "Xi_22", "Xi_11 + (Xi_12 + Xi_21)/2", "Xi_22 + (Xi_12 + Xi_21)/2")
"""Names of the blocks that must be negative definite: (31) twice, (32) twice."""


class Vertex(NamedTuple):
    """Model of the seat at one end of the mass range (7)-(10), (13)-(15).

    Attributes
    ----------
    A, B_1
        State X = [deflection, rate] and force: X' = A X + B_1 (u - F_d) + B_2 d.
    C_2, D_2
        Seat acceleration Y_2 = C_2 X + D_2 (u - F_d), in m/s2.
    C_3, D_3
        Controlled output Z_1 = alpha Y_2.
    """

    A: np.ndarray[Any, Any]
    B_1: np.ndarray[Any, Any]
    C_2: np.ndarray[Any, Any]
    D_2: float
    C_3: np.ndarray[Any, Any]
    D_3: float


def vertex(setting: Setting, mass: float) -> Vertex:
    """Return the model of the seat at a total mass.

    Parameters
    ----------
    setting
        Setting of the design.
    mass
        Total mass M (4), in kg.

    Returns
    -------
    Vertex
        Matrices of the model.
    """
    k_f, D_2 = setting.stiffness, 1.0 / mass
    C_2 = np.array([[-k_f * D_2, 0.0]])
    return Vertex(
        A=np.array([[0.0, 1.0], [-k_f * D_2, 0.0]]),
        B_1=np.array([[0.0], [D_2]]),
        C_2=C_2,
        D_2=D_2,
        C_3=setting.alpha * C_2,
        D_3=setting.alpha * D_2,
    )


def inequality(
    setting: Setting, i: int, j: int, Q: Any, R: Sequence[Any], lambda_squared: Any, block: Callable[..., Any]
) -> Any:
    """Assemble the matrix Xi_ij of (30).

    Parameters
    ----------
    setting
        Setting of the design: mass range, observer gains and weights.
    i, j
        Vertex of the model and vertex of the gains, 0 or 1.
    Q
        P_1^-1, shape (2, 2).
    R
        K_1 Q and K_2 Q, each of shape (1, 2).
    lambda_squared
        Array or expression of shape (1, 1).
    block
        ``numpy.block``, or ``cvxpy.bmat`` if Q, R or lambda are unknowns.

    Returns
    -------
    array or expression
        Of shape (6, 6), symmetric.
    """
    m = vertex(setting, setting.vertices[i])
    one = np.ones((1, 1))
    flow = m.A @ Q + m.B_1 @ R[j]
    observer = 2.0 * setting.P_2 * setting.observer[j] * m.D_2 * one
    output = m.C_3 @ Q + m.D_3 * R[j]
    D_3, c_0, column, zero = m.D_3 * one, setting.c_0 * one, np.zeros((2, 1)), np.zeros((1, 1))
    return block(
        [
            [flow + flow.T, -m.B_1, B_2, output.T, column],
            [-m.B_1.T, observer, zero, -D_3, c_0],
            [B_2.T, zero, -lambda_squared, zero, zero],
            [output, -D_3, zero, -one, zero],
            [column.T, c_0, zero, zero, -one],
        ]
    )


def relaxed(setting: Setting, Q: Any, R: Sequence[Any], lambda_squared: Any, block: Callable[..., Any]) -> list[Any]:
    """Assemble the four blocks of (31) and (32).

    Parameters
    ----------
    setting, Q, R, lambda_squared, block
        As of :func:`inequality`.

    Returns
    -------
    list of array or expression
        Each of shape (6, 6), symmetric, in the order of :data:`NAMES`.
    """
    xi = {(i, j): inequality(setting, i, j, Q, R, lambda_squared, block) for i in (0, 1) for j in (0, 1)}
    mixed = (xi[0, 1] + xi[1, 0]) / 2.0
    return [xi[0, 0], xi[1, 1], xi[0, 0] + mixed, xi[1, 1] + mixed]
