"""Evaluation: its results against the metrics and an independent simulation, other systems, its files."""

from __future__ import annotations

import csv
import hashlib
import re
from pathlib import Path

import numpy as np
import pytest

from cosim import SetupError, System
from cosim.metrics import Ride, actuator, daily_vdv, deflection_range, ride, seat_factor
from seat_cosim.evaluation.protocol import Protocol
from seat_cosim.evaluation.report import write
from seat_cosim.evaluation.results import METRICS, DriverClassResult, Evaluation, RideResult
from seat_cosim.evaluation.runner import evaluate
from seat_cosim.evaluation.seat import passive_seat, seat_signals
from seat_cosim.evaluation.system import EvaluatedSystem
from seat_cosim.scenarios import control, driver_mass, read_parameter_sets, seat_suspension
from tests.helpers.shell import Shell

SHORT = Protocol(classes=("EM3",), masses=(80.0,), seeds=(4, 5), duration=12.0, warm_up=2.0)
TINY = (
    "--classes",
    "EM3",
    "--masses",
    "80",
    "--seeds",
    "4,5",
    "--duration",
    "12",
    "--warm-up",
    "2",
    "--processes",
    "1",
)


def evaluated(folder: Path, title: str = "seat", **parameters: float | bool) -> EvaluatedSystem:
    system = seat_suspension(folder)
    system.parameters |= {name.replace("__", "."): value for name, value in parameters.items()}
    return EvaluatedSystem(title, system, seat_signals())


def passive(folder: Path) -> EvaluatedSystem:
    system = seat_suspension(folder)
    return passive_seat(system, read_parameter_sets(["passive"], system))


def table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def numbers(evaluation: Evaluation) -> dict[tuple[str, float], list[float | None]]:
    return {key: [metric.number(result) for metric in METRICS] for key, result in evaluation.results.items()}


def test_numbers_are_those_of_the_metrics(native: Path):
    system = seat_suspension(native / "fmi2")
    found = {}
    for seed in SHORT.seeds:
        excitation = {"shaker.profile": "random", "shaker.random.class": "EM3", "shaker.random.seed": seed}
        result = system.simulate(14.0, parameters={**driver_mass(80.0), **excitation})
        driver = ride(result["seat.driver_acceleration"], 500.0, 2.0)
        floor = ride(result["shaker.floor_acceleration"], 500.0, 2.0)
        deflection = result["seat.suspension_deflection"]
        spent = actuator(result["controller.force"], deflection, 500.0, 2.0)
        found[seed] = {
            "seat": seat_factor(driver, floor).rms,
            "seat_vdv": seat_factor(driver, floor).vdv,
            "a_w": driver.a_w,
            "vdv_8h": daily_vdv(driver.vdv, driver.duration),
            "mtvv": driver.mtvv,
            "peak_deflection": 1e3 * deflection_range(deflection, 500.0, 2.0).peak,
            "force_rms": spent.force_rms,
            "power": spent.power_positive,
        }
        found[seed]["mean_deflection"] = 1e3 * float(deflection[1000:].mean())
        found[seed]["saturated_share"] = 100.0 * float(np.mean(result["controller.saturated"][1000:]))
    both = {name: [values[name] for values in found.values()] for name in found[4]}
    expected = {name: np.mean(values) for name, values in both.items()}
    for name in ("peak_deflection", "mean_deflection", "saturated_share"):
        expected[name] = max(both[name], key=abs)
    expected["spread"] = 100.0 * (max(both["seat"]) / expected["seat"] - 1.0)
    (evaluation,) = evaluate([evaluated(native / "fmi2")], SHORT)
    result = evaluation.results["EM3", 80.0]
    got = {metric.key: metric.number(result) for metric in METRICS}
    assert got["end_stop_hits"] is got["impact_share"] is None
    assert {name: got[name] for name in expected} == pytest.approx(expected, rel=1e-12)


def test_the_control_beats_the_passive_seat_on_every_class(native: Path):
    protocol = Protocol(masses=(55.0,), seeds=(1,), duration=30.0)
    controlled, off = evaluate([evaluated(native / "fmi2"), passive(native / "fmi2")], protocol)
    for key, result in controlled.results.items():
        assert result.seat < off.results[key].seat, key


FIRST = {
    "controlled": [0.26, 0.21, 0.24, 0.40, 0.20, 0.28, 0.19, 0.37, 0.27],
    "uncontrolled": [0.93, 0.97, 1.02, 0.94, 0.44, 0.50, 0.42, 0.75, 0.52],
}
"""SEAT of EM1 to EM9 in an earlier, independent simulation of the same equations at 55 kg."""


def test_a_first_simulation_is_repeated_within_its_scatter(native: Path):
    # One run of 180 s scatters by 1 to 3 %, and the earlier numbers are rounded to 0.01: up to 2.5 % of 0.20.
    protocol = Protocol(masses=(55.0,), duration=60.0)
    off = evaluated(
        native / "fmi2", "off", **{name.replace(".", "__"): value for name, value in control(False).items()}
    )
    found = [
        [result.seat for result in evaluation.results.values()]
        for evaluation in evaluate([evaluated(native / "fmi2"), off], protocol)
    ]
    assert found[0] == pytest.approx(FIRST["controlled"], rel=0.08)
    assert found[1][3:] == pytest.approx(FIRST["uncontrolled"][3:], rel=0.05)
    # On EM1 to EM3 the undamped suspension resonates. Seen here: 0.89, 0.71 and 0.72 over twelve seeds of 200 s, and
    # an implicit solution of (1)-(2), (35)-(36) under the same floor agrees with the FMUs to 0.02 %.
    assert found[1][:3] == pytest.approx([0.89, 0.71, 0.72], rel=0.08)


def test_processes_do_not_change_a_number(native: Path):
    protocol = Protocol(classes=("EM3", "EM7"), masses=(80.0, 55.0), seeds=(4,), duration=5.0, warm_up=1.0)
    systems = [evaluated(native / "fmi2"), passive(native / "fmi2")]
    done: list[tuple[int, int]] = []
    alone, together = evaluate(systems, protocol), evaluate(systems, protocol, 2, lambda *how: done.append(how))
    assert [numbers(each) for each in alone] == [numbers(each) for each in together]
    assert done == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert list(alone[0].results) == [("EM3", 80.0), ("EM3", 55.0), ("EM7", 80.0), ("EM7", 55.0)]


def test_the_same_evaluation_writes_the_same_bytes(native: Path, tmp_path: Path):
    files = []
    for name in ("first", "second"):
        found = evaluate([evaluated(native / "fmi2"), passive(native / "fmi2")], SHORT)
        files.append(write(tmp_path / name, found, SHORT, ["seat-cosim", "evaluate"], ["A note."]))
    assert [path.name for path in files[0]] == [
        "evaluation.html",
        "evaluation.csv",
        "evaluation.json",
        "seat.svg",
        "seat.png",
        "inputs.svg",
        "system.ssp",
    ]
    for first, second in zip(*files, strict=True):
        assert first.read_bytes() == second.read_bytes(), first.name


def test_end_stops_are_counted_where_the_seat_has_them(native: Path):
    free = evaluated(native / "fmi2")
    stops = {"seat__end_stop__stiffness": 1e5, "seat__end_stop__damping": 0.0}
    stopped = evaluated(native / "fmi2", seat__end_stop__travel=0.015, **stops)
    assert (free.end_stop_travel, stopped.end_stop_travel) == (None, 0.015)
    without, with_ = (each.results["EM3", 80.0] for each in evaluate([free, stopped], SHORT))
    assert without.end_stop_hits is None
    assert with_.end_stop_hits
    sagged = evaluated(native / "fmi2", seat__end_stop__travel=0.015, seat__end_stop__height=-0.01, **stops)
    assert (stopped.end_stop_height, sagged.end_stop_height) == (0.0, -0.01)
    assert with_.peak_deflection < without.peak_deflection


def test_drivers_outside_the_range_of_the_gains_are_reported(native: Path):
    protocol = Protocol(classes=("EM3",), masses=(120.0,), seeds=(1, 2), duration=2.0, warm_up=0.0)
    (found,) = evaluate([evaluated(native / "fmi2")], protocol)
    assert len(found.warnings) == 1
    assert "driver_mass lies outside [driver_mass_min, driver_mass_max]" in found.warnings[0]


def result_of(*seats: float) -> DriverClassResult:
    """Results of rides with these SEAT."""
    floor = Ride(1.0, 4.0, 1.5, 3.0, 180.0)
    return DriverClassResult(tuple(RideResult(Ride(seat, 4.0 * seat, 1.5, 3.0, 180.0), floor) for seat in seats))


@pytest.mark.parametrize(
    ("seats", "repeatable"), [((0.95, 1.0, 1.05), True), ((0.94, 1.0, 1.06), False), ((1.0, 1.0), False)]
)
def test_runs_repeat_within_five_percent_of_their_mean(seats: tuple[float, ...], repeatable: bool):
    assert result_of(*seats).is_repeatable is repeatable


# ---- the command -----------------------------------------------------------------------------------------------------


def test_the_page_needs_no_other_file_and_identifies_what_was_evaluated(shell: Shell, native: Path, tmp_path: Path):
    code, out, err = shell("evaluate", *TINY, "--observer", "2", "--output", "out")
    assert (code, err) == (0, "")
    assert "SeatSuspension, Observer 2" in out
    page = (tmp_path / "out" / "evaluation.html").read_text(encoding="utf-8")
    assert set(re.findall(r'(?:src|href)="([a-z:]+)', page)) == {"data:image"}
    digest = hashlib.sha256((tmp_path / "out" / "system.ssp").read_bytes()).hexdigest()
    system = System.load(tmp_path / "out" / "system.ssp")
    assert digest in page
    for model in system.models.values():
        assert model.description.guid in page
    assert "controller.observer_gamma = -1e-06" in page
    assert "recalled" in page
    assert "friction is assumed" in page
    assert not re.search(r"\b20\d\d-\d\d-\d\d\b", page)


def test_a_saved_system_gives_the_same_table_again(shell: Shell, tmp_path: Path):
    words = ("--set", "seat.suspension_damping=300", "--observer", "2")
    assert shell("evaluate", *TINY, *words, "--output", "first")[0] == 0
    assert shell("evaluate", "first/system.ssp", *TINY, "--output", "second")[0] == 0
    first, second = (table(tmp_path / name / "evaluation.csv") for name in ("first", "second"))
    for row in (first[0], second[0]):
        row.pop("system")
    assert first == second
    assert shell("evaluate", "first/system.ssp", *TINY, "--travel", "none", "--output", "unlimited")[0] == 0
    assert {row["end_stop_hits"] for row in table(tmp_path / "unlimited" / "evaluation.csv")} == {""}
    assert shell("evaluate", *TINY, "--output", "third")[0] == 0
    assert table(tmp_path / "third" / "evaluation.csv")[0]["seat"] != first[0]["seat"]


def test_a_seat_of_other_names_and_units(shell: Shell, native: Path, foreign: Path, tmp_path: Path):
    system = System()
    system.name = "Chair"
    system.add("rig", native / "fmi3" / "Shaker.fmu")
    system.add("chair", foreign / "Chair.fmu")
    system.connect("rig.floor_displacement", "chair.zv")
    system.connect("rig.floor_velocity", "chair.dzv")
    system.order = ("chair", "rig")
    system.save(tmp_path / "Chair.ssp")
    words = ("--shaker", "rig", "--seat-signal", "chair.acc_seat", "--deflection-signal", "chair.stroke")
    words += ("--driver-mass-parameter", "chair.mass", "--processes", "2", "--output", "out")
    code, _, err = shell("evaluate", "Chair.ssp", *TINY, *words)
    assert (code, err) == (0, "warning: chair.F: not connected and not set, keeps its start value 0 N\n")
    chair, _ = table(tmp_path / "out" / "evaluation.csv")
    assert chair["force_rms (N)"] == ""
    # it has no end stops: what would have met those of the test counts
    assert (int(chair["end_stop_hits"]) > 0) is (float(chair["peak_deflection (mm)"]) >= 40.0)
    assert "saturation" in chair["not_judged"].split()
    # 80 kg on 5500 N/m and 500 N s/m: 1.3 Hz, damped by 0.38, so most of EM3 (1.5 to 3 Hz) lies above sqrt(2) 1.3 Hz
    assert 0.5 < float(chair["seat"]) < 1.0
    assert 20.0 < float(chair["peak_deflection (mm)"]) < 100.0


REFUSED = {
    "class": (("--classes", "EM1,EM11"), r"shaker.random.class: expected one of EM1, EM2, .*, got EM11"),
    "classes twice": (("--classes", "EM1,EM1"), "classes: expected each once, got EM1, EM1"),
    "no classes": (("--classes", ","), "classes: expected each once, got none"),
    "masses": (("--masses", "55,heavy"), "--masses 55,heavy: expected numbers with commas between"),
    "mass": (("--masses", "5"), r"controller.driver_mass: expected a value in \[20, 250\] kg, got 5"),
    "seeds": (("--seeds", "1.5"), "--seeds 1.5: expected whole numbers with commas between"),
    "travel": (("--travel", "wide"), "--travel wide: expected mm each way, or none"),
    "no travel": (("--travel", "0"), "travel: expected more than 0 mm each way, or none, got 0 mm"),
    "repeated": (("--protocol", "iso7096", "--seeds", "1,2"), "seeds: expected one, as protocol iso7096 repeats one"),
    "duration": (("--duration", "0.5"), "duration: expected at least 1 s, over which MTVV is taken, got 0.5 s"),
    "warm-up": (("--settle", "-1"), "warm-up: expected at least 0 s, got -1 s"),
    "signal": (
        ("--seat-signal", "seat.driver_accel"),
        r"signal seat.driver_accel: expected an output of SeatSuspension, got none \(did you mean seat.driver_acceler",
    ),
    "unit": (
        ("--seat-signal", "seat.seat_displacement"),
        "signal seat.seat_displacement: expected a unit like m/s2, got m",
    ),
    "parameter": (
        ("--driver-mass-parameter", "seat.driver"),
        "seat.driver: expected a variable of SeatPlant.fmu, got none",
    ),
    "shaker": (("--shaker", "rig"), "rig.profile: expected a component among"),
    "passive": (("--passive", "none.ssv"), r"none.ssv: expected a parameter set \(.ssv\), got"),
    "file": (("none.ssp",), "none.ssp: expected"),
    "replacement": (("--replace", "controller"), "--replace controller: expected COMPONENT=FILE.fmu"),
    "setting": (("--set", "seat.mass=3"), "seat.mass: expected a variable of SeatPlant.fmu, got none"),
    "gains": (("--gains", "best"), "best"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_wrong_arguments_are_refused_before_anything_runs(case: str, shell: Shell, tmp_path: Path):
    words, message = REFUSED[case]
    code, out, err = shell("evaluate", *words, "--output", "out")
    assert (code, out) == (2, "")
    assert err.startswith("seat-cosim: error: ")
    assert len(err.splitlines()) == 1
    assert re.search(message, err), err
    assert not (tmp_path / "out").exists()


def test_all_problems_are_reported_at_once(native: Path):
    wrong = Protocol(classes=("EM1", "XX"), masses=(55.0, 1e9), seeds=(-1,))
    with pytest.raises(SetupError) as error:
        evaluate([evaluated(native / "fmi2")], wrong)
    text = str(error.value)
    assert "got XX" in text
    assert "got 1000000000.0" in text
    assert "got -1" in text


def test_a_step_too_long_for_the_weighting_is_refused(native: Path):
    slow = evaluated(native / "fmi2")
    slow.system.step_size = 0.01
    with pytest.raises(SetupError, match="rate: expected at least 160 Hz, as Wk reaches to 80 Hz, got 100 Hz"):
        evaluate([slow], SHORT)


def test_a_ride_that_fails_is_named(shell: Shell, tmp_path: Path):
    code, out, err = shell("evaluate", *TINY, "--set", "seat.cushion_stiffness=1e15", "--output", "out")
    assert (code, out) == (1, "")
    assert len(err.splitlines()) == 1
    assert "SeatSuspension, EM3, 80 kg, seed 4: " in err
    assert not list((tmp_path / "out").glob("*"))


def test_a_folder_that_cannot_be_written_to_is_refused_before_anything_runs(shell: Shell, tmp_path: Path):
    (tmp_path / "file").touch()
    code, out, err = shell("evaluate", *TINY, "--output", "file/out")
    assert (code, out) == (2, "")
    assert "file/out: expected a folder to write to, got: Not a directory" in err
