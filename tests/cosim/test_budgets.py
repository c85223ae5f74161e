"""Limits of what a file may ask for, and the cost below them."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import pytest

from benchmarks.large_description import measure, with_variables
from cosim import System
from cosim.conformance.suite import validate
from cosim.errors import SetupError, did_you_mean
from cosim.fmi import archive as archives
from cosim.fmi import budgets, repairs
from cosim.fmi.description import ModelDescription
from cosim.ssp import xml as documents
from seat_cosim.scenarios import seat_suspension

MIB = 2**20


@pytest.mark.long
@pytest.mark.builds
@pytest.mark.parametrize("flavour", ["fmi2", "fmi3"])
def test_a_description_of_100_000_variables_is_validated_in_500_mb(native: Path, tmp_path: Path, flavour: str):
    path = with_variables(native / flavour / "SeatPlant.fmu", tmp_path / "large.fmu", 100_000)
    assert measure(path).megabytes < 500.0


@pytest.mark.builds
def test_fmpys_validation_is_left_out_above_its_limit(native: Path, tmp_path: Path):
    path = with_variables(native / "fmi3" / "SeatPlant.fmu", tmp_path / "large.fmu", 20_000)
    (outcome,) = validate(path, only=["fmpy_check"]).outcomes.values()
    assert outcome.not_applicable == "at most 20000 variables, as fmpy needs too long and too much memory"


@pytest.mark.builds
@pytest.mark.parametrize(
    ("module", "limit", "most", "message"),
    [
        (repairs, "MAX_VARIABLES", 5, "expected at most 5 variables, got"),
        (repairs, "MAX_UNITS", 1, "expected at most 1 units, got"),
        (archives, "MAX_MEMBERS", 2, "expected at most 2 members, got"),
        (budgets, "MAX_DOCUMENT", 1000, "modelDescription.xml: expected a document of at most 0.000954 MiB, got"),
        (budgets, "MAX_DOCUMENTS", 1000, "modelDescription.xml: expected at most 0.000954 MiB in all documents, got"),
    ],
)
def test_each_limit_of_an_fmu_has_a_message(
    native: Path, monkeypatch: pytest.MonkeyPatch, module: object, limit: str, most: int, message: str
):
    path = native / "fmi2" / "SeatPlant.fmu"
    assert ModelDescription.read(path).variables
    monkeypatch.setattr(module, limit, most)
    with pytest.raises(SetupError, match=message):
        ModelDescription.read(path)


@pytest.mark.builds
def test_each_limit_of_a_system_has_a_message(native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    seat_suspension(native / "fmi2").save(tmp_path / "system.ssp")
    assert System.load(tmp_path / "system.ssp").connections
    monkeypatch.setattr(documents, "MAX_CONNECTIONS", 2)
    with pytest.raises(SetupError, match="SystemStructure.ssd: expected at most 2 elements Connection, got"):
        System.load(tmp_path / "system.ssp")


@pytest.mark.builds
def test_archives_in_archives_are_refused_before_they_unfold(native: Path, tmp_path: Path):
    """Each stage is harmless by itself: 90 MiB of blanks in FMUs that are packed once more."""
    seat_suspension(native / "fmi2").save(tmp_path / "system.ssp")
    with zipfile.ZipFile(tmp_path / "system.ssp") as source, zipfile.ZipFile(tmp_path / "bomb.ssp", "w") as target:
        for name in source.namelist():
            content = source.read(name)
            if name.endswith(".fmu"):
                with (
                    zipfile.ZipFile(io.BytesIO(content)) as inner,
                    zipfile.ZipFile(out := io.BytesIO(), "w", 8) as new,
                ):
                    description = inner.read("modelDescription.xml")
                    new.writestr("modelDescription.xml", description + b" " * (30 * MIB))
                content = out.getvalue()
            target.writestr(name, content, 8)
    with pytest.raises(SetupError, match="expected documents of at most 100 times the size of the file, got .* MiB"):
        System.load(tmp_path / "bomb.ssp")


@pytest.mark.builds
def test_what_an_fmu_in_a_system_unfolds_to_is_compared_with_the_file_on_disk(
    native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(archives, "SAFE_SIZE", MIB)
    seat_suspension(native / "fmi2").save(tmp_path / "system.ssp")
    with zipfile.ZipFile(tmp_path / "system.ssp") as source, zipfile.ZipFile(tmp_path / "bomb.ssp", "w") as target:
        for name in source.namelist():
            content = source.read(name)
            if name.endswith("Shaker.fmu"):
                with zipfile.ZipFile(out := io.BytesIO(content), "a") as copy:  # stored: inside, nothing is unusual
                    copy.writestr("resources/zeros", bytes(64 * MIB))
                content = out.getvalue()
            target.writestr(name, content, 8)
    with pytest.raises(SetupError, match=r"expected at most 200 times the packed size when extracted, got"):
        System.load(tmp_path / "bomb.ssp")


def test_suggestions_cost_little_whatever_the_number_of_names():
    names = [f"part{i % 97}.signal_{i}" for i in range(100_000)]
    for i in range(1000, 11_000):
        found = did_you_mean(f"part{i % 97}.signl_{i}", names)
        assert (f"signal_{i}" in found) if i < 1020 else not found
    assert did_you_mean("seet", ["seat", "shaker"]) == " (did you mean seat?)"
