"""Built FMUs: valid, reproducible, complete."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu

import fmus.export.build as builder
from fmus.component import Component
from fmus.export.build import BuildError, build_python_fmu, source_files
from seat_cosim.components import COMPONENTS, EXPERIMENT, build
from tests.helpers.paths import ROOT

NAMES = [component.name for component in COMPONENTS]


@pytest.mark.parametrize("name", NAMES)
def test_fmpy_validate_finds_nothing(fmus: Path, name: str):
    assert validate_fmu(str(fmus / f"{name}.fmu")) == []


def test_builds_are_bit_identical_wherever_they_are_made(fmus: Path, tmp_path: Path):
    for built in build(tmp_path / "elsewhere", ["python"]):
        assert built.fresh
        assert built.path.read_bytes() == (fmus / built.path.name).read_bytes()


def test_an_fmu_of_the_same_content_is_left_alone(fmus: Path):
    before = (fmus / "Shaker.fmu").stat().st_mtime_ns
    assert not any(built.fresh for built in build(fmus.parent, ["python"]))
    assert (fmus / "Shaker.fmu").stat().st_mtime_ns == before


def test_a_broken_fmu_is_built_again(fmus: Path, tmp_path: Path):
    (tmp_path / "Shaker.fmu").write_bytes(b"no archive")
    built = build_python_fmu(COMPONENTS[NAMES.index("Shaker")], EXPERIMENT, tmp_path)
    assert built.fresh
    assert built.path.read_bytes() == (fmus / "Shaker.fmu").read_bytes()


def test_the_guid_follows_the_sources(fmus: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    component = COMPONENTS[NAMES.index("Shaker")]
    sources = source_files(component.module, "fmus.pythonfmu.component_slave")
    changed = tmp_path / "shaker.py"
    changed.write_bytes(sources["plant_models/shaker/shaker.py"].read_bytes() + b"\n# a change\n")
    monkeypatch.setattr(builder, "source_files", lambda *_: {**sources, "plant_models/shaker/shaker.py": changed})
    built = build_python_fmu(component, EXPERIMENT, tmp_path / "new")
    guids = {fmpy.read_model_description(str(path)).guid for path in (built.path, fmus / "Shaker.fmu")}
    assert len(guids) == 2


@pytest.mark.parametrize("component", COMPONENTS, ids=lambda c: c.name)
def test_description_agrees_with_the_declaration(fmus: Path, component: Component):
    description = fmpy.read_model_description(str(fmus / f"{component.name}.fmu"))
    assert description.generationDateAndTime is None
    assert description.coSimulation.canGetAndSetFMUstate
    assert description.coSimulation.canSerializeFMUstate
    assert float(description.defaultExperiment.stepSize) == 0.002
    assert len(description.modelVariables) == len(component.variables)
    for reference, (found, declared) in enumerate(zip(description.modelVariables, component.variables, strict=True)):
        assert (found.name, found.valueReference) == (declared.name, reference)
        assert (found.causality, found.variability, found.unit) == (
            declared.causality,
            declared.variability,
            declared.unit,
        )
        for attribute, value in (("min", declared.minimum), ("max", declared.maximum), ("start", declared.start)):
            text = getattr(found, attribute)
            if declared.type is float:
                assert (None if text is None else float(text)) == value, f"{attribute} of {found.name}"


def test_archives_hold_no_dates_no_caches_and_no_machine_paths(fmus: Path):
    root = str(ROOT).encode()
    for path in fmus.glob("*.fmu"):
        with zipfile.ZipFile(path) as archive:
            assert {info.date_time for info in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
            assert not [name for name in archive.namelist() if "__pycache__" in name]
            assert not [name for name in archive.namelist() if root in archive.read(name)]


def test_an_fmu_carries_only_what_its_component_imports(fmus: Path):
    with zipfile.ZipFile(fmus / "Shaker.fmu") as archive:
        names = archive.namelist()
    assert "resources/model/plant_models/shaker/shaker.py" in names
    assert not [name for name in names if "seat" in name.lower()]


def test_fmus_run_in_a_python_that_has_none_of_our_packages(fmus: Path, tmp_path: Path):
    """Only fmpy is at hand: site-packages without the project's editable install."""
    script = f"""
import sys
sys.meta_path[:] = [finder for finder in sys.meta_path if "editable" not in repr(finder).lower()]
import importlib.util
assert importlib.util.find_spec("plant_models") is None
import fmpy
for name in {NAMES!r}:
    result = fmpy.simulate_fmu({str(fmus)!r} + "/" + name + ".fmu", stop_time=0.01, output_interval=0.002)
    assert len(result) == 6, name
assert not [m for m in sys.modules if m.startswith(("plant_models", "fmus"))], "the host's modules were touched"
print("fine")
"""
    run = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.stdout.strip() == "fine", run.stderr


@pytest.mark.builds
def test_a_failing_builder_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(sys, "executable", "/bin/false")
    with pytest.raises(BuildError, match="Shaker: pythonfmu ended with 1"):
        build_python_fmu(COMPONENTS[NAMES.index("Shaker")], EXPERIMENT, tmp_path)
    assert not list(tmp_path.glob("*"))
