"""The closed-form friction against the Bouc-Wen equation (36) itself."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmus.component import ParameterError
from plant_models.seat.friction import after_slip, prepare
from plant_models.seat.parameters import FRICTION_A, FRICTION_ALPHA, FRICTION_BETA, FRICTION_GAMMA
from tests.helpers.reference import bouc_wen_rate

PUBLISHED = prepare(FRICTION_GAMMA.value, FRICTION_BETA.value, FRICTION_A.value)


def integrated(state: float, velocity: float, duration: float) -> float:
    """Solve (36) in time at a constant deflection rate."""
    solution = solve_ivp(
        lambda t, z: [bouc_wen_rate(velocity, z[0])],
        (0, duration),
        [state],
        "DOP853",
        rtol=1e-12,
        atol=1e-18,
        max_step=2e-5 / abs(velocity),  # of a step in deflection beyond which it overflows
    )
    return float(solution.y[0, -1])


@pytest.mark.slow
def test_random_histories_match_the_equation_to_1e_9_of_the_plateau():
    random = np.random.default_rng(36)
    closed = exact = 0.0
    worst = 0.0
    for _ in range(300):
        velocity = random.uniform(-1.5, 1.5) * 10.0 ** random.uniform(-4, 0)
        duration = random.uniform(0.0, 0.002)
        closed = after_slip(closed, velocity * duration, PUBLISHED)
        exact = integrated(exact, velocity, duration)
        worst = max(worst, abs(closed - exact))
    assert worst < 1e-9 * PUBLISHED.plateau


def test_a_wrong_coefficient_exceeds_that_bound():
    wrong = PUBLISHED._replace(unloading_scale=PUBLISHED.unloading_scale * (1 + 1e-6))
    state, velocity, duration = -0.8 * PUBLISHED.plateau, 0.1, 1e-4
    error = abs(after_slip(state, velocity * duration, wrong) - integrated(state, velocity, duration))
    assert error > 1e-9 * PUBLISHED.plateau


@pytest.mark.parametrize("amplitude", [0.005, 0.010])
def test_half_hertz_loops_saturate_at_75_3_newtons_both_ways(amplitude: float):
    deflections = amplitude * np.sin(2 * np.pi * 0.5 * np.arange(0.0, 6.0, 0.002))
    state, forces = 0.0, []
    for increment in np.diff(deflections):
        state = after_slip(state, float(increment), PUBLISHED)
        forces.append(FRICTION_ALPHA.value * state)
    assert max(forces) == pytest.approx(75.3255, abs=1e-3)
    assert min(forces) == pytest.approx(-75.3255, abs=1e-3)


def test_a_step_may_be_divided_anywhere():
    whole = after_slip(-1e-4, 3e-5, PUBLISHED)
    parts = -1e-4
    for share in (0.1, 0.35, 0.05, 0.5):
        parts = after_slip(parts, share * 3e-5, PUBLISHED)
    assert parts == pytest.approx(whole, rel=1e-12)


def test_friction_is_odd():
    forward = after_slip(-1e-4, 2e-5, PUBLISHED)
    assert after_slip(1e-4, -2e-5, PUBLISHED) == -forward


def test_a_state_beyond_the_plateau_decays_to_it():
    beyond = 1.5 * PUBLISHED.plateau
    states = [after_slip(beyond, x, PUBLISHED) for x in (0.0, 1e-5, 1e-4, 1e-2)]
    assert states[0] == beyond
    assert all(a > b for a, b in pairwise(states))
    assert states[-1] == pytest.approx(PUBLISHED.plateau, rel=1e-12)


def test_no_increment_overflows():
    for state in (-PUBLISHED.plateau, 0.0, PUBLISHED.plateau):
        assert after_slip(state, 1e300, PUBLISHED) == pytest.approx(PUBLISHED.plateau)
        assert math.isfinite(after_slip(state, 5e-324, PUBLISHED))


@pytest.mark.parametrize(
    ("gamma", "beta", "amplitude"),
    [(2e8, -9e7, 0.0), (2e8, -9e7, -1.0), (1e7, -9e7, 7.0), (1e7, 9e7, 7.0), (0.0, 0.0, 7.0), (math.nan, 0.0, 7.0)],
)
def test_parameters_without_a_plateau_are_refused(gamma: float, beta: float, amplitude: float):
    with pytest.raises(ParameterError, match=r"expected friction\.A > 0 and friction\.gamma > \|friction\.beta\|, got"):
        prepare(gamma, beta, amplitude)
