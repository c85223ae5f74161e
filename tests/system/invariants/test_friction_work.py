"""What friction takes from rest is never negative, whatever the deflection does.

With W the work done on the friction, zeta = s z_d and y as in :mod:`plant_models.seat.friction`, and

    S(z) = alpha/(2 (gamma - beta)) ln(1 + (gamma - beta) z^2/A),

what it gives back when the deflection turns round until z_d = 0: while unloading (zeta < 0) dW = dS exactly, while
loading

    dW - dS = alpha zeta (1 - (A - (gamma + beta) zeta^2)/(A + (gamma - beta) zeta^2)) dy
            = 2 alpha gamma zeta^3/(A + (gamma - beta) zeta^2) dy >= 0.

So W >= S(z_d) >= 0 from rest, for all A > 0, gamma > |beta|: that is the sharp bound, and what is tested. (At an
instant, friction may well give work: S is what it stores.)

Rounding: an error e in z_d is worth at most |dS/dz| e <= alpha p e/A with p the plateau; e is some eps p a step, and at
most PLATEAU_TOLERANCE p where the kernel takes a state so close to the plateau for one on it. With E = alpha/(gamma +
beta) = alpha p^2/A, and the work's own rounding, a step may be off by (PLATEAU_TOLERANCE + 16 eps) E + 16 eps |dW|.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import strategies as st

from plant_models.seat.friction import PLATEAU_TOLERANCE, FrictionCoefficients, after_slip, prepare
from plant_models.seat.interface import Parameters
from tests.helpers.driven import Driven
from tests.helpers.searching import examples, fails, for_all

EPS = np.finfo(float).eps


class Law(NamedTuple):
    """Parameters of (35)-(36)."""

    alpha: float
    gamma: float
    beta: float
    amplitude: float

    @property
    def kernel(self) -> FrictionCoefficients:
        return prepare(self.gamma, self.beta, self.amplitude)

    @property
    def scale(self) -> float:
        """E, in J."""
        return self.alpha / (self.gamma + self.beta)

    def stored(self, z: float) -> float:
        """S(z), in J."""
        unloading = self.gamma - self.beta
        return 0.5 * self.alpha / unloading * math.log1p(unloading * z * z / self.amplitude)

    def work(self, z: float, increment: float) -> float:
        """Integrate alpha z_d over an increment of the deflection, from the state z; in J."""
        sign = math.copysign(1.0, increment)
        zeta, y = sign * z, abs(increment)
        unloading, loading = self.gamma - self.beta, self.gamma + self.beta
        given_back = 0.0
        if zeta < 0.0:
            angle = math.sqrt(self.amplitude * unloading) * y - math.atan(-zeta * math.sqrt(unloading / self.amplitude))
            if angle < 0.0:
                return self.stored(math.sqrt(self.amplitude / unloading) * math.tan(angle)) - self.stored(zeta)
            given_back, zeta, y = self.stored(zeta), 0.0, angle / math.sqrt(self.amplitude * unloading)
        b, t = math.sqrt(self.amplitude * loading) * y, zeta * math.sqrt(loading / self.amplitude)
        return self.scale * (b + math.log1p(0.5 * (1.0 - t) * math.expm1(-2.0 * b))) - given_back


PUBLISHED = Law(3.0983e5, 2.1617e8, -9.8889e7, 6.9321)


def powers(low: int, high: int) -> st.SearchStrategy[float]:
    return st.floats(low, high).map(lambda exponent: 10.0**exponent)


ratios = st.one_of(st.floats(-0.99, 0.99), powers(-12, -2).flatmap(lambda e: st.sampled_from([1.0 - e, e - 1.0])))
laws = st.one_of(
    st.just(PUBLISHED),
    st.builds(
        lambda alpha, gamma, ratio, amplitude: Law(alpha, gamma, gamma * ratio, amplitude),
        powers(-3, 9),
        powers(2, 14),
        ratios,
        powers(-4, 4),
    ),
)


def of_one_size(low: int, high: int) -> st.SearchStrategy[list[float]]:
    return powers(low, high).flatmap(lambda size: st.lists(st.floats(-size, size), min_size=1, max_size=60))


of_all_sizes = st.lists(
    st.tuples(st.sampled_from([-1.0, 1.0]), powers(-9, 4)).map(lambda pair: pair[0] * pair[1]), min_size=1, max_size=60
)
histories = st.one_of(of_one_size(-9, 4), of_all_sizes)
"""Increments in units of the length over which the friction builds up."""


def check(law: Law, history: Sequence[float], kernel: FrictionCoefficients) -> None:
    """Check the work from rest after each increment."""
    length = 1.0 / law.kernel.loading_rate
    z = work = slack = 0.0
    for increment in history:
        done = law.work(z, increment * length)
        z = after_slip(z, increment * length, kernel)
        work += done
        slack += (PLATEAU_TOLERANCE + 16.0 * EPS) * law.scale + 16.0 * EPS * abs(done)
        assert work >= law.stored(z) - slack


@pytest.mark.slow
@examples(400, 10_000)
def test_work_from_rest_is_at_least_what_is_stored(count: int):
    for_all(count, lambda law, history: check(law, history, law.kernel), law=laws, history=histories)


def test_a_friction_that_unloads_too_late_gives_work_away():
    def perturbed(law: Law, history: Sequence[float]) -> None:
        check(law, history, law.kernel._replace(unloading_rate=0.999 * law.kernel.unloading_rate))

    fails(400, perturbed, law=laws, history=of_one_size(-4, -2))  # where little is lost


def test_a_higher_plateau_than_the_laws_gives_work_away():
    def perturbed(law: Law, history: Sequence[float]) -> None:
        check(law, history, law.kernel._replace(plateau=1.001 * law.kernel.plateau))

    fails(400, perturbed, law=laws, history=histories)


# ---- through the FMUs ------------------------------------------------------------------------------------------------

STEP = 5e-4
"""In s: one substep, so that the deflection goes straight from row to row unless it turns round in between."""


def taken(seat: Driven, forces: Sequence[float]) -> np.ndarray:
    """Push the seat on a floor at rest, each force for 20 ms; returns rows of deflection, its rate and friction."""
    seat.begin()
    rows, tick = [seat.get("suspension_deflection", "deflection_rate", "friction_force")], 0
    for force in forces:
        seat.set(force=force)
        for _ in range(40):
            seat.step(tick * STEP, STEP)
            tick += 1
            rows.append(seat.get("suspension_deflection", "deflection_rate", "friction_force"))
    seat.end()
    return np.array(rows)


def balance(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Work from rest, less what is stored, and how far it may be off, both in J after each row.

    The friction rises or falls all the way between two rows, so the trapezoid is off by at most half of both
    differences; where the deflection turns round, it went at most max|v| h further, under at most the plateau's force.
    """
    x, v, f = rows.T
    plateau = PUBLISHED.alpha * PUBLISHED.kernel.plateau
    work = np.cumsum(0.5 * (f[1:] + f[:-1]) * np.diff(x))
    straight = 0.5 * np.abs(np.diff(f) * np.diff(x))
    turning = 2.0 * plateau * STEP * np.maximum(np.abs(v[1:]), np.abs(v[:-1]))
    stored = np.array([PUBLISHED.stored(force / PUBLISHED.alpha) for force in f[1:]])
    return work - stored, np.cumsum(np.where(v[1:] * v[:-1] > 0.0, straight, straight + turning))


pushes = st.lists(st.floats(-600.0, 600.0), min_size=3, max_size=12)


@examples(8, 400)
def test_the_fmus_friction_takes_work_from_rest(seat: Driven, count: int):
    defaults = Parameters()
    assert (defaults.friction_alpha, defaults.friction_gamma, defaults.friction_beta) == PUBLISHED[:3]

    def honest(forces: Sequence[float]) -> None:
        excess, slack = balance(taken(seat, forces))
        assert (excess >= -slack).all()

    def reversed_force(forces: Sequence[float]) -> None:
        excess, slack = balance(taken(seat, forces) * [-1.0, -1.0, 1.0])
        assert (excess >= -slack).all()

    for_all(count, honest, forces=pushes)
    fails(8, reversed_force, forces=pushes)
