"""Replacing components by other FMUs: connections that fit stay, an error changes nothing."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim import SetupError, System
from cosim.engine.editing import edit
from cosim.engine.network import VariableRef
from cosim.units import Linear


def test_an_fmu_with_the_same_names_is_dropped_in(system: System, native: Path):
    before = {str(sink): str(feed.source) for sink, feed in system.connections.items()}
    system.parameters = {"seat.driver_mass": 80.0}
    system.replace("seat", native / "fmi3" / "SeatPlant.fmu")
    assert {str(sink): str(feed.source) for sink, feed in system.connections.items()} == before
    assert system.models["seat"].description.fmiVersion == "3.0"
    assert system.parameters == {"seat.driver_mass": 80.0}
    assert system.order == ("controller", "seat", "shaker")


def test_a_floor_in_another_unit_and_of_another_name(system: System, foreign: Path):
    system.replace("shaker", foreign / "Cabin.fmu", {"seat.floor_displacement": "0.001*z"})
    feed = system.connections[VariableRef("seat", "floor_displacement")]
    assert (str(feed.source), feed.transformation) == ("shaker.z", Linear(0.001))
    assert VariableRef("seat", "floor_velocity") not in system.connections
    assert [note for note in system.notes() if note.startswith("seat.floor_signals: set to displacement")]
    assert system.check_parameters({})["seat"]["floor_signals"] == 2.0


def test_a_declared_unit_is_converted(system: System, foreign: Path):
    system.replace("shaker", foreign / "Truck.fmu", {"seat.floor_acceleration": "acc"})
    assert system.connections[VariableRef("seat", "floor_acceleration")].transformation == Linear(9.80665)
    assert system.check_parameters({})["seat"]["floor_signals"] == 4.0


def test_a_seat_of_other_names_is_wired_both_ways(system: System, foreign: Path):
    system.replace(
        "seat",
        foreign / "Chair.fmu",
        {
            "seat.zv": "shaker.floor_displacement",
            "seat.dzv": "shaker.floor_velocity",
            "seat.F": "controller.force",
            "controller.seat_acceleration": "acc_seat",
            "controller.suspension_deflection": "stroke",
        },
    )
    assert len(system.connections) == 5
    assert system.connections[VariableRef("controller", "suspension_deflection")].transformation == Linear(0.001)
    assert system.notes() == []


def test_an_unconnected_input_is_reported_with_its_candidates(system: System, foreign: Path):
    with pytest.raises(
        SetupError,
        match=r"controller.suspension_deflection: expected an output of what is new to feed it, got none; "
        r"new outputs: seat.acc_seat, seat.stroke",
    ):
        system.replace("seat", foreign / "Chair.fmu", {"controller.seat_acceleration": "acc_seat"})
    with pytest.raises(
        SetupError, match=r"seat.acc_set: expected a variable of Chair.fmu, got none .did you mean acc_seat"
    ):
        system.replace("seat", foreign / "Chair.fmu", {"controller.seat_acceleration": "acc_set"})


def test_a_floor_that_feeds_nothing_is_refused(system: System, foreign: Path):
    with pytest.raises(SetupError, match="seat.floor_displacement: expected an output of what is new"):
        system.replace("shaker", foreign / "Cabin.fmu")


def test_what_goes_wrong_changes_nothing(system: System, foreign: Path):
    system.parameters = {"shaker.bump.height": 0.05}
    before = dict(system.models), dict(system.connections), dict(system.parameters), system.order
    for connections in ({}, {"seat.floor_displacement": "y"}, {"seat.flor": "z"}, {"seat.force": "z"}):
        with pytest.raises(SetupError):
            system.replace("shaker", foreign / "Cabin.fmu", connections)
        assert (system.models, system.connections, system.parameters, system.order) == before
    with pytest.raises(SetupError, match=r"shakr: expected a component among .*did you mean shaker"):
        system.replace("shakr", foreign / "Cabin.fmu")


def test_two_fmus_are_replaced_at_once(system: System, foreign: Path):
    edit(
        system,
        {"seat": foreign / "Chair.fmu", "controller": foreign / "Damper.fmu"},
        ["seat.dzv"] if VariableRef("seat", "dzv") in system.connections else [],
        [
            "shaker.floor_displacement=seat.zv",
            "seat.acc_seat=controller.acc",
            "controller.F = seat.F",
        ],
    )
    assert {str(sink) for sink in system.connections} == {"seat.zv", "controller.acc", "seat.F"}
    assert system.notes() == [
        "seat.dzv: not connected and not set, keeps its start value 0 m/s",
        "algebraic loop seat.acc_seat -> controller.acc -> controller.F -> seat.F -> seat.acc_seat: "
        "values are exchanged once in a step, not iterated",
    ]


def test_a_new_connection_takes_the_place_of_a_replaced_one_only(system: System, native: Path):
    same = native / "fmi3" / "Shaker.fmu"
    system.replace("shaker", same, {"seat.floor_displacement": "-1*floor_displacement"})
    assert system.connections[VariableRef("seat", "floor_displacement")].transformation == Linear(-1.0)
    with pytest.raises(SetupError, match=r"seat.force: expected|expected a free input, got one that controller.force"):
        system.replace("shaker", same, {"seat.force": "floor_displacement"})


def test_parameters_without_variability_are_repaired(foreign: Path, system: System):
    system.replace(
        "controller",
        foreign / "Damper.fmu",
        {"controller.acc": "seat.seat_acceleration_measured", "seat.force": "F"},
    )
    assert system.models["controller"].variables["damping"].variability == "fixed"
    assert system.check_parameters({"controller.damping": 500.0})["controller"] == {"damping": 500.0}
