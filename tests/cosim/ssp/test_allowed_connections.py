"""Connections by the kinds of their ends: SSP 1.0's table of allowed connections, all pairs of it."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import pytest

from cosim import SetupError
from cosim.engine.network import VariableRef
from tests.helpers.ssd_text import bindings, component, connection, connectors, document, load, system, value

pytestmark = pytest.mark.builds

KINDS = {"input": "in_Real", "output": "out_Real", "parameter": "Real", "calculatedParameter": "early"}
"""Kind to the variable of that kind."""

ALLOWED = {
    ("system", "parameter", "system", "calculatedParameter"),
    ("system", "parameter", "system", "output"),
    ("system", "input", "system", "output"),
    ("system", "parameter", "element", "parameter"),
    ("system", "parameter", "element", "input"),
    ("system", "input", "element", "input"),
    ("element", "calculatedParameter", "element", "input"),
    ("element", "output", "element", "input"),
    ("element", "calculatedParameter", "system", "calculatedParameter"),
    ("element", "calculatedParameter", "system", "output"),
    ("element", "output", "system", "output"),
}
"""Without those between a calculated parameter and a parameter of two components, which are not supported."""

ENDS = [(owner, kind) for owner in ("system", "element") for kind in KINDS]


@pytest.mark.parametrize(("start", "end"), list(product(ENDS, ENDS)))
def test_all_pairs_of_kinds(typed: Path, tmp_path: Path, start: tuple[str, str], end: tuple[str, str]):
    names = [
        ("", f"{side}{kind}") if owner == "system" else (side, KINDS[kind])
        for side, (owner, kind) in (("a", start), ("b", end))
    ]
    inside = connectors(
        **{name: kind for (_, kind), (owner, name) in zip((start, end), names, strict=True) if not owner}
    )
    elements = [component("a", "Typed.fmu"), component("b", "Typed.fmu")]
    text = document(*elements, inside=inside.replace("<ssd:Connectors></ssd:Connectors>", ""), joins=connection(*names))
    if {(*start, *end), (*end, *start)} & ALLOWED:
        assert len(load(tmp_path, text, typed).connections) == (start[0] == end[0] == "element")
        return
    with pytest.raises(SetupError) as error:
        load(tmp_path, text, typed)
    (problem,) = error.value.problems
    both = {start, end} == {("element", "calculatedParameter"), ("element", "parameter")}
    expected = "expected an output and an input, got a calculated parameter" if both else "expected a source and a sink"
    assert expected in problem


def test_a_systems_parameter_feeds_inputs_and_parameters(gain: Path, tmp_path: Path):
    inside = connectors(p="parameter", q="parameter") + bindings(value("p", 3.0), value("q", 2.0))
    joins = connection(("", "p"), ("a", "u")) + connection(("b", "u"), ("", "p")) + connection(("", "q"), ("a", "k"))
    loaded = load(tmp_path, document(component("a"), component("b"), inside=inside, joins=joins), gain)
    assert loaded.parameters == {"a.u": 3.0, "b.u": 3.0, "a.k": 2.0}
    result = loaded.simulate()
    assert (set(result["a.y"]), set(result["b.y"])) == ({6.0}, {3.0})
    assert not [warning for warning in result.warnings if "not connected" in warning]


def test_a_parameter_passes_a_system_to_an_input_outside(gain: Path, tmp_path: Path):
    inner = system(
        "inner",
        inside=connectors(p="parameter", out="output", c="calculatedParameter") + bindings(value("p", 3.0)),
        joins=connection(("", "p"), ("", "out")) + connection(("", "c"), ("", "p")),
    )
    joins = connection(("inner", "out"), ("a", "u"), '<ssc:LinearTransformation factor="2"/>')
    joins += connection(("inner", "c"), ("a", "k"))
    loaded = load(tmp_path, document(component("a"), inner, joins=joins), gain)
    assert loaded.parameters == {"a.u": 6.0, "a.k": 3.0}
    assert set(loaded.simulate()["a.y"]) == {18.0}


def test_a_calculated_parameter_feeds_an_input(typed: Path, gain: Path, tmp_path: Path):
    inner = system(
        "inner",
        component("t", "Typed.fmu", bindings(value("Real", 0.5))),
        inside=connectors(c="calculatedParameter"),
        joins=connection(("t", "early"), ("", "c")),
    )
    joins = connection(("inner", "c"), ("a", "u"), '<ssc:LinearTransformation offset="1"/>')
    loaded = load(tmp_path, document(component("a"), inner, joins=joins), typed, gain)
    assert loaded.connections[VariableRef("a", "u")].source == ("inner/t", "early")
    for stepper in ("python", None):
        result = loaded.simulate(stepper=stepper)
        assert set(result["a.y"]) == {6.0}
        assert "inner/t.early" not in result.values
    assert set(loaded.simulate(isolate=["inner/t"])["a.y"]) == {6.0}
    loaded.save(tmp_path / "again.ssp")
    assert type(loaded).load(tmp_path / "again.ssp").connections == loaded.connections


def test_a_calculated_parameter_does_not_set_a_parameter_through_systems_either(typed: Path, tmp_path: Path):
    inner = system(
        "inner", component("t", "Typed.fmu"), inside=connectors(c="calculatedParameter"),
        joins=connection(("t", "early"), ("", "c")),
    )  # fmt: skip
    text = document(component("a", "Typed.fmu"), inner, joins=connection(("inner", "c"), ("a", "Real")))
    with pytest.raises(SetupError, match=r"inner.t.early -> a.Real: expected an output and an input, got a calculated"):
        load(tmp_path, text, typed)


def test_a_value_that_reaches_nothing_is_reported(gain: Path, tmp_path: Path):
    inside = connectors(p="parameter") + bindings(value("p", 3.0))
    loaded = load(tmp_path, document(component("a"), inside=inside), gain)
    assert loaded.ignored == (f"{tmp_path}/it.ssd: parameter p: ignored, as p is connected to no component",)


def test_connectors_of_kind_inout_are_refused(gain: Path, tmp_path: Path):
    text = document(component("a"), inside=connectors(x="inout"), joins=connection(("", "x"), ("a", "u")))
    with pytest.raises(SetupError, match="expected an input and an output, got a connector of kind inout"):
        load(tmp_path, text, gain)
