"""Declarations: units, legal combinations, bounds, and what is derived from them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import pytest

from fmus.component import Component
from fmus.units import Dimension, dimension
from fmus.variables import (
    Quantity,
    VariableDeclaration,
    file_parameter,
    group,
    input_,
    left_out_of,
    output,
    parameter,
    record_of,
    same_as,
    variables_of,
)
from seat_cosim.components import COMPONENTS

ALL = [variable for component in COMPONENTS for variable in component.variables]


def test_units_by_name():
    assert dimension("N.s/m") == Dimension(kg=1, s=-1)
    assert dimension("s/kg2") == Dimension(kg=-2, s=1)
    assert dimension("1/m2") == Dimension(m=-2)
    assert dimension("1") == Dimension()


@pytest.mark.parametrize("name", ["furlong", "m^2", "m/s/s", "N m", "2m"])
def test_unknown_units_are_refused(name: str):
    with pytest.raises(ValueError, match="unit"):
        dimension(name)


@pytest.mark.parametrize("component", COMPONENTS, ids=lambda c: c.name)
def test_time_comes_first_and_every_variable_is_described(component: Component):
    assert component.variables[0].name == "time"
    for variable in component.variables:
        assert variable.description
        assert variable.type is not float or variable.unit, f"{variable.name} is physical and has no unit"
        known = {v.name for v in component.variables}
        assert set(variable.dependencies) <= known


def test_names_and_starts_are_those_of_the_contract():
    declared = {(c.name, v.name): v for c in COMPONENTS for v in c.variables}
    expected = {
        ("SeatController", "driver_mass"): (55.0, "kg", "tunable", 20.0, 250.0),
        ("SeatController", "force_limit"): (250.0, "N", "tunable", 0.0, 1e9),
        ("SeatController", "observer_gamma"): (-3e-6, "s/kg2", "fixed", None, -1e-15),
        ("SeatController", "rate_filter_cutoff"): (30.0, "Hz", "fixed", 0.1, 250.0),
        ("SeatController", "K2.rate"): (-134.0, "N.s/m", "fixed", None, None),
        ("SeatController", "driver_mass_max"): (80.0, "kg", "fixed", 20.0, 250.0),
        ("SeatController", "sample_time"): (0.002, "s", "constant", None, None),
        ("SeatPlant", "friction.A"): (6.9321, "1", "fixed", 1e-9, None),
        ("Shaker", "bump.height"): (0.07, "m", "fixed", None, None),
        ("Shaker", "random.class"): (1, None, "fixed", None, None),
        ("Shaker", "random.scale"): (1.0, "1", "fixed", 0.0, None),
        ("Shaker", "random.seed"): (1, None, "fixed", 0, 2**31 - 1),
        ("Shaker", "file.path"): ("example.csv", None, "fixed", None, None),
    }
    for key, values in expected.items():
        v = declared[key]
        assert (v.start, v.unit, v.variability, v.minimum, v.maximum) == values, key


def test_problem_names_variable_range_and_value():
    mass = next(v for v in ALL if v.name == "driver_mass" and v.maximum == 250.0)
    assert mass.problem(55.0) is None
    assert mass.problem(20.0) is None
    assert mass.problem(19.0) == "driver_mass: expected a value in [20.0, 250.0] kg, got 19.0"
    assert mass.problem(float("nan")) == "driver_mass: expected a finite number, got nan"
    assert mass.problem(float("-inf")) == "driver_mass: expected a finite number, got -inf"
    profile = next(v for v in ALL if v.name == "profile")
    assert profile.problem(2) is None
    assert profile.problem(0) == "profile: expected one of 1 (bump), 2 (sine), 3 (sweep), 4 (random), 5 (file), got 0"


def test_contradicting_declarations_are_refused():
    fine = VariableDeclaration("x", "x", float, "input", "continuous", "exact", "An input", unit="m", start=0.0)
    with pytest.raises(ValueError, match="not a legal combination"):
        replace(fine, variability="fixed")
    with pytest.raises(ValueError, match="expected a description"):
        replace(fine, description="")
    with pytest.raises(ValueError, match="furlong"):
        replace(fine, unit="furlong")
    with pytest.raises(ValueError, match=r"start of x: expected a value in \[1, inf\] m, got 0\.0"):
        replace(fine, minimum=1)


def test_a_dataclass_is_the_declaration():
    @dataclass(slots=True)
    class Record:
        push: float = input_("N", "A push", nominal=1.0)
        gain: float = parameter(Quantity(2.0, "1", "K", "here"), "A gain", name="law.gain", tunable=True, minimum=0.0)

    push, gain = variables_of(Record)
    assert (push.name, push.causality, push.unit, push.start) == ("push", "input", "N", 0.0)
    assert (gain.name, gain.field, gain.variability, gain.start) == ("law.gain", "gain", "tunable", 2.0)
    assert gain.description == "A gain; K (here)"
    assert Record().gain == 2.0


# ---- records in records ----------------------------------------------------------------------------------------------


@dataclass(slots=True)
class Spring:
    stiffness: float = parameter(Quantity(2.0, "N/m", "k", "here"), "Stiffness", name="spring.k", minimum=1.0)
    preload: float = parameter(Quantity(0.0, "N", "F_0", "none"), "Preload", added=True)
    steps: int = parameter(3, "Steps")


@dataclass(slots=True)
class Pair:
    gap: float = parameter(Quantity(0.1, "m", "g", "here"), "Gap")
    front: Spring = group(Spring, "front", without=["steps"])
    rear: Spring = group(
        Spring, "rear", starts={"stiffness": Quantity(0.0, "N/m", "k", "soft")}, minimums={"stiffness": 0.0}
    )


@dataclass(slots=True)
class Vehicle:
    left: Pair = group(Pair, "left")
    right: Pair = group(
        Pair, "right", without=["gap", "front.preload"], starts={"rear.stiffness": Quantity(7.0, "N/m", "k", "hard")}
    )


def test_a_record_in_a_record_has_its_names_behind_a_prefix():
    names = {v.name: v for v in variables_of(Pair)}
    assert list(names) == ["gap", "front.spring.k", "front.preload", "rear.spring.k", "rear.preload", "rear.steps"]
    rear = names["rear.spring.k"]
    assert (rear.field, rear.start, rear.minimum, rear.description) == (
        "rear.stiffness",
        0.0,
        0.0,
        "Stiffness; k (soft)",
    )
    assert (names["front.spring.k"].start, names["front.spring.k"].minimum) == (2.0, 1.0)
    assert names["rear.preload"].added
    assert [(v.field, v.start) for v in left_out_of(Pair)] == [("front.steps", 3)]


def test_records_nest_to_any_depth():
    names = [v.name for v in variables_of(Vehicle)]
    assert names[:2] == ["left.gap", "left.front.spring.k"]
    assert "right.gap" not in names
    assert {v.field for v in left_out_of(Vehicle)} == {
        "left.front.steps", "right.gap", "right.front.preload", "right.front.steps",
    }  # fmt: skip
    assert Vehicle().right.rear.stiffness == 7.0
    assert Vehicle().left.rear.stiffness == 0.0


def test_a_record_is_built_from_flat_values():
    values = {v.field: v.start for v in variables_of(Vehicle)}
    assert record_of(Vehicle, values) == Vehicle()
    changed = record_of(Vehicle, {**values, "right.front.stiffness": 4.0})
    assert (changed.right.front.stiffness, changed.right.rear.stiffness, changed.right.gap) == (4.0, 7.0, 0.1)
    assert record_of(Vehicle, {}) == Vehicle()


def test_wrong_groups_are_refused():
    @dataclass
    class File:
        path: str = file_parameter("here.csv", "A file")

    for wrong in ({"without": ["length"]}, {"starts": {"length": 1}}, {"minimums": {"length": 1.0}}):
        with pytest.raises(ValueError, match="group of Spring: expected a field that is no file, got length"):
            group(Spring, **wrong)
    with pytest.raises(ValueError, match="got path"):
        group(File, without=["path"])

    @dataclass
    class Other:
        spring: Spring = group(Spring, "spring", starts={"stiffness": Quantity(2.0, "N/m", "c", "another symbol")})

    with pytest.raises(ValueError, match=r"start of spring\.stiffness: expected its symbol and unit"):
        variables_of(Other)


def test_outputs_of_a_part_depend_on_the_names_in_the_whole():
    @dataclass
    class Part:
        force: float = output("N", "A force", dependencies=["k", "x"], added=True)
        rest: float = output("N", "Another", dependencies=["x"])

    @dataclass
    class Whole:
        part: Part = group(Part, dependencies={"k": ["own.k", "part.k"]})
        again: float = same_as(Part, "force", dependencies=["x"])

    force, rest, again = variables_of(Whole)
    assert (force.name, force.field, force.dependencies) == ("force", "part.force", ("own.k", "part.k", "x"))
    assert (rest.dependencies, again.name, again.dependencies, again.added) == (("x",), "again", ("x",), False)
