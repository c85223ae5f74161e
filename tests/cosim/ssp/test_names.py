"""Names of elements, connectors and parameters: any characters, one name for many, many of one name."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from cosim import SetupError, System
from cosim.engine.editing import edit
from cosim.engine.network import VariableRef
from tests.helpers.ssd_text import (
    bindings,
    component,
    connection,
    connector,
    connectors,
    document,
    load,
    parameter_set,
    system,
    value,
)
from tests.helpers.wild import Var, Wild, par, var_in

pytestmark = pytest.mark.builds

ODD = ["se.at", "1", "a b", "a=b", "2*a", "a-1", "a,b", 'a"b', "[/b]", "é", "a/b", "..", "y[1]", "#", "%41", "a:b"]


@pytest.mark.parametrize("name", ODD)
def test_components_may_have_any_name(gain: Path, tmp_path: Path, name: str):
    given = value(f"{name}.k", 2.0)
    joins = connection((name, "y"), ("after", "u"))
    loaded = load(tmp_path, document(component(name), component("after"), inside=bindings(given), joins=joins), gain)
    assert loaded.connections[VariableRef("after", "u")].source == (name, "y")
    parameters = {f"{name}.u": 3.0}
    result = loaded.simulate(parameters=parameters, record=[f"{name}.y", "after.y"])
    assert (set(result[f"{name}.y"]), set(result["after.y"])) == ({6.0}, {6.0})
    loaded.save(tmp_path / "again.ssp")
    again = System.load(tmp_path / "again.ssp")
    assert (again.connections, again.parameters) == (loaded.connections, {f"{name}.k": 2.0})
    assert set(again.simulate(parameters=parameters)["after.y"]) == {6.0}
    edit(again, {}, ["after.u"], [f"2*{name}.y = after.u"])
    assert again.connections[VariableRef("after", "u")].transformation.factor == 2.0
    if '"' not in name:
        edit(again, {}, ["after.u"], [f'-3*"{name}.y" + 0.5 = "after.u"'])
        assert again.connections[VariableRef("after", "u")].transformation == (-3.0, 0.5)


def test_fmus_of_components_with_odd_names_are_kept_apart(gain: Path, tmp_path: Path):
    names = ["a/b", "a-b", "a:b", ".."]
    made = System()
    for i, name in enumerate(names):
        folder = tmp_path / str(i)
        folder.mkdir()
        fmu = Wild([var_in("u"), par("k", start=str(i)), Var("y")], f"m->y[0] = {i};").build(folder / "Gain.fmu")
        made.add(name, fmu)
    made.save(tmp_path / "it.ssp")
    with zipfile.ZipFile(tmp_path / "it.ssp") as archive:
        fmus = [name for name in archive.namelist() if name.endswith(".fmu")]
    assert len(set(map(str.lower, fmus))) == len(names)
    loaded = System.load(tmp_path / "it.ssp")
    assert [model.variables["k"].start for model in loaded.models.values()] == ["0", "1", "2", "3"]


def test_names_that_mean_two_variables_are_refused(tmp_path: Path):
    short = Wild([var_in("b.u"), Var("y")]).build(tmp_path / "Short.fmu")
    long = Wild([var_in("u"), Var("z")]).build(tmp_path / "Long.fmu")
    for order in (("a", "a.b"), ("a.b", "a")):
        elements = [component(name, "Short.fmu" if name == "a" else "Long.fmu") for name in order]
        with pytest.raises(SetupError, match=r"expected names that differ from those of a.*, got a.b.u in both"):
            load(tmp_path, document(*elements))
    made = System()
    made.add("a", short)
    made.add("a.b.c", long)
    made.add("a.c", long)
    with pytest.raises(SetupError, match=r"component a.b: expected names that differ from those of a, got a.b.u in"):
        made.add("a.b", long)
    assert list(made.models) == ["a", "a.b.c", "a.c"]


# ---- one name for many -----------------------------------------------------------------------------------------------


def test_a_value_is_applied_to_all_of_its_name(gain: Path, tmp_path: Path):
    inside = connectors(**{"s.k": "parameter"}) + bindings(value("s.k", 9.0))
    joins = connection(("", "s.k"), ("other", "k"))
    text = document(component("s"), component("other"), inside=inside, joins=joins)
    assert load(tmp_path, text, gain).parameters == {"s.k": 9.0, "other.k": 9.0}


def test_names_of_nested_systems_and_dotted_components_are_all_reached(gain: Path, tmp_path: Path):
    inner = system("B", component("C"), component("C.D"), inside=connectors(**{"C.k": "parameter"}),
                   joins=connection(("", "C.k"), ("C.D", "k")))  # fmt: skip
    text = document(component("B.C"), inner, inside=bindings(value("B.C.k", 4.0)))
    assert load(tmp_path, text, gain).parameters == {"B.C.k": 4.0, "B/C.k": 4.0, "B/C.D.k": 4.0}


def test_a_mapped_name_is_applied_to_all_of_it(gain: Path, tmp_path: Path):
    mapping = '<ssm:MappingEntry source="q" target="s.k"><ssc:LinearTransformation factor="2"/></ssm:MappingEntry>'
    inside = connectors(**{"s.k": "parameter"}) + bindings(value("q", 9.0), mapping=mapping)
    text = document(component("s"), component("o"), inside=inside, joins=connection(("", "s.k"), ("o", "k")))
    assert load(tmp_path, text, gain).parameters == {"s.k": 18.0, "o.k": 18.0}


def test_a_systems_output_of_the_same_name_takes_no_value(gain: Path, tmp_path: Path):
    inside = connectors(**{"s.k": "output"}) + bindings(value("s.k", 9.0))
    assert load(tmp_path, document(component("s"), inside=inside), gain).parameters == {"s.k": 9.0}


# ---- many of one name ------------------------------------------------------------------------------------------------

TWICE = {
    "components": (document(component("a"), component("a")), "element a: expected a new name"),
    "a component and a system": (document(component("a"), system("a")), "element a: expected a new name"),
    "systems": (document(system("a"), system("a", component("b"))), "element a: expected a new name"),
    "a dictionary": (
        document(component("a"), '<ssd:SignalDictionaryReference name="a" dictionary="d"/>'),
        "element a: expected a new name",
    ),
    "inner elements": (document(system("s", component("a"), component("a"))), "element s.a: expected a new name"),
    "a failed component": (
        document(component("a", attributes='type="x/y"'), component("a")),
        "element a: expected a new name",
    ),
    "a system and its path": (
        document(component("s/a"), system("s", component("a"))),
        "component s/a: expected a new name",
    ),
    "connectors": (
        document(component("a", inside=f"<ssd:Connectors>{connector('u', 'input') * 2}</ssd:Connectors>")),
        "connector a.u: expected a new name",
    ),
    "connectors of two kinds": (
        document(
            inside=f"<ssd:Connectors>{connector('x', 'input')}{connector('x', 'output')}</ssd:Connectors>",
        ),
        "connector x: expected a new name",
    ),
    "parameters": (
        document(component("a", inside=bindings(value("k", 1.0), value("k", 2.0)))),
        "parameter k: expected one of this name, got 2",
    ),
    "parameters of two types": (
        document(component("a", inside=bindings(value("k", 1.0), value("k", 2, "Integer"), value("k", 3.0)))),
        "parameter k: expected one of this name, got 3",
    ),
    "units": (
        document(
            component("a"),
            after='<ssd:Units><ssc:Unit name="x"><ssc:BaseUnit m="1"/></ssc:Unit>'
            '<ssc:Unit name="x"><ssc:BaseUnit s="1"/></ssc:Unit></ssd:Units>',
        ),
        "unit x: expected one definition, got 2",
    ),
    "targets of a mapping": (
        document(
            component(
                "a",
                inside=bindings(
                    value("p", 1.0),
                    value("q", 2.0),
                    mapping='<ssm:MappingEntry source="p" target="k"/><ssm:MappingEntry source="q" target="k"/>',
                ),
            )
        ),
        "mapping to k: expected one entry, got 2",
    ),
}


@pytest.mark.parametrize("case", TWICE)
def test_names_that_occur_twice_are_refused(gain: Path, tmp_path: Path, case: str):
    text, problem = TWICE[case]
    with pytest.raises(SetupError, match=problem):
        load(tmp_path, text, gain)


def test_a_unit_may_be_repeated_and_a_name_reused_elsewhere(gain: Path, tmp_path: Path):
    unit = '<ssc:Unit name="x"><ssc:BaseUnit m="1"/></ssc:Unit>'
    text = document(
        component("a"),
        system("s", component("a")),
        system("t", component("a")),
        after=f"<ssd:Units>{unit * 2}</ssd:Units>",
    )
    assert list(load(tmp_path, text, gain).models) == ["a", "s/a", "t/a"]


def test_a_parameter_file_for_a_run_names_each_parameter_once(gain: Path, tmp_path: Path):
    from cosim.ssp import read_parameters
    from tests.helpers.ssd_text import NAMESPACES

    loaded = load(tmp_path, document(component("a")), gain)
    path = tmp_path / "p.ssv"
    path.write_text(parameter_set(value("a.k", 1.0), value("a.k", 1.0), root=NAMESPACES))
    with pytest.raises(SetupError, match=r"p.ssv: parameter a.k: expected one of this name, got 2"):
        read_parameters(path, loaded)
