"""The end of a run: its numbers, the passive seat, notes on what is doubtful, warnings in a user's words."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from cosim import System
from cosim.metrics import ride
from seat_cosim.plausibility import explained, notes_before
from seat_cosim.scenarios import SCENARIOS, control, read_parameter_sets, seat_suspension
from tests.helpers.shell import Shell


def numbers(shell: Shell, *words: str) -> dict:
    code, out, _ = shell(*words, "--json")
    assert code == 0
    return json.loads(out)


def test_the_numbers_are_those_of_the_metrics(shell: Shell, native: Path):
    found = numbers(shell, "run", "bump", "--driver-mass", "70")
    system = seat_suspension(native / "fmi2")
    masses = {"seat.driver_mass": 70.0, "controller.driver_mass": 70.0}
    active = system.simulate(3.0, parameters={**SCENARIOS["bump"].parameters, **masses})
    passive = system.simulate(
        3.0,
        parameters={
            **SCENARIOS["bump"].parameters,
            **masses,
            **control(False),
            **read_parameter_sets(["passive"], system),
        },
    )
    for title, result in (("this ride", active), ("passive seat", passive)):
        driver, floor = (
            ride(result[name], 500.0) for name in ("seat.driver_acceleration", "shaker.floor_acceleration")
        )
        assert found["rides"][title]["a_w"] == pytest.approx(driver.a_w, rel=1e-12)
        assert found["rides"][title]["seat"] == pytest.approx(driver.a_w / floor.a_w, rel=1e-12)
        assert found["rides"][title]["vdv"] == pytest.approx(driver.vdv, rel=1e-12)
        assert found["rides"][title]["stroke"] == pytest.approx(1e3 * abs(result["seat.suspension_deflection"]).max())
    share = 100.0 * np.mean(active["controller.saturated"])
    assert found["rides"]["this ride"]["saturated"] == pytest.approx(share)
    assert share > 0.0
    assert found["rides"]["passive seat"]["force_peak"] == 0.0


def test_the_table_stands_beside_the_passive_seat_and_ends_with_a_command(shell: Shell, tmp_path: Path):
    code, out, err = shell("run", "bump")
    assert (code, err) == (0, "")
    assert "passive seat" in out
    assert "not uncomfortable" in out
    last = out.splitlines()[-1]
    assert last.startswith("next: seat-cosim ")
    assert shell(*last.removeprefix("next: seat-cosim ").split())[0] == 0
    assert "passive seat" not in shell("run", "bump", "--compare", "none")[1]
    assert "passive seat" not in shell("run", "bump", "--control", "passive")[1]
    assert "passive seat" in shell("run", "sine", "--compare", "passive", "--stop-time", "2")[1]


def test_the_comparison_changes_nothing_of_the_run(shell: Shell, tmp_path: Path):
    for compare in ("none", "passive"):
        assert (
            shell("run", "bump", "--parameters", "load", "--compare", compare, "--output", compare, figure=True)[0] == 0
        )
    for name in ("result.csv", "overview.png"):
        assert (tmp_path / "none" / name).read_bytes() == (tmp_path / "passive" / name).read_bytes()


def test_a_share_of_the_travel_needs_end_stops(shell: Shell):
    stops = ("--set", "seat.end_stop.travel=0.06", "--set", "seat.end_stop.stiffness=5e4")
    ridden = numbers(shell, "run", "bump", *stops)["rides"]["this ride"]
    assert ridden["travel_share"] == pytest.approx(ridden["stroke"] / 0.6)
    assert numbers(shell, "run", "bump")["rides"]["this ride"]["travel_share"] is None
    sagged = numbers(shell, "run", "bump", *stops, "--set", "seat.end_stop.height=-0.02")["rides"]["this ride"]
    assert sagged["travel_share"] > ridden["travel_share"]


def test_quiet_prints_nothing(shell: Shell):
    assert shell("run", "bump", "--stop-time", "0.1", "--quiet") == (0, "", "")
    assert shell("run", "bump", "--stop-time", "0.1", "--quiet", "--driver-mass", "100")[1] == ""


def test_short_and_thinned_runs_have_the_numbers_that_can_be_had(shell: Shell):
    short = numbers(shell, "run", "bump", "--stop-time", "0.5", "--record-every", "7")["rides"]["this ride"]
    assert short["a_w"] is None
    assert short["peak"] > 1.0


def test_a_system_without_a_driver_shows_its_signals(shell: Shell, native: Path, tmp_path: Path):
    system = System()
    system.add("shaker", native / "fmi2" / "Shaker.fmu")
    system.stop_time = 1.0
    system.save(tmp_path / "Floor.ssp")
    code, out, _ = shell("simulate", "Floor.ssp")
    assert code == 0
    row = next(line.split() for line in out.splitlines() if "shaker.floor_displacement" in line)
    assert row == ["shaker.floor_displacement", "m", "0", "0.07", row[-1]]
    found = numbers(shell, "simulate", "Floor.ssp")
    assert found["rides"] == {}
    assert len(found["signals"]) == 3


@pytest.mark.parametrize("flavour", ["fmi2", "fmi3"])
def test_drivers_outside_the_gains_range_are_one_line(shell: Shell, flavour: str):
    words = ("run", "bump", "--flavour", flavour, "--driver-mass", "100", "--stop-time", "0.1")
    line = "driver of 100 kg: outside the 45 to 80 kg that the gains are for; those of the nearer end are used"
    assert shell(*words)[2] == f"warning: {line}; --gains recommended is for 45 to 120 kg\n"
    assert shell(*words, "--gains", "recommended")[2] == ""


def test_warnings_of_several_drivers_are_put_together():
    form = "controller: driver_mass lies outside [a, b]: x; got driver_mass = {} kg, driver_mass_min = 45 kg, "
    texts = [form.format(mass) + "driver_mass_max = 80 kg (fmi2GetReal, t = 0 s)" for mass in ("100", "120")]
    other = "seat: a warning of its own"
    found = explained([texts[0], other, texts[1]])
    assert found[0] == other
    assert found[1].startswith("drivers of 100 and 120 kg: outside the 45 to 80 kg")
    assert "recommended" in found[1]
    heavy = explained([form.format("150") + "driver_mass_max = 80 kg (fmi2GetReal, t = 0 s)"])
    assert "recommended" not in heavy[0]
    python = "controller: driver_mass 100.0 kg lies outside [45.0, 80.0] kg: the gains of the nearer end are used"
    assert explained([python])[0].startswith("driver of 100 kg: outside the 45 to 80 kg")


@pytest.mark.parametrize(
    ("words", "note"),
    [
        (["--set", "seat.driver_mass=70"], "the driver of the controller is not that of the seat"),
        (["--set", "seat.driver_mass=70000"], "seat.driver_mass = 70000 kg: drivers weigh 30 to 200 kg"),
        (["--set", "shaker.bump.height=70"], "shaker.floor_displacement reaches 70 m, beyond the 0.3 m"),
        (["--step-size", "0.01"], "step size 0.01 s: controller samples every 0.002 s"),
    ],
)
def test_what_is_doubtful_is_reported_once_and_blocks_nothing(shell: Shell, words: list[str], note: str):
    code, _, err = shell("run", "bump", *words)
    assert code == 0
    assert err.count(note) == 1
    assert "note: " not in shell("run", "bump", "--driver-mass", "70", "--step-size", "0.001")[2]


def test_a_floor_that_contradicts_itself_is_noted(native: Path):
    system = seat_suspension(native / "fmi2")
    assert notes_before(system, {}) == []
    system.replace("shaker", native / "fmi3" / "Shaker.fmu", {"seat.floor_displacement": "1.5*floor_displacement"})
    (note,) = notes_before(system, {})
    assert "scaled differently (floor_displacement by 1.5, floor_velocity by 1, floor_acceleration by 1)" in note
    whole = {f"seat.floor_{name}": f"1.5*floor_{name}" for name in ("displacement", "velocity", "acceleration")}
    system.replace("shaker", native / "fmi2" / "Shaker.fmu", whole)
    assert notes_before(system, {}) == []


def test_an_output_without_a_unit_is_noted(foreign: Path, native: Path):
    system = seat_suspension(native / "fmi2")
    system.replace("shaker", foreign / "Cabin.fmu", {"seat.floor_displacement": "z"})
    (note,) = notes_before(system, {})
    assert note.startswith("shaker.z declares no unit and is taken as m for seat.floor_displacement")
    system.replace("shaker", foreign / "Cabin.fmu", {"seat.floor_displacement": "0.001*z"})
    assert notes_before(system, {}) == []
