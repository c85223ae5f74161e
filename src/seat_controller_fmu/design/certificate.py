"""Certificate of a set of gains, independent of the solver that designed it: numpy and scipy only.

It has three independent parts:

1. The matrix inequalities (31)-(32). Their eigenvalues are computed for the Q of the gains, or for one that a search
   over its three entries finds. The smallest lambda that they certify follows in closed form.
2. The true worst-case gain of the loop (26)-(27) over the mass range, by a frequency sweep. It must be below lambda.
3. The delay margin of the sampled loop, see :mod:`seat_controller_fmu.design.sampled_loop`.
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

MIN_MARGIN = 1e-8
"""A block is negative definite if its largest eigenvalue, scaled to a unit diagonal, is below minus this."""

DRIVER_MASSES = tuple(float(mass) for mass in range(45, 121, 5))
"""Driver masses in kg for the sampled loop, inside and outside the range of the design."""

_MASS_STEP = 5.0
"""Distance of the masses of the sampled loop, in kg."""

_INFEASIBLE = 1e6
_LAMBDA_ROW = 3  # the only row of (30) with lambda
_OTHER_ROWS = [0, 1, 2, 4, 5]
_MEMBERSHIPS = np.linspace(0.0, 1.0, 21)
_FREQUENCIES = np.logspace(-4, 3, 2801)


@dataclass(frozen=True)
class Certificate:
    """Certified properties of a set of gains.

    Attributes
    ----------
    lambda_
        Requested level of (28).
    margins
        For each block of (31)-(32), minus its largest eigenvalue at ``lambda_``, scaled to a unit diagonal; must be
        above 0.
    Q
        Q of the margins, None if none was found.
    certified_lambda
        Smallest level that the inequalities certify, over all Q; infinite if none is found.
    worst_case_lambda
        True largest gain alpha |z_s''| / |z_v''| over mass range and frequency; infinite if the loop is unstable.
    delay_margin_ms
        Driver mass in kg to the delay margin of the sampled loop in ms; NaN if it is unstable.
    """

    lambda_: float
    margins: Mapping[str, float]
    Q: Matrix | None
    certified_lambda: float
    worst_case_lambda: float
    delay_margin_ms: Mapping[float, float]

    @property
    def problems(self) -> list[str]:
        """Failed conditions, one line each; empty if the gains pass."""
        failed = [
            f"{name}: expected negative definite at lambda = {self.lambda_:g}, got a largest scaled eigenvalue of "
            f"{-margin:.3g}"
            for name, margin in self.margins.items()
            if not margin > MIN_MARGIN
        ]
        if not self.worst_case_lambda < self.lambda_:
            failed.append(f"true gain: expected below lambda = {self.lambda_:g}, got {self.worst_case_lambda:.4g}")
        unstable = [f"{mass:g}" for mass, margin in self.delay_margin_ms.items() if math.isnan(margin)]
        if unstable:
            masses = "all drivers" if len(unstable) == len(self.delay_margin_ms) else f"{', '.join(unstable)} kg"
            failed.append(f"sampled loop: expected stable at {masses}, got unstable without any extra delay")
        return failed

    def figures(self) -> dict[str, Any]:
        """Return the results for a gains file, by name."""
        return {
            "certified_lambda": self.certified_lambda,
            "worst_case_lambda": self.worst_case_lambda,
            "delay_margin_ms": {f"{mass:g}": margin for mass, margin in self.delay_margin_ms.items()},
        }


def block_margins(blocks: Iterable[Array]) -> dict[str, float]:
    """Return minus the largest eigenvalue of each block, scaled by a congruence to a unit diagonal.

    The sign does not depend on the scaling. The scaling makes the margins comparable, with rounding errors of 1e-15.

    Parameters
    ----------
    blocks
        The four blocks of (31)-(32), each of shape (6, 6), symmetric.

    Returns
    -------
    dict
        Name of the block to its margin; minus infinity if the diagonal is not negative.
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
    """Find the smallest lambda of (31)-(32) from the blocks at lambda = 1.

    lambda is in one diagonal entry of each block only. By the Schur complement a block is negative definite if the rest
    S of it is, and lambda^2 > w' (-S)^-1 w with w the row of that entry.

    Returns
    -------
    violation : float
        Largest scaled eigenvalue of all S; must be below 0.
    lambda_ : float
        Smallest lambda; infinite if there is none.
    """
    rest = blocks[:, _OTHER_ROWS][:, :, _OTHER_ROWS]
    scale = 1.0 / np.sqrt(np.maximum(np.abs(np.diagonal(rest, axis1=1, axis2=2)), 1e-300))
    scaled = rest * scale[:, :, None] * scale[:, None, :]
    violation = float(np.linalg.eigvalsh(scaled).max())
    if violation >= -MIN_MARGIN:
        return violation, math.inf
    row = (blocks[:, _OTHER_ROWS, _LAMBDA_ROW] * scale)[:, :, None]
    squared = (row * np.linalg.solve(-scaled, row)).sum(axis=(1, 2)) / -blocks[:, _LAMBDA_ROW, _LAMBDA_ROW]
    return violation, math.sqrt(float(squared.max()))


def smallest_lambda(setting: Setting, feedback: tuple[Any, Any], Q: Array) -> float:
    """Return the smallest lambda for which (31)-(32) hold with a given Q, in closed form.

    Parameters
    ----------
    setting
        Setting of the design.
    feedback
        K_1 and K_2, in N/m and N.s/m.
    Q
        Shape (2, 2), symmetric.

    Returns
    -------
    float
        Infinite if there is none.
    """
    return _schur(_blocks(setting, feedback, Q, 1.0))[1]


def search_Q(setting: Setting, feedback: tuple[Any, Any]) -> tuple[Array | None, float]:
    """Find the Q that certifies the smallest lambda for given gains, by a search over its three entries.

    Q is written as [[e^2a, r e^(a+b)], [., e^2b]] with r = tanh c, so that every point of the search is positive
    definite and a, b, c have similar magnitudes. Start points are the Lyapunov solutions of the closed loops at the two
    vertices, in several sizes. A simplex that has collapsed at the edge of the feasible set is restarted.

    Parameters
    ----------
    setting
        Setting of the design.
    feedback
        K_1 and K_2, in N/m and N.s/m.

    Returns
    -------
    Q : array or None
        Shape (2, 2); None if none was found.
    lambda_ : float
        Infinite if none was found.
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
        return math.log(level) if violation < -MIN_MARGIN else _INFEASIBLE + violation  # decreases towards feasibility

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
    """Return the largest true gain alpha |z_s''| / |z_v''| of (26)-(27) over masses and frequencies.

    The floor does not excite the estimation error, so the error has no part in it.

    Parameters
    ----------
    setting
        Setting of the design.
    feedback
        K_1 and K_2, in N/m and N.s/m.

    Returns
    -------
    float
        Infinite if the loop is unstable.
    """
    minimum, maximum = setting.vertices
    worst = 0.0
    for h_1 in _MEMBERSHIPS:
        inverse = h_1 / minimum + (1.0 - h_1) / maximum  # 1/M (11)
        model = vertex(setting, 1.0 / inverse)
        K = h_1 * np.array([feedback[0]]) + (1.0 - h_1) * np.array([feedback[1]])
        closed, output = model.A + model.B_1 @ K, model.C_3 + model.D_3 * K
        if np.linalg.eigvals(closed).real.max() >= 0.0:
            return math.inf
        s = 2j * np.pi * _FREQUENCIES[:, None, None]
        states = np.linalg.solve(s * np.eye(2) - closed, np.broadcast_to(B_2.astype(complex), (len(s), 2, 1)))
        worst = max(worst, float(np.abs(output @ states).max()))
    return worst


def masses_of(setting: Setting) -> tuple[float, ...]:
    """Return the driver masses of the sampled loop: :data:`DRIVER_MASSES`, and the range of a design that exceeds them.

    Parameters
    ----------
    setting
        Setting of the design.

    Returns
    -------
    tuple of float
        In kg, ascending.

    Examples
    --------
    >>> from seat_controller_fmu.design.gains import preset
    >>> masses_of(preset("recommended").setting) == DRIVER_MASSES
    True
    """
    low, high = setting.driver_mass_min, setting.driver_mass_max
    between = np.arange(math.ceil(low / _MASS_STEP) * _MASS_STEP, high, _MASS_STEP)
    return tuple(sorted({*DRIVER_MASSES, low, *map(float, between), high}))


def delay_margins(gains: Gains, seat_for: SeatFor, masses: tuple[float, ...] = DRIVER_MASSES) -> dict[float, float]:
    """Return the delay margins of the sampled loop.

    Parameters
    ----------
    gains
        Set of gains.
    seat_for
        Function from the driver's mass in kg to the seat.
    masses
        Driver masses, in kg.

    Returns
    -------
    dict
        Driver mass in kg to the delay margin in ms.
    """
    with threadpool_limits(1, "blas"):  # for these small matrices threads are ten times slower
        return {mass: delay_margin(gains.controller(mass), seat_for(mass)) for mass in masses}


def certify(gains: Gains, seat_for: SeatFor, lambda_: float | None = None) -> Certificate:
    """Certify a set of gains.

    Parameters
    ----------
    gains
        Set of gains; its Q is checked if it has one, otherwise the Q of :func:`search_Q`.
    seat_for
        Function from the driver's mass in kg to the seat of the sampled loop.
    lambda_
        Level to certify; that of the set if None.

    Returns
    -------
    Certificate
        Its ``problems`` are empty if the gains pass.
    """
    level = gains.lambda_ if lambda_ is None else lambda_
    found_Q, smallest = search_Q(gains.setting, gains.feedback)
    Q = np.array(gains.Q) if gains.Q is not None else found_Q
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
        delay_margin_ms=delay_margins(gains, seat_for, masses_of(gains.setting)),
    )
