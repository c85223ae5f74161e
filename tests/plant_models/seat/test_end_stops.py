"""The end stops against closed forms: statics, an elastic bounce, energy, a force that never pulls."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fmus.component import ParameterError
from plant_models.seat.interface import Inputs, Parameters
from plant_models.seat.seat import Masses, State, advance, initialize, prepare

H = 0.002
FREE = {"friction_alpha": 0.0, "suspension_stiffness": 0.0, "cushion_stiffness": 0.0, "cushion_damping": 0.0}
TRAVEL = 0.04
HEIGHTS = [0.0, 0.025, -0.032]
"""Of static equilibrium above the middle of the travel; the last one is what 15 kg sag on 4600 N/m."""


def stops(stiffness: float, damping: float = 0.0, **others: float) -> Parameters:
    return Parameters(end_stop_travel=TRAVEL, end_stop_stiffness=stiffness, end_stop_damping=damping, **others)


@pytest.mark.parametrize("height", HEIGHTS)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_force_beyond_the_travel_is_carried_by_suspension_and_end_stop(sign: float, height: float):
    p = stops(2e5, 3000.0, friction_alpha=0.0, suspension_damping=2000.0, end_stop_height=height)
    c = prepare(p)
    state = initialize(Inputs(), c, 0.0)[0]
    for k in range(3000):
        state, outputs = advance(state, Inputs(force=sign * 500.0), c, k * H, H)
    expected = sign * (500.0 + 2e5 * (TRAVEL - sign * height)) / (p.suspension_stiffness + 2e5)
    assert outputs.suspension_deflection == pytest.approx(expected, rel=1e-9)
    assert abs(outputs.seat_acceleration) < 1e-9


@pytest.mark.parametrize("stiffness", [1e4, 1e5, 1e6])
@pytest.mark.parametrize("step", [1e-3, H, 0.01])
def test_a_free_mass_bounces_off_an_elastic_end_stop(stiffness: float, step: float):
    """In contact for half a period pi sqrt(m/k), then it leaves as fast as it came."""
    p = stops(stiffness, **FREE)
    c = prepare(p)
    speed = 0.7
    state = State(Masses(0.0, speed, 0.0, 0.0, 0.0))
    contact = math.pi * math.sqrt(p.seat_mass / stiffness)
    count = math.ceil((TRAVEL / speed + contact) / step) + 3
    for k in range(count):
        state, _ = advance(state, Inputs(), c, k * step, step)
    assert state.masses.seat_velocity == pytest.approx(-speed, rel=2e-5)
    left = count * step - TRAVEL / speed - contact
    assert state.masses.seat_displacement == pytest.approx(TRAVEL - speed * left, abs=2e-6)


@pytest.mark.parametrize(("speed", "height"), [(speed, height) for speed in (0.7, -0.7) for height in HEIGHTS])
def test_a_free_mass_bounces_off_the_stop_it_meets_where_that_is(speed: float, height: float):
    """Off the upper stop at travel - height or the lower one at -(travel + height), as fast as it came."""
    p = stops(1e5, end_stop_height=height, **FREE)
    c = prepare(p)
    side = math.copysign(1.0, speed)
    distance = TRAVEL - side * height
    contact = math.pi * math.sqrt(p.seat_mass / 1e5)
    count = math.ceil((distance / abs(speed) + contact) / H) + 3
    state = State(Masses(0.0, speed, 0.0, 0.0, 0.0))
    for k in range(count):
        state, _ = advance(state, Inputs(), c, k * H, H)
    assert state.masses.seat_velocity == pytest.approx(-speed, rel=2e-5)
    left = count * H - distance / abs(speed) - contact
    assert state.masses.seat_displacement == pytest.approx(side * (distance - abs(speed) * left), abs=2e-6)


def test_a_seat_is_the_mirror_image_of_one_with_the_opposite_height():
    """The equations are odd: floor, force and height of the other sign give motions of the other sign, bit for bit."""
    runs = []
    for sign in (1.0, -1.0):
        c = prepare(stops(5e4, 800.0, end_stop_height=sign * 0.03))
        state, found = initialize(Inputs(), c, 0.0)[0], []
        for k in range(600):
            floor = 0.05 * math.sin(0.02 * k)
            inputs = Inputs(floor_displacement=sign * floor, force=sign * 200.0 * math.sin(0.05 * k))
            state, outputs = advance(state, inputs, c, k * H, H)
            found.append((outputs.seat_acceleration, outputs.suspension_deflection))
        runs.append(np.array(found))
    assert np.array_equal(runs[0], -runs[1])
    assert np.abs(runs[0][:, 1] + 0.03).max() > TRAVEL  # it meets a stop


def energy(state: State, p: Parameters) -> float:
    """Kinetic and elastic energy on a floor at rest, in J."""
    depth = max(0.0, abs(state.masses.seat_displacement + p.end_stop_height) - TRAVEL)
    return 0.5 * (
        p.seat_mass * state.masses.seat_velocity**2
        + p.driver_mass * state.masses.driver_velocity**2
        + p.suspension_stiffness * state.masses.seat_displacement**2
        + p.cushion_stiffness * (state.masses.driver_displacement - state.masses.seat_displacement) ** 2
        + p.end_stop_stiffness * depth**2
    )


@pytest.mark.parametrize("height", HEIGHTS)
@pytest.mark.parametrize(("stiffness", "damping"), [(1e5, 0.0), (1e5, 300.0), (1e5, 5000.0), (1e6, 2000.0)])
def test_impacts_never_add_energy(stiffness: float, damping: float, height: float):
    p = stops(stiffness, damping, friction_alpha=0.0, end_stop_height=height)
    c = prepare(p)
    start = 0.035 - height
    state = State(Masses(start, 1.5, start, 1.5, 0.0))
    energies, hits = [energy(state, p)], 0
    for k in range(2000):
        state, _ = advance(state, Inputs(), c, k * H, H)
        energies.append(energy(state, p))
        hits += abs(state.masses.seat_displacement + height) > TRAVEL
    assert hits > 5
    assert np.diff(energies).max() < 1e-6 * energies[0]  # of rounding and of RK4
    assert energies[-1] < 0.6 * energies[0]


def test_an_end_stop_never_pulls():
    """Leaving fast, the damper alone would."""
    c = prepare(stops(1e4, 5000.0, **FREE))
    _, inside = advance(State(Masses(TRAVEL + 0.01, -5.0, 0.0, 0.0, 0.0)), Inputs(), c, 0.0, 1e-5)
    assert inside.seat_acceleration == 0.0
    _, inside = advance(State(Masses(TRAVEL + 0.01, 0.0, 0.0, 0.0, 0.0)), Inputs(), c, 0.0, 1e-5)
    assert inside.seat_acceleration < 0.0
    _, inside = advance(State(Masses(-TRAVEL - 0.01, 0.0, 0.0, 0.0, 0.0)), Inputs(), c, 0.0, 1e-5)
    assert inside.seat_acceleration > 0.0


@pytest.mark.slow
@pytest.mark.parametrize("damping", [0.0, 500.0, 5000.0])
def test_a_hard_impact_is_accurate_at_2_ms(damping: float):
    """Against steps of 2 us; measured 1e-5, and 4e-3 where the substep of impact is not divided."""
    accelerations = []
    for part in (1, 1000):
        p = stops(1e6, damping, friction_alpha=0.0)
        c = prepare(p)
        state = State(Masses(0.03, 0.6, 0.03, 0.6, 0.0))
        found = []
        for k in range(40 * part):
            state, outputs = advance(state, Inputs(), c, k * H / part, H / part)
            if (k + 1) % part == 0:
                found.append(outputs.seat_acceleration)
        accelerations.append(np.array(found))
    coarse, fine = accelerations
    error = np.sqrt(np.mean((coarse - fine) ** 2) / np.mean(fine**2))
    print(error)
    assert error < 1e-4


def test_end_stops_without_stiffness_are_refused():
    with pytest.raises(ParameterError, match=r"expected end_stop\.stiffness > 0 where end_stop\.travel > 0, got"):
        prepare(Parameters(end_stop_travel=0.05))
    prepare(Parameters(end_stop_stiffness=1e5))


@pytest.mark.parametrize("height", [TRAVEL, -TRAVEL, 1.0])
def test_an_equilibrium_that_is_not_between_the_stops_is_refused(height: float):
    with pytest.raises(ParameterError, match=r"expected \|end_stop\.height\| < end_stop\.travel .*, got .* = 0\.04 m"):
        prepare(stops(1e5, end_stop_height=height))
    prepare(Parameters(end_stop_height=height))  # without stops there is nothing to be between


def test_no_height_is_the_symmetric_seat_to_the_last_bit():
    p = stops(5e4, 800.0)
    assert p.end_stop_height == 0.0
    assert prepare(p) == prepare(stops(5e4, 800.0, end_stop_height=-0.0))


def test_stiffer_end_stops_get_shorter_substeps_and_too_stiff_ones_are_refused():
    assert prepare(stops(1e8)).substep < prepare(stops(1e5)).substep
    assert prepare(Parameters(end_stop_stiffness=1e8)).substep == prepare(Parameters()).substep
    with pytest.raises(ParameterError, match="expected a fastest motion below 50000 rad/s, got"):
        prepare(stops(1e13))
