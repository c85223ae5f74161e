"""Design of gains by the matrix inequalities (28)-(32); the only module that imports cvxpy (extra ``design``).

The inequalities are the paper's; the paper does not give the objective. There are three:

``margin``
    The largest t with Xi < -t I at a given lambda, as a feasibility solver finds it. Its supremum is at Q -> infinity,
    where the spring is cancelled completely, and a solver stops somewhere on the way. A bound on Q_11 gives a problem
    with a solution. The default bound is calibrated to give the paper's stiffness gains.
``lambda``
    The smallest lambda. Not useful in practice: lambda bounds alpha |z_s''|/|z_v''| and is at least alpha, as any seat
    follows the cabin at 0 Hz. Gains with lambda -> alpha hold the deflection at 0 at all frequencies, like a seat that
    is bolted to the floor. The result shows the limit of the inequalities.
``trade-off``
    At a given lambda, the smallest bound on  E[z_s''^2] + (2 pi f_x)^4 E[x^2] + w_u E[(K x)^2]  under white noise of
    the floor acceleration. The same Q bounds it: (30) implies A Q + Q A' + B_2 B_2'/lambda^2 < 0, so lambda^2 Q bounds
    the covariance of x for unit intensity. f_x is the frequency below which the seat follows the cabin.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np

from seat_controller_fmu.design.gains import Gains
from seat_controller_fmu.design.lmi import relaxed, vertex
from seat_controller_fmu.design.setting import Setting

OBJECTIVES = ("trade-off", "margin", "lambda")
"""Names of the objectives."""

SOLVERS = ("CLARABEL", "CVXOPT", "SCS")
"""Names of the solvers, the default first."""

DEFLECTION_BOUND = 36.0
"""Bound on Q_11 of the objective ``margin``, calibrated: at lambda = 1.2 it gives the published stiffness gains."""

FOLLOW = 0.14
"""Default of f_x in Hz: below, the seat follows the cabin. Chosen with the recommended gains, see
docs/explanation/certificate.md."""

_STRICT = 1e-4  # margin of the scaled blocks: solvers have no strict inequalities, and the certificate needs a margin


class DesignError(ValueError):
    """An infeasible design; the message names the failed condition and possible changes."""


def _solver_module() -> Any:
    try:
        import cvxpy
    except ImportError as error:
        raise DesignError(
            "design: expected cvxpy, got none; install it with: pip install 'seat-cosim[design]'"
        ) from error
    return cvxpy


class _Problem:
    """Unknowns and inequalities of one design, scaled so that their numbers are near one."""

    def __init__(self, cp: Any, setting: Setting, lambda_: float | None, sizes: tuple[float, float]) -> None:
        self.cp = cp
        self.setting = setting
        self.state = np.diag(sizes)  # approximate square roots of the diagonal of Q
        self.scaled_Q = cp.Variable((2, 2), symmetric=True)
        self.Q = self.state @ self.scaled_Q @ self.state
        force = setting.stiffness * self.state
        self.R = [cp.Variable((1, 2)) @ force for _ in setting.observer]
        if lambda_ is None:
            free = cp.Variable((1, 1), nonneg=True)
            self.lambda_squared: Any = setting.alpha**2 * free
            size = setting.alpha
        else:
            self.lambda_squared = lambda_**2 * np.ones((1, 1))
            size = lambda_
        observer = math.sqrt(2.0 * setting.P_2 * abs(setting.L1) / setting.vertices.minimum)
        self.scale = np.diag([1.0 / sizes[0], 1.0 / sizes[1], 1.0 / observer, 1.0 / size, 1.0, 1.0])

    def constraints(self, margin: Any) -> list[Any]:
        """Return (31)-(32) and Q > 0, each with ``margin`` in the unscaled inequality, or a small fixed one if None."""
        cp, W = self.cp, self.scale
        constraints = []
        for block in relaxed(self.setting, self.Q, self.R, self.lambda_squared, cp.bmat):
            scaled = W @ block @ W
            bound = _STRICT * np.eye(6) if margin is None else margin * W @ W
            constraints.append((scaled + scaled.T) / 2.0 << -bound)
        inverse = np.linalg.inv(self.state @ self.state)
        constraints.append(self.scaled_Q >> (_STRICT * np.eye(2) if margin is None else margin * inverse))
        return constraints

    def bound_variance(self, row: Any, limit: Any) -> Any:
        """Return the constraint row Q^-1 row' <= limit; ``row`` is linear in Q and R, ``limit`` has shape (1, 1)."""
        scaled = row @ np.linalg.inv(self.state)
        matrix = self.cp.bmat([[limit, scaled], [scaled.T, self.scaled_Q]])
        return (matrix + matrix.T) / 2.0 >> 0

    def solve(self, objective: Any, constraints: list[Any], solver: str, advice: str) -> float:
        """Solve the problem and return its optimal value; raise :class:`DesignError` with ``advice`` otherwise."""
        cp = self.cp
        options = {"SCS": {"eps": 1e-8, "max_iters": 100_000}}.get(solver, {})
        problem = cp.Problem(objective, constraints)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the certificate checks the accuracy of the solution
            try:
                problem.solve(solver=solver, **options)
            except cp.error.SolverError as error:
                raise DesignError(f"design: expected {solver} to solve, got: {error}; {advice}") from error
        if self.scaled_Q.value is None or problem.status not in ("optimal", "optimal_inaccurate"):
            got = f"{solver} returns {problem.status}"
            raise DesignError(f"design: expected feasible inequalities (31)-(32), got none, {got}; {advice}")
        return float(problem.value)

    def feedback(self) -> list[np.ndarray[Any, Any]]:
        """Return K_i = R_i Q^-1, in N/m and N.s/m."""
        return [np.asarray(np.linalg.solve(self.Q.value, R.value.T)[:, 0]) for R in self.R]


def _advice(setting: Setting, lambda_: float | None) -> str:
    """Check necessary conditions without a solver; return the advice for a solver that fails."""
    if lambda_ is not None and not lambda_ > 0.0:
        raise DesignError(f"design: expected lambda above 0, got {lambda_}")
    if lambda_ is not None and lambda_ <= setting.alpha:
        raise DesignError(
            f"design: expected lambda above alpha = {setting.alpha:g}, got {lambda_:g}: a seat follows the cabin at "
            "0 Hz, so no gains go below; raise lambda or lower alpha"
        )
    for L, mass in zip(setting.observer, setting.vertices, strict=True):
        decay, needed = -2.0 * setting.P_2 * L / mass, setting.c_0**2
        if not decay > needed:
            raise DesignError(
                f"design: expected 2 P_2 |L_i| D_2i > c_0^2 (the observer's entry of (30)), got {decay:g} and "
                f"{needed:g}; raise P_2 or the observer gain, or lower c_0"
            )
    return "raise lambda or P_2, lower c_0 or alpha, or narrow the mass range"


def design(
    setting: Setting,
    objective: str = "trade-off",
    lambda_: float = 1.2,
    *,
    follow: float = FOLLOW,
    force_weight: float = 0.0,
    deflection_bound: float = DEFLECTION_BOUND,
    solver: str = SOLVERS[0],
) -> Gains:
    """Design state feedback gains.

    Parameters
    ----------
    setting
        Setting of the design: mass range, observer gains, weights.
    objective
        One of :data:`OBJECTIVES`, described in this module's docstring.
    lambda_
        Level of (28); not used by the objective ``lambda``.
    follow
        f_x of ``trade-off``, in Hz.
    force_weight
        w_u of ``trade-off``, in (m/s2)^2/N^2.
    deflection_bound
        Bound on Q_11 of ``margin``.
    solver
        One of :data:`SOLVERS`.

    Returns
    -------
    Gains
        Without figures of a certificate.

    Raises
    ------
    DesignError
        If the design is infeasible, cvxpy is missing, or the solver fails.
    """
    if objective not in OBJECTIVES:
        raise DesignError(f"design: expected an objective among {', '.join(OBJECTIVES)}, got {objective}")
    level = None if objective == "lambda" else lambda_
    advice = _advice(setting, level)
    cp = _solver_module()
    sizes = (1.0 / lambda_, 1.0 / lambda_) if objective == "trade-off" else (30.0, 10.0)
    problem = _Problem(cp, setting, level, sizes)
    record: dict[str, Any] = {"name": objective}
    if objective == "margin":
        t = cp.Variable()
        bound = [problem.Q[0, 0] <= deflection_bound]
        value = problem.solve(cp.Maximize(t), problem.constraints(t) + bound, solver, advice)
        record |= {"deflection_bound": deflection_bound}
        if not value > 0.0:
            raise DesignError(f"design: expected a feasibility margin above 0, got {value:.3g}; {advice}")
    elif objective == "lambda":
        goal = cp.Minimize(problem.lambda_squared[0, 0] / setting.alpha**2)
        level = setting.alpha * math.sqrt(problem.solve(goal, problem.constraints(None), solver, advice))
    else:
        cost, extra = _trade_off(problem, follow, force_weight)
        problem.solve(cp.Minimize(cost), problem.constraints(None) + extra, solver, advice)
        record |= {"follow": follow, "force_weight": force_weight}
    K_1, K_2 = ((float(K[0]), float(K[1])) for K in problem.feedback())
    Q = np.asarray(problem.Q.value)
    assert level is not None
    return Gains(
        K1=K_1,
        K2=K_2,
        setting=setting,
        lambda_=level,
        Q=((float(Q[0, 0]), float(Q[0, 1])), (float(Q[1, 0]), float(Q[1, 1]))),
        objective=record,
    )


def _trade_off(problem: _Problem, follow: float, force_weight: float) -> tuple[Any, list[Any]]:
    """Return the cost and the constraints that bound the weighted variances at both vertices by the larger one."""
    cp, setting = problem.cp, problem.setting
    worst = [cp.Variable((1, 1), nonneg=True) for _ in range(3)]
    corner = (2.0 * math.pi * follow) ** 2
    weights = (1.0, corner, math.sqrt(force_weight))
    constraints = []
    for mass, R in zip(setting.vertices, problem.R, strict=True):
        m = vertex(setting, mass)
        rows: Sequence[Any] = (m.C_2 @ problem.Q + m.D_2 * R, np.array([[1.0, 0.0]]) @ problem.Q, R)
        for limit, weight, row in zip(worst, weights, rows, strict=True):
            if weight > 0.0:
                constraints.append(problem.bound_variance(weight * row, limit))
    return sum(limit[0, 0] for limit, weight in zip(worst, weights, strict=True) if weight > 0.0), constraints
