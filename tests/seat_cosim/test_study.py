"""Studies of the seat suspension: their words, the metrics of an evaluation, the shipped ones, and the command."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cosim import metrics
from cosim.errors import SetupError
from cosim.sweep.design import Block, Values, Variable
from cosim.sweep.loaded import LoadedSystem
from cosim.sweep.plan import Batch, make_plan
from cosim.sweep.study import Study
from seat_cosim.cli.seat_options import SeatOptions
from seat_cosim.cli.sweep import duration
from seat_cosim.scenarios import SYSTEM_NAMES, TRUCK, seat_suspension
from seat_cosim.study import SHIPPED, SeatVocabulary, read
from seat_cosim.study.figures import FIGURES, _variance_shares, pareto_front
from tests.helpers.paths import ROOT
from tests.helpers.shell import Shell

pytest.importorskip("pyarrow")
PAGE = ROOT / "docs" / "explanation" / "robustness-studies.md"


@pytest.fixture(scope="session")
def carried_folder(native: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder whose subfolder ``fmus`` has the system of the native FMUs."""
    folder = tmp_path_factory.mktemp("carried")
    for floor, name in SYSTEM_NAMES.items():
        system = seat_suspension(native / "fmi2", floor)
        system.stop_time = 3.0
        system.save(folder / "fmus" / f"{name}.ssp")
    (folder / "fmus" / "fmi2").symlink_to(native / "fmi2")
    return folder


@pytest.fixture
def here(carried_folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(carried_folder)
    return carried_folder


def study(**given: Any) -> Study:
    return Study(**{"name": "s", "system": "SeatSuspension", "vocabulary": SeatVocabulary(), **given})


def grid(**values: tuple[Any, ...]) -> Block:
    return Block({name.replace("__", "."): Variable(Values(each)) for name, each in values.items()})


def rows(given: Study) -> dict[str, list[Any]]:
    plan = make_plan(given)
    with LoadedSystem() as loaded:
        return plan(loaded, Batch(0, given.design.points(range(given.design.runs)))).columns


def test_metrics_are_those_of_the_same_ride_by_hand(here: Path, native: Path):
    travel, seed, mass = 0.02, 3, 80.0
    world = {"seat.end_stop.travel": travel, "seat.end_stop.stiffness": 1e5, "seat.end_stop.damping": 1e3}
    world |= {"shaker.random.class": "EM3", "controller.force_limit": 150.0}
    found = rows(
        study(
            words={"scenario": "random", "gains": "recommended"}, parameters=world, stop_time=8.0, warm_up=2.0,
            vary=[grid(driver_mass=(mass,), shaker__random__seed=(seed,))],
        )
    )  # fmt: skip
    system = seat_suspension(native / "fmi2")
    options = SeatOptions("fmi2", None, gains="recommended", driver_mass=mass)
    given = {"shaker.profile": "random", "shaker.random.seed": seed, **options.parameters(system), **world}
    result = system.simulate(8.0, parameters=given)
    rate, driver = 500.0, result["seat.driver_acceleration"]
    ride, floor = (metrics.ride(signal, rate, 2.0) for signal in (driver, result["shaker.floor_acceleration"]))
    deflection, force = (result[name] for name in ("seat.suspension_deflection", "controller.force"))
    stops = metrics.end_stops(deflection, rate, travel, 2.0)
    spent = metrics.actuator(force, deflection, rate, 2.0)
    after = slice(1000, None)
    expected = {
        "a_w": ride.a_w, "vdv": ride.vdv, "mtvv": ride.mtvv, "crest_factor": ride.crest_factor,
        "floor_a_w": floor.a_w, "seat": ride.a_w / floor.a_w, "seat_vdv": ride.vdv / floor.vdv,
        "peak_acceleration": np.abs(driver[after]).max(), "peak_deflection": np.abs(deflection[after]).max(),
        "mean_deflection": deflection[after].mean(), "end_stop_hits": stops.hits,
        "impact_share": metrics.impact_share(metrics.weighted(driver, rate, 2.0), deflection, rate, travel, 2.0),
        "force_rms": spent.force_rms, "driving_power": spent.power_positive,
        "saturated_share": np.mean(np.abs(force[after]) >= 150.0 * (1.0 - 1e-9)),
    }  # fmt: skip
    assert {name: found[name] for name in expected} == {name: [value] for name, value in expected.items()}
    assert stops.hits > 0
    assert expected["saturated_share"] > 0.0
    assert set(expected) == set(SeatVocabulary.metrics)


def test_a_seat_in_a_truck_is_measured_against_its_cab(here: Path, native: Path):
    found = rows(
        study(
            system="TruckSeat", words={"scenario": "truck"}, stop_time=6.0, warm_up=2.0, metrics=["seat", "floor_a_w"]
        )
    )
    system = seat_suspension(native / "fmi2", TRUCK)
    given = make_plan(study(system="TruckSeat", words={"scenario": "truck"})).case({}).options
    result = system.simulate(6.0, parameters=given.values)
    driver, floor = (
        metrics.ride(result[f"{each}_acceleration"], 500.0, 2.0) for each in ("seat.driver", "truck.floor")
    )
    assert (found["error"], found["floor_a_w"], found["seat"]) == ([None], [floor.a_w], [driver.a_w / floor.a_w])
    with pytest.raises(SetupError, match="scenario truck: expected a system with a component truck, got one of"):
        make_plan(study(words={"scenario": "truck"}))


@pytest.mark.parametrize(
    "words",
    [
        {"gains": "recommended", "driver_mass": 90.0},
        {"gains": "recommended", "observer": "2"},
        {"parameter_sets": "prototype, load", "mode": "robust", "driver_mass": 60.0},
        {"control": "passive", "parameter_sets": "prototype"},
        {"control": "off"},
        {"mode": "robust"},
    ],
    ids=str,
)
def test_choices_mean_what_they_mean_to_other_commands(here: Path, native: Path, words: dict[str, Any]):
    given = {"seat.end_stop.travel": 0.03, "seat.actuator.delay": 0.004}
    names = dict(words)
    sets = tuple(name.strip() for name in names.pop("parameter_sets", "").split(",") if name)
    options = SeatOptions("fmi2", None, sets, **names, settings=tuple(f"{k}={v}" for k, v in given.items()))
    system = seat_suspension(native / "fmi2")
    expected = system.check_parameters({"shaker.profile": "sine", **options.parameters(system)})
    found = make_plan(study(words={"scenario": "sine", **words}, parameters=given)).case({})
    assert found.system.check_parameters(found.options.values) == expected
    assert found.options.stop_time == 5.0


def test_a_mismatch_acts_on_what_the_mode_does_not_know(here: Path):
    share = Variable(Values((2.0,)), scales=("seat.actuator.time_constant",))
    given = study(
        words={"mode": "robust"}, parameters={"seat.actuator.time_constant": 0.01}, vary=[Block({"share": share})]
    )
    values = make_plan(given).case({"share": 2.0}).options.values
    assert values["seat.actuator.time_constant"] == 0.02
    assert values["controller.actuator_time_constant"] == 0.01


def test_gains_and_sets_of_the_studys_folder_are_read_once_and_are_part_of_it(here: Path, tmp_path: Path):
    from seat_controller_fmu.design.gains import FOLDER

    for name in ("published", "recommended"):
        (tmp_path / f"{name}.json").write_bytes((FOLDER / f"{name}.json").read_bytes())
    given = study(folder=tmp_path, vary=[grid(gains=("published.json", "recommended"))])
    plan = make_plan(given)
    expected = make_plan(study(vary=[grid(gains=("published", "recommended"))]))
    (tmp_path / "published.json").write_bytes((tmp_path / "recommended.json").read_bytes())
    assert plan.case({"gains": "published.json"}).options == expected.case({"gains": "published"}).options
    assert make_plan(given).fingerprint != plan.fingerprint


def test_files_of_parameters_travel(here: Path, tmp_path: Path):
    floor = tmp_path / "floor.csv"
    floor.write_text("time,displacement\n" + "".join(f"{0.01 * i},{0.001 * (i % 7)}\n" for i in range(400)))
    given = study(
        folder=tmp_path, words={"scenario": "file"}, stop_time=2.0, metrics=["peak_acceleration"],
        vary=[grid(shaker__file__path=("floor.csv",))],
    )  # fmt: skip
    plan = make_plan(given)
    cache = tmp_path / "cache"
    cache.mkdir()
    for digest, (suffix, content) in plan.assets().items():
        (cache / f"{digest}{suffix}").write_bytes(content)
    moved = plan.hashed().located(cache)
    floor.unlink()
    with LoadedSystem() as loaded:
        found = moved(loaded, Batch(0, [{"shaker.file.path": "floor.csv"}])).columns
    assert found["error"] == [None]
    assert found["peak_acceleration"][0] > 0.0


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"words": {"gains": "recomended"}}, "recommended"),
        ({"words": {"mode": "robuts"}}, "mode: expected one of published, robust, got robuts (did you mean robust?)"),
        ({"words": {"scenario": "bmp"}}, "scenario: expected one of bump, sine, sweep, random, file, truck, got bmp"),
        ({"words": {"control": True}}, "control: expected one of on, off, passive, got True"),
        ({"vary": [grid(driver_mass=(55.0, -1.0))]}, "driver_mass: expected a number above 0 kg, got -1.0"),
        ({"vary": [grid(observer=("1", "3"))]}, "observer: expected one of 1, 2, equal-rate, got 3"),
        ({"metrics": ["aw"]}, "metric aw: expected one of a_w, vdv, mtvv"),
    ],
)  # fmt: skip
def test_a_wrong_word_is_found_before_a_run(here: Path, given: dict[str, Any], message: str):
    with pytest.raises(SetupError) as error:
        make_plan(study(**given))
    assert message in str(error.value)


def test_a_pareto_front_has_no_point_that_is_worse_in_both():
    points = np.random.default_rng(1).random((2, 200))
    front = set(pareto_front(*points).tolist())
    for i in range(200):
        is_dominated = ((points < points[:, [i]]).all(axis=0)).any()
        assert is_dominated != (i in front)


def test_shares_of_variance_are_those_of_a_sum_of_squares():
    x, y, z = np.random.default_rng(2).uniform(-1.0, 1.0, (3, 20_000))
    table = {"run": x, "x": x, "y": y, "z": z, "seat": 3.0 * x**2 + y, "later": z}
    found = _variance_shares(table, np.ones(20_000, dtype=bool))
    total = 9.0 * 4.0 / 45.0 + 1.0 / 3.0  # variances of 3 x^2 and of y
    edges = np.linspace(-1.0, 1.0, 11)
    parabola, line = np.diff(edges**3) / 0.2, (edges[1:] + edges[:-1]) / 2.0  # means of both in each bin
    assert list(found) == ["x", "y", "z"]
    assert found["x"] == pytest.approx(parabola.var() / total, abs=0.02)
    assert found["y"] == pytest.approx(line.var() / total, abs=0.02)
    assert found["z"] < 0.005


def test_durations_are_words():
    assert [duration(each) for each in (0.04, 59.94, 61.0, 7200.0)] == ["0.0 s", "59.9 s", "1 min 1 s", "2 h 0 min"]


# ---- the shipped studies ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_study_fits_the_system_and_says_what_it_asks(here: Path, name: str):
    given = read(name)
    plan = make_plan(given)
    assert given.name == name
    assert given.question.endswith("?")
    assert given.figure in FIGURES
    with LoadedSystem() as loaded:
        last = given.design.runs - 1
        short = make_plan(replace(given, stop_time=3.0, warm_up=1.0))
        assert short(loaded, Batch(last, given.design.points([last]))).columns["error"] == [None]
    assert {column.name for column in plan.columns} >= {"seat", *given.design.variables}


@pytest.fixture
def swept(here: Path, shell: Shell, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Shell:
    monkeypatch.chdir(here)
    return shell


def test_the_command_runs_a_study_draws_its_figure_and_answers(swept: Shell, tmp_path: Path):
    short = (ROOT / "seat_cosim" / "study" / "shipped" / "driver_masses.toml").read_text()
    short = short.replace("stop_time = 40.0", "stop_time = 4.0").replace("warm_up = 10.0", "warm_up = 2.0")
    file = tmp_path / "short.toml"
    file.write_text(short.replace("[45.0, 120.0, 16]", "[45.0, 120.0, 4]"))
    out = tmp_path / "out"
    code, text, err = swept("sweep", str(file), "--output", str(out), "--processes", "2", figure=True)
    assert (code, err) == (0, "")
    assert "120 runs, 0 failed" in text
    assert "From 45 to 120 kg, SEAT is" in text
    assert "runs.parquet, figure.svg, figure.png in" in text
    assert (out / "study.toml").read_text() == file.read_text()
    figure = (out / "figure.svg").read_bytes()
    code, text, err = swept("sweep", str(file), "--output", str(out), "--json")
    found = json.loads(text)
    assert (code, found["runs"], found["resumed"], found["failed"]) == (0, 120, 120, 0)
    assert found["answer"].startswith("From 45 to 120 kg")
    assert (out / "figure.svg").read_bytes() == figure
    file.write_text(file.read_text().replace('seed" = [1, 2]', 'seed" = [1, 3]'))
    code, text, err = swept("sweep", str(file), "--output", str(out))
    assert (code, text) == (2, "")
    assert "expected no sweep, or one of the same study, got another study; --force removes it" in err


def test_a_dry_run_says_how_many_runs_and_how_long(swept: Shell, tmp_path: Path):
    code, text, err = swept("sweep", "comfort_stroke", "--dry-run", "--processes", "3")
    assert (code, err) == (0, "")
    assert f"comfort_stroke: {read('comfort_stroke').design.runs} runs of gains, spring_share, damping" in text
    assert "ms for each run, of which metrics" in text
    assert "on 3 workers" in text


def test_a_study_whose_runs_all_fail_ends_with_their_reason(swept: Shell, tmp_path: Path):
    file = tmp_path / "bad.toml"
    file.write_text(
        'name = "bad"\nsystem = "SeatSuspension"\n[parameters]\n"seat.end_stop.travel" = 0.04\n'
        "[[vary]]\nvariables.driver_mass = [55.0, 70.0]\n"
    )
    code, _, err = swept("sweep", str(file), "--output", str(tmp_path / "out"), "--processes", "1")
    assert code == 1
    assert "expected runs that end, got none; run 0: seat: fmi2ExitInitializationMode failed" in err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("driver_mases",), "study driver_mases: expected a file, or one of actuator_tolerance"),
        (("none.toml",), "none.toml: expected a study in TOML, got: No such file"),
        (("driver_masses", "--workers", "2", "--processes", "2"), "expected one of them, got several"),
    ],
)
def test_a_wrong_command_is_refused(swept: Shell, words: tuple[str, ...], message: str):
    code, text, err = swept("sweep", *words)
    assert (code, text) == (2, "")
    assert message in err


@pytest.mark.long
@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_study_gives_the_answer_of_its_page(swept: Shell, tmp_path: Path, name: str):
    code, text, _ = swept("sweep", name, "--output", str(tmp_path / name), "--json", figure=True)
    found = json.loads(text)
    assert (code, found["failed"]) == (0, 0)
    assert " ".join(found["answer"].split()) in " ".join(PAGE.read_text(encoding="utf-8").split())
    drawn = (tmp_path / name / "figure.svg").read_bytes()
    assert drawn == (ROOT / "docs" / "figures" / f"study-{name}.svg").read_bytes()
