"""The estimator of mass and friction on made-up forces."""

from __future__ import annotations

import math

import numpy as np
import pytest

from seat_controller_fmu import estimator
from seat_controller_fmu.interface import Parameters

C = estimator.prepare(Parameters(driver_mass=75.0))
H = 0.002


def ride(mass: float, friction: float, offset: float, seconds: float, level: float = 1.0) -> estimator.EstimatorState:
    """Slide to and fro at 1.5 Hz, with the driver's acceleration at 1.1 and 2.3 Hz."""
    state = estimator.start(C)
    for k in range(round(seconds / H)):
        t = k * H
        rate = 0.15 * math.sin(3.0 * math.pi * t)
        a_b = level * (math.sin(2.2 * math.pi * t) + 0.5 * math.sin(4.6 * math.pi * t))
        y = mass * a_b + friction * math.copysign(1.0, rate) + offset
        state = estimator.slide(state, rate)
        if state.sliding_direction:
            state = estimator.step(state, y, a_b, C)
    return state


@pytest.mark.parametrize("mass", [45.0, 70.0, 120.0])
@pytest.mark.parametrize("friction", [38.0, 75.0, 113.0])
@pytest.mark.parametrize("offset", [0.0, 20.0])
def test_mass_and_friction_are_found_in_spite_of_an_offset(mass: float, friction: float, offset: float):
    state = ride(mass, friction, offset, 10.0)
    assert state.mass == pytest.approx(mass, rel=0.01)
    assert state.friction == pytest.approx(friction, rel=0.01)
    assert state.mass_trusted
    assert state.friction_trusted


def test_without_excitation_the_mass_stays_and_is_not_trusted_while_friction_is_found():
    state = ride(120.0, 40.0, 0.0, 10.0, level=0.01)
    assert state.mass == pytest.approx(75.0, abs=2.0)
    assert not state.mass_trusted
    assert state.friction == pytest.approx(40.0, abs=2.0)
    assert state.friction_trusted


def test_without_sliding_nothing_changes():
    state = estimator.start(C)
    for k in range(5000):
        state = estimator.slide(state, 0.04 * math.sin(0.01 * k))
        assert state.sliding_direction == 0.0


def test_estimates_are_bounded():
    for mass, friction in ((500.0, 400.0), (1.0, -50.0)):
        state = ride(mass, friction, 0.0, 20.0)
        assert estimator.MASS_MIN <= state.mass <= estimator.MASS_MAX
        assert 0.0 <= state.friction <= estimator.FRICTION_MAX


def test_a_change_of_driver_is_followed():
    state = ride(60.0, 75.0, 0.0, 20.0)
    for k in range(round(40.0 / H)):
        t = k * H
        rate, a_b = 0.15 * math.sin(3.0 * math.pi * t), math.sin(2.2 * math.pi * t)
        state = estimator.slide(state, rate)
        if state.sliding_direction:
            state = estimator.step(state, 100.0 * a_b + 75.0 * math.copysign(1.0, rate), a_b, C)
    assert state.mass == pytest.approx(100.0, rel=0.05)


def test_solution_is_that_of_least_squares():
    """The recursive sums against a weighted least-squares solution by numpy, with the ridge as extra equations."""
    random = np.random.default_rng(2)
    a, s = random.normal(0.0, 1.0, 400), random.choice([-1.0, 1.0], 400)
    y = 90.0 * a + 60.0 * s + 5.0 + random.normal(0.0, 10.0, 400)
    state = estimator.start(C)._replace(sliding=20.0)
    for one in zip(a, s, y, strict=True):
        state = state._replace(direction=float(one[1]))
        state = estimator.step(state, float(one[2]), float(one[0]), C)
    weights = np.sqrt(C.memory ** np.arange(399, -1, -1))
    ridge = np.diag(np.sqrt([estimator.MASS_RIDGE, estimator.FRICTION_RIDGE]))
    matrix = np.vstack([np.column_stack([a, s, np.ones(400)]) * weights[:, None], np.hstack([ridge, np.zeros((2, 1))])])
    right = np.concatenate([y * weights, ridge @ [C.nominal_mass, C.nominal_friction]])
    mass, friction, _ = np.linalg.lstsq(matrix, right, rcond=None)[0]
    solved = estimator._solve(state._replace(mass=0.0, friction=0.0), C)
    assert solved.mass == pytest.approx(estimator.GAIN * mass, rel=1e-9)
    assert solved.friction == pytest.approx(estimator.GAIN * friction, rel=1e-9)
