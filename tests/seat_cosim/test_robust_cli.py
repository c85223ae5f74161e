"""The mode robust on the command line: run, evaluate, design."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cosim.errors import SetupError
from cosim.results.result import Result
from seat_cosim.robust_certificate import robust_parameters
from seat_cosim.scenarios import mode
from tests.helpers.shell import Shell

LAG = ("--set", "seat.actuator.time_constant=0.005")


def test_the_mode_gets_actuator_and_travel_of_the_seat_unless_they_are_set():
    seat = {"seat.actuator.time_constant": 0.005, "seat.actuator.delay": 0.0, "seat.end_stop.travel": 0.05}
    told = mode("robust", {**seat, "controller.travel": 0.03})
    assert told == {"controller.mode": "robust", "controller.actuator_time_constant": 0.005}
    assert mode("robust", seat)["controller.travel"] == 0.05
    sagged = mode("robust", {**seat, "seat.end_stop.height": -0.02})
    assert sagged["controller.travel"] == pytest.approx(0.03)  # the shorter way
    assert mode("published", seat) == {"controller.mode": "published"}


def test_run_in_mode_robust_differs_from_the_published_law(
    shell: Shell, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    forces = {}
    for name in ("published", "robust"):
        words = ("run", "bump", "--mode", name, *LAG, "--stop-time", "1", "--output", name)
        assert shell(*words)[0] == 0
        result = Result.read(tmp_path / name / "result.csv")
        forces[name] = result["controller.force"]
        assert set(result["controller.fault"]) == {1.0}
        made = json.loads((tmp_path / name / "run.json").read_text())
        assert name in json.dumps(made)
    assert abs(forces["published"] - forces["robust"]).max() > 10.0
    assert shell("run", "bump", "--stop-time", "1", "--output", "default", *LAG)[0] == 0
    assert (Result.read(tmp_path / "default" / "result.csv")["controller.force"] == forces["published"]).all()


def test_evaluate_takes_the_mode(shell: Shell, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    short = ("--classes", "EM6", "--masses", "70", "--seeds", "1", "--duration", "5", "--processes", "1")
    code, out, err = shell("evaluate", "--mode", "robust", *LAG, *short, "--output", "found")
    assert code == 0, err
    assert "robust" in out


def test_design_certifies_the_sampled_loop(shell: Shell, tmp_path: Path):
    """20 ms of delay margin without the follow term, 12 ms at its bound, at every mass."""
    words = ("design", "--mode", "robust", "--set", "actuator_time_constant=0.005", "--output", str(tmp_path))
    code, out, err = shell(*words)
    assert code == 0, err
    assert "follow term at its bound" in out
    found = json.loads((tmp_path / "certificate.json").read_text())
    margins = found["delay_margin_ms"]
    assert min(margins["follow term off"].values()) >= 20.0
    assert min(margins["follow term at its bound"].values()) >= 12.0
    assert found["parameters"]["actuator_time_constant"] == 0.005


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("robust.speed=1", "expected PARAMETER=VALUE with a parameter of the controller, got robust.speed=1"),
        ("travel", "got travel"),
        ("travel=wide", "travel: expected a number, got wide"),
        ("travel=-1", "expected a value in"),
        ("robust.estimator=perhaps", "expected one of off, monitor, friction, friction_and_mass, got perhaps"),
    ],
)
def test_settings_that_are_none_are_refused_by_name(setting: str, message: str, shell: Shell):
    with pytest.raises(SetupError, match="design") as error:
        robust_parameters([setting])
    assert message in str(error.value)
    code, _, err = shell("design", "--mode", "robust", "--set", setting)
    assert code == 2
    assert message in " ".join(err.split())


def test_design_of_gains_takes_no_settings(shell: Shell):
    code, _, err = shell("design", "--gains", "published", "--set", "travel=0.05")
    assert code == 2
    assert "expected --set with --mode robust only" in " ".join(err.split())


@pytest.mark.parametrize(
    ("travel", "height", "told"), [("0.04", "-0.01", 0.03), (0.04, 0.015, 0.025), ("0.04", None, 0.04)]
)
def test_the_mode_gets_the_shorter_travel_of_numbers_and_of_texts(travel: object, height: object, told: float):
    given = {"seat.end_stop.travel": travel, "seat.end_stop.height": height}
    found = mode("robust", {name: value for name, value in given.items() if value is not None})  # type: ignore[misc]
    assert found == {"controller.mode": "robust", "controller.travel": pytest.approx(told)}


def test_the_mode_leaves_a_text_that_is_no_number_to_its_own_error(shell: Shell):
    words = ("--mode", "robust", "--set", "seat.end_stop.travel=wide", "--set", "seat.end_stop.height=0.01")
    code, _, error = shell("run", "bump", *words)
    assert code == 2
    assert "seat.end_stop.travel: expected" in error
