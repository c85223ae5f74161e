"""A certificate that does not believe the solver: gains in, margins out, with numpy and scipy alone.

Three independent questions are asked of a set of gains:

1. Do the matrix inequalities (31)-(32) hold? Their eigenvalues are computed for a Q, the one that comes with the gains
   or one found by a search over its three entries; the smallest lambda they certify follows in closed form.
2. What is the true worst-case gain of the loop (26)-(27) over the mass range? A frequency sweep; it must lie below 1.
3. Does the loop as it runs, sampled and delayed, hold? See :mod:`seat_controller_fmu.design.sampled_loop`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import solve_continuous_lyapunov
from scipy.optimize import minimize
from threadpoolctl import threadpool_limits

from seat_controller_fmu.design.gains import Gains, Matrix
from seat_controller_fmu.design.lmi import B_2, NAMES, relaxed, vertex
from seat_controller_fmu.design.sampled_loop import SeatFor, delay_margin
from seat_controller_fmu.design.setting import Setting

Array = np.ndarray[Any, Any]

STRICT = 1e-8
"""A block counts as negative definite if its largest eigenvalue, scaled to a unit diagonal, lies below minus this."""

DRIVER_MASSES = tuple(float(mass) for mass in range(45, 121, 5))
"""Driver masses in kg for which the sampled loop is looked at, inside and outside the design's range."""

_INFEASIBLE = 1e6
_LAMBDA_ROW = 3  # of (30): the only one with lambda, and -B_2 beside it
_OTHERS = [0, 1, 2, 4, 5]
_SHARES = np.linspace(0.0, 1.0, 21)
_FREQUENCIES = np.logspace(-4, 3, 2801)


@dataclass(frozen=True)
class Certificate:
    """What is certified of a set of gains.

    Attributes
    ----------
    lambda_
        The level that was asked for.
    margins
        For each block of (31)-(32), minus its largest eigenvalue at ``lambda_``, scaled to a unit diagonal; above 0
        is needed.
    Q
        The Q they were computed with.
    certified_lambda
        The smallest level that these inequalities certify, over all Q; infinite where none is found.
    worst_case_lambda
        The true largest gain alpha |z_s''| / |z_v''| over mass range and frequency; infinite if the loop is unstable.
    delay_margin_ms
        Driver mass in kg to the extra delay in ms the sampled loop survives; NaN where it is unstable.
    """

    lambda_: float
    margins: Mapping[str, float]
    Q: Matrix | None
    certified_lambda: float
    worst_case_lambda: float
    delay_margin_ms: Mapping[float, float]

    @property
    def problems(self) -> list[str]:
        """What fails, one line each; empty if the gains pass."""
        failed = [
            f"{name}: expected negative definite at lambda = {self.lambda_:g}, got a largest scaled eigenvalue of "
            f"{-margin:.3g}"
            for name, margin in self.margins.items()
            if not margin > STRICT
        ]
        if not self.worst_case_lambda < self.lambda_:
            failed.append(f"true gain: expected below lambda = {self.lambda_:g}, got {self.worst_case_lambda:.4g}")
        failed += [
            f"sampled loop: expected stable at {mass:g} kg, got unstable without any extra delay"
            for mass, margin in self.delay_margin_ms.items()
            if math.isnan(margin)
        ]
        return failed

    def figures(self) -> dict[str, Any]:
        """Return the results as they stand in a gains file."""
        return {
            "certified_lambda": self.certified_lambda,
            "worst_case_lambda": self.worst_case_lambda,
            "delay_margin_ms": {f"{mass:g}": margin for mass, margin in self.delay_margin_ms.items()},
        }


def block_margins(blocks: Iterable[Array]) -> dict[str, float]:
    """Return minus the largest eigenvalue of each block, scaled by a congruence to a unit diagonal.

    The sign does not depend on the scaling; the scaling makes the number comparable and its rounding error some 1e-15.
    """
    margins = {}
    for name, block in zip(NAMES, blocks, strict=True):
        diagonal = np.diag(block)
        if (diagonal >= 0.0).any():  # cannot be negative definite, and cannot be scaled
            margins[name] = -math.inf
            continue
        scale = 1.0 / np.sqrt(-diagonal)
        margins[name] = -float(np.linalg.eigvalsh(block * np.outer(scale, scale)).max())
    return margins


def _blocks(setting: Setting, feedback: tuple[Any, Any], Q: Array, lambda_: float) -> Array:
    """Evaluate the four blocks of (31)-(32), shape (4, 6, 6)."""
    R = [np.array([K]) @ Q for K in feedback]
    return np.array(relaxed(setting, Q, R, np.array([[lambda_ * lambda_]]), np.block))


def _schur(blocks: Array) -> tuple[float, float]:
    """Judge (31)-(32) for any lambda, from the blocks at lambda = 1.

    lambda stands in one diagonal entry of each block only, so by the Schur complement a block is negative definite if
    the rest S of it is, and lambda^2 > w' (-S)^-1 w with w the row beside that entry.

    Returns
    -------
    tuple
        The largest scaled eigenvalue of all S, which must lie below 0, and then the smallest lambda.
    """
    rest = blocks[:, _OTHERS][:, :, _OTHERS]
    scale = 1.0 / np.sqrt(np.maximum(np.abs(np.diagonal(rest, axis1=1, axis2=2)), 1e-300))
    scaled = rest * scale[:, :, None] * scale[:, None, :]
    violation = float(np.linalg.eigvalsh(scaled).max())
    if violation >= -STRICT:
        return violation, math.inf
    row = (blocks[:, _OTHERS, _LAMBDA_ROW] * scale)[:, :, None]
    squared = (row * np.linalg.solve(-scaled, row)).sum(axis=(1, 2)) / -blocks[:, _LAMBDA_ROW, _LAMBDA_ROW]
    return violation, math.sqrt(float(squared.max()))


def smallest_lambda(setting: Setting, feedback: tuple[Any, Any], Q: Array) -> float:
    """Return the smallest lambda for which (31)-(32) hold with this Q, in closed form; infinite where there is none."""
    return _schur(_blocks(setting, feedback, Q, 1.0))[1]


def search_Q(setting: Setting, feedback: tuple[Any, Any]) -> tuple[Array | None, float]:
    """Find the Q that certifies the smallest lambda for given gains, by a search over its three entries.

    Q is written as [[e^2a, r e^(a+b)], [., e^2b]] with r = tanh c, so that every point of the search is positive
    definite and all three numbers are of one size. Starts are the Lyapunov solutions of the two vertices' closed loops
    at several sizes; a simplex that has collapsed on an edge of the feasible set starts anew.

    Returns
    -------
    tuple
        Q of shape (2, 2) and the lambda; None and infinity where none was found.
    """
    # the blocks are affine in the entries of Q
    constant = _blocks(setting, feedback, np.zeros((2, 2)), 1.0)
    units = (np.diag([1.0, 0.0]), np.array([[0.0, 1.0], [1.0, 0.0]]), np.diag([0.0, 1.0]))
    slopes = [_blocks(setting, feedback, unit, 1.0) - constant for unit in units]

    def matrix(x: Array) -> Array:
        size, r = np.exp(x[:2]), math.tanh(x[2])
        return np.asarray(np.outer(size, size) * np.array([[1.0, r], [r, 1.0]]))

    def objective(x: Array) -> float:
        if np.abs(x).max() > 30.0:
            return 2.0 * _INFEASIBLE
        Q = matrix(x)
        violation, level = _schur(constant + Q[0, 0] * slopes[0] + Q[0, 1] * slopes[1] + Q[1, 1] * slopes[2])
        return math.log(level) if violation < -STRICT else _INFEASIBLE + violation  # downhill to where it is feasible

    starts = []
    for mass, K in zip(setting.vertices, feedback, strict=True):
        model = vertex(setting, mass)
        closed = model.A + model.B_1 @ np.array([K])
        if np.linalg.eigvals(closed).real.max() >= 0.0:
            return None, math.inf
        Q = solve_continuous_lyapunov(closed, -np.eye(2))
        r = Q[0, 1] / math.sqrt(Q[0, 0] * Q[1, 1])
        for size in (1.0, 1e2, 1e4, 1e6):
            starts.append(np.array([0.5 * math.log(size * Q[0, 0]), 0.5 * math.log(size * Q[1, 1]), math.atanh(r)]))
    x = min(starts, key=objective)
    for spread in (1.0, 0.5, 0.2, 0.1, 0.05):
        simplex = x + spread * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        options = {"initial_simplex": simplex, "xatol": 1e-7, "fatol": 1e-9}
        found = minimize(objective, x, method="Nelder-Mead", options=options)
        if found.fun > _INFEASIBLE / 2.0:
            return None, math.inf
        x = found.x
    return matrix(x), math.exp(found.fun)


def worst_case_lambda(setting: Setting, feedback: tuple[Any, Any]) -> float:
    """Sweep the true gain alpha |z_s''| / |z_v''| of (26)-(27) over masses and frequency.

    The estimation error is not excited by the floor and adds nothing.
    """
    minimum, maximum = setting.vertices
    worst = 0.0
    for share in _SHARES:
        inverse = share / minimum + (1.0 - share) / maximum  # h_1 = share (11)
        model = vertex(setting, 1.0 / inverse)
        K = share * np.array([feedback[0]]) + (1.0 - share) * np.array([feedback[1]])
        closed, output = model.A + model.B_1 @ K, model.C_3 + model.D_3 * K
        if np.linalg.eigvals(closed).real.max() >= 0.0:
            return math.inf
        s = 2j * np.pi * _FREQUENCIES[:, None, None]
        states = np.linalg.solve(s * np.eye(2) - closed, np.broadcast_to(B_2.astype(complex), (len(s), 2, 1)))
        worst = max(worst, float(np.abs(output @ states).max()))
    return worst


def delay_margins(gains: Gains, seat_for: SeatFor, masses: tuple[float, ...] = DRIVER_MASSES) -> dict[float, float]:
    """Return the sampled loop's delay margin in ms by driver mass in kg."""
    with threadpool_limits(1, "blas"):  # these matrices are small, and threads make it ten times slower
        return {mass: delay_margin(gains.controller(mass), seat_for(mass)) for mass in masses}


def certify(gains: Gains, seat_for: SeatFor, lambda_: float | None = None) -> Certificate:
    """Ask all three questions of a set of gains.

    Parameters
    ----------
    gains
        The set; its own Q is checked if it has one, a found one otherwise.
    seat_for
        The seat whose sampled loop is looked at, by driver's mass.
    lambda_
        Level to certify; the set's own where None.
    """
    level = gains.lambda_ if lambda_ is None else lambda_
    found, smallest = search_Q(gains.setting, gains.feedback)
    Q = np.array(gains.Q) if gains.Q is not None else found
    if Q is None or np.linalg.eigvalsh(Q).min() <= 0.0:
        margins = dict.fromkeys(NAMES, -math.inf)
    else:
        margins = block_margins(_blocks(gains.setting, gains.feedback, Q, level))
    return Certificate(
        lambda_=level,
        margins=margins,
        Q=None if Q is None else ((float(Q[0, 0]), float(Q[0, 1])), (float(Q[1, 0]), float(Q[1, 1]))),
        certified_lambda=smallest,
        worst_case_lambda=worst_case_lambda(gains.setting, gains.feedback),
        delay_margin_ms=delay_margins(gains, seat_for),
    )
