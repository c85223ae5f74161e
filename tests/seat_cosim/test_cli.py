"""The command line: files of results, exit codes, one line for each error."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import click
import numpy as np
import pytest

from cosim import Result, System
from seat_controller_fmu.design.gains import preset
from seat_cosim import carried
from seat_cosim.cli.design import design
from seat_cosim.components import COMPONENTS
from seat_cosim.scenarios import SYSTEM_FILES, SYSTEM_NAMES, seat_suspension
from tests.helpers.files import read_csv
from tests.helpers.shell import Shell


def test_reproduce_bump_writes_results_figures_and_table(shell: Shell, tmp_path: Path):
    code, out, err = shell("reproduce", "bump")
    assert (code, err) == (0, "")
    for case in ("uncontrolled", "observer1", "observer2"):
        table = read_csv(tmp_path / "results" / "bump" / case / "result.csv")
        assert len(table["time"]) == 1501
    names = sorted(path.name for path in (tmp_path / "results" / "bump").glob("*.png"))
    assert names == ["fig05_driver_acceleration.png", "fig06_observers.png", "fig07_force.png"]
    for number in ("3.21", "1.39", "1.24", "431.49", "837.96", "203.81", "597.95", "250.00", "75.33"):
        assert number in out
    assert "about 4" in out


def test_reproduction_is_reproducible(shell: Shell, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    contents = []
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        monkeypatch.chdir(tmp_path / folder)
        assert shell("reproduce", "bump")[0] == 0
        files = sorted(path for path in (tmp_path / folder).rglob("*") if path.is_file())
        contents.append([path.read_bytes() for path in files])
    assert len(contents[0]) == 9
    assert contents[0] == contents[1]


def test_run_applies_its_options_in_their_order(shell: Shell, tmp_path: Path):
    code, out, _ = shell(
        "run",
        "sine",
        "--driver-mass",
        "70",
        "--observer",
        "2",
        "--set",
        "controller.driver_mass=60",
        "--stop-time",
        "0.1",
        figure=True,
    )
    assert code == 0
    assert "51 rows and figure" in out
    folder = tmp_path / "results" / "run" / "sine"
    assert {path.name for path in folder.iterdir()} == {"result.csv", "run.json", "overview.png"}
    again = ("--control", "off", "--stop-time", "0.1", "--output", str(folder), "--force")
    assert "51 rows in" in shell("run", "sine", *again)[1]
    assert {path.name for path in folder.iterdir()} == {"result.csv", "run.json"}  # no figure of another run stays
    assert not read_csv(folder / "result.csv")["controller.force"].any()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["run", "bump", "--step-size", "0"], "step size: expected a finite number of seconds above 0, got 0.0"),
        (["run", "bump", "--stop-time", "-1"], "stop time: expected a finite number of seconds above 0, got -1.0"),
        (["run", "bump", "--set", "seat.driver_mass=nan"], "seat.driver_mass: expected a finite number, got nan"),
        (["run", "bump", "--driver-mass", "-5"], "seat.driver_mass: expected a value in [1e-09, inf] kg, got -5.0"),
        (["run", "bump", "--set", "seat.drivr_mass=5"], "did you mean driver_mass"),
        (
            ["run", "bump", "--set", "sead.driver_mass=5"],
            "expected a component among shaker, seat, controller, got sead",
        ),
        (["run", "bump", "--set", "nonsense"], "--set nonsense: expected COMPONENT.VARIABLE=VALUE"),
        (["run", "bump", "--record-every", "0"], "0 is not in the range x>=1"),
        (["run", "bump", "--format", "xlsx"], "'xlsx' is not one of 'csv', 'parquet', 'mdf4'"),
        (["run", "bump", "--observer", "3"], "'3' is not one of '1', '2'"),
        (["run", "jump"], "'jump' is not one of"),
        (["run"], "Missing argument"),
        (["jump"], "expected a command, got jump; seat-cosim --help lists them"),
        (["simulat"], "got simulat (did you mean simulate?)"),
        (["build", "--platforms", "vax"], "--platforms vax: expected all or names of x86_64-linux, aarch64-linux"),
        (["run", "bump", "--output", "/proc/nowhere"], "/proc/nowhere: expected a folder to write to, got"),
    ],
)
def test_wrong_use_is_one_line_and_exit_code_2(shell: Shell, tmp_path: Path, words: list[str], message: str):
    code, out, err = shell(*words)
    assert code == 2
    assert out == ""
    assert err.startswith("seat-cosim: error: ")
    assert message in err
    assert err.count("\n") == 1
    assert not list(tmp_path.rglob("result*"))


def test_run_takes_gains_by_name_and_by_file(shell: Shell, tmp_path: Path):
    results = {}
    (tmp_path / "mine.json").write_text(preset("recommended").to_json())
    for name in ("published", "recommended", "mine.json"):
        assert shell("run", "bump", "--gains", name, "--stop-time", "0.4", "--output", f"of-{name}")[0] == 0
        results[name] = (tmp_path / f"of-{name}" / "result.csv").read_bytes()
    assert shell("run", "bump", "--stop-time", "0.4", "--output", "default")[0] == 0
    assert (tmp_path / "default" / "result.csv").read_bytes() == results["published"]
    assert results["recommended"] == results["mine.json"] != results["published"]


@pytest.mark.parametrize(("number", "gamma"), [("1", "-3e-6"), ("2", "-1e-6")])
def test_the_observer_is_that_of_gamma(shell: Shell, tmp_path: Path, number: str, gamma: str):
    for name, words in (("named", ("--observer", number)), ("set", ("--set", f"controller.observer_gamma={gamma}"))):
        assert shell("run", "bump", *words, "--stop-time", "0.4", "--output", name)[0] == 0
    assert (tmp_path / "named" / "result.csv").read_bytes() == (tmp_path / "set" / "result.csv").read_bytes()


NO_EFFECT = [
    ("design --gains published --observer-gamma -1e-6", "--observer-gamma with --gains published"),
    ("design --gains published --observer-rate -30", "--observer-rate with --gains published"),
    ("design --gains published --observer-gains -4000 -3500", "--observer-gains with --gains published"),
    ("design --gains published --driver-mass-min 40", "--driver-mass-min with --gains published"),
    ("design --gains published --driver-mass-max 120", "--driver-mass-max with --gains published"),
    ("design --gains published --objective lambda", "--objective with --gains published"),
    ("design --gains published --follow 0.2", "--follow with --gains published"),
    ("design --gains published --force-weight 2", "--force-weight with --gains published"),
    ("design --gains published --alpha 0.1", "--alpha with --gains published"),
    ("design --gains published --c0 2", "--c0 with --gains published"),
    ("design --gains published --p2 2", "--p2 with --gains published"),
    ("design --gains published --solver SCS", "--solver with --gains published"),
    ("design --gains published --pareto", "--pareto or --no-pareto: expected with --output FOLDER"),
    ("design --objective margin --follow 0.2", "--follow with --objective margin"),
    ("design --objective lambda --force-weight 1", "--force-weight with --objective lambda"),
    ("run bump --gains recommended --observer 2", "--observer with --gains recommended"),
    ("run bump --gains published --observer 1", "--observer with --gains published"),
    ("run bump --control off --gains recommended", "--gains with --control off"),
    ("run bump --control passive --observer 2", "--observer with --control passive"),
    ("run bump --control passive --compare passive", "--compare with --control passive"),
    ("run bump --time-limit 3", "--time-limit 3: expected with --isolate COMPONENT"),
    ("evaluate --gains recommended --observer 2", "--observer with --gains recommended"),
    ("build --flavour python --platforms all", "--platforms with --flavour python"),
    ("validate --list --strict", "--strict with --list"),
    ("validate --list Some.fmu", "FILE.fmu with --list"),
]


@pytest.mark.parametrize(("line", "message"), NO_EFFECT)
def test_an_option_without_effect_is_an_error_that_names_both(shell: Shell, tmp_path: Path, line: str, message: str):
    code, out, err = shell(*line.split())
    assert (code, out) == (2, "")
    assert message in err
    assert not list(tmp_path.rglob("*.*"))


def test_every_option_of_a_design_counts_or_is_refused_with_given_gains():
    """No option of `design` may be forgotten in the list above."""
    used = {"--gains", "--lambda", "--output", "--mode", "--set"}
    options = {option.opts[0] for option in design.params if isinstance(option, click.Option)} - used
    assert options == {message.split()[0] for line, message in NO_EFFECT if line.startswith("design --gains")}


def test_design_certifies_a_preset(shell: Shell):
    code, out, err = shell("design", "--gains", "published")
    assert (code, err) == (0, "")
    assert "4573.00" in out
    assert "0.0231" in out
    assert "0.0230" in out


def test_design_writes_gains_that_run_and_certify(shell: Shell, tmp_path: Path):
    words = ("--driver-mass-max", "120", "--observer-gains", "-4000", "-3500", "--no-pareto", "--output", "made")
    assert shell("design", *words)[0] == 0
    names = {path.name for path in (tmp_path / "made").iterdir()}
    assert names == {"gains.json", "gains.ssv", "transmissibility.png", "delay_margin.png"}
    assert shell("design", "--gains", "made/gains.json")[0] == 0
    assert shell("run", "bump", "--gains", "made/gains.json", "--stop-time", "0.1")[0] == 0


def test_gains_that_fail_the_certificate_are_reported_with_exit_code_1(shell: Shell, tmp_path: Path):
    wrong = json.loads(preset("published").to_json()) | {"K1": [4573.0, 90.0], "Q": None}
    (tmp_path / "wrong.json").write_text(json.dumps(wrong))
    code, out, err = shell("design", "--gains", "wrong.json")
    assert code == 1
    assert "Certificate" in out
    assert "Xi_11: expected negative definite at lambda = 1.2" in err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--lambda", "0.01"], "expected lambda above alpha = 0.02, got 0.01"),
        (["--driver-mass-min", "120", "--driver-mass-max", "45"], "expected driver_mass_min < driver_mass_max"),
        (["--observer-gamma", "1e-6"], "expected an observer constant Gamma below 0 (a stable observer), got 1e-06"),
        (["--observer-rate", "30"], "expected an observer gain below 0"),
        (["--observer-rate", "-30", "--observer-gamma", "-1e-6"], "expected one of --observer-gamma"),
        (["--gains", "best"], "gains: expected one of published"),
    ],
)
def test_impossible_designs_are_one_line_and_exit_code_2(shell: Shell, words: list[str], message: str):
    code, _, err = shell("design", *words)
    assert code == 2
    assert message in err
    assert err.count("\n") == 1


def test_the_message_about_missing_fmus_names_the_remedy(shell: Shell):
    code, _, err = shell("run", "bump", "--fmus", "nowhere", fmus=False)
    assert code == 2
    assert "expected Shaker.fmu, SeatPlant.fmu, SeatController.fmu, got no such file; run: seat-cosim build" in err


def test_a_wrong_fmu_is_refused(shell: Shell, tmp_path: Path):
    folder = tmp_path / "wrong" / "fmi2"
    folder.mkdir(parents=True)
    for name in ("Shaker", "SeatPlant", "SeatController"):
        (folder / f"{name}.fmu").write_text("not a zip")
    code, _, err = shell("run", "bump", "--fmus", "wrong", fmus=False)
    assert code == 2
    assert "Shaker.fmu: expected an FMU" in err


def test_a_failing_run_is_exit_code_1_and_leaves_a_partial_result(shell: Shell, fmus: Path, tmp_path: Path):
    assert shell("run", "bump", "--stop-time", "0.1", "--output", "here")[0] == 0
    words = ("run", "bump", "--flavour", "python", "--set", "controller.driver_mass_min=100", "--output", "here")
    code, out, err = shell(*words)
    assert code == 1
    assert out == ""
    assert err.startswith("seat-cosim: error: controller: fmi2DoStep failed at t = 0 s (discard)")
    assert "expected driver_mass_min < driver_mass_max, got 100.0 kg and 80.0 kg" in err
    assert err.count("\n") == 1
    assert "(no rows of 3 s in here/result.partial.csv)" in err
    assert [path.name for path in (tmp_path / "here").glob("result*")] == ["result.partial.csv"]
    manifest = json.loads((tmp_path / "here" / "run.json").read_text())
    assert (manifest["complete"], manifest["rows"]) == (False, 0)
    assert manifest["error"].startswith("controller: fmi2DoStep failed at t = 0 s (discard)")


def test_a_run_that_cannot_begin_is_exit_code_1(shell: Shell, tmp_path: Path):
    code, out, err = shell("run", "bump", "--set", "controller.driver_mass_min=100", "--output", "here")
    assert code == 1
    assert out == ""
    assert err.startswith("seat-cosim: error: controller: fmi2ExitInitializationMode failed at t = 0 s (error)")
    assert "driver_mass_max; got driver_mass_min = 100 kg, driver_mass_max = 80 kg" in err
    assert err.count("\n") == 1
    assert [path.name for path in (tmp_path / "here").iterdir()] == ["run.json"]
    manifest = json.loads((tmp_path / "here" / "run.json").read_text())
    assert not manifest["complete"]
    assert manifest["error"] in err


def test_a_refused_run_leaves_an_earlier_result_alone(shell: Shell, tmp_path: Path):
    assert shell("run", "bump", "--stop-time", "0.1", "--output", "here")[0] == 0
    before = (tmp_path / "here" / "result.csv").read_bytes()
    assert shell("run", "bump", "--step-size", "0", "--output", "here")[0] == 2
    assert (tmp_path / "here" / "result.csv").read_bytes() == before


def test_debug_shows_the_traceback_and_nothing_else_does(shell: Shell):
    assert "Traceback" in shell("run", "bump", "--step-size", "0", "--debug")[2]
    assert "Traceback" not in shell("run", "bump", "--step-size", "0")[2]


@pytest.mark.long
def test_build_prints_what_is_built_and_what_is_up_to_date(shell: Shell, tmp_path: Path):
    code, out, _ = shell("build", "--flavour", "fmi2", "--flavour", "fmi3", "--output", "here")
    assert code == 0
    assert len(re.findall(r"(fmu|ssp) .* built", out)) == 2 * (len(COMPONENTS) + len(SYSTEM_NAMES))
    assert "stepper" in out
    assert (tmp_path / "here" / "fmi3" / "SeatController.fmu").exists()
    for names in SYSTEM_FILES.values():
        for floor, name in names.items():
            assert System.load(tmp_path / "here" / name).order == ("controller", "seat", floor)
    out = shell("build", "--flavour", "fmi3", "--output", "here")[1]
    assert out.count("up to date") == len(COMPONENTS) + len(SYSTEM_NAMES) + 1  # the loop in C
    assert "SeatSuspension.ssp" not in out


@pytest.mark.parametrize("words", [("export", "out"), ("fmus", "--export", "out")])
def test_what_the_package_carries_is_exported(
    words: tuple[str, ...], shell: Shell, native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(carried, "package_folders", lambda: (tmp_path / "none", tmp_path / "none"))
    code, _, err = shell(*words)
    assert code == 2
    assert "expected the FMUs of a wheel, got none; build them: seat-cosim build" in err
    monkeypatch.setattr(carried, "package_folders", lambda: (tmp_path / "none", native))
    code, out, _ = shell(*words)
    assert code == 0
    assert str(Path("out", "fmi3", "Shaker.fmu")) in out
    exported = tmp_path / "out" / "fmi2" / "SeatPlant.fmu"
    assert exported.read_bytes() == (native / "fmi2" / "SeatPlant.fmu").read_bytes()
    assert exported.with_name("SeatPlant_ref.csv").exists()
    assert shell(*words)[0] == 0
    (tmp_path / "out" / "examples" / "foreign" / "cabin.py").write_text("# mine\n")
    code, _, err = shell(*words)
    assert code == 2
    assert "cabin.py: expected no other file of this name, got one; --force replaces it" in err
    assert shell(*words, "--force")[0] == 0


def test_fmus_here_win_over_those_of_the_package(
    shell: Shell, native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    for name in ("clone", "wheel", "fmus"):
        (tmp_path / name / "fmi2").mkdir(parents=True)
    monkeypatch.setattr(carried, "package_folders", lambda: (tmp_path / "clone", tmp_path / "wheel"))
    found = []
    for name in ("wheel", "clone", "fmus"):
        shutil.copytree(native / "fmi2", tmp_path / name / "fmi2", dirs_exist_ok=True)
        assert shell("run", "bump", "--stop-time", "0.1", "--output", name + "-run", fmus=False)[0] == 0
        run = json.loads((tmp_path / f"{name}-run" / "run.json").read_text())
        found.append(run["components"]["seat"]["fmu"])
    assert found == [
        f"{tmp_path}/wheel/fmi2/SeatPlant.fmu",
        f"{tmp_path}/clone/fmi2/SeatPlant.fmu",
        "fmus/fmi2/SeatPlant.fmu",
    ]


def test_a_system_of_this_project_has_a_name(
    shell: Shell, native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(carried, "package_folders", lambda: (tmp_path, tmp_path / "none"))
    code, _, err = shell("simulate", "SeatSuspension")
    assert code == 2
    assert "system SeatSuspension: expected a system in fmus (run: seat-cosim build), got no such file" in err
    seat_suspension(native / "fmi3").save(tmp_path / "SeatSuspension-fmi3.ssp")
    assert shell("simulate", "SeatSuspension-fmi3", "--stop-time", "0.1")[0] == 0
    code, _, err = shell("simulate", "SeatSuspensoin")
    assert (code, "did you mean SeatSuspension-fmi3?" in err) == (2, True)


def test_run_writes_the_chosen_formats_and_every_nth_row(shell: Shell, tmp_path: Path):
    words = ("run", "bump", "--stop-time", "0.1", "--output", "here", "--record-every", "20")
    assert shell(*words, "--format", "mdf4", "--format", "parquet", "--format", "csv")[0] == 0
    results = [Result.read(tmp_path / "here" / f"result{suffix}") for suffix in (".csv", ".mf4", ".parquet")]
    assert list(results[0].time) == [0.0, 0.04, 0.08, 0.1]
    assert all(np.array_equal(result.rows, results[0].rows) for result in results)
    assert results[1].units["controller.force"] == results[2].units["controller.force"] == "N"
    assert shell(*words)[0] == 0
    assert not (tmp_path / "here" / "result.mf4").exists()


@pytest.mark.parametrize(
    "command", [[], ["build"], ["export"], ["fmus"], ["run"], ["reproduce"], ["rerun"], ["design"]]
)
def test_help_has_an_example(shell: Shell, command: list[str]):
    code, out, _ = shell(*command, "--help", fmus=False)
    assert code == 0
    assert "Example" in out
    assert "seat-cosim " in out.split("Example")[1]


def test_the_equal_rate_observer_is_that_of_the_preset(shell: Shell, tmp_path: Path):
    for name, words in (("one", ["--observer", "equal-rate"]), ("two", ["--gains", "equal-rate"]), ("three", [])):
        assert shell("run", "bump", "--stop-time", "1", "--driver-mass", "70", "--output", name, *words)[0] == 0
    results = [(tmp_path / name / "result.csv").read_bytes() for name in ("one", "two", "three")]
    assert results[0] == results[1]
    assert results[0] != results[2]


def test_reproduce_takes_the_observer_of_the_rig_and_refuses_it_elsewhere(shell: Shell, tmp_path: Path):
    tables = []
    for words in ([], ["--observer", "1"], ["--observer", "equal-rate"]):
        code, out, err = shell("reproduce", "fig12", "--output", str(tmp_path), *words)
        assert code == 0, err
        tables.append(out)
    assert tables[0] == tables[1] != tables[2]
    for what in ("bump", "fig8", "table1"):
        code, _, err = shell("reproduce", what, "--observer", "2", "--output", str(tmp_path))
        assert code == 2
        assert "--observer 2: expected with the figures of the rig (fig10, fig11, fig12, fig13, fig14, fig15" in err


def test_design_prints_the_margins_of_other_seats(shell: Shell):
    code, out, err = shell("design", "--gains", "published")
    assert code == 0, err
    rows = {line.strip()[:14]: line.split()[-6:] for line in out.splitlines()}
    assert rows["strapped load "] == ["22", "28", "40", "48", "56", "64"]
    assert rows["empty seat, co"] == ["8", "10", "10", "12", "12", "12"]
