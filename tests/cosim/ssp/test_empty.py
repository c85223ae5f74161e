"""What is empty is absent, as some tools write it."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim import SetupError
from tests.helpers.ssd_text import bindings, component, connection, connector, document, load, system, value

pytestmark = pytest.mark.builds

JOIN = connection(("a", "y"), ("b", "u"))


def with_connector(unit: str) -> str:
    return f"<ssd:Connectors>{connector('y', 'output', unit=unit)}</ssd:Connectors>"


def test_empty_units_are_none(gain: Path, tmp_path: Path):
    text = document(component("a", inside=with_connector("")), component("b", inside=with_connector(" ")), joins=JOIN)
    result = load(tmp_path, text, gain).simulate(parameters={"a.u": 3.0, "a.k": 2.0, "b.k": 5.0})
    assert (result["a.y"][-1], result["b.y"][-1]) == (6.0, 30.0)


def test_an_empty_element_of_a_connection_is_the_system(gain: Path, tmp_path: Path):
    joins = connection(("", "in"), ("a", "u")).replace("startConnector", 'startElement="" startConnector')
    inside = f"<ssd:Connectors>{connector('in', 'input', unit='')}</ssd:Connectors>" + bindings(value("in", 4.0))
    loaded = load(tmp_path, document(component("a"), inside=inside, joins=joins), gain)
    assert loaded.parameters == {"a.u": 4.0}
    swapped = joins.replace("start", "x").replace("end", "start").replace("x", "end")
    assert load(tmp_path, document(component("a"), inside=inside, joins=swapped), gain).parameters == {"a.u": 4.0}


@pytest.mark.parametrize(
    ("written", "empty"),
    [
        ('startTime="0"', 'startTime=""'),
        ('stopTime="2"', 'stopTime=""'),
        ("<ssd:Component ", '<ssd:Component type="" implementation="" description="" id="" '),
        ("<ssd:Connection ", '<ssd:Connection suppressUnitConversion="" description="" '),
        ("<ssd:ParameterBinding ", '<ssd:ParameterBinding source="" sourceBase="" prefix="" type="" '),
        ("<ssv:Real ", '<ssv:Real unit="" '),
        ("<ssd:ParameterMapping>", '<ssd:ParameterMapping source="" sourceBase="" type="">'),
        ("<ssm:MappingEntry ", '<ssm:MappingEntry suppressUnitConversion="" '),
        ("<ssc:LinearTransformation ", '<ssc:LinearTransformation offset="" '),
        ("<ssd:SystemStructureDescription ", '<ssd:SystemStructureDescription author="" generationDateAndTime="" '),
        ("<ssd:Elements>", "<ssd:ParameterBindings/><ssd:Elements>"),
        ("</ssd:System>", "<ssd:SignalDictionaries/><ssd:GraphicalElements/><ssd:Annotations/></ssd:System>"),
        ("<ssd:DefaultExperiment", "<ssd:Enumerations/><ssd:Units/><ssd:DefaultExperiment"),
        ("</ssv:Parameters>", "</ssv:Parameters><ssv:Enumerations/><ssv:Units></ssv:Units>"),
    ],
)
def test_whatever_is_empty_is_absent(gain: Path, tmp_path: Path, written: str, empty: str):
    mapped = '<ssm:MappingEntry source="q" target="k"/>'
    text = document(
        component("a", inside=bindings(value("q", 2.0), mapping=mapped)),
        component("b"),
        joins=connection(("a", "y"), ("b", "u"), '<ssc:LinearTransformation factor="3"/>'),
        after='<ssd:DefaultExperiment startTime="0" stopTime="2"/>',
    )
    assert written in text
    loaded = load(tmp_path, text.replace(written, empty), gain)
    assert loaded.parameters == {"a.k": 2.0}
    assert [c.transformation.factor for c in loaded.connections.values()] == [3.0]
    assert loaded.clock().stop_time == (1.0 if empty == 'stopTime=""' else 2.0)


def test_systems_without_anything_are_read(gain: Path, tmp_path: Path):
    nothing = "<ssd:Connectors/><ssd:Elements/><ssd:Connections></ssd:Connections>"
    text = document(component("a"), system("empty", inside=nothing))
    assert list(load(tmp_path, text, gain).models) == ["a"]


@pytest.mark.parametrize(
    ("written", "empty", "problem"),
    [
        ('source="Gain.fmu"', 'source=""', "expected a source in the folder of the description, got ''"),
        ('startConnector="y"', 'startConnector=""', "a.: expected a variable of Gain.fmu, got none"),
        ('name="a"', 'name=""', "attribute 'name': .* allowed minimum length of '1'"),
        ('version="1.0" name', 'version="" name', "expected version 1.0 or 2.0, got none"),
    ],
)
def test_what_is_required_must_not_be_empty(gain: Path, tmp_path: Path, written: str, empty: str, problem: str):
    text = document(component("a"), component("b"), joins=JOIN).replace(written, empty, 1)
    with pytest.raises(SetupError, match=problem):
        load(tmp_path, text, gain)


def test_an_empty_text_is_a_value(typed: Path, tmp_path: Path):
    text = document(component("a", "Typed.fmu", bindings(value("text", "", "String"))))
    assert load(tmp_path, text, typed).parameters == {"a.text": ""}


@pytest.mark.parametrize(
    "written", ["<ssc:Enumeration/>", '<ssc:Enumeration name=""/>', '<ssc:Enumeration name="Gear"/>']
)
def test_an_enumeration_needs_no_name(typed: Path, tmp_path: Path, written: str):
    inside = (
        f'<ssd:Connectors><ssd:Connector name="in_Enumeration" kind="input">{written}</ssd:Connector></ssd:Connectors>'
    )
    joins = connection(("a", "out_Integer"), ("b", "in_Enumeration"))
    text = document(component("a", "Typed.fmu"), component("b", "Typed.fmu", inside), joins=joins)
    assert len(load(tmp_path, text, typed).connections) == 1
