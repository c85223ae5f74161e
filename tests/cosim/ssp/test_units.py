"""Units through connectors and parameters: differences, units known by name, units that nobody knows."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim import SetupError
from cosim.engine.network import VariableRef
from tests.helpers.ssd_text import bindings, component, connection, connectors, document, load, system, value
from tests.helpers.wild import Var, Wild, par, var_in

pytestmark = pytest.mark.builds

DEGREES = (
    '<UnitDefinitions><Unit name="K"><BaseUnit K="1"/></Unit>'
    '<Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit>'
    '<Unit name="degF"><BaseUnit K="1" factor="0.5" offset="255"/></Unit></UnitDefinitions>'
)
KELVIN = '<ssd:Units><ssc:Unit name="K"><ssc:BaseUnit K="1"/></ssc:Unit></ssd:Units>'


def temperatures(folder: Path, unit: str, name: str, types: bool = False) -> Path:
    """Build an FMU with a temperature and a difference of two, in a unit: outputs, inputs, parameters."""
    relative = f"unit='{unit}' relativeQuantity='true'"
    before = DEGREES
    if types:
        before += f"<TypeDefinitions><SimpleType name='D'><Real {relative}/></SimpleType></TypeDefinitions>"
        relative = "declaredType='D'"
    variables = [
        Var("dT", more=relative), Var("T", more=f"unit='{unit}'"),
        var_in("in_dT", more=relative), var_in("in_T", more=f"unit='{unit}'"),
        par("dTp", more=relative), par("Tp", more=f"unit='{unit}'"),
        Var("seen_dT"), Var("seen_T"),
    ]  # fmt: skip
    lines = "m->dT[0] = 5; m->T[0] = 20; m->seen_dT[0] = m->in_dT[0]; m->seen_T[0] = m->in_T[0];"
    return Wild(variables, lines, before=before, experiment='stopTime="1" stepSize="0.1"').build(folder / name)


@pytest.mark.parametrize("types", [False, True])
@pytest.mark.parametrize(("unit", "factor"), [("degC", 1.0), ("degF", 0.5)])
def test_differences_arrive_without_an_offset(tmp_path: Path, types: bool, unit: str, factor: float):
    temperatures(tmp_path, unit, "Src.fmu", types)
    temperatures(tmp_path, "K", "Snk.fmu")
    joins = connection(("src", "dT"), ("snk", "in_dT")) + connection(("src", "T"), ("snk", "in_T"))
    loaded = load(tmp_path, document(component("src", "Src.fmu"), component("snk", "Snk.fmu"), joins=joins))
    result = loaded.simulate()
    offset = {"degC": 273.15, "degF": 255.0}[unit]
    assert (result["snk.seen_dT"][-1], result["snk.seen_T"][-1]) == (5.0 * factor, 20.0 * factor + offset)
    assert all(c.explicit == (1.0, 0.0) and c.convert_units for c in loaded.connections.values())


def test_differences_pass_connectors_of_systems(tmp_path: Path):
    temperatures(tmp_path, "degC", "Src.fmu")
    temperatures(tmp_path, "degF", "Snk.fmu")
    inner = system(
        "inner", component("snk", "Snk.fmu"), inside=connectors(d="input Real K", t="input Real K"),
        joins=connection(("", "d"), ("snk", "in_dT")) + connection(("", "t"), ("snk", "in_T")),
    )  # fmt: skip
    joins = connection(("src", "dT"), ("inner", "d")) + connection(("src", "T"), ("inner", "t"))
    result = load(tmp_path, document(component("src", "Src.fmu"), inner, joins=joins, after=KELVIN)).simulate()
    assert result["inner/snk.seen_dT"][-1] == 10.0
    assert result["inner/snk.seen_T"][-1] == pytest.approx((20 + 273.15 - 255.0) / 0.5, rel=1e-14)


def test_a_difference_does_not_feed_an_absolute_value(tmp_path: Path):
    temperatures(tmp_path, "degC", "Src.fmu")
    temperatures(tmp_path, "K", "Snk.fmu")
    for ends, got in (
        (("dT", "in_T"), "a difference in degC and an absolute value in K"),
        (("T", "in_dT"), "an absolute value in degC and a difference in K"),
    ):
        text = document(
            component("src", "Src.fmu"),
            component("snk", "Snk.fmu"),
            joins=connection(("src", ends[0]), ("snk", ends[1])),
        )
        with pytest.raises(SetupError, match=f"expected two differences or two absolute values, got {got}"):
            load(tmp_path, text)


def test_parameters_are_differences_where_their_variables_are(tmp_path: Path):
    temperatures(tmp_path, "K", "Snk.fmu")
    units = '<ssc:Unit name="C"><ssc:BaseUnit K="1" offset="273.15"/></ssc:Unit>'
    inside = connectors(d="parameter Real K", t="parameter Real K")
    inside += bindings(value("d", 5, attributes='unit="C"'), value("t", 5, attributes='unit="C"'), units=units)
    direct = bindings(value("dTp", 7, attributes='unit="C"'), value("Tp", 7, attributes='unit="C"'), units=units)
    joins = connection(("", "d"), ("a", "dTp")) + connection(("", "t"), ("a", "Tp"))
    elements = [component("a", "Snk.fmu"), component("b", "Snk.fmu", direct)]
    loaded = load(tmp_path, document(*elements, inside=inside, joins=joins, after=KELVIN))
    assert loaded.parameters == {"a.dTp": 5.0, "a.Tp": 278.15, "b.dTp": 7.0, "b.Tp": 280.15}


# ---- units known by their names --------------------------------------------------------------------------------------


def lengths(folder: Path, unit: str, name: str) -> Path:
    """Build an FMU with an output of 70, an input that is seen and a parameter, in a unit without a definition."""
    declared = f"unit='{unit}'" if unit else ""
    variables = [Var("y", more=declared), var_in("u", more=declared), par("p", more=declared), Var("seen")]
    lines = "m->y[0] = 70; m->seen[0] = m->u[0];"
    definitions = f"<UnitDefinitions><Unit name='{unit}'/></UnitDefinitions>" if unit else ""
    return Wild(variables, lines, before=definitions, experiment='stopTime="1" stepSize="0.1"').build(folder / name)


@pytest.mark.parametrize(
    ("source", "sink", "seen"),
    [("mm", "m", 0.07), ("km/h", "m/s", 70 / 3.6), ("deg", "rad", 70 * 3.141592653589793 / 180), ("bar", "Pa", 7e6)],
)
def test_units_are_known_by_their_names(tmp_path: Path, source: str, sink: str, seen: float):
    lengths(tmp_path, source, "A.fmu")
    lengths(tmp_path, sink, "B.fmu")
    text = document(component("a", "A.fmu"), component("b", "B.fmu"), joins=connection(("a", "y"), ("b", "u")))
    assert load(tmp_path, text).simulate()["b.seen"][-1] == pytest.approx(seen, rel=1e-14)


def test_a_connector_says_the_unit_that_the_fmu_does_not(tmp_path: Path):
    lengths(tmp_path, "", "A.fmu")
    lengths(tmp_path, "m", "B.fmu")
    joins = connection(("a", "y"), ("b", "u"))
    for unit, seen in (("mm", 0.07), ("km", 70e3), ("m", 70.0)):
        text = document(
            component("a", "A.fmu", connectors(y=f"output Real {unit}")), component("b", "B.fmu"), joins=joins
        )
        loaded = load(tmp_path, text)
        assert loaded.simulate()["b.seen"][-1] == pytest.approx(seen, rel=1e-14)
        assert loaded.ignored == ()


def test_units_that_nobody_knows_are_reported(tmp_path: Path):
    lengths(tmp_path, "", "A.fmu")
    lengths(tmp_path, "m", "B.fmu")
    joins = connection(("a", "y"), ("b", "u"))
    text = document(component("a", "A.fmu", connectors(y="output Real kgps")), component("b", "B.fmu"), joins=joins)
    loaded = load(tmp_path, text)
    (note,) = loaded.ignored
    assert note == "connection a.y -> b.u: units kgps and m are not converted: kgps is not defined and not known"
    assert loaded.simulate()["b.seen"][-1] == 70.0
    text = document(component("b", "B.fmu", connectors(y="output Real kgps")))
    (note,) = load(tmp_path, text).ignored
    assert note.endswith("connector b.y: its unit kgps is ignored, the FMU's is m")


def test_a_connector_that_contradicts_the_fmu_is_refused(tmp_path: Path):
    lengths(tmp_path, "mm", "A.fmu")
    with pytest.raises(SetupError, match="connector a.y: expected the FMU's unit mm, got m of another definition"):
        load(tmp_path, document(component("a", "A.fmu", connectors(y="output Real m"))))


def test_a_system_defines_the_unit_that_the_fmu_only_names(tmp_path: Path):
    lengths(tmp_path, "ell", "A.fmu")
    lengths(tmp_path, "m", "B.fmu")
    ell = '<ssd:Units><ssc:Unit name="ell"><ssc:BaseUnit m="1" factor="0.5"/></ssc:Unit></ssd:Units>'
    elements = [component("a", "A.fmu", connectors(y="output Real ell")), component("b", "B.fmu")]
    text = document(*elements, joins=connection(("a", "y"), ("b", "u")), after=ell)
    assert load(tmp_path, text).simulate()["b.seen"][-1] == 35.0


def test_values_in_units_that_nobody_knows_are_refused(tmp_path: Path):
    lengths(tmp_path, "m", "B.fmu")
    lengths(tmp_path, "", "A.fmu")
    lengths(tmp_path, "lump", "C.fmu")
    given = bindings(value("p", 3, attributes='unit="lump"'))
    with pytest.raises(SetupError, match="parameter p: expected a unit that is defined or known by its name, got lump"):
        load(tmp_path, document(component("b", "B.fmu", given)))
    for fmu in ("A.fmu", "C.fmu"):
        assert load(tmp_path, document(component("b", fmu, given))).parameters == {"b.p": 3.0}
    given = bindings(value("p", 3, attributes='unit="mm"'))
    assert load(tmp_path, document(component("b", "B.fmu", given))).parameters == {"b.p": 0.003}


def test_suppressed_conversions_take_values_as_they_are(tmp_path: Path):
    lengths(tmp_path, "mm", "A.fmu")
    lengths(tmp_path, "m", "B.fmu")
    joins = connection(("a", "y"), ("b", "u"), attributes='suppressUnitConversion="true"')
    loaded = load(tmp_path, document(component("a", "A.fmu"), component("b", "B.fmu"), joins=joins))
    assert loaded.simulate()["b.seen"][-1] == 70.0
    assert not loaded.connections[VariableRef("b", "u")].convert_units
