"""The vehicle against independent linear solutions: modes, free decay, force, road, energy."""

from __future__ import annotations

import dataclasses
import itertools
import math

import numpy as np
import pytest
from scipy.linalg import eig, expm

from fmus.component import ParameterError
from plant_models.truck import vehicle
from plant_models.truck.interface import Inputs, Parameters, Profile
from plant_models.truck.modes import floor_response, matrices, modes, state_matrix
from plant_models.truck.road import BEFORE
from plant_models.truck.truck import advance, initialize, is_valid_state, prepare
from plant_models.truck.vehicle import MAX_SUBSTEP

TRUCK = Parameters()
M = matrices(TRUCK)
STILL = (0.0, 0.0, 0.0)
"""No force of the seat over a substep."""

FLAT = ((0.0, 0.0),) * 3
RADIANS = [2 * math.pi * mode.frequency * MAX_SUBSTEP for mode in modes(TRUCK)]
"""|s| h of each mode."""

RK4 = max((1 + x) * x**4 / (120 * math.e * mode.damping) for x, mode in zip(RADIANS, modes(TRUCK), strict=True))
"""Largest error of a decaying mode, of its amplitude.

A substep has the error (|s| h)^5/120 with less than |s| h of it from further terms, a time t the error
|s| t (|s| h)^4/120 exp(-zeta |s| t), which is largest at 1/(zeta |s|).
"""


def random_start(seed: int) -> np.ndarray:
    """Displacements of centimetres, and rates."""
    return np.random.default_rng(seed).normal(0.0, [0.02] * 6 + [0.3] * 6)


def test_the_matrices_are_those_of_an_elastic_system():
    for matrix in (M.M, M.C, M.K):
        assert (matrix == matrix.T).all()
    assert np.linalg.eigvalsh(M.K).min() > 0.0
    assert np.linalg.eigvalsh(M.C).min() > -1e-9 * np.linalg.eigvalsh(M.C).max()
    lift = np.array([1.0, 0.0, 1.0, 0.0, 1.0, 1.0])  # a road that is 1 m higher lifts everything by 1 m
    assert np.linalg.solve(M.K, M.B.sum(axis=1)) == pytest.approx(lift, abs=1e-12)
    a, slope = TRUCK.chassis_position, 0.01  # a slope that falls ahead lowers the axles and turns the bodies
    tilted = np.linalg.solve(M.K, M.B @ [-slope * a, slope * (TRUCK.wheelbase - a)])
    ahead = a - TRUCK.cab_position
    expected = [-slope * ahead, slope, 0.0, slope, -slope * a, slope * (TRUCK.wheelbase - a)]
    assert tilted == pytest.approx(expected, abs=1e-12)


def test_the_modes_are_where_the_literature_has_them():
    """Body and cab at 1 to 3 Hz, wheel hop at 8 to 12 Hz; eigenvalues by another form of the problem."""
    found = modes(TRUCK)
    zero = np.zeros((6, 6))
    values = eig(np.block([[zero, M.K], [M.K, M.C]]), np.block([[M.K, zero], [zero, -M.M]]), right=False)
    expected = sorted(abs(value) / (2.0 * np.pi) for value in values if value.imag > 0.0)
    assert [mode.frequency for mode in found] == pytest.approx(expected, rel=1e-6)
    assert all(1.0 < mode.frequency < 3.0 for mode in found[:4])
    assert all(8.0 < mode.frequency < 12.0 for mode in found[4:])
    assert all(0.1 < mode.damping < 0.4 for mode in found)
    assert [mode.shape.argmax() for mode in found[4:]] == [4, 5]


def decay(start: np.ndarray, h: float, steps: int) -> np.ndarray:
    """States of the free truck after each substep."""
    c = vehicle.prepare(TRUCK)
    z, v = tuple(start[:6]), tuple(start[6:])
    rows = []
    for _ in range(steps):
        z, v = vehicle.substep(z, v, h, FLAT, STILL, c)
        rows.append([*z, *v])
    return np.array(rows)


def test_the_free_decay_is_that_of_the_matrix_exponential():
    """In modal coordinates, each mode by its own bound."""
    start = random_start(1)
    transition = expm(state_matrix(M) * MAX_SUBSTEP)
    expected = list(itertools.accumulate(range(1000), lambda x, _: transition @ x, initial=start))
    _, vectors = np.linalg.eig(state_matrix(M))
    modal = np.linalg.inv(vectors)
    errors = np.abs((decay(start, MAX_SUBSTEP, 1000) - expected[1:]) @ modal.T).max(axis=0)
    print(f"largest error of a mode {(errors / np.abs(modal @ start)).max():.2e} of its amplitude, bound {RK4:.2e}")
    assert (errors < RK4 * np.abs(modal @ start)).all()


def test_the_integration_is_of_fourth_order():
    start = random_start(2)
    end = expm(state_matrix(M) * 0.128) @ start
    coarse, fine = (np.abs(decay(start, h, round(0.128 / h))[-1] - end).max() for h in (0.004, 0.002))
    assert 12.0 < coarse / fine < 20.0


@pytest.mark.parametrize("step", [0.002, 0.01])
def test_a_force_on_the_floor_acts_as_the_matrices_say(step: float):
    """A constant force from rest: x = A^-1 (exp(A t) - 1) b, which accelerates the cab at once."""
    force = 500.0
    c, inputs = prepare(Parameters(road_profile=Profile.bump, obstacle_height=0.0)), Inputs(seat_force=force)
    state, outputs = initialize(inputs, c, 0.0)
    d = TRUCK.seat_position
    at_once = force * (1.0 / TRUCK.cab_mass + d * d / TRUCK.cab_pitch_inertia)
    assert outputs.floor_acceleration == pytest.approx(at_once, rel=1e-12)
    A = state_matrix(M)
    b = np.concatenate([np.zeros(6), np.linalg.solve(M.M, M.D * force)])
    static = -np.linalg.solve(A, b)
    transition, x = expm(A * step), np.zeros(12)
    for k in range(round(10.0 / step)):
        state, outputs = advance(state, inputs, c, k * step, step)
        x = static + transition @ (x - static)
        rate = A @ x + b
        assert outputs.floor_displacement == pytest.approx(M.D @ x[:6], abs=10.0 * RK4 * abs(M.D @ static[:6]))
        assert outputs.floor_acceleration == pytest.approx(M.D @ rate[6:], abs=10.0 * RK4 * at_once)
    assert outputs.floor_displacement == pytest.approx(force * M.D @ np.linalg.solve(M.K, M.D), rel=1e-4)


@pytest.mark.parametrize("step", [0.002, 0.007])
def test_a_force_is_linear_between_the_communication_points(step: float):
    """First-order hold: x' = A x + b F(t) with F linear from the last input to this one, by one matrix exponential."""
    c = prepare(Parameters(road_profile=Profile.bump, obstacle_height=0.0))
    forces = 400.0 * np.sin(9.0 * step * np.arange(401))
    state, _ = initialize(Inputs(seat_force=float(forces[0])), c, 0.0)
    b = np.concatenate([np.zeros(6), np.linalg.solve(M.M, M.D)])
    held = np.zeros((14, 14))  # of x, F and F'
    held[:12, :12], held[:12, 12], held[12, 13] = state_matrix(M), b, 1.0
    transition, x, largest = expm(held * step), np.zeros(12), 0.0
    for k, (before, force) in enumerate(itertools.pairwise(forces)):
        state, outputs = advance(state, Inputs(seat_force=float(force)), c, k * step, step)
        x = (transition @ np.concatenate([x, [before, (force - before) / step]]))[:12]
        largest = max(largest, abs(M.D @ x[:6]))
        assert outputs.floor_displacement == pytest.approx(M.D @ x[:6], abs=20.0 * RK4 * max(largest, 1e-6))
    assert largest > 1e-3


@pytest.mark.parametrize("frequency", [0.7, 1.24, 2.12, 4.0, 8.7, 10.1])
def test_the_response_to_a_sine_road_is_that_of_the_matrices(frequency: float):
    """Both axles on a sine, the rear one later by the wheelbase.

    The steady error of RK4 with a sine in its stages is of the order (|s| h)^4 of the fastest mode.
    """
    c, omega = vehicle.prepare(TRUCK), 2.0 * math.pi * frequency
    delay = TRUCK.wheelbase / TRUCK.speed

    def at(time: float) -> tuple[float, float]:
        return math.sin(omega * time), math.sin(omega * (time - delay))

    z = v = (0.0,) * 6
    h, settled, steps = MAX_SUBSTEP, 4500, 5000
    rows = []
    for k in range(steps):
        z, v = vehicle.substep(z, v, h, (at(k * h), at((k + 0.5) * h), at((k + 1) * h)), STILL, c)
        if k >= settled:
            out = vehicle.outputs(z, v, at((k + 1) * h), 0.0, c)
            rows.append(((k + 1) * h, out.floor_acceleration))
    time, acceleration = np.array(rows).T
    basis = np.column_stack([np.sin(omega * time), np.cos(omega * time)])
    (s, o), *_ = np.linalg.lstsq(basis, acceleration, rcond=None)
    expected = floor_response(TRUCK, [frequency])[0][0]
    error = abs(complex(s, o) - expected) / abs(expected)
    print(f"{frequency} Hz: relative error {error:.1e}")
    assert error < 1e-4


def test_the_floor_answers_a_force_symmetrically():
    """Reciprocity, and a driving point never gives energy back in the mean: Re(velocity/force) > 0."""
    frequencies = np.geomspace(0.1, 50.0, 60)
    _, force = floor_response(TRUCK, frequencies)
    mobility = force / (2j * np.pi * frequencies)
    assert (mobility.real > 0.0).all()


def energy(state: np.ndarray) -> np.ndarray:
    """Of rows of displacements and rates, in J."""
    z, v = state[:, :6], state[:, 6:]
    return 0.5 * (np.einsum("ki,ij,kj->k", z, M.K, z) + np.einsum("ki,ij,kj->k", v, M.M, v))


@pytest.mark.parametrize("seed", range(4))
def test_the_free_truck_only_loses_energy(seed: int):
    stored = energy(decay(random_start(seed), MAX_SUBSTEP, 1500))
    assert (np.diff(stored) < 0.0).all()
    assert stored[-1] < 0.01 * stored[0]


def test_the_energy_of_a_driven_floor_balances():
    """What the force does on the floor is stored or dissipated; the trapezoidal sums are right to (omega h)^2/12."""
    force, h = 800.0, 0.0005
    c = vehicle.prepare(TRUCK)
    z = v = (0.0,) * 6
    rows = [[*z, *v]]
    for _ in range(4000):
        z, v = vehicle.substep(z, v, h, FLAT, (force,) * 3, c)
        rows.append([*z, *v])
    states = np.array(rows)
    rates = states[:, 6:]
    work = force * (states[-1, :6] - states[0, :6]) @ M.D
    dissipated = np.trapezoid(np.einsum("ki,ij,kj->k", rates, M.C, rates), dx=h)
    assert dissipated > 0.3 * work
    assert energy(states)[-1] + dissipated == pytest.approx(work, rel=1e-4)


# ---- parameters and states -------------------------------------------------------------------------------------------


def test_parameters_that_contradict_one_another_are_refused():
    with pytest.raises(ParameterError, match=r"chassis.position = 4.6 m, chassis.wheelbase = 4.5 m"):
        prepare(Parameters(chassis_position=4.6))
    for name in ("cab_mass", "cab_pitch_inertia", "front_axle_mass", "rear_axle_mass", "chassis_pitch_inertia"):
        with pytest.raises(ParameterError, match="fastest motion below 50000 rad/s"):
            prepare(dataclasses.replace(TRUCK, **{name: 1e-9}))
    for name in ("front_stiffness", "rear_tyre_stiffness", "cab_rear_damping"):
        with pytest.raises(ParameterError, match="fastest motion below 50000 rad/s"):
            prepare(dataclasses.replace(TRUCK, **{name: 1e308}))


def test_stiff_trucks_get_shorter_substeps():
    """Light axles on hard tyres; the floor still follows the matrices."""
    stiff = dataclasses.replace(TRUCK, front_axle_mass=7.0, rear_axle_mass=11.0)
    c = vehicle.prepare(stiff)
    fastest = np.abs(np.linalg.eigvals(state_matrix(matrices(stiff)))).max()
    assert fastest * c.substep < 1.0 / vehicle.SUBSTEPS_PER_RADIAN
    assert c.substep < 0.2 * MAX_SUBSTEP


def test_states_of_a_run_are_valid_and_others_are_not():
    c = prepare(TRUCK)
    state, _ = initialize(Inputs(), c, 5.0)
    assert is_valid_state(state, TRUCK, 5.0)
    for k in range(600):
        state, _ = advance(state, Inputs(), c, 5.0 + k * 0.002, 0.002)
        assert is_valid_state(state, TRUCK, 5.0 + (k + 1) * 0.002)
    time, front, rear = 6.2, state.front, state.rear
    assert is_valid_state(state, TRUCK, time + 0.9)
    other = [
        state._replace(front=front._replace(cell=front.cell - 1000)),
        state._replace(front=front._replace(cell=front.cell + 1000)),
        state._replace(rear=rear._replace(cell=-2)),
        state._replace(start=8.0),
        state._replace(start=-1e9),
    ]
    assert not any(is_valid_state(each, TRUCK, time) for each in other)
    bump = Parameters(road_profile=Profile.bump)
    assert not is_valid_state(state, bump, time)
    assert is_valid_state(state._replace(front=BEFORE, rear=BEFORE), bump, time)
    assert not is_valid_state(state._replace(front=BEFORE, rear=BEFORE._replace(end=0.1)), bump, time)
