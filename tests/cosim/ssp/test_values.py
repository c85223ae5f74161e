"""Values of parameters: which are applied, by which type, and which are refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim import SetupError, System
from tests.helpers.ssd_text import bindings, component, connection, document, load, system, value

pytestmark = pytest.mark.builds


def entry(source: str, target: str) -> str:
    return f'<ssm:MappingEntry source="{source}" target="{target}"/>'


# ---- mappings --------------------------------------------------------------------------------------------------------


def test_only_mapped_parameters_are_applied(gain: Path, tmp_path: Path):
    given = bindings(value("p", 5.0), value("u", 7.0), mapping=entry("p", "k"))
    loaded = load(tmp_path, document(component("a", inside=given)), gain)
    assert loaded.parameters == {"a.k": 5.0}
    assert loaded.ignored == (f"{tmp_path}/it.ssd: parameters without an entry in the mapping are ignored: u",)


def test_a_mapped_name_is_applied_under_its_new_names_only(gain: Path, tmp_path: Path):
    given = bindings(value("k", 5.0), mapping=entry("k", "u"))
    assert load(tmp_path, document(component("a", inside=given)), gain).parameters == {"a.u": 5.0}
    given = bindings(value("q", 5.0), mapping=entry("q", "u") + entry("q", "k"))
    assert load(tmp_path, document(component("a", inside=given)), gain).parameters == {"a.u": 5.0, "a.k": 5.0}


def test_a_mapping_without_entries_applies_nothing(gain: Path, tmp_path: Path):
    given = bindings(value("k", 5.0), mapping=" ")
    loaded = load(tmp_path, document(component("a", inside=given)), gain)
    assert (loaded.parameters, len(loaded.ignored)) == ({}, 1)


def test_the_prefix_comes_before_the_mapping(gain: Path, tmp_path: Path):
    given = bindings(value("k", 5.0), value("u", 6.0), mapping=entry("x.k", "s.a.k"), attributes='prefix="x."')
    loaded = load(tmp_path, document(system("s", component("a")), inside=given), gain)
    assert loaded.parameters == {"s/a.k": 5.0}
    assert loaded.ignored[0].endswith("without an entry in the mapping are ignored: x.u")


def test_entries_without_a_parameter_are_reported(gain: Path, tmp_path: Path):
    given = bindings(value("q", 5.0), mapping=entry("q", "k") + "".join(entry(f"n{i}", f"m{i}") for i in range(10)))
    loaded = load(tmp_path, document(component("a", inside=given)), gain)
    assert loaded.ignored[0].endswith("entries of the mapping without a parameter are ignored: "
                                      "n0, n1, n2, n3, n4, n5, n6, n7 and 2 more")  # fmt: skip


# ---- types -----------------------------------------------------------------------------------------------------------

TAKEN = [
    ("Real", "Integer", "3", 3.0),
    ("Real", "Boolean", "true", 1.0),
    ("Real", "Boolean", "0", 0.0),
    ("Integer", "Boolean", "true", 1),
    ("Integer", "Real", "-4.0", -4),
    ("Boolean", "Integer", "1", True),
    ("Boolean", "Real", "0.0", False),
    ("Enumeration", "Integer", "2", 2),
    ("Enumeration", "Integer", "1", 1),
    ("Enumeration", "Real", "3.0", 3),
    ("Enumeration", "Enumeration", "2", 3),
    ("Enumeration", "Enumeration", "1", 2),
    ("Enumeration", "Enumeration", "R", 1),
    ("Enumeration", "String", "2", 3),
]

REFUSED = [
    ("Real", "String", "3", "expected a value of type Real, got String 3"),
    ("Real", "Enumeration", "2", "expected a value of type Real, got Enumeration 2"),
    ("Integer", "Real", "2.5", "expected a whole number, got 2.5"),
    ("Integer", "Real", "3e9", r"expected a value in \[-2147483648, 2147483647\], got 3000000000.0"),
    ("Integer", "Enumeration", "1", "expected a value of type Integer, got Enumeration 1"),
    ("Boolean", "Integer", "2", "expected true or false, got 2"),
    ("Boolean", "Real", "0.5", "expected true or false, got 0.5"),
    ("Boolean", "String", "true", "expected a value of type Boolean, got String true"),
    ("Enumeration", "Integer", "4", "expected one of R, 1, 2, got 4"),
    ("Enumeration", "Real", "1.5", "expected one of R, 1, 2, got 1.5"),
    ("Enumeration", "Enumeration", "3", "expected one of R, 1, 2, got 3"),
    ("Enumeration", "Boolean", "true", "expected one of R, 1, 2, got True"),
    ("text", "Real", "1", "expected a value of type String, got Real 1"),
    ("text", "Boolean", "true", "expected a value of type String, got Boolean True"),
]


@pytest.mark.parametrize(("variable", "type_", "given", "expected"), TAKEN)
def test_conversions_that_lose_nothing_are_made(
    typed: Path, tmp_path: Path, variable: str, type_: str, given: str, expected: float
):
    text = document(component("a", "Typed.fmu", bindings(value(variable, given, type_))))
    result = load(tmp_path, text, typed).simulate()
    assert result[f"a.out_{variable}"][-1] == expected
    again = tmp_path / "again.ssp"
    load(tmp_path, text, typed).save(again)
    assert System.load(again).simulate()[f"a.out_{variable}"][-1] == expected


@pytest.mark.parametrize(("variable", "type_", "given", "problem"), REFUSED)
def test_values_that_lose_something_are_refused(
    typed: Path, tmp_path: Path, variable: str, type_: str, given: str, problem: str
):
    text = document(component("a", "Typed.fmu", bindings(value(variable, given, type_))))
    with pytest.raises(SetupError, match=f"parameter {variable}: a.{variable}: {problem}"):
        load(tmp_path, text, typed)


LOSSLESS = {
    ("Integer", "Real"), ("Boolean", "Real"), ("Enumeration", "Real"), ("Boolean", "Integer"),
    ("Enumeration", "Integer"), ("Integer", "Enumeration"),
}  # fmt: skip


@pytest.mark.parametrize("source", ["Real", "Integer", "Boolean", "Enumeration"])
@pytest.mark.parametrize("sink", ["Real", "Integer", "Boolean", "Enumeration"])
def test_connections_between_types(typed: Path, tmp_path: Path, source: str, sink: str):
    joins = connection(("a", f"out_{source}"), ("b", f"in_{sink}"))
    text = document(component("a", "Typed.fmu"), component("b", "Typed.fmu"), joins=joins)
    if source == sink or (source, sink) in LOSSLESS:
        assert len(load(tmp_path, text, typed).connections) == 1
    else:
        with pytest.raises(SetupError, match=f"expected a type that takes {source} without loss, got {sink}"):
            load(tmp_path, text, typed)
