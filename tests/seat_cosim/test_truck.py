"""The seat in a truck: its ride, its evaluation on roads, what the seat does to the cab."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from cosim import Result, System
from seat_controller_fmu.controller import SEAT_CONTROLLER
from seat_controller_fmu.interface import Mode
from seat_cosim import carried
from seat_cosim.evaluation.installation import Installation
from seat_cosim.evaluation.seat import installed
from seat_cosim.scenarios import SCENARIOS, SYSTEM_FILES, TRUCK, control, read_parameter_sets, road, seat_suspension
from tests.helpers.shell import Shell


def numbers(shell: Shell, *words: str) -> dict:
    code, out, err = shell(*words, "--json")
    assert code == 0, err
    return json.loads(out)


def test_a_ride_is_that_of_the_system_with_end_stops(shell: Shell, native: Path):
    found = numbers(shell, "run", "truck", "--road", "D", "--speed", "45", "--stop-time", "10", "--driver-mass", "80")
    system = seat_suspension(native / "fmi2", TRUCK)
    parameters = {**road("D", 45.0), **installed(system, Installation())}
    masses = {"seat.driver_mass": 80.0, "controller.driver_mass": 80.0}
    result = system.simulate(10.0, parameters=parameters | masses)
    ride = found["rides"]["this ride"]
    assert ride["peak"] == np.abs(result["seat.driver_acceleration"]).max()
    assert ride["stroke"] == 1e3 * np.abs(result["seat.suspension_deflection"]).max()
    assert ride["travel_share"] == pytest.approx(ride["stroke"] / 0.4, rel=1e-12)
    assert found["rides"]["passive seat"]["seat"] != ride["seat"]


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("run bump --road C", "--road with bump: expected one of them, got both; its floor is no truck's"),
        ("run random --speed 30", "--speed with random: expected one of them"),
        ("run truck --speed 0", "--speed: expected more than 0 km/h, got 0"),
        ("run truck --speed nan", "--speed: expected more than 0 km/h, got nan"),
        ("run truck --road F", "'F' is not one of 'A', 'B', 'C', 'D', 'E'"),
        ("run truck --recording ride.csv --channel z", "expected with the scenario file, got truck"),
        ("run truck --set truck.obstacle.height=0.1", "expected truck.road.profile = bump or pothole or kerb"),
        ("run truck --set shaker.bump.height=0.1", "expected a component"),
        ("evaluate --profile roads --classes EM3", "class EM3: expected a road and a speed in km/h, such as C60"),
        ("evaluate --profile roads --classes C0", "class C0: expected a road and a speed"),
        ("evaluate --profile roads --classes Q60", "road.class"),
        ("evaluate --profile roads --classes C900", "truck.speed: expected a value in"),
        ("evaluate --profile roads --protocol iso7096", "--protocol iso7096 with --profile roads: expected one"),
    ],
)
def test_what_does_not_fit_is_refused_by_name(shell: Shell, tmp_path: Path, command: str, message: str):
    code, _, error = shell(*command.split())
    assert code == 2
    assert message in error, error
    assert not list(tmp_path.rglob("*.csv"))


def test_roads_are_evaluated_with_drivers_and_seats(shell: Shell, tmp_path: Path):
    words = ("--profile", "roads", "--classes", "B60,C30", "--masses", "55", "--seeds", "1", "--duration", "10")
    code, out, err = shell("evaluate", *words, "--processes", "1", "--output", "out")
    assert (code, err) == (0, ""), err
    assert "B60" in out
    rows = json.loads((tmp_path / "out" / "evaluation.json").read_text(encoding="utf-8"))
    assert "C30" in json.dumps(rows)
    assert "passive seat" in out


@pytest.fixture(scope="module")
def rides(native: Path) -> dict[str, Result]:
    """A minute on class C at 60 km/h, with the published controller and with the passive seat."""
    system = seat_suspension(native / "fmi2", TRUCK)
    stops = installed(system, Installation())
    passive = {**control(False), **read_parameter_sets(["passive"], system)}
    parameters = {**SCENARIOS["truck"].parameters, **stops}
    return {
        name: system.simulate(60.0, parameters=parameters | given)
        for name, given in (("active", control(True)), ("passive", passive))
    }


@pytest.mark.parametrize("name", ["active", "passive"])
def test_energy_over_the_connection_balances(rides: dict[str, Result], name: str):
    """Work of the seat's force on the floor as the seat extrapolates it, against that on the cab.

    The cab moves under a force that is linear between the communication points, which a test of its kernel shows.
    """
    result = rides[name]
    force, h = result["seat.floor_force"], 0.002
    place, speed, acceleration = (
        result[f"truck.floor_{each}"] for each in ("displacement", "velocity", "acceleration")
    )
    inertia = 28.0 * result["seat.seat_acceleration"] + 55.0 * result["seat.driver_acceleration"]
    np.testing.assert_allclose(force, -inertia, atol=1e-9 * np.abs(force).max())  # Newton's laws for both masses
    first, last = force[:-1], force[1:]
    received = float(np.sum(0.5 * (first + last) * np.diff(place)))
    begin, end = speed[:-1], speed[:-1] + h * acceleration[:-1]
    given = float(np.sum(h / 6.0 * (first * begin + (first + last) * (begin + end) + last * end)))  # Simpson's rule
    assert abs(given) > 50.0
    assert abs(received - given) < 1e-3 * abs(given)


def test_the_seat_moves_the_cab_a_little(native: Path, rides: dict[str, Result]):
    system = seat_suspension(native / "fmi2", TRUCK)
    system.disconnect(f"{TRUCK}.seat_force")
    parameters = {**SCENARIOS["truck"].parameters, **installed(system, Installation()), **control(True)}
    alone = system.simulate(60.0, parameters=parameters)["truck.floor_acceleration"]
    together = rides["active"]["truck.floor_acceleration"]
    change = np.sqrt(np.mean((together - alone) ** 2) / np.mean(alone**2))
    assert 1e-3 < change < 0.1


def test_the_system_file_rides_the_default_road(native: Path, tmp_path: Path):
    system = seat_suspension(native / "fmi2", TRUCK)
    system.save(tmp_path / "Truck.ssp")
    loaded = System.load(tmp_path / "Truck.ssp").simulate(1.0)
    expected = system.simulate(1.0, parameters=SCENARIOS["truck"].parameters)
    name = "seat.driver_acceleration"
    assert loaded[name].tobytes() == expected[name].tobytes()


def test_the_mode_robust_has_no_gains_to_warn_of(native: Path):
    for mode in Mode:
        told = SEAT_CONTROLLER.warnings(SEAT_CONTROLLER.parameters(driver_mass=110.0, mode=mode))
        parameters = {"controller.driver_mass": 110.0, "controller.mode": mode.name}
        warnings = seat_suspension(native / "fmi2").simulate(0.02, parameters=parameters).warnings
        assert len(told) == len(warnings) == (1 if mode == Mode.published else 0)


@pytest.mark.parametrize("name", ["TruckSeat", "TruckSeat-fmi3", "SeatSuspension", "TruckCab"])
def test_what_is_of_this_project_is_shown_by_its_name(
    name: str, shell: Shell, native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    for flavour, names in SYSTEM_FILES.items():
        for floor, file in names.items():
            seat_suspension(native / flavour, floor).save(tmp_path / "fmus" / file)
    monkeypatch.setattr(carried, "package_folders", lambda: (tmp_path / "fmus", native))
    code, out, err = shell("info", name)
    assert (code, err) == (0, "")
    assert out.startswith(name.removesuffix("-fmi3"))
