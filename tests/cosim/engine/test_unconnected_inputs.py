"""Unconnected inputs: derived where a component can, reported where it cannot."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim import SetupError, System

FLOOR = ("displacement", "velocity", "acceleration")


@pytest.fixture
def pair(native: Path) -> System:
    system = System()
    system.add("shaker", native / "fmi2" / "Shaker.fmu")
    system.add("seat", native / "fmi2" / "SeatPlant.fmu")
    return system


def connect(system: System, *signals: str) -> None:
    for signal in signals:
        system.connect(f"shaker.floor_{signal}", f"seat.floor_{signal}")


def test_a_floor_with_all_signals_needs_no_choice(pair: System):
    connect(pair, *FLOOR)
    assert pair.check_parameters({})["seat"] == {}
    assert pair.notes() == ["seat.force: not connected and not set, keeps its start value 0.0 N"]


@pytest.mark.parametrize(("number", "signal"), list(enumerate(FLOOR, start=2)))
def test_one_signal_is_chosen_and_reported(pair: System, number: int, signal: str):
    connect(pair, signal)
    assert pair.check_parameters({})["seat"] == {"floor_signals": float(number)}
    assert pair.notes()[0].startswith(f"seat.floor_signals: set to {signal}, as not all of its inputs are connected")
    result = pair.simulate(0.2)
    assert result.complete
    assert result.warnings[0].startswith(f"seat.floor_signals: set to {signal}")
    assert abs(result["seat.seat_displacement"]).max() > 1e-3


def test_of_two_signals_the_preferred_one_is_taken(pair: System):
    connect(pair, "acceleration", "velocity")
    assert pair.check_parameters({})["seat"] == {"floor_signals": 3.0}
    assert pair.notes()[0].endswith("derived from seat.floor_velocity; seat.floor_acceleration is ignored")


def test_no_floor_at_all_is_an_error(pair: System):
    with pytest.raises(
        SetupError,
        match="seat: expected one of seat.floor_displacement, seat.floor_velocity, seat.floor_acceleration to be "
        "connected, got none",
    ):
        pair.simulate(0.2)


def test_a_floor_that_is_set_is_no_silent_zero(pair: System):
    assert pair.check_parameters({"seat.floor_displacement": 0.0})["seat"] == {
        "floor_displacement": 0.0,
        "floor_signals": 2.0,
    }


def test_the_users_choice_stays(pair: System):
    connect(pair, "displacement")
    assert pair.check_parameters({"seat.floor_signals": "all"})["seat"] == {"floor_signals": 1.0}


def test_an_input_that_is_set_is_not_reported(pair: System):
    connect(pair, *FLOOR)
    assert pair.notes({"seat.force": 10.0}) == []


def test_the_input_of_a_driver_outside_is_reported_where_one_is_chosen(pair: System):
    """By its name, number or in the parameters of the system; what the seat models itself needs no input."""
    connect(pair, *FLOOR)
    pair.parameters["seat.force"] = 0.0
    note = "seat.driver_force: not connected and not set, keeps its start value 0.0 N"
    assert pair.notes() == pair.notes({"seat.driver.model": "seated"}) == pair.notes({"seat.driver.model": 2}) == []
    assert pair.notes({"seat.driver.model": "external"}) == pair.notes({"seat.driver.model": 3.0}) == [note]
    assert pair.notes(["seat.driver.model"]) == [note]
    pair.parameters["seat.driver.model"] = "external"
    assert pair.notes() == [note]
    assert pair.notes({"seat.driver_force": 1.0}) == []
