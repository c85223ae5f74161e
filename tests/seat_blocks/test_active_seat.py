"""ActiveSeat against controller and seat co-simulated by the master, and what it adds to them."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fmus.component import pack_state, unpack_state
from fmus.variables import record_of
from plant_models.seat.interface import Parameters as SeatParameters
from seat_blocks.active_seat import (
    ACTIVE_SEAT,
    advance,
    controller_parameters,
    initialize,
    is_valid_state,
    prepare,
    warnings,
)
from seat_blocks.interface import ActiveParameters, Inputs
from seat_controller_fmu.interface import Mode
from seat_controller_fmu.interface import Parameters as ControllerParameters
from seat_cosim.scenarios import SCENARIOS, read_parameter_sets, seat_suspension
from tests.helpers.driven import driven
from tests.helpers.paths import NATIVE
from tests.seat_blocks.conftest import Block

SEAT = (
    "driver_acceleration",
    "seat_acceleration",
    "suspension_deflection",
    "deflection_rate",
    "floor_force",
    "friction_force",
    "seat_displacement",
    "driver_displacement",
)
CONTROLLER = (
    "force",
    "force_demand",
    "motor_torque",
    "disturbance_estimate",
    "saturated",
    "fault",
    "friction_estimate",
)

STOPS = {"seat.end_stop.travel": 0.04, "seat.end_stop.stiffness": 1e5, "seat.end_stop.damping": 1e3}
DRIVER = {"seat.driver_mass": 70.0, "controller.driver_mass": 70.0}
TOLERANCE = 1e-12


def largest_difference(found: np.ndarray, expected: np.ndarray) -> float:
    """Largest difference, as a share of the largest value."""
    scale = np.abs(expected).max()
    return float(np.abs(np.asarray(found, float) - expected).max() / scale) if scale else float(np.abs(found).max())


@pytest.mark.parametrize("step_size", [0.001, 0.002, 0.010])
@pytest.mark.parametrize("scenario", ["bump", "random"])
@pytest.mark.parametrize("mode", ["published", "robust"])
@pytest.mark.parametrize("flavour", NATIVE)
def test_it_equals_controller_and_seat_by_the_master(
    native: Path, block: Block, flavour: str, mode: str, scenario: str, step_size: float
):
    """With the prototype's imperfections and end stops, every output, to 1e-12; what is found is no difference."""
    parts = seat_suspension(native / flavour)
    seat = {**read_parameter_sets(["prototype"], parts), **STOPS}
    known = {
        "controller.actuator_time_constant": seat["seat.actuator.time_constant"],
        "controller.actuator_delay": seat["seat.actuator.delay"],
        "controller.travel": 0.04,
    }
    floor, law = SCENARIOS[scenario].parameters, {"controller.mode": mode}
    run = {"stop_time": 2.0, "step_size": step_size}
    expected = parts.simulate(**run, parameters={**floor, **law, **seat, **known, **DRIVER})
    once = {f"seat.{name}": value for name, value in {**law, **seat, "seat.driver_mass": 70.0}.items()}
    found = block(flavour, "ActiveSeat").simulate(**run, parameters={**floor, **once})
    assert np.abs(expected["controller.force"]).max() > 50.0
    for part, names in (("seat", SEAT), ("controller", CONTROLLER)):
        for name in names:
            assert largest_difference(found[f"seat.{name}"], expected[f"{part}.{name}"]) < TOLERANCE, name


def floor_at(time: float) -> tuple[float, float, float]:
    """A sine of 3 Hz and 15 mm that begins at rest: displacement, velocity, acceleration."""
    w, rise = 2.0 * math.pi * 3.0, 0.015
    return rise * (1.0 - math.cos(w * time)), rise * w * math.sin(w * time), rise * w * w * math.cos(w * time)


@pytest.mark.parametrize("flavour", NATIVE)
@pytest.mark.parametrize("mode", [Mode.published, Mode.robust])
def test_inner_steps_close_the_loop_inside_a_step_of_the_host(native: Path, tmp_path: Path, flavour: str, mode: Mode):
    """At 10 ms as controller and seat at 2 ms on the floor that the block extrapolates; 1e-12, but for rounding."""
    folder = native / flavour
    names = SEAT[:5]
    with (
        driven(folder / "ActiveSeat.fmu", tmp_path / "block") as block,
        driven(folder / "SeatController.fmu", tmp_path / "controller") as controller,
        driven(folder / "SeatPlant.fmu", tmp_path / "seat") as seat,
    ):
        z, v, a = floor_at(0.0)
        block.begin(inner_step_size=0.002, controller__mode=mode, floor_acceleration=a)
        controller.begin(mode=mode, travel=0.0)
        seat.begin(floor_acceleration=a)
        rows = []
        for k in range(200):
            z, v, a = floor_at(0.01 * k)
            block.set(floor_displacement=z, floor_velocity=v, floor_acceleration=a)
            block.step(0.01 * k, 0.01)
            for i in range(5):
                time, tau = 0.002 * (5 * k + i), 0.002 * i
                measured = seat.get("seat_acceleration_measured", "suspension_deflection_measured")
                controller.set(seat_acceleration=measured[0], suspension_deflection=measured[1])
                controller.step(time, 0.002)
                (force,) = controller.get("force")
                displacement, velocity = z + tau * (v + 0.5 * tau * a), v + tau * a
                seat.set(floor_displacement=displacement, floor_velocity=velocity, floor_acceleration=a, force=force)
                seat.step(time, 0.002)
            rows.append((block.get(*names, "force"), [*seat.get(*names), force]))
    found, expected = np.array([row[0] for row in rows]), np.array([row[1] for row in rows])
    scales = np.abs(expected).max(axis=0)
    assert (scales > [0.5, 0.5, 0.005, 0.1, 50.0, 50.0]).all()
    assert (np.abs(found - expected) / scales).max() < TOLERANCE


def test_inner_steps_bring_a_coarse_host_close_to_the_fine_one(block: Block):
    """Random floor at 10 ms: what is left is the extrapolation of the floor over 10 ms instead of 2 ms."""
    system = block("fmi2", "ActiveSeat")
    floor = {"shaker.profile": "random", "shaker.random.class": "EM3"}
    fine = system.simulate(stop_time=10.0, step_size=0.002, parameters=floor)
    plain = system.simulate(stop_time=10.0, step_size=0.01, parameters=floor)
    inner = system.simulate(stop_time=10.0, step_size=0.01, parameters={**floor, "seat.inner_step_size": 0.002})

    def error(coarse: object) -> float:
        true = fine["seat.driver_acceleration"][::5]
        difference = coarse["seat.driver_acceleration"] - true
        return float(np.sqrt((difference**2).mean() / (true**2).mean()))

    print(error(plain), error(inner))
    assert error(inner) < 0.5 * error(plain)


def ride(parameters: ActiveParameters, steps: list[float]) -> list[tuple[float, ...]]:
    coefficients, time = prepare(parameters), 0.0
    state, outputs = initialize(Inputs(0.0, 0.0, floor_at(0.0)[2]), coefficients, time)
    found = []
    for step in steps:
        state, outputs = advance(state, Inputs(*floor_at(time)), coefficients, time, step)
        time += step
        found.append((time, outputs.controller.force, outputs.seat.driver_acceleration))
    return found


@pytest.mark.parametrize("inner", [0.001, 0.002, 0.0039])
def test_inner_steps_shorter_than_two_samples_are_samples(inner: float):
    """Between samples the force does not change, so exchanges in between would change nothing."""
    expected = ride(ActiveParameters(inner_step_size=0.002), [0.01] * 20)
    assert ride(ActiveParameters(inner_step_size=inner), [0.01] * 20) == expected
    assert ride(ActiveParameters(inner_step_size=0.004), [0.01] * 20) != expected


def test_a_host_off_the_grid_meets_every_sample_once():
    """Steps of 3 ms: the inner steps end at the multiples of 2 ms, wherever the steps of the host do."""
    coefficients = prepare(ActiveParameters(inner_step_size=0.002))
    state, _ = initialize(Inputs(), coefficients, 0.0)
    for k in range(100):
        state, _ = advance(state, Inputs(*floor_at(0.003 * k)), coefficients, 0.003 * k, 0.003)
        assert state.controller.next_sample == math.ceil(1.5 * (k + 1))


def test_the_controller_knows_the_seat_unless_it_is_given_something_else():
    seat = SeatParameters(
        driver_mass=82.0,
        actuator_time_constant=0.02,
        actuator_delay=0.15,
        end_stop_travel=0.04,
        end_stop_height=-0.01,
        end_stop_stiffness=1e5,
    )
    own = ActiveParameters(seat=seat).controller
    known = controller_parameters(own, seat)
    assert (known.driver_mass, known.actuator_time_constant) == (82.0, 0.02)
    assert known.actuator_delay == 0.1, "the longest that the controller can follow"
    assert known.travel == pytest.approx(0.03)
    assert known == replace(
        ControllerParameters(), driver_mass=82.0, actuator_time_constant=0.02, actuator_delay=0.1, travel=known.travel
    )
    given = replace(own, driver_mass=60.0, actuator_time_constant=0.01, actuator_delay=0.004, travel=0.02)
    assert controller_parameters(given, seat) == replace(
        ControllerParameters(), driver_mass=60.0, actuator_time_constant=0.01, actuator_delay=0.004, travel=0.02
    )
    light = controller_parameters(own, replace(seat, driver_mass=5.0))
    assert light.driver_mass == 20.0, "an empty seat: the least of the controller's range"


def test_another_mass_than_the_seats_is_warned_of():
    def warned(assumed: float, true: float) -> list[str]:
        given = ActiveParameters()
        return warnings(
            replace(
                given,
                controller=replace(given.controller, driver_mass=assumed),
                seat=SeatParameters(driver_mass=true),
            )
        )

    assert warned(0.0, 70.0) == warned(75.0, 70.0) == []
    assert "controller.driver_mass 50.0 kg is not seat.driver_mass 70.0 kg" in warned(50.0, 70.0)[0]
    assert "lies outside" in warned(0.0, 120.0)[0], "as the controller warns"


def test_both_parts_judge_a_state():
    parameters = ActiveParameters()
    coefficients = prepare(parameters)
    state, _ = initialize(Inputs(), coefficients, 0.0)
    state, _ = advance(state, Inputs(0.01, 0.1, 1.0), coefficients, 0.0, 0.01)
    assert unpack_state(ACTIVE_SEAT.state, pack_state(state)) == state
    assert is_valid_state(state, parameters, 0.01)
    assert not is_valid_state(state, parameters, 5.0)
    broken = state.seat._replace(actuator=state.seat.actuator._replace(line_length=3))
    assert not is_valid_state(state._replace(seat=broken), parameters, 0.01)


def test_parameters_of_both_parts_have_their_names_behind_a_prefix():
    names = {v.name: v for v in ACTIVE_SEAT.variables}
    assert {"seat.driver_mass", "controller.driver_mass", "controller.K1.deflection", "seat.friction.alpha"} <= set(
        names
    )
    flat = {v.field: v.start for v in ACTIVE_SEAT.variables if v.causality == "parameter"}
    assert record_of(ActiveParameters, flat) == ActiveParameters()
    changed = record_of(ActiveParameters, {**flat, "controller.K1_deflection": 1.0, "seat.sensor_seed": 7})
    assert (changed.controller.K1_deflection, changed.seat.sensor_seed) == (1.0, 7)
