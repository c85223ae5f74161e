"""The drivers of the seat: the lumped one as before, a seated body inside the integrator, an external one."""

from __future__ import annotations

import hashlib
import math
import random
import struct
from collections.abc import Iterator

import numpy as np
import pytest
from scipy.linalg import expm

from fmus.component import ParameterError
from plant_models.driver import body as bodies
from plant_models.driver import driver
from plant_models.driver.interface import Inputs as DriverInputs
from plant_models.driver.interface import Parameters as DriverParameters
from plant_models.seat.interface import DriverModel, FloorSignals, Inputs, Outputs, Parameters
from plant_models.seat.seat import advance, initialize, prepare

H = 0.002

OLD = (
    "seat_acceleration",
    "suspension_deflection",
    "deflection_rate",
    "driver_acceleration",
    "seat_displacement",
    "driver_displacement",
    "friction_force",
    "seat_acceleration_measured",
    "suspension_deflection_measured",
)
"""Outputs of the seat before there were other drivers than the lumped one."""

IMPERFECT = {
    "driver_mass": 80.0,
    "suspension_damping": 300.0,
    "actuator_force_limit": 250.0,
    "actuator_delay": 0.006,
    "actuator_time_constant": 0.005,
    "sensor_bandwidth": 80.0,
    "acceleration_bias": 0.02,
    "acceleration_resolution": 0.01,
    "deflection_bias": 1e-3,
    "deflection_resolution": 1e-4,
    "end_stop_travel": 0.015,
    "end_stop_stiffness": 4e4,
    "end_stop_damping": 300.0,
    "end_stop_height": 0.002,
}


def rough_ride(parameters: Parameters, seed: int = 1, steps: int = 400) -> Iterator[Outputs]:
    """Yield the outputs of a seat on a rough floor with a random force; nothing but + - * in the floor."""
    drawn, c = random.Random(seed), prepare(parameters)
    z = v = 0.0
    state, _ = initialize(Inputs(), c, 0.0)
    for k in range(steps):
        a = drawn.uniform(-4.0, 4.0) - 20.0 * z - 3.0 * v
        force, push = drawn.uniform(-300.0, 300.0), drawn.uniform(-300.0, 300.0)
        state, outputs = advance(state, Inputs(z, v, a, force, push), c, k * H, H)
        z += H * v + 2e-6 * a
        v += H * a
        yield outputs


STOPS = {"end_stop_travel": 0.01, "end_stop_stiffness": 4e4, "end_stop_damping": 300.0}


@pytest.mark.parametrize(
    ("parameters", "expected"),
    [
        ({}, "5ff504c173783d07"),
        ({"driver_mass": 80.0, "suspension_damping": 300.0, **STOPS, "actuator_delay": 0.006}, "7673ac4031a5fb68"),
        ({**STOPS, "floor_signals": FloorSignals.acceleration}, "a9f0e32679b8258a"),
    ],
    ids=["default", "stops and delay", "derived floor"],
)
def test_the_lumped_driver_gives_the_bits_that_it_gave_before_there_were_others(
    parameters: dict[str, float], expected: str
):
    """Digests of the kernel that knew no other driver; without friction and lag, as exp and tan differ by platform."""
    digest = hashlib.sha256()
    for outputs in rough_ride(Parameters(friction_alpha=0.0, **parameters)):
        digest.update(struct.pack(f"<{len(OLD)}d", *(getattr(outputs, name) for name in OLD)))
        assert outputs.head_acceleration == outputs.driver_acceleration
    assert digest.hexdigest()[:16] == expected


@pytest.mark.parametrize(
    ("parameters", "expected"),
    [
        ({}, (-5.348198509084038, -1.2375319252551749, 0.0013343755940375679, -75.32550401200629)),
        (IMPERFECT, (-0.5293884498326479, -0.1652332231613543, 0.0005635281346013273, -73.5691288372022)),
    ],
    ids=["default", "imperfect"],
)
def test_the_lumped_driver_ends_with_friction_where_it_ended_before(
    parameters: dict[str, float], expected: tuple[float, ...]
):
    """Recorded with the same kernel; rounding errors of another platform's exp and tan may add up to 1e-9."""
    *_, last = rough_ride(Parameters(**parameters))
    found = (last.seat_acceleration, last.driver_acceleration, last.suspension_deflection, last.friction_force)
    assert found == pytest.approx(expected, rel=1e-9)


def linear(p: Parameters) -> np.ndarray:
    """State matrix of the frictionless seat with a seated driver: five displacements, five velocities, a force."""
    body = bodies.prepare(p.driver_mass, p.contact_stiffness, p.contact_damping)
    masses = np.array([p.seat_mass, *body.masses])

    def chain(links: tuple[float, ...]) -> np.ndarray:
        matrix = np.diag(links)
        for i in range(1, 5):
            matrix[i - 1, i - 1] += links[i]
            matrix[i, i - 1] = matrix[i - 1, i] = -links[i]
        return matrix

    K, C = chain((p.suspension_stiffness, *body.k)), chain((p.suspension_damping, *body.c))
    A = np.zeros((11, 11))
    A[:5, 5:10] = np.eye(5)
    A[5:10, :5], A[5:10, 5:10] = -K / masses[:, None], -C / masses[:, None]
    A[5, 10] = 1.0 / p.seat_mass
    return A


@pytest.mark.parametrize("mass", [45.0, 55.2, 120.0])
def test_with_a_seated_driver_a_step_is_the_matrix_exponential(mass: float):
    """Of the linear seat; substeps of 0.39 ms, half a radian of the fastest motion, err by 1e-5."""
    p = Parameters(driver_mass=mass, friction_alpha=0.0, suspension_damping=300.0, driver_model=DriverModel.seated)
    c, transition = prepare(p), expm(linear(p) * H)
    state = initialize(Inputs(), c, 0.0)[0]
    exact = np.array([0.0] * 10 + [100.0])
    for _ in range(300):
        state, outputs = advance(state, Inputs(force=100.0), c, 0.0, H)
        exact = transition @ exact
        m = state.masses
        found = (m.seat_displacement, m.driver_displacement, *m.upper_displacements)
        assert found == pytest.approx(exact[:5], abs=2e-8)
        rates = (m.seat_velocity, m.driver_velocity, *m.upper_velocities)
        assert rates == pytest.approx(exact[5:10], abs=2e-6)
        accelerations = (linear(p) @ exact)[5:10]
        assert outputs.seat_acceleration == pytest.approx(accelerations[0], abs=1e-3)
        assert outputs.driver_acceleration == pytest.approx(accelerations[1], abs=1e-3)
        assert outputs.head_acceleration == pytest.approx(accelerations[4], abs=1e-3)
    assert outputs.seat_velocity == state.masses.seat_velocity


@pytest.mark.parametrize("imperfections", [{}, IMPERFECT], ids=["ideal", "imperfect"])
def test_the_floor_carries_the_inertia_of_the_seat_and_a_seated_body(imperfections: dict[str, float]):
    """Newton's law for all that stands on the floor; the links between cancel, up to 1e3 N times rounding errors."""
    p = Parameters(**imperfections, driver_model=DriverModel.seated)
    c, drawn = prepare(p), np.random.default_rng(3)
    state, largest = initialize(Inputs(), c, 0.0)[0], 0.0
    for k in range(300):
        floor = Inputs(0.03 * math.sin(0.05 * k), 0.75 * math.cos(0.05 * k), 0.0, 100.0 * drawn.standard_normal())
        state, outputs = advance(state, floor, c, k * H, H)
        m = state.masses
        z, v = (m.driver_displacement, *m.upper_displacements), (m.driver_velocity, *m.upper_velocities)
        contact = bodies.contact_force(z[0] - m.seat_displacement, v[0] - m.seat_velocity, c.body)
        a = bodies.accelerations(z, v, contact, c.body)
        inertia = sum(mass * a_i for mass, a_i in zip(c.body.masses, a, strict=True))
        assert outputs.floor_force == pytest.approx(-inertia - p.seat_mass * outputs.seat_acceleration, abs=1e-8)
        largest = max(largest, abs(outputs.floor_force))
    assert largest > 100.0


@pytest.mark.parametrize("imperfections", [{}, {**IMPERFECT, "actuator_force_limit": 0.0}], ids=["ideal", "imperfect"])
def test_an_external_force_moves_the_seat_and_the_floor_does_not_feel_it_directly(imperfections: dict[str, float]):
    """m_s z_s'' is the force of the driver less that on the floor; it moves the seat as the actuator does."""
    p = Parameters(**imperfections, driver_model=DriverModel.external)
    drawn = random.Random(1)
    for outputs in rough_ride(p):
        drawn.uniform(-4.0, 4.0), drawn.uniform(-300.0, 300.0)
        push = drawn.uniform(-300.0, 300.0)
        assert p.seat_mass * outputs.seat_acceleration == pytest.approx(push - outputs.floor_force, abs=1e-9)
        assert outputs.driver_acceleration == outputs.head_acceleration == outputs.seat_acceleration
        assert outputs.driver_displacement == outputs.seat_displacement
    c = prepare(Parameters(driver_model=DriverModel.external))
    ends = [advance(initialize(Inputs(), c, 0.0)[0], Inputs(**{name: 80.0}), c, 0.0, H)[0].masses for name in FORCES]
    assert ends[0] == ends[1]


FORCES = ("force", "driver_force")


def floor_at(t: float) -> tuple[float, float, float]:
    """A floor of three sines at 1.3, 2.9 and 4.7 Hz."""
    z = v = a = 0.0
    for f, size in ((1.3, 0.9), (2.9, 0.8), (4.7, 0.6)):
        w = 2.0 * math.pi * f
        z -= size / w**2 * math.sin(w * t)
        v -= size / w * math.cos(w * t)
        a += size * math.sin(w * t)
    return z, v, a


def ride(step_size: float, stop: float, inside: bool) -> np.ndarray:
    """Driver's acceleration every 10 ms on a floor of sines; a driver outside exchanges values once in a step."""
    model = DriverModel.seated if inside else DriverModel.external
    c, d = prepare(Parameters(driver_model=model)), driver.prepare(DriverParameters())
    state, outputs = initialize(Inputs(*floor_at(0.0)), c, 0.0)
    person, felt = driver.initialize(DriverInputs(0.0, 0.0, outputs.seat_acceleration), d, 0.0)
    found, every = [], round(0.01 / step_size)
    for k in range(round(stop / step_size)):
        seat = DriverInputs(outputs.seat_displacement, outputs.seat_velocity, outputs.seat_acceleration)
        push = felt.contact_force
        person, felt = driver.advance(person, seat, d, k * step_size, step_size)
        state, outputs = advance(state, Inputs(*floor_at(k * step_size), 0.0, push), c, k * step_size, step_size)
        if (k + 1) % every == 0:
            found.append(outputs.driver_acceleration if inside else felt.driver_acceleration)
    return np.array(found)


def test_explicit_coupling_is_stable_at_2_ms_and_converges():
    """The driver's force is held over a step, so it is late by half a step on average: an error of first order."""
    reference = ride(1e-3, 4.0, inside=True)
    errors = {}
    for step_size in (2e-3, 1e-3):
        difference = ride(step_size, 4.0, inside=False) - reference
        errors[step_size] = np.sqrt(np.mean(difference**2) / np.mean(reference**2))
    assert errors[2e-3] < 0.05
    assert errors[1e-3] == pytest.approx(0.5 * errors[2e-3], rel=0.15)


def test_a_body_that_is_too_fast_is_refused():
    with pytest.raises(ParameterError, match="fastest motion below 50000 rad/s"):
        prepare(Parameters(driver_model=DriverModel.seated, contact_damping=1e9))
    prepare(Parameters(contact_damping=1e9))
