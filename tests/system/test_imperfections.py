"""Imperfections of actuator, sensors and travel through the FMUs: the same in every flavour, absent by default."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from cosim import RunError
from plant_models.seat.interface import Parameters
from plant_models.shaker.parameters import BUMP_HEIGHT
from seat_cosim.scenarios import SCENARIOS, control, seat_suspension
from tests.helpers.driven import Driven
from tests.helpers.paths import NATIVE
from tests.helpers.reference import bump

H = 0.002

ACTUATOR = {"actuator.force_limit": 150.0, "actuator.delay": 0.0137, "actuator.time_constant": 0.006}
SENSORS = {
    "sensor.bandwidth": 40.0,
    "sensor.acceleration_noise": 0.05,
    "sensor.acceleration_bias": 0.01,
    "sensor.acceleration_resolution": 0.01,
    "sensor.deflection_noise": 1e-4,
    "sensor.deflection_bias": -1e-3,
    "sensor.deflection_resolution": 1e-4,
    "sensor.seed": 7,
}
STOPS = {"end_stop.travel": 0.02, "end_stop.stiffness": 2e5, "end_stop.damping": 1500.0}
SAGGED = {**STOPS, "end_stop.height": -0.012}
ALL = {**ACTUATOR, **SENSORS, **SAGGED}


def of_seat(parameters: dict[str, float]) -> dict[str, float]:
    return {f"seat.{name}": value for name, value in parameters.items()}


@pytest.mark.parametrize(
    "imperfections", [ACTUATOR, SENSORS, STOPS, SAGGED, ALL], ids=["actuator", "sensors", "stops", "sagged", "all"]
)
def test_flavours_agree_to_the_last_bit(native: Path, fmus: Path, imperfections: dict[str, float]):
    parameters = {**SCENARIOS["bump"].parameters, **control(True), **of_seat(imperfections)}
    folders = [fmus, *(native / flavour for flavour in NATIVE)]
    found = [seat_suspension(folder).simulate(1.0, H, parameters) for folder in folders]
    perfect = seat_suspension(folders[1]).simulate(1.0, H, {**SCENARIOS["bump"].parameters, **control(True)})
    for other in found[1:]:
        for name, expected in found[0].values.items():
            assert np.array_equal(other[name], expected), name
    name = "seat.seat_acceleration_measured" if imperfections is SENSORS else "seat.driver_acceleration"
    assert np.abs(found[0][name] - perfect[name]).max() > 0.05


def test_end_stops_bound_the_deflection(native: Path):
    parameters = {**SCENARIOS["bump"].parameters, **control(True)}
    system = seat_suspension(native / "fmi2")
    free = system.simulate(1.5, H, parameters)
    bounded = system.simulate(1.5, H, {**parameters, **of_seat({**STOPS, "end_stop.stiffness": 1e6})})
    assert np.abs(free["seat.suspension_deflection"]).max() > 0.5 * BUMP_HEIGHT.value
    assert 0.02 < np.abs(bounded["seat.suspension_deflection"]).max() < 0.0225


def test_a_seat_that_sags_meets_the_lower_end_stop_first(native: Path):
    system = seat_suspension(native / "fmi2")
    parameters = {**SCENARIOS["bump"].parameters, **control(False)}
    bounded = system.simulate(1.5, H, {**parameters, **of_seat({**SAGGED, "end_stop.stiffness": 1e6})})
    deflection = bounded["seat.suspension_deflection"]
    assert -0.0105 < deflection.min() < -0.008  # travel less sag
    assert 0.02 < deflection.max() < 0.0345  # and travel with it


def test_everything_is_off_by_default():
    p = Parameters()
    for name in (*ACTUATOR, *SENSORS, *SAGGED):
        field = name.replace(".", "_")
        field = field if hasattr(p, field) else field.removeprefix("sensor_")
        assert getattr(p, field) == (1 if name == "sensor.seed" else 0), name


def drive(seat: Driven, first: int, last: int) -> list[list[float]]:
    """Step along the bump under a force that changes each time."""
    found = []
    for k in range(first, last):
        z, v, a = bump()(k * H)
        seat.set(floor_displacement=z, floor_velocity=v, floor_acceleration=a, force=120.0 * np.sin(0.3 * k))
        seat.step(k * H, H)
        found.append(seat.get("driver_acceleration", "seat_acceleration_measured", "suspension_deflection_measured"))
    return found


def test_a_step_can_be_taken_back_while_forces_are_on_their_way(seat: Driven):
    seat.begin(**{name.replace(".", "__"): value for name, value in {**ALL, "actuator.delay": 0.2}.items()})
    drive(seat, 0, 150)
    state = seat.state()
    once = drive(seat, 150, 300)
    seat.restore(state)
    assert drive(seat, 150, 300) == once
    assert np.ptp(np.array(once), axis=0).min() > 0.01


def test_a_step_that_fails_leaves_the_forces_on_their_way(seat: Driven):
    """The floor overflows while forces enter and leave the delay; then the same step once more on the bump."""
    runs = []
    for fails in (False, True):
        seat.begin(actuator__delay=0.0051)
        before = drive(seat, 0, 40)
        if fails:
            seat.set(force=1e4, floor_velocity=1.5e308)
            with pytest.raises(FMICallException):
                seat.step(40 * H, H)
        runs.append(before + drive(seat, 40, 80))
        seat.end()
    assert runs[0] == runs[1]


def test_a_step_that_fails_leaves_no_trace(seat: Driven):
    """Nor of the force that entered the empty delay line in it."""
    seat.begin(actuator__delay=0.01)
    for k in range(10):
        seat.step(k * H, H)
    still = {"force": 0.0, "floor_velocity": 0.0}
    seat.set(**still)
    before = seat.saved()
    seat.set(force=70.0, floor_velocity=1.5e308)
    with pytest.raises(FMICallException):
        seat.step(10 * H, H)
    seat.set(**still)
    assert seat.saved() == before


def test_end_stops_without_stiffness_are_refused(seat: Driven):
    with suppress(RunError, FMICallException):  # the Python flavour refuses the first step
        seat.begin(end_stop__travel=0.05)
        seat.step(0.0, H)
    assert "end_stop.stiffness > 0 where end_stop.travel > 0" in seat.said
    assert "end_stop.travel = 0.05 m" in seat.said
