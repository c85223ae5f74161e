"""Sources of components and parameters: URIs that stay within the package's folder are read, all others are refused."""

from __future__ import annotations

import shutil
import zipfile
from pathlib import Path

import pytest

from cosim import SetupError, System
from cosim.ssp.package import DESCRIPTION
from tests.helpers.ssd_text import NAMESPACES, component, document, load, parameter_set, value

pytestmark = pytest.mark.builds

INSIDE = [
    "resources/My Gain.fmu",
    "resources/My%20Gain.fmu",
    "./resources/./My%20Gain.fmu",
    "resources/../resources/My%20Gain.fmu",
    "other/../resources/My Gain.fmu",
    "resources//My%20Gain.fmu",
    "%72esources/My%20G%61in.fmu",
    "file:resources/My%20Gain.fmu",
    "file:./resources/My Gain.fmu",
    "FILE:resources/My%20Gain.fmu",
]

OUTSIDE = [
    "../Gain.fmu",
    "resources/../../Gain.fmu",
    "%2e%2e/Gain.fmu",
    "resources/%2E%2E%2f..%2fGain.fmu",
    "file:../Gain.fmu",
    "file:///etc/passwd",
    "file://host/resources/My%20Gain.fmu",
    "/resources/My Gain.fmu",
    "http://localhost/Gain.fmu",
    "proxy-fmu://localhost?file=../Gain.fmu",
    "resources\\My Gain.fmu",
    "C:/Gain.fmu",
    "resources/My%20Gain.fmu?x=1",
    "resources/My%00Gain.fmu",
    "resources/..",
    ".",
]


@pytest.fixture
def folder(gain: Path, tmp_path: Path) -> Path:
    """A folder with an FMU in ``resources``, beside one that is outside."""
    (tmp_path / "system" / "resources").mkdir(parents=True)
    shutil.copy(gain, tmp_path / "system" / "resources" / "My Gain.fmu")
    shutil.copy(gain, tmp_path / "Gain.fmu")
    return tmp_path / "system"


def packed(folder: Path, text: str) -> Path:
    """Pack a folder and a description."""
    path = folder.parent / "it.ssp"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(DESCRIPTION, text)
        for file in sorted(folder.glob("*/*")):
            archive.write(file, file.relative_to(folder).as_posix())
    return path


@pytest.mark.parametrize("source", INSIDE)
def test_sources_inside_the_folder_are_read(folder: Path, source: str):
    text = document(component("a", source))
    assert load(folder, text).models["a"].path.name == "My Gain.fmu"
    assert System.load(packed(folder, text)).models["a"].member == "resources/My Gain.fmu"


@pytest.mark.parametrize("source", OUTSIDE)
def test_sources_outside_the_folder_are_refused_by_name(folder: Path, source: str):
    text = document(component("a", source))
    for made in (lambda: load(folder, text), lambda: System.load(packed(folder, text))):
        with pytest.raises(SetupError) as error:
            made()
        (problem,) = error.value.problems
        assert problem.endswith(f"expected a source in the folder of the description, got {source!r}")


def test_a_file_uri_may_name_the_folder(folder: Path, monkeypatch: pytest.MonkeyPatch):
    fmu = folder / "resources" / "My Gain.fmu"
    for uri in (fmu.as_uri(), fmu.as_uri().replace("file://", "file://localhost")):
        text = document(component("a", uri))
        assert load(folder, text).models["a"].path.name == fmu.name
        monkeypatch.chdir(folder)
        assert System.load("it.ssd").models["a"].path.name == fmu.name
        with pytest.raises(SetupError, match="expected a source in the folder"):
            System.load(packed(folder, text))
    beside = folder.with_name("system2")
    beside.mkdir()
    with pytest.raises(SetupError, match="expected a source in the folder"):
        load(beside, text)


def test_files_of_parameters_and_mappings_are_found_likewise(folder: Path):
    given = parameter_set(value("q", 3.0), root=NAMESPACES)
    (folder / "resources" / "p 1.ssv").write_text(given)
    mapping = f'<ssm:ParameterMapping version="1.0" {NAMESPACES}><ssm:MappingEntry source="q" target="k"/>'
    (folder / "resources" / "m.ssm").write_text(f"{mapping}</ssm:ParameterMapping>")
    bound = (
        '<ssd:ParameterBindings><ssd:ParameterBinding source="x/../resources/p%201.ssv">'
        '<ssd:ParameterMapping source="file:resources/m.ssm"/></ssd:ParameterBinding></ssd:ParameterBindings>'
    )
    text = document(component("a", INSIDE[0], bound))
    assert load(folder, text).parameters == {"a.k": 3.0}
    assert System.load(packed(folder, text)).parameters == {"a.k": 3.0}
    with pytest.raises(SetupError, match="got '../p.ssv'"):
        load(folder, text.replace("x/../resources/p%201.ssv", "../p.ssv"))
