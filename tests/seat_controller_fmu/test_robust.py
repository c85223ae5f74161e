"""The law of the mode robust, term by term, on its Python model."""

from __future__ import annotations

import math
import re
from dataclasses import astuple, replace

import numpy as np
import pytest

from fmus.component import ParameterError
from seat_controller_fmu import robust
from seat_controller_fmu.controller import State, advance, initialize, prepare, step
from seat_controller_fmu.interface import Estimator, Fault, Inputs, Mode, Parameters
from seat_controller_fmu.parameters import SAMPLE_TIME
from tests.seat_controller_fmu.test_controller import Counted

h = SAMPLE_TIME.value

ROBUST = Parameters(mode=Mode.robust)
TUNED = replace(ROBUST, robust_estimator=Estimator.off)


def drive(parameters: Parameters, inputs: list[Inputs], state: State | None = None) -> tuple[State, list[float]]:
    """Take samples; returns the state after them and the force of each."""
    c = prepare(parameters)
    state = state or initialize(Inputs(), c, 0.0)[0]
    forces = []
    for each in inputs:
        state, outputs = step(state, each, c)
        forces.append(outputs.force)
    if all(math.isfinite(x) for each in inputs for x in astuple(each)):
        assert outputs.fault == Fault.none
    return state, forces


def sine(
    count: int, first: int = 0, amplitude: float = 0.006, frequency: float = 3.0, acceleration: float = 0.05
) -> list[Inputs]:
    """Make measurements of an isolated seat, which do not contradict one another."""
    omega = 2.0 * math.pi * frequency
    return [
        Inputs(acceleration * math.sin(omega * k * h), amplitude * math.sin(omega * k * h + 0.5))
        for k in range(first, first + count)
    ]


def test_the_published_law_is_the_default_and_does_not_touch_the_robust_state():
    assert Parameters().mode == Mode.published
    before = initialize(Inputs(), prepare(Parameters()), 0.0)[0].robust
    state, _ = drive(Parameters(), sine(50))
    assert state.robust == before


def test_parameters_of_the_mode_robust_do_not_change_the_published_law():
    other = Parameters(actuator_delay=0.02, travel=0.03, robust_observer_rate=200.0, robust_friction=10.0)
    assert drive(Parameters(), sine(200))[1] == drive(other, sine(200))[1]


def test_observed_motion_finds_rate_and_floor():
    """A seat that is still while the floor oscillates at 2 Hz: v within 3 % of its amplitude, with a 24 Hz corner."""
    omega, amplitude = 4.0 * math.pi, 0.006
    errors = []
    c = prepare(TUNED)
    state, _ = initialize(Inputs(), c, 0.0)
    for k in range(500):
        state, _ = step(state, Inputs(1e-3 * (-1) ** k, -amplitude * math.sin(omega * k * h)), c)
        errors.append(state.robust.rate + amplitude * omega * math.cos(omega * k * h))
    assert np.abs(errors[250:]).max() < 0.03 * amplitude * omega
    assert state.robust.floor == pytest.approx(-amplitude * omega**2 * math.sin(omega * 499 * h), abs=0.3)


def test_bias_of_the_accelerometer_does_not_reach_the_observed_rate():
    def rate(bias: float) -> float:
        biased = [replace(each, seat_acceleration=each.seat_acceleration + bias) for each in sine(80)]
        return drive(TUNED, biased)[0].robust.rate

    assert rate(0.0) == pytest.approx(rate(0.1), abs=1e-3)


@pytest.mark.parametrize("mass", [45.0, 80.0, 120.0])
def test_the_drivers_filter_is_that_of_the_cushion(mass: float):
    """Tustin's rule: at 3 Hz within 1e-3 of (c s + k)/(m s^2 + c s + k), at 0 Hz exactly 1."""
    p = replace(TUNED, driver_mass=mass)
    n = robust.prepare(p).nominal
    z = np.exp(-2j * np.pi * 3.0 * h)
    found = (n.b_0 + n.b_1 * z + n.b_2 * z * z) / (1.0 + n.a_1 * z + n.a_2 * z * z)
    s = 2j * np.pi * 3.0
    cushion = p.robust_cushion_damping * s + p.robust_cushion_stiffness
    assert abs(found - cushion / (mass * s * s + cushion)) < 1e-3
    assert (n.b_0 + n.b_1 + n.b_2) / (1.0 + n.a_1 + n.a_2) == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize(("lag", "delay"), [(0.0, 0.0), (0.005, 0.0), (0.01, 0.01), (0.0, 0.1), (0.0248, 0.002)])
def test_modelled_force_is_that_of_the_actuator(lag: float, delay: float):
    """The force of each sample, delayed and lagging as the seat's actuator does it, at the samples."""
    p = replace(TUNED, actuator_time_constant=lag, actuator_delay=delay)
    c, state = prepare(p), initialize(Inputs(), prepare(p), 0.0)[0]
    forces, applied = [0.0], []
    for each in sine(300):
        state, outputs = step(state, each, c)
        applied.append(state.robust.applied)
        forces.append(outputs.force)
    samples, actual = round(delay / h), 0.0
    for k in range(300):
        target = forces[k - samples] if k >= samples else 0.0
        actual = target + (actual - target) * (math.exp(-h / lag) if lag else 0.0)
        assert applied[k] == pytest.approx(actual, abs=1e-9)


def test_the_seat_starts_without_force_off_centre_too():
    assert abs(drive(ROBUST, [Inputs(0.0, 0.03)])[1][0]) < 2.0


def test_enabled_ramps_the_force_and_disabled_gives_none():
    state, forces = drive(ROBUST, sine(600))
    off = replace(ROBUST, enabled=False)
    state, fading = drive(off, sine(200, 600), state)
    steps = np.abs(np.diff([forces[-1], *fading]))
    ramp = math.ceil(ROBUST.robust_ramp_time / h)
    assert fading[ramp + 1 :] == [0.0] * (199 - ramp)
    assert steps.max() < 0.2 * ROBUST.force_limit
    _, rising = drive(ROBUST, sine(200, 800), state)
    assert abs(rising[0]) < 0.1 * ROBUST.force_limit


def test_force_is_limited_and_the_observer_gets_it():
    p = replace(TUNED, force_limit=50.0)
    state, forces = drive(p, sine(600))
    assert np.abs(forces).max() == 50.0
    assert abs(state.robust.estimate) < 2.0 * 50.0 + TUNED.suspension_stiffness * 0.006


def test_without_stops_there_is_neither_follow_term_nor_overload_damper():
    c = robust.prepare(replace(TUNED, travel=0.0))
    assert (c.follow_slope, c.overload_slope) == (0.0, 0.0)


def test_follow_term_grows_with_the_envelope_up_to_its_bound():
    c = robust.prepare(TUNED)
    beta = [
        min(max((share * TUNED.travel - c.follow_begin) * c.follow_slope, c.follow_min), c.follow_max)
        for share in (0.1, 0.6, 5.0)
    ]
    assert beta[0] == 0.0
    assert 0.0 < beta[1] < TUNED.robust_follow_max
    assert beta[2] == TUNED.robust_follow_max


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"robust_bias_rate": 50.0}, "robust.bias_rate below 2 robust.centring_damping"),
        ({"robust_overload_begin": 2.0}, "robust.overload_begin < robust.overload_end"),
        ({"travel": 0.2}, "travel <= robust.deflection_range"),
    ],
)
def test_parameters_that_contradict_one_another_are_refused_by_name(changed: dict[str, float], message: str):
    with pytest.raises(ParameterError, match=re.escape(message)):
        prepare(replace(Parameters(), **changed))


def test_bias_rate_below_the_limit_is_stable_and_above_it_is_not():
    """The poles of s^3 + 2 zeta w_0 s^2 + w_0^2 s + gamma, which the refusal is about."""
    w_0, zeta = 2.0 * math.pi * ROBUST.robust_centring_frequency, ROBUST.robust_centring_damping
    limit = 2.0 * zeta * w_0**3
    for share, stable in ((0.99, True), (1.01, False)):
        assert (np.roots([1.0, 2.0 * zeta * w_0, w_0**2, share * limit]).real < 0.0).all() == stable


def test_measurements_that_are_not_finite_are_faults_of_the_kernel_and_leave_no_trace():
    state, _ = drive(ROBUST, sine(500))
    for bad, fault in ((Inputs(math.nan, 0.01), 2), (Inputs(0.0, math.inf), 7), (Inputs(-math.inf, 0.0), 2)):
        after, forces = drive(ROBUST, [bad, *sine(5, 501)], state)
        assert after.robust.faults.fault == fault
        assert all(math.isfinite(force) for force in forces)
        assert math.isfinite(after.deflection)
        assert math.isfinite(after.rate)


def test_states_that_no_run_can_have_are_refused():
    c = prepare(ROBUST)
    state = initialize(Inputs(), c, 0.0)[0].robust
    assert robust.is_valid_state(state, ROBUST)
    for bad in (
        state._replace(place=1),
        state._replace(place=-1),
        state._replace(line_length=4),
        state._replace(faults=state.faults._replace(fault=11)),
    ):
        assert not robust.is_valid_state(bad, ROBUST)
    late = replace(ROBUST, actuator_delay=0.01)
    assert robust.is_valid_state(state._replace(place=4, line_length=10), late)


def test_steps_of_any_length_take_the_same_samples():
    fine, coarse = initialize(Inputs(), prepare(ROBUST), 0.0)[0], initialize(Inputs(), prepare(ROBUST), 0.0)[0]
    c = prepare(ROBUST)
    for k in range(40):
        fine, _ = advance(fine, Inputs(0.1, 0.005), c, k * h / 4, h / 4)
    coarse, _ = advance(coarse, Inputs(0.1, 0.005), c, 0.0, 10 * h)
    assert fine == coarse


def counted(parameters: Parameters, count: int = 600) -> tuple[int, int]:
    """Return multiplications and additions of a sample in the middle of a motion."""
    plain, _ = drive(parameters, sine(count))
    c = prepare(parameters)

    def wrapped(x: object) -> object:
        if type(x) is float:
            return Counted(x)
        if isinstance(x, tuple):
            return type(x)(*map(wrapped, x)) if hasattr(x, "_fields") else tuple(map(wrapped, x))
        return x

    Counted.multiplications = Counted.additions = 0
    last = sine(count + 1)[-1]
    after, _ = step(
        wrapped(plain), Inputs(Counted(last.seat_acceleration), Counted(last.suspension_deflection)), wrapped(c)
    )
    operations = (Counted.multiplications, Counted.additions)
    assert after == step(plain, last, c)[0]
    return operations


def test_cost_of_a_sample():
    """Counted as for the published law; docs/how-to/microcontroller.md has the same numbers."""
    found = {
        "law": counted(TUNED),
        "law and estimator": counted(ROBUST),
        "lag, delay": counted(replace(TUNED, actuator_time_constant=0.01, actuator_delay=0.01)),
    }
    print(found)
    assert found == {"law": (61, 70), "law and estimator": (75, 82), "lag, delay": (64, 73)}


def test_faults_are_numbered_alike_in_c():
    from tests.helpers.paths import ROOT

    header = (ROOT / "src/seat_controller_fmu/interface.h").read_text(encoding="utf-8")
    names = re.findall(r"FAULT_(\w+)", header)
    assert [name.lower() for name in names] == [fault.name for fault in Fault]
