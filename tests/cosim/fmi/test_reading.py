"""What the master reads in a model description: lists with any white space, and names that stand for one variable."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from cosim.engine.dependencies import declared_dependencies
from cosim.errors import SetupError
from cosim.fmi.description import ModelDescription
from tests.helpers.faulty import library_member
from tests.helpers.reference_fmus import description

WHITE = ("{} {}", "{}  {}", " {} {} ", "{}\t{}", "{}\n{}", "{}&#10;{}", "&#9;{}&#13; {}&#32;")
"""Two items of a list, as XML schema separates them."""


def read(tmp_path: Path, fmi: int, *changes: str, model: str = "dahlquist") -> ModelDescription:
    """Read a reference model's description, with texts replaced by others, in pairs."""
    xml = description(model, fmi)
    for old, new in zip(changes[::2], changes[1::2], strict=True):
        assert old in xml, old
        xml = xml.replace(old, new, 1)
    path = tmp_path / "Model.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", xml)
        archive.writestr(library_member("reference", fmi), b"")
    return ModelDescription.read(path)


@pytest.mark.parametrize("white", WHITE)
@pytest.mark.parametrize(("fmi", "key", "first", "second"), [(2, "index", 2, 4), (3, "valueReference", 1, 3)])
def test_lists_may_have_any_white_space(tmp_path: Path, fmi: int, key: str, first: int, second: int, white: str):
    place = {2: 3, 3: 2}[fmi]
    old = f'{key}="{place}" dependencies="{first} {second}"'
    new = f'{key}="{place}" dependencies="{white.format(first, second)}"'
    new += f' dependenciesKind="{white.format("dependent", "constant")}"'
    found = read(tmp_path, fmi, old, new)
    assert declared_dependencies(found, "initialization") == {"der(x)": {"x", "k"}}
    (unknown,) = (u for u in found.description.initialUnknowns if u.variable.name == "der(x)")
    assert unknown.dependenciesKind == ["dependent", "constant"]


@pytest.mark.parametrize("white", ["", " ", "   ", "&#9;", "\n"])
@pytest.mark.parametrize("fmi", [2, 3])
def test_a_list_of_white_space_is_empty(tmp_path: Path, fmi: int, white: str):
    found = read(tmp_path, fmi, 'dependencies=""', f'dependencies="{white}"')
    assert declared_dependencies(found, "step")["x"] == set()


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_list_of_anything_else_is_an_error(tmp_path: Path, fmi: int):
    with pytest.raises(SetupError, match=r"Model\.fmu: expected a readable modelDescription\.xml"):
        read(tmp_path, fmi, 'dependencies=""', 'dependencies="1, 2"')


@pytest.mark.parametrize("fmi", [2, 3])
def test_two_variables_of_one_name_are_refused_by_it(tmp_path: Path, fmi: int):
    with pytest.raises(SetupError, match=r"Model\.fmu: k: expected one variable of this name, got 2$"):
        read(tmp_path, fmi, 'name="u"', 'name="k"')


@pytest.mark.parametrize("fmi", [2, 3])
def test_three_variables_of_one_name_are_one_error(tmp_path: Path, fmi: int):
    with pytest.raises(SetupError, match="k: expected one variable of this name, got 3") as caught:
        read(tmp_path, fmi, 'name="u"', 'name="k"', 'name="time"', 'name="k"')
    assert len(caught.value.args) == 1


def test_an_alias_of_a_variables_name_is_refused_by_it(tmp_path: Path):
    alias = '<Alias name="k"/></Float64>'
    with pytest.raises(SetupError, match="k: expected one variable of this name, got 2"):
        read(tmp_path, 3, 'start="0"/>', f'start="0">{alias}')


def test_two_aliases_of_one_name_are_refused_by_it(tmp_path: Path):
    with pytest.raises(SetupError, match="v: expected one variable of this name, got 2"):
        read(tmp_path, 3, 'start="0"/>', 'start="0"><Alias name="v"/><Alias name="v"/></Float64>')


def test_names_that_differ_in_capitals_are_two(tmp_path: Path):
    assert {"k", "K"} <= set(read(tmp_path, 2, 'name="u"', 'name="K"').variables)
