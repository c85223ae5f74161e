"""The conformance suite on conforming FMUs (ours, and some like the public reference models) and on foreign ones."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest
from fmpy.validation import validate_fmu
from fmu_manipulation_toolbox.cli.fmutool import fmutool

from cosim.conformance.process import RuleRunner
from cosim.conformance.suite import ValidationReport, load_rules, validate
from seat_cosim.components import COMPONENTS
from tests.helpers.reference_fmus import MODELS, ReferenceFmus
from tests.helpers.shell import Shell

NAMES = [component.name for component in COMPONENTS]

PYTHONFMU = {"lifecycle.token", "lifecycle.call-order", "lifecycle.fixed", "state.free", "side_effects.memory"}
"""Findings in every FMU of pythonfmu, whose library handles these calls itself."""


def messages(found: ValidationReport) -> list[str]:
    return [f"{finding.rule}: {finding.message}" for finding in found.findings]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("flavour", ["fmi2", "fmi3"])
def test_native_fmus_conform(native: Path, runner: RuleRunner, flavour: str, name: str):
    found = validate(native / flavour / f"{name}.fmu", runner=runner)
    assert messages(found) == []
    inapplicable = {name for name, outcome in found.outcomes.items() if outcome.not_applicable}
    assert inapplicable <= {
        "description.date",  # they have none, so that builds are the same to the bit
        "description.step",  # they take steps of any size
        "variables.derivatives",  # and have no continuous states to show
        "structure.derivatives",
        "structure.dependencies-told",  # the shaker has no inputs
        "variables.aliases",
        "variables.relative-quantities",
        "arrays.dimensions",
        "arrays.start",
        "arrays.access",
        "clocks.attributes",
        "clocks.references",
        "clocks.event-mode",
        "lifecycle.once",  # there can be any number of instances
    }


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if name == "SeatController" else [pytest.mark.long]) for name in NAMES]
)
def test_python_fmus_conform_but_for_what_pythonfmu_does(fmus: Path, runner: RuleRunner, name: str):
    found = validate(fmus / f"{name}.fmu", runner=runner)
    assert {finding.rule for finding in found.findings} <= PYTHONFMU, messages(found)
    assert found.outcomes["state.continues"].verdict == "passed"


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("model", MODELS)
def test_no_false_alarm_on_fmus_like_the_reference_models(
    reference_fmus: ReferenceFmus, runner: RuleRunner, model: str, fmi: int
):
    found = validate(reference_fmus.make(model, fmi), runner=runner)
    assert messages(found) == []


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("flavour", ["fmi2", "fmi3", "python"])
def test_other_validators_find_nothing_either(
    native: Path, fmus: Path, monkeypatch: pytest.MonkeyPatch, flavour: str, name: str
):
    path = str((fmus if flavour == "python" else native / flavour) / f"{name}.fmu")
    assert validate_fmu(path) == []
    monkeypatch.setattr(sys, "argv", ["fmutool", "-input", path, "-check"])
    fmutool()  # which would exit


def test_other_validators_would_find_something(foreign: Path, monkeypatch: pytest.MonkeyPatch):
    path = str(foreign / "Cabin.fmu")
    assert validate_fmu(path) != []
    monkeypatch.setattr(sys, "argv", ["fmutool", "-input", path, "-check"])
    with pytest.raises(SystemExit):
        fmutool()


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("Cabin", {"variables.combinations", "structure.initial-unknowns", "steps.stop-time"}),
        ("Damper", {"variables.combinations", "structure.initial-unknowns", "steps.stop-time"}),
        ("Truck", {"steps.stop-time"}),
        ("Chair", {"steps.stop-time", "steps.time"}),
    ],
)
def test_what_is_wrong_with_raw_fmus_of_foreign_tools(foreign: Path, runner: RuleRunner, name: str, expected: set[str]):
    found = validate(foreign / f"{name}.fmu", runner=runner, skip=["side_effects.memory"])
    assert {finding.rule for finding in found.findings if finding.severity == "error"} == expected


# ---- the command -----------------------------------------------------------------------------------------------------


def test_rules_are_documented():
    for rule in load_rules().values():
        assert rule.title
        assert rule.clause or rule.severity == "warning" or rule.id == "archive.size"
        assert set(rule.needs) <= set(load_rules())


def test_command_prints_a_row_for_each_rule(shell: Shell, native: Path):
    code, out, err = shell("validate", str(native / "fmi3" / "SeatPlant.fmu"))
    assert code == 0, err
    assert all(name in out for name in load_rules())
    assert "0 failed, 0 with warnings" in out


def test_command_fails_for_ci_and_writes_json(shell: Shell, reference_fmus: ReferenceFmus):
    path = reference_fmus.make(xml=lambda text: text.replace('stepSize="0.1"', 'stepSize="-1"'))
    code, out, _ = shell("validate", str(path), "--json", "-", "--rule", "description.experiment")
    assert code == 1
    (fmu,) = json.loads(out)["fmus"]
    (row,) = fmu["rules"]
    assert (row["rule"], row["verdict"]) == ("description.experiment", "failed")
    assert row["findings"] == [
        {"severity": "error", "message": "DefaultExperiment: expected a stepSize above 0, got -1"}
    ]
    both = ("--rule", "description.experiment", "--rule", "archive.paths")
    assert shell("validate", str(path), *both, "--skip", "description.experiment")[0] == 0


def test_groups_of_rules_are_chosen_and_left_out(native: Path):
    running = ("binary", "lifecycle", "steps", "state", "side_effects")
    for words in ({"only": ("archive", "description.schema")}, {"skip": ("variables", "structure", *running)}):
        shown = set(validate(native / "fmi2" / "Shaker.fmu", **words).outcomes)
        assert "description.schema" in shown
        assert {"archive.paths", "archive.size"} <= shown
        assert not {name for name in shown if name.startswith(("variables.", "structure.", *running))}


def test_warnings_count_with_strict_only(shell: Shell, reference_fmus: ReferenceFmus, tmp_path: Path):
    path = reference_fmus.make(archive=lambda members: members | {"notes.txt": b"remember"})
    assert shell("validate", str(path), "--rule", "archive.stray")[0] == 0
    code, out, _ = shell("validate", str(path), "--rule", "archive.stray", "--strict", "--json", "report.json")
    assert code == 1
    assert "1 with warnings" in out
    assert json.loads((tmp_path / "report.json").read_text())["fmus"][0]["warnings"] == 1


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["nowhere.fmu"], "nowhere.fmu: expected an FMU, got no such file"),
        ([], "Missing argument"),
        (
            ["{fmu}", "--rule", "lifecycle.forever"],
            "rule lifecycle.forever: expected an id that --list shows, or one of archive",
        ),
        (["{fmu}", "--time-limit", "0"], "--time-limit"),
        (["{fmu}", "--json", "no/such/folder.json", "--rule", "archive.paths"], "--json no/such/folder.json: expected"),
    ],
)
def test_wrong_use_is_an_error_of_one_line(shell: Shell, native: Path, words: list[str], message: str):
    fmu = str(native / "fmi2" / "Shaker.fmu")
    code, _, err = shell("validate", *(word.format(fmu=fmu) for word in words))
    assert code == 2
    assert message in err
    assert len(err.strip().splitlines()) == 1


def test_rules_are_listed(shell: Shell):
    code, out, _ = shell("validate", "--list")
    assert code == 0
    assert all(name in out for name in load_rules())
