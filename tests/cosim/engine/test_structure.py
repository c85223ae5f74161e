"""Wiring a system: every mistake is one clear error that names both ends."""

from __future__ import annotations

import shutil
import zipfile
from pathlib import Path

import pytest

from cosim import SetupError, System
from cosim.engine.structure import VariableRef
from cosim.fmi.description import ModelDescription
from cosim.units import IDENTITY, Linear, Unit, conversion
from tests.helpers.files import edited


@pytest.fixture
def pair(fmus: Path) -> System:
    system = System()
    system.add("shaker", fmus / "Shaker.fmu")
    system.add("seat", fmus / "SeatPlant.fmu")
    return system


@pytest.mark.parametrize(
    ("source", "sink", "problem"),
    [
        ("shaker.floor_displacement", "seat.floor_velocity", "expected two units of one dimension, got m and m/s"),
        ("shaker.floor_displacment", "seat.floor_displacement", "did you mean floor_displacement"),
        ("shaker.floor_displacement", "seat.floor", "seat.floor: expected a variable of SeatPlant.fmu, got none"),
        (
            "shaker.bump.height",
            "seat.floor_displacement",
            "shaker.bump.height to be an output, got one of causality parameter",
        ),
        (
            "shaker.floor_displacement",
            "seat.seat_displacement",
            "seat.seat_displacement to be an input, got one of causality output",
        ),
        ("shaker.floor_displacement", "chair.floor", "expected a component among shaker, seat, got chair"),
        ("shaker", "seat.force", "shaker: expected COMPONENT.VARIABLE"),
    ],
)
def test_wrong_connections_are_refused(pair: System, source: str, sink: str, problem: str):
    with pytest.raises(SetupError, match=problem):
        pair.connect(source, sink)
    assert not pair.connections


def test_all_problems_of_a_connection_are_told_at_once(pair: System):
    with pytest.raises(SetupError) as error:
        pair.connect("shaker.bump.height", "seat.seat_acceleration")
    assert len(error.value.problems) == 3
    assert all("shaker.bump.height -> seat.seat_acceleration" in problem for problem in error.value.problems)


def test_an_input_is_fed_once(pair: System):
    pair.connect("shaker.floor_displacement", "seat.floor_displacement")
    with pytest.raises(SetupError, match=r"got one that shaker\.floor_displacement feeds"):
        pair.connect("shaker.floor_displacement", "seat.floor_displacement")


def test_types_must_agree(fmus: Path, pair: System):
    pair.add("controller", fmus / "SeatController.fmu")
    with pytest.raises(SetupError, match="expected two ends of one numeric type, got Boolean and Real"):
        pair.connect("controller.saturated", "seat.force")


def test_one_dimension_in_two_units_is_converted(fmus: Path, tmp_path: Path, pair: System):
    millimetres = edited(
        fmus / "Shaker.fmu", tmp_path / "mm.fmu", ('<BaseUnit m="1"/>', '<BaseUnit m="1" factor="0.001"/>')
    )
    pair.add("other", millimetres)
    pair.connect("other.floor_displacement", "seat.floor_displacement")
    assert pair.connections[VariableRef("seat", "floor_displacement")].transformation == Linear(0.001)
    result = pair.simulate(0.02, 0.002, {"seat.floor_signals": "all"})
    held = result["seat.seat_displacement"] - result["seat.suspension_deflection"]  # the floor of the step before
    assert held[1:] == pytest.approx(1e-3 * result["other.floor_displacement"][:-1], rel=1e-9)
    assert held[-1] > 0.0


def test_units_are_converted_both_ways_and_offsets_too():
    celsius, kelvin = Unit("degC", (0, 0, 0, 0, 1, 0, 0, 0), 1.0, 273.15), Unit("K", (0, 0, 0, 0, 1, 0, 0, 0))
    metre, g = Unit("m", (0, 1, 0, 0, 0, 0, 0, 0)), Unit("g", (0, 1, -2, 0, 0, 0, 0, 0), 9.80665)
    metre_per_second2 = Unit("m/s2", (0, 1, -2, 0, 0, 0, 0, 0))
    assert conversion(celsius, kelvin)(20.0) == pytest.approx(293.15)
    assert conversion(kelvin, celsius)(293.15) == pytest.approx(20.0)
    assert conversion(g, metre_per_second2)(2.0) == 2 * 9.80665
    assert conversion(metre, g) is None
    assert conversion(metre, None) == conversion(metre, metre._replace(name="metre")) == IDENTITY


def test_transformations_compose_in_their_order():
    both = Linear(2.0, 1.0).after(Linear(3.0, 5.0))
    assert both(7.0) == 2.0 * (3.0 * 7.0 + 5.0) + 1.0
    assert Linear(2.0, 1.0).after(IDENTITY) == IDENTITY.after(Linear(2.0, 1.0)) == Linear(2.0, 1.0)


def test_a_transformation_comes_after_the_conversion_of_units(fmus: Path, tmp_path: Path, pair: System):
    pair.add(
        "mm",
        edited(fmus / "Shaker.fmu", tmp_path / "mm.fmu", ('<BaseUnit m="1"/>', '<BaseUnit m="1" factor="0.001"/>')),
    )
    pair.connect("mm.floor_displacement", "seat.floor_displacement", Linear(-1.0, 0.5))
    pair.connect("mm.floor_velocity", "seat.floor_acceleration", Linear(2.0), convert_units=False)
    transformations = {port.variable: feed.transformation for port, feed in pair.connections.items()}
    assert transformations == {"floor_displacement": Linear(-0.001, 0.5), "floor_acceleration": Linear(2.0)}


def test_an_input_is_freed(pair: System):
    pair.connect("shaker.floor_displacement", "seat.floor_displacement")
    pair.disconnect("seat.floor_displacement")
    assert not pair.connections
    with pytest.raises(SetupError, match=r"seat.force: expected an input that is fed, got one that is free"):
        pair.disconnect("seat.force")


def test_a_run_needs_times_from_somewhere(fmus: Path, tmp_path: Path, pair: System):
    assert pair.step_size == 0.002
    with pytest.raises(SetupError, match="stop time: expected one, as neither the system nor its FMUs"):
        pair.simulate()
    pair.stop_time = 0.01
    pair.parameters = {"seat.floor_signals": "all"}
    assert len(pair.simulate().time) == 6


def test_a_missing_unit_is_not_compared(fmus: Path, tmp_path: Path, pair: System):
    pair.add("other", edited(fmus / "Shaker.fmu", tmp_path / "no.fmu", (' unit="m"', "")))
    pair.connect("other.floor_displacement", "seat.floor_velocity")


def test_component_names(fmus: Path, pair: System):
    with pytest.raises(SetupError, match="component seat: expected a new name"):
        pair.add("seat", fmus / "SeatPlant.fmu")
    with pytest.raises(SetupError, match="expected a name without dots"):
        pair.add("a.b", fmus / "SeatPlant.fmu")


def test_files_that_are_no_fmus(fmus: Path, tmp_path: Path):
    with pytest.raises(SetupError, match=r"nowhere\.fmu: expected an FMU, got no such file"):
        ModelDescription.read(tmp_path / "nowhere.fmu")
    (tmp_path / "text.fmu").write_text("hello")
    with pytest.raises(SetupError, match="expected an FMU .a zip archive., got another kind of file"):
        ModelDescription.read(tmp_path / "text.fmu")
    with zipfile.ZipFile(tmp_path / "empty.fmu", "w") as archive:
        archive.writestr("readme.txt", "nothing")
    with pytest.raises(SetupError, match=r"expected a modelDescription\.xml in the archive, got none"):
        ModelDescription.read(tmp_path / "empty.fmu")
    with zipfile.ZipFile(tmp_path / "broken.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", "<fmiModelDescription")
    with pytest.raises(SetupError, match=r"broken\.fmu/modelDescription\.xml: expected XML, got"):
        ModelDescription.read(tmp_path / "broken.fmu")
    shutil.copy(fmus / "Shaker.fmu", tmp_path / "cut.fmu")
    with (tmp_path / "cut.fmu").open("r+b") as stream:
        stream.truncate(1000)
    with pytest.raises(SetupError, match="got another kind of file"):
        ModelDescription.read(tmp_path / "cut.fmu")


def test_other_kinds_of_fmus_are_refused(fmus: Path, tmp_path: Path):
    one = edited(fmus / "Shaker.fmu", tmp_path / "one.fmu", ("CoSimulation", "ModelExchange"))
    with pytest.raises(SetupError, match="expected FMI 2.0 or 3.0 for co-simulation, got FMI 2.0, no co-simulation"):
        ModelDescription.read(one)


def test_an_fmu_without_a_binary_for_this_platform_is_refused(fmus: Path, tmp_path: Path):
    with zipfile.ZipFile(fmus / "Shaker.fmu") as archive, zipfile.ZipFile(tmp_path / "bare.fmu", "w") as copy:
        copy.writestr("modelDescription.xml", archive.read("modelDescription.xml"))
    with pytest.raises(SetupError, match=r"bare\.fmu: expected a binary for .*, got none"):
        ModelDescription.read(tmp_path / "bare.fmu")


def test_parameters_are_checked_together(pair: System):
    with pytest.raises(SetupError) as error:
        pair.check_parameters(
            {
                "seat.floor_signals": "all",
                "seat.driver_mass": "heavy",
                "seat.seat_mass": -1,
                "seat.friction_A": 1,
                "seat.friction_force": 1,
                "shaker.profile": "jump",
                "shaker.bump.speed": float("nan"),
                "nobody.x": 1,
                "plain": 1,
            }
        )
    texts = error.value.problems
    assert len(texts) == 8
    assert "seat.driver_mass: expected a number, got heavy" in texts
    assert "seat.seat_mass: expected a value in [1e-09, inf] kg, got -1" in texts
    assert "seat.friction_force: expected a parameter or an input, got a output" in texts
    assert "shaker.profile: expected one of bump, sine, sweep, random, file, got jump" in texts
    assert "shaker.bump.speed: expected a finite number, got nan" in texts


def test_parameters_are_converted(fmus: Path, pair: System):
    pair.add("controller", fmus / "SeatController.fmu")
    values = pair.check_parameters(
        {
            "shaker.profile": "sine",
            "controller.enabled": "False",
            "seat.driver_mass": "70",
            "seat.force": 3,
            "seat.floor_signals": "velocity",
        }
    )
    assert values == {
        "shaker": {"profile": 2.0},
        "seat": {"driver_mass": 70.0, "force": 3.0, "floor_signals": 3.0},
        "controller": {"enabled": 0.0},
    }


def test_a_connected_input_is_not_a_parameter(pair: System):
    pair.connect("shaker.floor_displacement", "seat.floor_displacement")
    with pytest.raises(SetupError, match=r"seat.floor_displacement: expected a free input, got one that"):
        pair.check_parameters({"seat.floor_displacement": 1.0})


def test_the_order_names_each_component_once(pair: System):
    assert pair.order == ("shaker", "seat")
    pair.order = ("seat", "shaker")
    assert pair.order == ("seat", "shaker")
    with pytest.raises(SetupError, match="order: expected each of shaker, seat once, got seat, seat"):
        pair.order = ("seat", "seat")


def test_only_outputs_are_recorded(pair: System):
    with pytest.raises(SetupError, match="record seat.driver_mass: expected an output"):
        pair.recorded(["seat.driver_mass"])
