"""SemiActiveSeat against a passive seat of the same damping, closed forms, and its law against what it says."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from fmus.component import ParameterError, pack_state, unpack_state
from plant_models.seat.interface import Parameters as SeatParameters
from seat_blocks import passive_seat, skyhook
from seat_blocks.interface import DamperParameters, Inputs, PassiveParameters, SemiActiveParameters
from seat_blocks.semi_active_seat import SEMI_ACTIVE_SEAT, advance, initialize, is_valid_state, prepare
from tests.seat_blocks.conftest import Block

H = 0.002
W = 2.0 * math.pi * 2.0
STOPS = {"end_stop_travel": 0.04, "end_stop_stiffness": 1e5, "end_stop_damping": 1e3}


def floor_at(time: float, rise: float = 0.02) -> Inputs:
    """A sine of 2 Hz that begins at rest."""
    return Inputs(rise * (1.0 - math.cos(W * time)), rise * W * math.sin(W * time), rise * W * W * math.cos(W * time))


def semi_active(**damper: float) -> SemiActiveParameters:
    given = SemiActiveParameters()
    return replace(given, damper=replace(given.damper, **damper), seat=replace(given.seat, **STOPS))


@pytest.mark.parametrize("damping", [0.0, 736.0])
def test_a_damper_without_a_range_is_a_passive_one(damping: float):
    """The same seat whatever the law wants: the same operations, so the same bits."""
    parameters = semi_active(minimum=damping, maximum=damping)
    passive = passive_seat.prepare(PassiveParameters(replace(parameters.seat, suspension_damping=damping)))
    c, inputs = prepare(parameters), floor_at(0.0)
    state, _ = initialize(inputs, c, 0.0)
    expected_state, _ = passive_seat.initialize(inputs, passive, 0.0)
    for k in range(500):
        state, outputs = advance(state, floor_at(k * H), c, k * H, H)
        expected_state, expected = passive_seat.advance(expected_state, floor_at(k * H), passive, k * H, H)
        assert outputs.seat == expected.seat
        assert outputs.damping == damping
    assert state.seat == expected_state


def test_the_damper_follows_with_its_lag():
    """Where the law wants c_min, the mean over a step of a decay from c_max is known in closed form."""
    T, low, high = 0.010, 100.0, 2000.0
    c = prepare(semi_active(skyhook=0.0, time_constant=T, minimum=low, maximum=high))
    state, _ = initialize(Inputs(), c, 0.0)
    state = state._replace(damping=high)
    for k in range(20):
        state, outputs = advance(state, Inputs(), c, k * H, H)
        mean = (high - low) * math.exp(-k * H / T) * (1.0 - math.exp(-H / T)) * T / H
        assert outputs.damping == pytest.approx(low + mean, rel=1e-12)
    assert state.damping == pytest.approx(low + (high - low) * math.exp(-20 * H / T), rel=1e-12)


@pytest.mark.parametrize("step", [0.0004, 0.002, 0.010, 0.011])
def test_the_law_is_sampled_at_2_ms_whatever_the_step_of_the_host(step: float):
    """On a floor of constant acceleration, which is extrapolated exactly: at 2 ms grid points all agree.

    Shorter steps integrate with shorter substeps, and the lag acts by its mean over shorter parts; the bound is the
    Runge-Kutta error of the substep of 0.5 ms.
    """

    def ride(h: float) -> dict[int, float]:
        c, found = prepare(semi_active()), {}
        state, _ = initialize(Inputs(0.0, 0.0, 1.5), c, 0.0)
        for k in range(round(0.22 / h)):
            t = k * h
            state, outputs = advance(state, Inputs(0.75 * t * t, 1.5 * t, 1.5), c, t, h)
            found[round((k + 1) * h / 1e-4)] = outputs.seat.suspension_deflection
        return found

    expected, found = ride(0.002), ride(step)
    common = sorted(set(expected) & set(found))
    assert len(common) >= 10
    scale = max(map(abs, expected.values()))
    bound = 1e-12 if step >= 0.002 else 1e-4
    assert max(abs(found[n] - expected[n]) for n in common) < bound * scale


def test_the_damper_takes_energy_out_and_stays_in_its_range():
    parameters = semi_active(minimum=150.0, maximum=2500.0)
    c, random = prepare(parameters), np.random.default_rng(5)
    state, _ = initialize(Inputs(), c, 0.0)
    dampings = []
    for k in range(2000):
        inputs = floor_at(k * H)
        inputs.floor_acceleration += random.normal(0.0, 3.0)
        state, outputs = advance(state, inputs, c, k * H, H)
        assert outputs.force * outputs.seat.deflection_rate <= 0.0
        assert outputs.force == -outputs.damping * outputs.seat.deflection_rate
        dampings.append(outputs.damping)
    assert 150.0 <= min(dampings) < 400.0
    assert 1500.0 < max(dampings) <= 2500.0


def test_it_isolates_better_than_the_passive_seat(block: Block):
    """The driver's weighted acceleration is not needed to see it: the RMS on EM3 falls by more than a tenth."""
    floor = {"shaker.profile": "random", "shaker.random.class": "EM3"}
    rms = {}
    for name in ("PassiveSeat", "SemiActiveSeat"):
        result = block("fmi2", name).simulate(stop_time=30.0, parameters=floor)
        rms[name] = float(np.sqrt((result["seat.driver_acceleration"] ** 2).mean()))
    print(rms)
    assert rms["SemiActiveSeat"] < 0.9 * rms["PassiveSeat"]


# ---- the law ---------------------------------------------------------------------------------------------------------


def law(**damper: float) -> skyhook.SkyhookCoefficients:
    return skyhook.prepare(replace(DamperParameters(), **damper))


def test_the_velocity_is_the_integral_of_the_acceleration_with_a_leak():
    """At a frequency f the gain is 1/(2 pi sqrt(f^2 + f_l^2)), for a bias 1/(2 pi f_l), but for the step of 2 ms."""
    c = law(velocity_corner=0.2)
    state = skyhook.start(c, 0.0)
    for _ in range(10_000):
        state = skyhook.sample(state, 0.05, 0.0, c)
    assert state.velocity == pytest.approx(0.05 / (2.0 * math.pi * 0.2), rel=1e-9)
    state, largest = skyhook.start(c, 0.0), 0.0
    for k in range(10_000):
        state = skyhook.sample(state, math.sin(W * k * H), 0.0, c)
        largest = max(largest, abs(state.velocity)) if k > 5000 else 0.0
    assert largest == pytest.approx(1.0 / math.hypot(W, 2.0 * math.pi * 0.2), rel=2e-3)


@pytest.mark.parametrize(
    ("velocity", "rate", "expected"),
    [
        (0.2, 0.2, 1000.0),  # as the skyhook wants
        (0.1, 0.2, 500.0),
        (-0.1, -0.2, 500.0),
        (0.001, 0.2, 150.0),  # not less than the open valve
        (0.2, 0.01, 2500.0),  # not more than the closed one
        (0.2, -0.2, 150.0),  # it would have to push
        (-0.2, 0.2, 150.0),
        (0.0, 0.2, 150.0),
        (0.2, 0.0, 150.0),
    ],
)
def test_the_damping_is_the_skyhooks_where_a_damper_can_give_it(velocity: float, rate: float, expected: float):
    c = law(minimum=150.0, maximum=2500.0, skyhook=1000.0, velocity_corner=0.0)
    state = skyhook.SkyhookState(0, True, 0.0, 0.0, velocity, rate / c.rate_decay, 150.0)
    assert skyhook.sample(state, 0.0, 0.0, c).damping == pytest.approx(expected, rel=1e-12)


def test_contradicting_parameters_are_refused():
    with pytest.raises(ParameterError, match=r"damper\.minimum <= damper\.maximum, got 300\.0 and 200\.0"):
        prepare(semi_active(minimum=300.0, maximum=200.0))
    with pytest.raises(ParameterError, match="fastest motion"):
        prepare(replace(SemiActiveParameters(), seat=SeatParameters(seat_mass=1e-6)))


def test_a_state_is_valid_near_its_time_with_a_damping():
    parameters = semi_active()
    c = prepare(parameters)
    state, _ = advance(initialize(Inputs(), c, 0.0)[0], floor_at(0.1), c, 0.0, 0.01)
    assert unpack_state(SEMI_ACTIVE_SEAT.state, pack_state(state)) == state
    assert state.law.next_sample == 5
    assert is_valid_state(state, parameters, 0.01)
    assert not is_valid_state(state, parameters, 5.0)
    assert not is_valid_state(state._replace(damping=-1.0), parameters, 0.01)
