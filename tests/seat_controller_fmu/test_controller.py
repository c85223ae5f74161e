"""The controller's sample against its equations, each alone."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from fmus.component import ParameterError
from seat_controller_fmu.controller import (
    Coefficients,
    State,
    advance,
    initialize,
    mass_range,
    observer_gains,
    prepare,
    step,
    warnings,
)
from seat_controller_fmu.interface import Inputs, Outputs, Parameters
from seat_controller_fmu.parameters import SAMPLE_TIME

h = SAMPLE_TIME.value


def start(parameters: Parameters, time: float = 0.0) -> tuple[State, Coefficients]:
    coefficients = prepare(parameters)
    return initialize(Inputs(), coefficients, time)[0], coefficients


@pytest.mark.parametrize("mass", [45.0, 55.0, 70.0, 80.0])
@pytest.mark.parametrize("gamma", [-3e-6, -1e-6])
def test_observer_error_decays_by_1_plus_h_L_D_a_sample(mass: float, gamma: float):
    parameters = Parameters(driver_mass=mass, observer_gamma=gamma, force_limit=1e9)
    state, c = start(parameters)
    vertices = mass_range(parameters)
    M = mass + parameters.seat_mass
    h_1, h_2 = vertices.memberships(M)
    L_1, L_2 = observer_gains(parameters)
    factor = 1.0 + h * (h_1 * L_1 + h_2 * L_2) / M
    F_d, errors = -80.0, []
    for delta in 0.01 * np.sin(np.arange(40)):
        measured = (-parameters.suspension_stiffness * delta + state.demand - F_d) / M  # (3)
        state, _ = step(state, Inputs(float(measured), float(delta)), c)
        errors.append(F_d - state.estimate)
    assert np.array(errors[1:12]) / np.array(errors[:11]) == pytest.approx(factor, rel=1e-9)


def test_published_poles_of_the_observer_differ_over_the_mass():
    for mass, pole in ((45.0, -62.6), (80.0, -28.6)):
        c = prepare(Parameters(driver_mass=mass))
        assert c.observer_force / h == pytest.approx(pole, abs=0.05)


def test_given_observer_gains_are_used_as_they_are():
    c = prepare(Parameters(driver_mass=45.0, L1=-1000.0))
    assert c.observer_acceleration == pytest.approx(-1000.0 * h)
    assert observer_gains(Parameters(L1=-1000.0))[1] == observer_gains(Parameters())[1]


def test_rate_filter_is_exact_on_a_ramp_in_steady_state():
    state, c = start(Parameters(enabled=False))
    for k in range(200):
        state, outputs = step(state, Inputs(0.0, 0.3 * k * h), c)
    assert outputs.deflection_rate == pytest.approx(0.3, rel=1e-12)


def test_rate_filter_has_its_cut_off_frequency():
    tau = 1.0 / (2.0 * math.pi * 30.0)
    state, c = start(Parameters(enabled=False))
    state, _ = step(state, Inputs(0.0, 0.0), c)
    state, outputs = step(state, Inputs(0.0, 1e-3), c)
    assert outputs.deflection_rate == pytest.approx(1e-3 / (tau + h), rel=1e-14)
    state, outputs = step(state, Inputs(0.0, 1e-3), c)
    assert outputs.deflection_rate == pytest.approx(1e-3 / (tau + h) * tau / (tau + h), rel=1e-14)


def test_first_sample_takes_its_own_deflection_as_the_previous_one():
    state, c = start(Parameters())
    _, outputs = step(state, Inputs(0.0, 0.05), c)
    assert outputs.deflection_rate == 0.0


def test_law_schedules_the_gains_over_the_mass():
    for mass, stiffness, damping in ((45.0, 4573.0, -90.0), (80.0, 4560.0, -134.0), (20.0, 4573.0, -90.0)):
        c = prepare(Parameters(driver_mass=mass))
        assert (c.deflection_gain, c.rate_gain_K) == pytest.approx((stiffness, damping))
    between = prepare(Parameters(driver_mass=60.0))
    assert 4560.0 < between.deflection_gain < 4573.0


@pytest.mark.parametrize("acceleration", [-40.0, 40.0])
def test_force_is_limited_and_saturated_is_set(acceleration: float):
    state, c = start(Parameters(force_limit=100.0))
    _, outputs = step(state, Inputs(acceleration, 0.0), c)
    assert abs(outputs.force_demand) > 100.0
    assert outputs.force == math.copysign(100.0, outputs.force_demand)
    assert outputs.saturated


def test_observer_winds_up_as_published_and_not_with_anti_windup():
    estimates = {}
    for anti_windup in (False, True):
        state, c = start(Parameters(force_limit=50.0, anti_windup=anti_windup))
        for _ in range(100):
            # a seat under a load beyond the force limit
            measured = (state.force - 200.0) / (55.0 + 28.0)
            state, outputs = step(state, Inputs(measured, 0.0), c)
        estimates[anti_windup] = outputs.disturbance_estimate
    assert estimates[True] == pytest.approx(200.0, rel=1e-3)
    assert estimates[False] > 350.0


def test_disabled_gives_no_force_and_no_estimate_but_filters_on():
    state, c = start(Parameters(enabled=False))
    for k in range(5):
        state, outputs = step(state, Inputs(3.0, 0.01 * k), c)
    assert (outputs.force, outputs.force_demand, outputs.disturbance_estimate, outputs.motor_torque) == (0, 0, 0, 0)
    assert outputs.deflection_rate > 0.0


def test_torque_follows_the_scissor_and_is_zero_beyond_its_reach():
    parameters = Parameters(force_limit=1e9)
    state, c = start(parameters)
    _, outputs = step(state, Inputs(1.0, 0.02), c)
    lever = math.sqrt(0.30**2 - 0.22**2)
    assert outputs.motor_torque == pytest.approx(outputs.force * lever / (2 * 20.0), rel=1e-14)
    _, outputs = step(state, Inputs(1.0, 0.11), c)
    assert outputs.motor_torque == 0.0


def test_a_step_takes_every_sample_that_is_due_in_it():
    state, c = start(Parameters())
    state, _ = advance(state, Inputs(0.1, 0.001), c, 0.0, 5 * h)
    assert state.next_sample == 5
    held, outputs = advance(state, Inputs(9.0, 0.009), c, 5 * h - 1e-9, 1e-10)
    assert held == state
    assert outputs.force == state.force
    state, _ = advance(state, Inputs(0.1, 0.001), c, 5 * h, h / 4)
    assert state.next_sample == 6


def test_small_steps_take_each_sample_once_in_spite_of_rounding():
    state, c = start(Parameters())
    time = 0.0
    for _ in range(20_000):
        state, _ = advance(state, Inputs(), c, time, h / 10)
        time += h / 10
    assert state.next_sample == 2000


@pytest.mark.parametrize(("time", "first"), [(0.0, 0), (0.002, 1), (0.003, 2), (3 * 0.1, 150)])
def test_initialisation_takes_no_sample_and_finds_the_first(time: float, first: int):
    state, outputs = initialize(Inputs(1.0, 0.01), prepare(Parameters()), time)
    assert state.next_sample == first
    p = Parameters()
    assert outputs == Outputs(driver_mass_estimate=p.driver_mass, friction_estimate=p.robust_friction)


def test_reversed_mass_range_is_refused():
    with pytest.raises(ParameterError, match="driver_mass_min < driver_mass_max, got 90.0 kg and 80.0 kg"):
        prepare(Parameters(driver_mass_min=90.0))


def test_driver_outside_the_range_is_legal_and_warned_of():
    assert warnings(Parameters(driver_mass=80.0)) == []
    assert "outside [45.0, 80.0] kg" in warnings(Parameters(driver_mass=81.0))[0]


class Counted(float):
    """A number that counts the arithmetic done with it."""

    multiplications = 0
    additions = 0

    def _multiplied(self, value: float) -> Counted:
        Counted.multiplications += 1
        return Counted(value)

    def _added(self, value: float) -> Counted:
        Counted.additions += 1
        return Counted(value)

    def __mul__(self, other: Any) -> Counted:
        return self._multiplied(float(self) * float(other))

    def __truediv__(self, other: Any) -> Counted:
        return self._multiplied(float(self) / float(other))

    def __rtruediv__(self, other: Any) -> Counted:
        return self._multiplied(float(other) / float(self))

    def __add__(self, other: Any) -> Counted:
        return self._added(float(self) + float(other))

    def __sub__(self, other: Any) -> Counted:
        return self._added(float(self) - float(other))

    def __rsub__(self, other: Any) -> Counted:
        return self._added(float(other) - float(self))

    __rmul__ = __mul__
    __radd__ = __add__


def test_a_sample_costs_ten_multiplications_and_ten_additions():
    """The paper's figure is 15 and 12; square root of (33) aside."""
    plain, c = start(Parameters())
    plain, _ = step(plain, Inputs(0.5, 0.01), c)
    counted = State(*(Counted(x) if type(x) is float else x for x in plain))
    coefficients = Coefficients(*(Counted(x) if type(x) is float else x for x in c))
    Counted.multiplications = Counted.additions = 0
    after, outputs = step(counted, Inputs(Counted(0.6), Counted(0.011)), coefficients)
    print(f"{Counted.multiplications} multiplications or divisions, {Counted.additions} additions or subtractions")
    assert (Counted.multiplications, Counted.additions) == (10, 10)
    assert (after, outputs) == step(plain, Inputs(0.6, 0.011), c)
