"""FMUs of other makers run in the places of ours, each in a process of its own (docs/how-to/replace-a-component.md)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cosim import Result, System
from seat_cosim.scenarios import SCENARIOS, control, seat_suspension

CHAIR = {
    "seat.zv": "shaker.floor_displacement",
    "seat.dzv": "shaker.floor_velocity",
    "seat.F": "controller.force",
    "controller.seat_acceleration": "acc_seat",
    "controller.suspension_deflection": "stroke",
}


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def off_and_on(system: System, isolate: str, **parameters: float) -> list[Result]:
    given = {name.replace("__", "."): value for name, value in parameters.items()}
    with system.open(isolate=(isolate,)) as session:
        results = [session.run(2.0, parameters={**given, **control(on)}) for on in (False, True)]
    for result in results:
        assert result.error is None
        assert result.complete
    return results


def test_a_cabin_moves_the_seat(native: Path, foreign: Path):
    system = seat_suspension(native / "fmi2")
    system.replace("shaker", foreign / "Cabin.fmu", {"seat.floor_displacement": "0.001*z"})
    off, on = off_and_on(system, "shaker")
    floor = off["seat.seat_displacement"] - off["seat.suspension_deflection"]
    # the floor of a row is that of the step before, moved on by its parabola
    assert np.abs(floor - 1e-3 * off["shaker.z"]).max() < 1e-5
    assert off["shaker.z"].max() > 40.0
    assert rms(on["seat.driver_acceleration"]) < 0.3 * rms(off["seat.driver_acceleration"])


def test_a_truck_moves_the_seat_by_its_acceleration_in_g(native: Path, foreign: Path):
    system = seat_suspension(native / "fmi3")
    system.replace("shaker", foreign / "Truck.fmu", {"seat.floor_acceleration": "acc"})
    off, on = off_and_on(system, "shaker")
    assert any("seat.floor_signals: set to acceleration" in text for text in off.warnings)
    assert rms(on["seat.driver_acceleration"]) < 0.5 * 9.80665 * rms(on["shaker.acc"])
    assert rms(off["seat.driver_acceleration"]) > rms(on["seat.driver_acceleration"])


def test_our_controller_isolates_another_seat(native: Path, foreign: Path):
    system = seat_suspension(native / "fmi3")
    system.replace("seat", foreign / "Chair.fmu", CHAIR)
    off, on = off_and_on(system, "seat", controller__driver_mass=62.0)
    assert on["seat.acc_seat"][0] == off["seat.acc_seat"][0] == 0.0
    assert rms(on["seat.acc_seat"]) < 0.3 * rms(off["seat.acc_seat"])
    assert np.abs(on["controller.force"]).max() == 250.0


def test_another_controller_isolates_our_seat(native: Path, foreign: Path):
    ours, theirs = (seat_suspension(native / "fmi2") for _ in range(2))
    bump = SCENARIOS["bump"].parameters
    theirs.replace(
        "controller",
        foreign / "Damper.fmu",
        {"controller.acc": "seat.seat_acceleration_measured", "seat.force": "F"},
    )
    uncontrolled = ours.simulate(2.0, parameters={**bump, **control(False)})
    skyhook = theirs.simulate(2.0, parameters=bump, isolate=("controller",))
    assert skyhook.complete
    assert rms(skyhook["seat.driver_acceleration"]) < 0.5 * rms(uncontrolled["seat.driver_acceleration"])
    # the law by hand: a step integrates the acceleration from before it, and its force is that of its end, as the FMU
    # does not say that it samples
    velocity, forces = 0.0, []
    for acceleration in skyhook["seat.seat_acceleration_measured"][:-1]:
        velocity += 0.002 * (acceleration - 2.0 * np.pi * 0.2 * velocity)
        forces.append(min(max(-1000.0 * velocity, -250.0), 250.0))
    assert skyhook["controller.F"][1:] == pytest.approx(np.array(forces), abs=1e-9)
