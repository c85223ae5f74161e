"""The command simulate: any system, changed on the command line; errors are found before an FMU is loaded."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from cosim import System
from cosim.engine.network import VariableRef
from cosim.units import Linear
from seat_cosim.scenarios import seat_suspension
from tests.helpers.files import read_csv
from tests.helpers.shell import Shell


@pytest.fixture
def ssp(native: Path, shell: Shell, tmp_path: Path) -> str:
    """A system file in the folder where the shell is."""
    system = seat_suspension(native / "fmi2")
    system.stop_time = 0.2
    system.save(tmp_path / "Seat.ssp")
    return "Seat.ssp"


def test_a_system_runs_as_its_file_says(shell: Shell, ssp: str, tmp_path: Path):
    code, out, err = shell("simulate", ssp, figure=True)
    assert (code, err) == (0, "")
    assert "components step in the order controller, seat, shaker\n" in out
    folder = tmp_path / "results" / "simulate" / "Seat"
    assert {path.name for path in folder.iterdir()} == {"result.csv", "run.json", "overview.png"}
    result = read_csv(folder / "result.csv")
    expected = System.load(tmp_path / ssp).simulate()
    assert np.array_equal(result["seat.driver_acceleration"], expected["seat.driver_acceleration"])
    assert result["time"][-1] == 0.2


def test_options_win_over_files_and_files_over_the_system(shell: Shell, ssp: str, tmp_path: Path):
    (tmp_path / "mass.ssv").write_text(
        '<ssv:ParameterSet xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" version="1.0" '
        'name="mass"><ssv:Parameters><ssv:Parameter name="seat.driver_mass"><ssv:Real value="70"/></ssv:Parameter>'
        '<ssv:Parameter name="controller.driver_mass"><ssv:Real value="70"/></ssv:Parameter></ssv:Parameters>'
        "</ssv:ParameterSet>"
    )
    words = (
        "--parameters",
        "mass.ssv",
        "--set",
        "controller.driver_mass=75",
        "--stop-time",
        "0.1",
        "--save",
        "new.ssp",
    )
    assert shell("simulate", ssp, *words)[0] == 0
    saved = System.load(tmp_path / "new.ssp")
    assert saved.parameters == {"seat.driver_mass": 70.0, "controller.driver_mass": 75.0}
    assert saved.stop_time == 0.1


def test_jacobi_reports_that_the_force_is_late(shell: Shell, ssp: str):
    code, out, _ = shell("simulate", ssp, "--algorithm", "jacobi")
    assert code == 0
    assert "all components exchange their values at once" in out
    late = {line.split()[0]: line.split()[-1] for line in out.splitlines() if "." in line and "->" not in line}
    assert late["controller.force"] == "1"
    assert late["shaker.floor_velocity"] == "0"


def test_a_bad_order_says_what_it_hands_over_too_early(shell: Shell, ssp: str):
    code, out, _ = shell("simulate", ssp, "--order", "controller,shaker,seat")
    assert code == 0
    assert "note: shaker.floor_velocity -> seat.floor_velocity hands over the value of the step's end" in out
    assert "controller.force -> " not in out


def test_an_fmu_is_replaced_and_the_system_saved(shell: Shell, ssp: str, foreign: Path, tmp_path: Path):
    words = ("--replace", f"shaker={foreign / 'Cabin.fmu'}", "--connect", "0.001*shaker.z=seat.floor_displacement")
    code, out, err = shell("simulate", ssp, *words, "--isolate", "shaker", "--save", "cab.ssp", "--output", "there")
    assert code == 0
    assert "0.001 x" in out
    assert "warning: seat.floor_signals: set to displacement" in err
    saved = System.load(tmp_path / "cab.ssp")
    assert saved.connections[VariableRef("seat", "floor_displacement")].transformation == Linear(0.001)
    assert json.loads((tmp_path / "there" / "run.json").read_text())["complete"]


def test_own_steps_and_records(shell: Shell, ssp: str, tmp_path: Path):
    words = ("--component-step", "seat=0.001", "--record", "seat.driver_acceleration", "--record-every", "10")
    assert shell("simulate", ssp, *words, "--output", "there")[0] == 0
    result = read_csv(tmp_path / "there" / "result.csv")
    assert list(result) == ["time", "seat.driver_acceleration"]
    assert len(result["time"]) == 11


def test_a_run_in_real_time_reports_its_deadlines(shell: Shell, ssp: str):
    code, out, _ = shell("simulate", ssp, "--real-time")
    assert code == 0
    assert "deadlines missed, the worst by" in out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--replace", "shaker"), "--replace shaker: expected COMPONENT=FILE.fmu"),
        (("--replace", "shakr=x.fmu"), "shakr: expected a component among"),
        (("--replace", "shaker=x.fmu"), "x.fmu: expected an FMU, got no such file"),
        (("--connect", "shaker.x"), "connect shaker.x: expected A.x=B.y, the output first"),
        (("--connect", "shaker.floor_velocity=seat.floor_velocity"), "expected a free input"),
        (("--disconnect", "seat.forc"), "seat.forc: expected a variable of"),
        (("--set", "seat.driver_mass"), "--set seat.driver_mass: expected COMPONENT.VARIABLE=VALUE"),
        (("--set", "seat.driver_mas=1"), "did you mean driver_mass"),
        (("--parameters", "no.ssv"), "no.ssv: expected a parameter set (.ssv), got no such file"),
        (("--component-step", "seat=fast"), "--component-step seat=fast: expected a number of seconds, got fast"),
        (("--component-step", "seat=0.003"), "expected a multiple or a whole part of 0.002 s, got 0.003 s"),
        (("--order", "seat,shaker"), "order: expected each of controller, seat, shaker once, got seat, shaker"),
        (("--record", "seat.x"), "record seat.x: expected an output"),
        (("--stop-time", "-1"), "stop time: expected a finite number of seconds above 0, got -1.0"),
        (("--isolate", "chair"), "chair"),
    ],
)
def test_an_error_is_one_line_and_leaves_no_files(
    shell: Shell, ssp: str, tmp_path: Path, words: tuple[str, ...], message: str
):
    code, _, err = shell("simulate", ssp, *words)
    assert code == 2
    assert message in err
    assert err.count("\n") == 1
    assert not (tmp_path / "results").exists()


def test_a_file_that_is_no_system(shell: Shell, native: Path, tmp_path: Path):
    assert shell("simulate", "no.ssp")[::2] == (
        2,
        "seat-cosim: error: no.ssp: expected a system structure (.ssp or .ssd), got no such file\n",
    )
