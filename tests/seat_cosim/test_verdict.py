"""Verdict: its criteria, the one that decides, the installation of both seats, protocols, and seats that must fail."""

from __future__ import annotations

import csv
import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cosim import SetupError
from cosim.metrics import Ride, impact_share, sine_transmissibility
from seat_cosim.evaluation.criteria import (
    INPUT,
    SEAT_RMS,
    Judgement,
    Outcome,
    judge_end_stops,
    judge_mean_deflection,
    judge_repeatability,
    judge_saturation,
    judge_seat_rms,
    judge_seat_vdv,
)
from seat_cosim.evaluation.damping import floor_amplitude
from seat_cosim.evaluation.inputs import INPUTS
from seat_cosim.evaluation.installation import Installation
from seat_cosim.evaluation.protocol import Protocol, Run, iso7096
from seat_cosim.evaluation.results import DriverClassResult, RideResult
from seat_cosim.evaluation.runner import evaluate
from seat_cosim.evaluation.seat import common_parameters, installed, passive_seat, seat_signals
from seat_cosim.evaluation.system import EvaluatedSystem
from seat_cosim.evaluation.verdict import SeatVerdict, Verdict, judge_all
from seat_cosim.scenarios import read_parameter_sets, seat_suspension
from tests.helpers.shell import Shell

BIAS = "seat.sensor.acceleration_bias=0.02"


def ride(seat: float = 0.5, vdv: float = 0.5, **others: Any) -> RideResult:
    """A ride with these SEAT by a_w and by VDV."""
    return RideResult(Ride(seat, 4.0 * vdv, 1.5, 3.0, 180.0), Ride(1.0, 4.0, 1.5, 3.0, 180.0), **others)


def result(*rides: RideResult) -> DriverClassResult:
    return DriverClassResult(rides)


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def data(folder: Path) -> dict[str, Any]:
    return json.loads((folder / "evaluation.json").read_text(encoding="utf-8"))  # type: ignore[no-any-return]


def worst(found: dict[str, Any], system: int = 0) -> dict[str, dict[str, Any]]:
    """Criterion to its worst judgement."""
    return {each["criterion"]: each for each in found["systems"][system]["criteria"]}


# ---- criteria --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("seat", "outcome"), [(0.99, "pass"), (1.0, "pass"), (1.001, "fail"), (math.nan, "not judged")]
)
def test_seat_is_judged_by_the_limit_of_its_class(seat: float, outcome: str):
    assert judge_seat_rms("EM3", result(ride(seat))).outcome == outcome


def test_a_class_without_a_known_limit_is_not_judged():
    for name in ("IT1", "own"):
        found = judge_seat_rms(name, result(ride(0.1)))
        assert found.outcome is Outcome.NOT_JUDGED
        assert name in found.sentence


def test_the_dose_is_compared_with_the_passive_seats():
    assert judge_seat_vdv(result(ride(vdv=0.4)), result(ride(vdv=0.5))).outcome is Outcome.PASS
    assert judge_seat_vdv(result(ride(vdv=0.6)), result(ride(vdv=0.5))).outcome is Outcome.FAIL
    assert judge_seat_vdv(result(ride(vdv=0.1)), None).outcome is Outcome.NOT_JUDGED


def test_what_has_no_signal_is_not_judged():
    silent = result(ride())
    assert judge_end_stops(silent).sentence.endswith("no signal of the deflection")
    assert judge_mean_deflection(silent, 0.04).outcome is Outcome.NOT_JUDGED
    assert judge_mean_deflection(result(ride(mean_deflection=0.01)), None).detail == "unlimited travel"
    assert judge_saturation(silent).outcome is Outcome.NOT_JUDGED


def test_the_mean_deflection_counts_by_its_magnitude():
    found = judge_mean_deflection(result(ride(mean_deflection=0.001), ride(mean_deflection=-0.012)), 0.04)
    assert (found.outcome, found.value, found.detail) == (Outcome.FAIL, pytest.approx(0.3), "-12.0 mm")


@pytest.mark.parametrize(("share", "outcome"), [(0.0, "pass"), (0.05, "pass"), (0.06, "fail")])
def test_impacts_and_saturation_may_have_a_share(share: float, outcome: str):
    contacts = result(ride(vdv=1.0, peak_deflection=0.04, end_stop_hits=3, impact_share=share, saturated_share=share))
    assert judge_end_stops(contacts).outcome == judge_saturation(contacts).outcome == outcome
    assert judge_end_stops(contacts).detail == f"3 hits, {share:.0%} of the driver's VDV"


def test_the_same_impacts_count_the_same_in_a_seat_that_isolates_better():
    rough = ride(vdv=0.8, peak_deflection=0.04, end_stop_hits=9, impact_share=0.5)
    gentle = ride(vdv=0.1, peak_deflection=0.04, end_stop_hits=9, impact_share=0.4)
    assert judge_end_stops(result(rough)).value == pytest.approx(0.4)
    assert judge_end_stops(result(gentle)).outcome is Outcome.PASS


def test_fewer_than_three_runs_are_not_judged_as_repeatable():
    assert judge_repeatability(result(ride(), ride())).outcome is Outcome.NOT_JUDGED
    assert judge_repeatability(result(ride(), ride(), ride())).outcome is Outcome.PASS
    assert judge_repeatability(result(ride(0.5), ride(0.5), ride(0.6))).outcome is Outcome.FAIL


def judged(value: float | None, limit: float | None = 1.0, *, test: bool = False) -> Judgement:
    return Judgement(INPUT if test else SEAT_RMS, value, limit)


@pytest.mark.parametrize(
    ("judgements", "outcome", "decides"),
    [
        ([judged(0.5), judged(0.9)], "pass", 1),
        ([judged(0.5), judged(None), judged(0.9)], "not judged", 1),
        ([judged(1.5), judged(None), judged(3.0)], "fail", 2),
        ([judged(1.5), judged(9.0, test=True)], "fail", 0),
        ([judged(0.5), judged(9.0, test=True)], "fail", 1),
        ([judged(0.5), judged(0.9, test=True)], "pass", 0),
    ],
)
def test_the_worst_criterion_decides(judgements: list[Judgement], outcome: str, decides: int):
    found = Verdict(tuple(judgements))
    assert found.outcome == outcome
    assert found.deciding is judgements[decides]


def test_the_verdict_on_a_seat_is_the_worst_of_its_cells():
    cells = {("EM1", 55.0): Verdict((judged(0.9),)), ("EM3", 80.0): Verdict((judged(1.4),))}
    found = SeatVerdict(cells)
    assert (found.outcome, found.where) == (Outcome.FAIL, ("EM3", 80.0))
    assert found.sentence == (
        "Verdict: fail, decided by SEAT by a_w: 1.40 > 1.00, EM3, 80 kg; 1 of 2 combinations of class and driver pass"
    )


def test_impacts_have_the_dose_of_their_samples():
    rate, quiet = 100.0, np.full(1000, 0.5)
    deflection = np.zeros(1000)
    deflection[300:310] = 0.05
    shaken = quiet.copy()
    shaken[305:330] = 3.0
    dose = (3.0**4 * 25 + 0.5**4 * 10) / (3.0**4 * 25 + 0.5**4 * 975)  # 10 in contact and 25 after it
    expected = 1.0 - (1.0 - dose) ** 0.25
    assert impact_share(shaken, deflection, rate, travel=0.04) == pytest.approx(expected, rel=1e-9)
    assert impact_share(quiet, np.zeros(1000), rate, travel=0.04) == 0.0
    assert impact_share(shaken[100:], deflection, rate, 0.04, warm_up=1.0) > expected


# ---- protocols -------------------------------------------------------------------------------------------------------


def test_the_survey_rides_several_inputs_and_iso7096_repeats_one():
    assert Protocol().runs("EM7") == [Run(seed) for seed in INPUTS["EM7"].seeds]
    assert Protocol(seeds=(5, 6)).runs("EM7") == [Run(5), Run(6)]
    assert iso7096().runs("EM7") == [Run(INPUTS["EM7"].seeds[0], n) for n in range(3)]
    assert iso7096(seeds=(5,)).runs("EM1") == [Run(5, n) for n in range(3)]
    assert iso7096().has_both_persons
    assert not iso7096(masses=(55.0, 80.0)).has_both_persons
    with pytest.raises(SetupError, match="seeds: expected one"):
        iso7096(seeds=(1, 2))


SHORT = {"classes": ("EM5",), "masses": (55.0,), "duration": 12.0, "warm_up": 2.0}


def seats(folder: Path, *, travel: float | None = 0.04, **parameters: Any) -> list[EvaluatedSystem]:
    """The seat suspension with parameters, and the passive seat in the same installation."""
    system, reference = seat_suspension(folder), seat_suspension(folder)
    installation = Installation(travel)
    system.parameters |= installed(system, installation) | parameters
    common = installed(reference, installation) | common_parameters(system)
    passive = passive_seat(reference, read_parameter_sets(["passive"], reference), common)
    return [EvaluatedSystem("seat", system, seat_signals(), travel), passive]


def test_repeated_runs_have_the_same_floor_and_other_sensor_noise(native: Path):
    noisy = {"seat.sensor.acceleration_noise": 0.2, "seat.sensor.seed": 7}
    exact, quiet = evaluate(seats(native / "fmi2", **noisy), iso7096(**SHORT))
    runs = exact.results["EM5", 55.0].rides
    assert len({run.floor.a_w for run in runs}) == 1
    assert len({run.seat.a_w for run in runs}) == 3
    assert len({run.seat.a_w for run in quiet.results["EM5", 55.0].rides}) == 1
    assert [run.run.repetition for run in runs] == [0, 1, 2]


def test_the_damping_test_finds_the_resonance_of_a_seat_with_75_kg(native: Path):
    """Against the passive seat's own transmissibility: 75 and 28 kg on 4600 N/m, 1.06 Hz undamped."""
    controlled, passive = evaluate(seats(native / "fmi2"), iso7096(**SHORT))
    found = passive.damping
    assert found.amplitude == floor_amplitude(0.04) == pytest.approx(0.016)
    assert found.frequency == pytest.approx(1.0, abs=0.1)
    system = passive.evaluated.system
    parameters = {
        **dict.fromkeys(("seat.cushion_stiffness",), 9e6),
        "seat.cushion_damping": 2.5e4,
        "seat.driver_mass": 75.0,
        "shaker.profile": "sine",
        "shaker.sine.frequency": found.frequency,
        "shaker.sine.amplitude": 0.016,
    }
    run = system.simulate(20.0, parameters=parameters)
    again = sine_transmissibility(
        run["shaker.floor_acceleration"], run["seat.driver_acceleration"], 500.0, found.frequency, 10.0
    )
    assert found.transmissibility == pytest.approx(again.rms_ratio, rel=1e-9)
    assert 1.0 < found.transmissibility < 1.5
    verdicts = judge_all([controlled, passive], iso7096(**SHORT))
    assert [each.criterion.key for each in verdicts[1].criteria][-2:] == ["repeatability", "damping"]


def test_the_survey_has_no_damping_test_and_judges_no_repeatability(native: Path):
    evaluations = evaluate(seats(native / "fmi2"), Protocol(**SHORT))
    verdict = judge_all(evaluations, Protocol(**SHORT))[0]
    assert evaluations[0].damping is None
    assert not {"damping", "repeatability"} & {each.criterion.key for each in verdict.criteria}


# ---- installation ----------------------------------------------------------------------------------------------------


def test_what_belongs_to_the_test_is_the_same_for_both_seats(native: Path):
    changed = {
        "seat.cushion_stiffness": 5e4,
        "seat.end_stop.travel": 0.03,
        "shaker.random.scale": 0.5,
        "seat.friction.alpha": 0.0,
        "seat.actuator.delay": 0.01,
    }
    active, passive = seats(native / "fmi2", **changed)
    assert (active.end_stop_travel, passive.end_stop_travel) == (0.03, 0.03)
    for name in ("seat.cushion_stiffness", "shaker.random.scale", "seat.end_stop.stiffness"):
        assert passive.system.parameters[name] == active.system.parameters[name]
    assert passive.system.parameters["seat.friction.alpha"] != 0.0
    assert "seat.actuator.delay" not in passive.system.parameters


@pytest.mark.parametrize(
    ("words", "travel"),
    [
        ((), 0.04),
        (("--travel", "25"), 0.025),
        (("--travel", "none"), None),
        (("--set", "seat.end_stop.travel=0.02"), 0.02),
        (("--travel", "25", "--set", "seat.end_stop.travel=0.02"), 0.02),
        (("--parameters", "own.ssv"), 0.035),
    ],
)
def test_both_seats_have_the_stops_of_the_test(
    words: tuple[str, ...], travel: float | None, shell: Shell, tmp_path: Path
):
    (tmp_path / "own.ssv").write_text(
        '<ssv:ParameterSet xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" version="1.0" '
        'name="own"><ssv:Parameters><ssv:Parameter name="seat.end_stop.travel"><ssv:Real value="0.035"/>'
        "</ssv:Parameter></ssv:Parameters></ssv:ParameterSet>"
    )
    short = ("--classes", "EM1", "--masses", "55", "--seeds", "4", "--duration", "20", "--processes", "1")
    code, _, err = shell("evaluate", *short, *words, "--output", "out")
    assert (code, err) == (0, "")
    active, passive = rows(tmp_path / "out" / "evaluation.csv")
    assert data(tmp_path / "out")["travel_m"] == travel
    if travel is None:
        assert active["end_stop_hits"] == passive["end_stop_hits"] == ""
        assert {"end_stops", "mean_deflection"} <= set(active["not_judged"].split())
    else:
        for row in (active, passive):
            assert int(row["end_stop_hits"]) > 0
            # rubber of 100 kN/m
            assert 1e3 * travel < float(row["peak_deflection (mm)"]) < 1e3 * travel + 20.0


def test_the_robust_mode_knows_the_travel_of_the_test(shell: Shell, tmp_path: Path):
    short = ("--classes", "EM5", "--masses", "55", "--seeds", "4", "--duration", "5", "--processes", "1")
    assert shell("evaluate", *short, "--mode", "robust", "--travel", "35", "--output", "out")[0] == 0
    assert "controller.travel = 0.035" in (tmp_path / "out" / "evaluation.html").read_text(encoding="utf-8")


def test_the_passive_seat_is_measured_where_the_active_one_is(shell: Shell, tmp_path: Path):
    short = ("--classes", "EM6", "--masses", "55", "--seeds", "4", "--duration", "5", "--processes", "1")
    found = []
    for words in ((), ("--seat-signal", "seat.seat_acceleration")):
        assert shell("evaluate", *short, *words, "--output", f"out{len(words)}")[0] == 0
        found.append(rows(tmp_path / f"out{len(words)}" / "evaluation.csv")[1]["a_w (m/s²)"])
    assert found[0] != found[1]


# ---- seats that used to pass -----------------------------------------------------------------------------------------


def test_a_biased_sensor_fails(shell: Shell, tmp_path: Path):
    """0.02 m/s2 drive the seat to its stops, and without them to 92 mm, at 238 N RMS."""
    words = ("--classes", "EM3", "--masses", "55", "--set", BIAS, "--processes", "1")
    code, out, _ = shell("evaluate", *words, "--output", "stops")
    assert code == 0
    found = data(tmp_path / "stops")
    assert found["verdict"] == "fail"
    assert found["deciding_criterion"] == "end_stops"
    assert "Verdict: fail, decided by end stops" in out
    failed = {name for name, each in worst(found).items() if each["verdict"] == "fail"}
    assert {"mean_deflection", "saturation", "end_stops", "seat_vdv", "seat_rms"} == failed
    assert shell("evaluate", *words, "--travel", "none", "--output", "unlimited")[0] == 0
    row = rows(tmp_path / "unlimited" / "evaluation.csv")[0]
    assert (row["verdict"], row["deciding_criterion"]) == ("fail", "saturation")
    assert float(row["peak_deflection (mm)"]) > 70.0
    assert shell("evaluate", *words[:4], "--processes", "1", "--output", "unbiased")[0] == 0
    assert worst(data(tmp_path / "unbiased"))["mean_deflection"]["verdict"] == "pass"


def test_a_seat_that_hits_its_stops_fails(shell: Shell, tmp_path: Path):
    words = ("--classes", "EM2", "--masses", "55,100", "--travel", "30", "--processes", "1")
    code, out, _ = shell("evaluate", *words, "--output", "out")
    assert code == 0
    assert "Verdict: fail, decided by end stops: what impacts add to the SEAT by VDV" in out
    found = rows(tmp_path / "out" / "evaluation.csv")
    assert len(found) == 4
    for row in found:
        assert (row["verdict"], row["deciding_criterion"]) == ("fail", "end_stops")
        assert int(row["end_stop_hits"]) > 50
        assert float(row["impact_share (%)"]) > 20.0
    # the SEAT by a_w alone would let all of them pass
    assert all(float(row["seat"]) < float(row["seat_limit"]) for row in found)


def test_a_good_seat_passes_and_the_passive_one_does_not(shell: Shell, tmp_path: Path):
    words = ("--classes", "EM1", "--masses", "100", "--processes", "1", "--output", "out")
    assert shell("evaluate", "--mode", "robust", *words)[0] == 0
    robust, passive = rows(tmp_path / "out" / "evaluation.csv")
    assert robust["verdict"] == "pass"
    assert (passive["verdict"], passive["deciding_criterion"]) == ("fail", "end_stops")
    assert "seat_vdv" not in (passive["failed"] + passive["not_judged"]).split()


def test_inputs_that_do_not_conform_are_reported(shell: Shell, tmp_path: Path):
    words = ("--mode", "robust", "--classes", "EM4", "--masses", "80", "--processes", "1")
    code, out, _ = shell("evaluate", *words, "--seeds", "1,2,3", "--output", "out")
    assert code == 0
    found = data(tmp_path / "out")
    assert (found["verdict"], found["deciding_criterion"]) == ("fail", "input")
    assert "decided by input conforms" in out
    assert found["systems"][0]["results"][0]["metrics"]["input_rms_error"] == pytest.approx(-5.5, abs=0.7)
    page = (tmp_path / "out" / "evaluation.html").read_text(encoding="utf-8")
    assert page.count("<td>no</td>") >= 2
    assert shell("evaluate", *words, "--output", "conforming")[0] == 0
    assert worst(data(tmp_path / "conforming"))["input"]["verdict"] == "pass"
    assert shell("evaluate", *words, "--set", "shaker.random.scale=0.9", "--output", "scaled")[0] == 0
    assert data(tmp_path / "scaled")["deciding_criterion"] == "input"


def test_the_protocol_of_the_standard_on_the_page(shell: Shell, tmp_path: Path):
    words = ("--protocol", "iso7096", "--classes", "EM5,EM6", "--duration", "30", "--processes", "1")
    code, out, _ = shell("evaluate", *words, "--mode", "robust", "--output", "out")
    assert code == 0
    assert "5.5.3" in out
    page = (tmp_path / "out" / "evaluation.html").read_text(encoding="utf-8")
    for text in ("ISO 7096:2020", "75 kg of inert mass", "Daily exposure", "2002/44/EC", "runs repeat", "Inputs"):
        assert text in page, text
    found = data(tmp_path / "out")
    assert found["protocol"]["driver_masses"] == [55.0, 100.0]
    assert found["protocol"]["seeds"]["EM5"] == [INPUTS["EM5"].seeds[0]] * 3
    assert worst(found)["repeatability"]["value"] == 0.0
    assert worst(found)["damping"]["value"] == found["systems"][0]["damping_test"]["transmissibility"]


def test_exposure_is_that_of_the_directive(shell: Shell, tmp_path: Path):
    words = ("--classes", "EM5", "--masses", "55", "--seeds", "4", "--duration", "20", "--processes", "1")
    assert shell("evaluate", *words, "--output", "out")[0] == 0
    for row in rows(tmp_path / "out" / "evaluation.csv"):
        a_w, dose = float(row["a_w (m/s²)"]), float(row["vdv_8h (m/s^1.75)"])
        assert float(row["a8 (m/s²)"]) == pytest.approx(a_w)
        for name, a8, vdv in (("action", 0.5, 9.1), ("limit", 1.15, 21.0)):
            assert float(row[f"{name}_a_w (h)"]) == pytest.approx(8.0 * (a8 / a_w) ** 2)
            assert float(row[f"{name}_vdv (h)"]) == pytest.approx(8.0 * (vdv / dose) ** 4)


def test_every_row_has_a_verdict_that_its_criteria_explain(shell: Shell, tmp_path: Path):
    words = ("--classes", "EM1,EM6", "--masses", "55,120", "--seeds", "4", "--duration", "20", "--processes", "1")
    assert shell("evaluate", *words, "--output", "out")[0] == 0
    found = data(tmp_path / "out")
    for system in found["systems"]:
        for row in system["results"]:
            outcomes = {each["criterion"]: each["verdict"] for each in row["criteria"]}
            expected = next(one for one in ("fail", "not judged", "pass") if one in outcomes.values())
            assert row["verdict"] == outcomes[row["deciding_criterion"]] == expected
        assert system["verdict"] in {row["verdict"] for row in system["results"]}


def test_a_nan_is_never_passed():
    assert judge_end_stops(result(replace(ride(), end_stop_hits=0, impact_share=math.nan))).outcome is not Outcome.PASS
