"""Values that pass between FMUs: units by definition and by name, differences, narrow types, enumerations."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim import RunError, SetupError, System
from cosim.results.result import Result, StepperName
from tests.helpers.hosts import HOSTS
from tests.helpers.wild import Var, Wild, par, var_in

pytestmark = pytest.mark.builds

H = 0.01

UNITS = {
    "K": '<BaseUnit K="1"/>',
    "degC": '<BaseUnit K="1" offset="273.15"/>',
    "degF": '<BaseUnit K="1" factor="0.5555555555555556" offset="255.3722222222222"/>',
    "m": '<BaseUnit m="1"/>',
}


def defined(*names: str) -> str:
    return (
        "<UnitDefinitions>"
        + "".join(f'<Unit name="{n}">{UNITS.get(n, "")}</Unit>' for n in names)
        + "</UnitDefinitions>"
    )


def unit(name: str, relative: bool = False) -> str:
    return f'unit="{name}"' + (' relativeQuantity="true"' if relative else "")


def pair(
    folder: Path, source: Var, sink: Var, *, calculate: str = "", units: tuple[str, str] = ("", ""), version: int = 3
) -> System:
    """Make a system of an output and an input, which comes out as ``k.seen``."""
    seen = Var("seen", "Real", start=None, initial="calculated", depends=(sink.name,))
    models = {
        "s": Wild([source, par("p")], calculate=calculate, before=units[0]),
        "k": Wild([sink, seen], calculate=f"m->seen[0] = (double)m->{sink.c_name}[0];", before=units[1]),
    }
    system = System()
    for name, model in models.items():
        (folder / name).mkdir(exist_ok=True)
        system.add(name, model.build(folder / name / f"{name}.fmu", version))
    return system


def connected(system: System, source: str = "y", sink: str = "u") -> System:
    system.connect(f"s.{source}", f"k.{sink}")
    system.order = ["s", "k"]
    return system


# ---- units -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize(
    ("source", "sink", "relative", "expected"),
    [
        ("degC", "K", False, 278.15),
        ("degC", "K", True, 5.0),
        ("degF", "K", True, 5.0 / 1.8),
        ("degF", "degC", False, -15.0),
        ("degF", "degC", True, 5.0 / 1.8),
        ("degC", "degC", True, 5.0),
    ],
)
def test_a_difference_is_converted_without_an_offset(
    tmp_path: Path, version: int, source: str, sink: str, relative: bool, expected: float
):
    ends = Var("y", start="5", more=unit(source, relative)), var_in("u", more=unit(sink, relative))
    system = connected(pair(tmp_path, *ends, units=(defined(source), defined(sink)), version=version))
    assert system.simulate(H, H)["k.seen"][-1] == pytest.approx(expected, abs=1e-9)


def test_a_difference_does_not_feed_an_absolute_value(tmp_path: Path):
    ends = Var("y", start="5", more=unit("degC", True)), var_in("u", more=unit("K"))
    system = pair(tmp_path, *ends, units=(defined("degC"), defined("K")))
    with pytest.raises(
        SetupError, match="expected two differences or two absolute values, got a difference in degC and"
    ):
        connected(system)


def test_a_difference_and_a_value_are_the_same_where_no_offset_is(tmp_path: Path):
    ends = Var("y", start="5", more=unit("m", True)), var_in("u", more=unit("m"))
    system = connected(pair(tmp_path, *ends, units=(defined("m"), defined("m"))))
    assert system.simulate(H, H)["k.seen"][-1] == 5.0


def test_a_difference_may_be_declared_by_the_type(tmp_path: Path):
    attributes = 'unit="degC" relativeQuantity="true"'
    types = {
        2: f'<SimpleType name="Delta"><Real {attributes}/></SimpleType>',
        3: f'<Float64Type name="Delta" {attributes}/>',
    }
    for version, text in types.items():
        ends = Var("y", start="5", more='declaredType="Delta"'), var_in("u", more=unit("K", True))
        folder = tmp_path / str(version)
        folder.mkdir()
        system = connected(
            pair(
                folder,
                *ends,
                units=(f"{defined('degC')}<TypeDefinitions>{text}</TypeDefinitions>", defined("K")),
                version=version,
            )
        )
        assert system.simulate(H, H)["k.seen"][-1] == pytest.approx(5.0)


@pytest.mark.parametrize(
    ("source", "sink", "value", "expected"),
    [
        ("mm", "m", "70", 0.07),
        ("km/h", "m/s", "36", 10.0),
        ("bar", "Pa", "2", 2e5),
        ("deg", "rad", "180", 3.141592653589793),
        ("1/min", "Hz", "60", 1.0),
        ("degC", "K", "1", 274.15),
        ("N.m", "J", "3", 3.0),
        ("m/s2", "mm/s2", "1", 1000.0),
    ],
)
@pytest.mark.parametrize("definitions", ["", "names only"])
def test_units_known_by_name_are_converted(
    tmp_path: Path, source: str, sink: str, value: str, expected: float, definitions: str
):
    """FMUs of several tools declare names of units without base units, or no unit at all."""
    ends = Var("y", start=value, more=unit(source)), var_in("u", more=unit(sink))
    named = [
        f'<UnitDefinitions><Unit name="{name}"/></UnitDefinitions>' if definitions else "" for name in (source, sink)
    ]
    system = connected(pair(tmp_path, *ends, units=(named[0], named[1])))
    assert system.simulate(H, H)["k.seen"][-1] == pytest.approx(expected)
    assert not [note for note in system.notes() if "unit" in note]


@pytest.mark.parametrize(("source", "sink"), [("zork", "m"), ("mm", "ell"), ("a b", "c d"), ("100%", "1/2")])
def test_names_that_differ_and_are_not_known_are_reported(tmp_path: Path, source: str, sink: str):
    ends = Var("y", start="70", more=unit(source)), var_in("u", more=unit(sink))
    system = connected(pair(tmp_path, *ends))
    (note,) = [note for note in system.notes() if "unit" in note]
    assert f"units {source} and {sink} are not converted" in note
    assert system.simulate(H, H)["k.seen"][-1] == 70.0


def test_known_units_of_two_dimensions_are_refused(tmp_path: Path):
    ends = Var("y", start="70", more=unit("mm")), var_in("u", more=unit("kg"))
    with pytest.raises(SetupError, match="expected two units of one dimension, got mm and kg"):
        connected(pair(tmp_path, *ends))


def test_a_unit_with_two_definitions_is_converted(tmp_path: Path):
    """The same name, defined as 1 and as 1000 of the base unit."""
    ends = Var("y", start="2", more=unit("t")), var_in("u", more=unit("t"))
    definitions = ('<UnitDefinitions><Unit name="t"><BaseUnit kg="1" factor="1000"/></Unit></UnitDefinitions>',
                   '<UnitDefinitions><Unit name="t"><BaseUnit kg="1"/></Unit></UnitDefinitions>')  # fmt: skip
    system = connected(pair(tmp_path, *ends, units=definitions))
    assert system.simulate(H, H)["k.seen"][-1] == 2000.0


# ---- types -----------------------------------------------------------------------------------------------------------


def run(system: System, host: tuple[StepperName, bool]) -> Result:
    stepper, isolated = host
    return system.simulate(3 * H, H, stepper=stepper, isolate=list(system.models) if isolated else [])


@pytest.mark.parametrize("host", HOSTS)
@pytest.mark.parametrize(
    ("source", "sink", "value", "shown"),
    [
        ("Int32", "Int8", "300", "300"),
        ("Int64", "UInt8", "-1", "-1"),
        ("UInt64", "Int64", "9223372036854775808", "9223372036854775808"),
        ("Int16", "UInt16", "-5", "-5"),
    ],
)
def test_a_value_out_of_the_inputs_range_ends_the_run_with_the_value(
    tmp_path: Path, host: tuple[StepperName, bool], source: str, sink: str, value: str, shown: str
):
    """From the second step on, so that the initialization is past."""
    number = f"{value}u" if source.startswith("U") else value
    calculate = f"if (m->run.time > 0.015) m->y[0] = {number};"
    ends = Var("y", source, start="1", variability="discrete"), var_in("u", sink, "0")
    result = run(connected(pair(tmp_path, *ends, calculate=calculate)), host)
    assert result.error is not None
    assert str(result.error).startswith(("k.u: expected a value in [", "s.y: expected a whole number up to 2^53"))
    assert shown in str(result.error)
    assert len(result.time) >= 1


@pytest.mark.parametrize("host", HOSTS)
def test_a_value_out_of_range_at_the_start_is_an_error(tmp_path: Path, host: tuple[StepperName, bool]):
    ends = Var("y", "Int32", start="300", variability="discrete"), var_in("u", "Int8", "0")
    with pytest.raises(RunError, match=r"k\.u.*300"):
        run(connected(pair(tmp_path, *ends)), host)


@pytest.mark.parametrize("host", HOSTS)
@pytest.mark.parametrize("type_", ["Int64", "UInt64"])
def test_a_value_that_a_double_does_not_have_is_an_error_not_another_value(
    tmp_path: Path, host: tuple[StepperName, bool], type_: str
):
    ends = Var("y", type_, start=str(2**53 + 1), variability="discrete"), var_in("u", type_, "0")
    with pytest.raises(RunError, match=r"9007199254740993|2\^53"):
        run(connected(pair(tmp_path, *ends)), host)


@pytest.mark.parametrize("host", HOSTS)
@pytest.mark.parametrize(
    ("source", "sink", "value"),
    [("Int32", "Int8", -128), ("Int8", "Int64", -7), ("Boolean", "Int8", 1), ("Int8", "Real", -3),
     ("UInt8", "Float32", 255), ("Int64", "Int64", 2**53), ("Boolean", "Real", 1), ("Float32", "Real", 0.5)],
)  # fmt: skip
def test_values_that_fit_arrive(tmp_path: Path, host: tuple[StepperName, bool], source: str, sink: str, value: float):
    variability = None if source in ("Real", "Float32") else "discrete"
    ends = Var("y", source, start=str(value), variability=variability), var_in("u", sink, "0")
    assert run(connected(pair(tmp_path, *ends)), host)["k.seen"][-1] == value


@pytest.mark.parametrize(
    ("source", "sink"),
    [("Real", "Int32"), ("Real", "Boolean"), ("Int8", "Boolean"), ("Int64", "Float32"), ("Float32", "Int8")],
)
def test_types_that_lose_something_are_not_connected(tmp_path: Path, source: str, sink: str):
    variability = None if source in ("Real", "Float32") else "discrete"
    ends = Var("y", source, start="1", variability=variability), var_in("u", sink, "0")
    with pytest.raises(
        SetupError, match=f"connection s.y -> k.u: .*{'Float64' if source == 'Real' else source}.*{sink}"
    ):
        connected(pair(tmp_path, *ends))


def enumeration(items: dict[str, int]) -> str:
    listed = "".join(f'<Item name="{name}" value="{value}"/>' for name, value in items.items())
    return f'<TypeDefinitions><EnumerationType name="Mode">{listed}</EnumerationType></TypeDefinitions>'


def test_enumerations_with_the_same_items_are_connected_and_others_are_not(tmp_path: Path):
    ends = (Var("y", "Enumeration", start="2", variability="discrete", more='declaredType="Mode"'),
            var_in("u", "Enumeration", "1", more='declaredType="Mode"'))  # fmt: skip
    few, many = enumeration({"off": 1, "on": 2}), enumeration({"off": 1, "on": 2, "boost": 3})
    system = connected(pair(tmp_path, *ends, units=(few, many)))
    assert system.simulate(H, H)["k.seen"][-1] == 2.0
    with pytest.raises(
        SetupError, match="expected an enumeration with the items off, on, boost, got one without boost"
    ):
        connected(pair(tmp_path, *ends, units=(many, few)))


def test_an_item_that_the_type_does_not_have_ends_the_run(tmp_path: Path):
    ends = (Var("y", "Int32", start="7", variability="discrete"),
            var_in("u", "Enumeration", "1", more='declaredType="Mode"'))  # fmt: skip
    system = connected(pair(tmp_path, *ends, units=("", enumeration({"off": 1, "on": 2}))))
    with pytest.raises(RunError, match=r"k\.u.*7"):
        system.simulate(H, H)


# ---- parameters ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("type_", "value", "problem"),
    [
        ("Int8", 300, r"expected a value in \[-128, 127\], got 300"),
        ("UInt8", -1, r"expected a value in \[0, 255\], got -1"),
        ("Int64", 2**53 + 1, r"expected a whole number up to 2\^53 either way, got 9007199254740993"),
        ("Int32", 1.5, "expected a whole number, got 1.5"),
        ("Boolean", "maybe", "expected true or false, got maybe"),
        ("Real", "fast", "expected a number, got fast"),
    ],
)
def test_parameters_that_do_not_fit_are_refused(tmp_path: Path, type_: str, value: object, problem: str):
    system = System()
    system.add("a", Wild([par("p", type_, "0"), Var("y", start="0")]).build(tmp_path / "a.fmu", 3))
    with pytest.raises(SetupError, match=f"a.p: {problem}"):
        system.validate(H, H, {"a.p": value})  # type: ignore[dict-item]


def test_a_number_is_never_the_name_of_an_item(tmp_path: Path):
    """An enumeration whose items are named by other numbers."""
    model = Wild(
        [par("p", "Enumeration", "1", more='declaredType="Mode"'), Var("y", start=None, initial="calculated")],
        calculate="m->y[0] = m->p[0];",
        before=enumeration({"3": 1, "2": 3, "1": 2}),
    )
    system = System()
    system.add("a", model.build(tmp_path / "a.fmu", 3))
    assert system.simulate(H, H, {"a.p": 2})["a.y"][-1] == 2.0
    assert system.simulate(H, H, {"a.p": "2"})["a.y"][-1] == 3.0  # a text is the name of an item first


@pytest.mark.parametrize("initial", ["exact", "approx"])
@pytest.mark.parametrize("version", [2, 3])
def test_start_values_of_outputs_are_set(tmp_path: Path, version: int, initial: str):
    output = Var("x", start="1", initial=initial)
    system = System()
    system.add("a", Wild([output], advance="m->x[0] += h;").build(tmp_path / "a.fmu", version))
    result = system.simulate(0.1, 0.1, {"a.x": 5.0})
    assert list(result["a.x"]) == pytest.approx([5.0, 5.1])
