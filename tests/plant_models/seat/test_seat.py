"""The seat against closed forms: statics, modes, energy, step sizes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import expm

from fmus.component import ParameterError, pack_state
from plant_models.seat.interface import Inputs, Parameters
from plant_models.seat.seat import Masses, State, advance, initialize, prepare

H = 0.002


def test_starts_at_rest_with_all_outputs_zero():
    state, outputs = initialize(Inputs(), prepare(Parameters()), 0.0)
    assert state == State(Masses(0.0, 0.0, 0.0, 0.0, 0.0))
    assert outputs.seat_acceleration == outputs.driver_acceleration == outputs.suspension_deflection == 0.0


def test_without_friction_a_step_is_the_matrix_exponential():
    p = Parameters(friction_alpha=0.0, suspension_damping=300.0)
    c = prepare(p)
    k, d, kc, cc, ms, mb = (
        p.suspension_stiffness,
        p.suspension_damping,
        p.cushion_stiffness,
        p.cushion_damping,
        p.seat_mass,
        p.driver_mass,
    )
    A = np.array(
        [
            [0, 1, 0, 0, 0],
            [-(k + kc) / ms, -(d + cc) / ms, kc / ms, cc / ms, 1 / ms],
            [0, 0, 0, 1, 0],
            [kc / mb, cc / mb, -kc / mb, -cc / mb, 0],
            [0, 0, 0, 0, 0],
        ]
    )
    state = State(Masses(0.01, -0.2, 0.011, 0.1, 0.0))
    exact = np.array([*state.masses[:4], 100.0])
    for _ in range(200):
        state, _ = advance(state, Inputs(force=100.0), c, 0.0, H)
        exact = expm(A * H) @ exact
    scale = np.array([0.01, 0.2, 0.01, 0.2])
    assert np.abs((np.array(state.masses[:4]) - exact[:4]) / scale).max() < 1e-7


def test_force_lifts_the_seat_to_static_equilibrium():
    c = prepare(Parameters(friction_alpha=0.0, suspension_damping=2000.0))
    state = initialize(Inputs(), c, 0.0)[0]
    for _ in range(5000):
        state, outputs = advance(state, Inputs(force=92.0), c, 0.0, H)
    assert outputs.suspension_deflection == pytest.approx(92.0 / 4600.0, rel=1e-9)
    assert outputs.driver_displacement == pytest.approx(outputs.seat_displacement, rel=1e-9)


def test_friction_holds_the_seat_below_its_plateau():
    c = prepare(Parameters())
    state = initialize(Inputs(), c, 0.0)[0]
    for _ in range(2000):
        state, outputs = advance(state, Inputs(force=60.0), c, 0.0, H)
    assert outputs.suspension_deflection < 1e-4
    assert outputs.friction_force + 4600.0 * outputs.suspension_deflection == pytest.approx(60.0, rel=1e-3)


def energy(state: State, p: Parameters) -> float:
    """Kinetic and elastic energy on a floor at rest, in J."""
    return 0.5 * (
        p.seat_mass * state.masses.seat_velocity**2
        + p.driver_mass * state.masses.driver_velocity**2
        + p.suspension_stiffness * state.masses.seat_displacement**2
        + p.cushion_stiffness * (state.masses.driver_displacement - state.masses.seat_displacement) ** 2
    )


def test_energy_decays_on_a_still_floor_and_comes_to_rest():
    p = Parameters()
    c = prepare(p)
    state = State(Masses(0.03, 0.0, 0.03, 0.0, 0.0))
    energies = []
    for _ in range(3000):
        state, _ = advance(state, Inputs(), c, 0.0, H)
        energies.append(energy(state, p))
    # friction stores up to alpha z^2/(2 A) = 1.3 mJ and gives it back
    assert np.diff(energies).max() < 1.5e-3
    assert abs(state.masses.seat_velocity) < 1e-6


def test_deflection_and_rate_are_relative_to_the_floor():
    c = prepare(Parameters())
    floor = Inputs(floor_displacement=0.02, floor_velocity=0.3, floor_acceleration=2.0)
    state, outputs = advance(State(Masses(0.05, 0.1, 0.05, 0.1, 0.0)), floor, c, 0.0, H)
    z_v = 0.02 + 0.3 * H + 0.5 * 2.0 * H * H
    assert outputs.suspension_deflection == pytest.approx(state.masses.seat_displacement - z_v, rel=1e-14)
    assert outputs.deflection_rate == pytest.approx(state.masses.seat_velocity - (0.3 + 2.0 * H), rel=1e-14)


def test_sensors_report_the_truth():
    c = prepare(Parameters())
    _, outputs = advance(State(Masses(0.01, 0.1, 0.01, 0.1, 1e-5)), Inputs(), c, 0.0, H)
    assert outputs.seat_acceleration_measured == outputs.seat_acceleration
    assert outputs.suspension_deflection_measured == outputs.suspension_deflection


def test_a_stiffer_seat_gets_shorter_substeps():
    assert prepare(Parameters()).substep == 0.5e-3
    assert prepare(Parameters(cushion_stiffness=1e8)).substep < 0.3e-3


def test_a_seat_that_is_too_stiff_is_refused():
    with pytest.raises(ParameterError, match="expected a fastest motion below 50000 rad/s, got"):
        prepare(Parameters(cushion_stiffness=1e13))


def test_any_step_size_gives_finite_values():
    c = prepare(Parameters())
    for step_size in (1e-6, 1e-4, 0.01, 1.0):
        state, outputs = advance(State(Masses(0.02, 0.0, 0.02, 0.0, 0.0)), Inputs(), c, 0.0, step_size)
        assert all(map(math.isfinite, pack_state(state)))
        assert math.isfinite(outputs.seat_acceleration)


@pytest.mark.parametrize(
    "imperfections",
    [
        {},
        {"end_stop_travel": 0.02, "end_stop_stiffness": 2e5, "end_stop_damping": 3000.0, "end_stop_height": 0.005},
        {"actuator_delay": 0.003, "actuator_time_constant": 0.02, "actuator_force_limit": 120.0},
    ],
)
def test_the_floor_carries_the_inertia_of_seat_and_driver(imperfections: dict[str, float]):
    """Newton's law for all that stands on the floor, with masses that the force itself is not computed from.

    What cancels in it is the cushion, whose forces reach 1e3 N; so the rounding errors are below 1e-12 N times 1e3.
    """
    p = Parameters(suspension_damping=300.0, **imperfections)
    c, random = prepare(p), np.random.default_rng(3)
    state, largest = initialize(Inputs(), c, 0.0)[0], 0.0
    for k in range(400):
        floor = Inputs(0.03 * math.sin(0.05 * k), 0.75 * math.cos(0.05 * k), 0.0, 100.0 * random.standard_normal())
        state, outputs = advance(state, floor, c, k * H, H)
        inertia = p.seat_mass * outputs.seat_acceleration + p.driver_mass * outputs.driver_acceleration
        assert outputs.floor_force == pytest.approx(-inertia, abs=1e-9)
        largest = max(largest, abs(outputs.floor_force))
    assert largest > 100.0


def test_a_floor_that_rises_is_pushed_down_and_one_that_accelerates_is_not():
    """At rest the spring answers with -k_f z_v and the actuator with -u, whatever z_v'' is."""
    c = prepare(Parameters())
    still = initialize(Inputs(floor_displacement=0.01, force=20.0), c, 0.0)[1]
    jerked = initialize(Inputs(floor_displacement=0.01, floor_acceleration=5.0, force=20.0), c, 0.0)[1]
    assert still.floor_force == jerked.floor_force == pytest.approx(-4600.0 * 0.01 - 20.0)
    assert str(initialize(Inputs(), c, 0.0)[1].floor_force) == "0.0"
