"""Ways that used to end nowhere: paths, folders that overwrite each other, messages, tracebacks."""

from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import seat_cosim.design_figures
from cosim import Result, System
from cosim.errors import SetupError
from seat_cosim.cli.console import console
from seat_cosim.plausibility import recording_notes
from seat_cosim.scenarios import seat_suspension
from tests.helpers.paths import ROOT
from tests.helpers.shell import Shell


def recording(path: Path, time_factor: float = 1.0, factor: float = 1.0, offset: float = 0.0) -> Path:
    times = np.arange(0.0, 4.0, 0.005)
    values = 1.4 * np.sin(2.0 * np.pi * 2.0 * times)
    rows = (f"{time_factor * t:.6f},{factor * a + offset:.6f}" for t, a in zip(times, values, strict=True))
    path.write_text("\n".join(["time,acceleration", *rows]) + "\n")
    return path


# ---- paths -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("where", ["floor.csv", "rides/floor.csv", "~/floor.csv"])
@pytest.mark.parametrize("command", ["run", "simulate"])
def test_a_recording_is_found_from_where_the_user_stands(
    command: str, where: str, shell: Shell, native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    path = Path(where).expanduser() if where.startswith("~") else tmp_path / where
    path.parent.mkdir(parents=True, exist_ok=True)
    recording(path)
    seat_suspension(native / "fmi2").save(tmp_path / "Seat.ssp")
    words = ("run", "file") if command == "run" else ("simulate", "Seat.ssp", "--set", "shaker.profile=file")
    code, out, _ = shell(*words, "--set", f"shaker.file.path={where}", "--stop-time", "1", "--json")
    assert code == 0
    folder = Path(json.loads(out)["folder"])
    assert json.loads((folder / "run.json").read_text())["parameters"]["shaker.file.path"] == str(path.resolve())
    assert np.abs(Result.read(folder / "result.csv")["shaker.floor_acceleration"]).max() > 0.5


def test_a_missing_recording_is_named_as_the_user_knows_it(shell: Shell, tmp_path: Path):
    code, _, err = shell("run", "file", "--set", "shaker.file.path=no.csv")
    assert code == 2
    assert f"shaker.file.path: expected a file, got none at {tmp_path / 'no.csv'}" in err


def test_the_fmus_own_recording_is_still_found_by_its_name(shell: Shell, native: Path):
    start = seat_suspension(native / "fmi2").models["shaker"].variables["file.path"].start
    assert shell("run", "file", "--set", f"shaker.file.path={start}", "--stop-time", "0.1")[0] == 0


# ---- folders ---------------------------------------------------------------------------------------------------------


def test_runs_with_other_options_have_folders_of_their_own(shell: Shell, tmp_path: Path):
    short = ("--stop-time", "0.1", "--quiet")
    for words in ([], ["--driver-mass", "70"], [], ["--driver-mass", "80"], ["--driver-mass", "70"]):
        assert shell("run", "bump", *words, *short)[0] == 0
    folders = sorted((tmp_path / "results" / "run").iterdir())
    assert [folder.name for folder in folders] == ["bump", "bump-2", "bump-3"]
    masses = [json.loads((f / "run.json").read_text())["parameters"].get("seat.driver_mass") for f in folders]
    assert masses == [None, 70.0, 80.0]


def test_results_of_another_kind_are_not_overwritten(shell: Shell, tmp_path: Path):
    assert shell("run", "bump", "--stop-time", "0.1", "--output", "here")[0] == 0
    before = (tmp_path / "here" / "result.csv").read_bytes()
    assert shell("run", "bump", "--stop-time", "0.1", "--driver-mass", "70", "--output", "here")[0] == 0
    code, _, err = shell("run", "sine", "--stop-time", "0.1", "--output", "here")
    assert code == 2
    assert "--output here: expected no results of another kind, got those of seat-cosim run bump; --force" in err
    assert (tmp_path / "here" / "result.csv").read_bytes() != before
    assert shell("run", "sine", "--stop-time", "0.1", "--output", "here", "--force")[0] == 0
    (tmp_path / "here" / "run.json").write_text("{}")
    assert "got those of another program" in shell("run", "sine", "--stop-time", "0.1", "--output", "here")[2]


def test_a_long_evaluation_survives_a_short_one(shell: Shell, tmp_path: Path):
    short = ("evaluate", "--classes", "EM3", "--seeds", "1", "--duration", "2", "--warm-up", "0", "--processes", "1")
    for mass in ("80", "55", "80"):
        assert shell(*short, "--masses", mass)[0] == 0
    folders = sorted((tmp_path / "results" / "evaluate").iterdir())
    assert [folder.name for folder in folders] == ["SeatSuspension", "SeatSuspension-2"]
    assert "55" in (folders[1] / "evaluation.csv").read_text()


# ---- what is in a file, what is installed, what is better -----------------------------------------------------------


def test_info_shows_what_is_in_a_file(shell: Shell, native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(console, "width", 300)
    seat_suspension(native / "fmi2").save(tmp_path / "Seat.ssp")
    assert shell("run", "bump", "--stop-time", "0.1", "--output", "here", "--driver-mass", "70")[0] == 0
    for file, texts in {
        str(native / "fmi3" / "SeatPlant.fmu"): [
            "SeatPlant, FMI 3.0",
            "floor_displacement",
            "input",
            "m/s2",
            "2 displacement",
        ],
        "Seat.ssp": ["controller.force", "seat.force", "order controller, seat, shaker"],
        "passive": ["seat.suspension_damping", "736.0", "N.s/m", "fitted"],
        "here/run.json": ["51 rows, complete", "seat-cosim run bump", "seat.driver_mass", "70.0"],
    }.items():
        code, out, _ = shell("info", file)
        assert code == 0
        for text in texts:
            assert text in out, f"{file}: {text}"
    for file, message in {
        "none.fmu": "none.fmu: expected an FMU",
        "none.ssv": "none.ssv: expected a parameter set (.ssv), got: No such file",
        "here/result.csv": "expected an .fmu, .ssp, .ssd, .ssv or run.json, got .csv",
        "SeatPlan": "did you mean SeatPlant?",
    }.items():
        code, _, err = shell("info", file)
        assert (code, message in err) == (2, True), err


def test_the_doctor_tells_what_is_there_and_what_is_missing(
    shell: Shell, native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    from seat_cosim import carried, doctor

    monkeypatch.setattr(carried, "package_folders", lambda: (native, tmp_path))
    code, out, _ = shell("doctor", "--json")
    assert code == 0
    facts: dict[tuple[str, str], list[str]] = {}
    for fact in json.loads(out):
        facts.setdefault((fact["group"], fact["name"]), []).append(fact["found"])
    assert facts["master", "stepping loop"] == ["in C"]
    assert any("FMI 3.0" in text for text in facts["FMUs", "Shaker"])
    monkeypatch.setattr(doctor, "version", lambda name: (_ for _ in ()).throw(doctor.PackageNotFoundError(name)))
    monkeypatch.setattr(carried, "package_folders", lambda: (tmp_path, tmp_path))
    code, out, _ = shell("doctor")
    assert code == 1
    assert "WRONG" in out
    assert 'pip install "seat-cosim[mdf]"' in " ".join(out.split())


def test_controllers_are_compared_in_one_table_and_figure(shell: Shell, native: Path, tmp_path: Path):
    words = ("compare", "passive", "published", "recommended", "observer2", str(native / "fmi3" / "SeatController.fmu"))
    where = ("--fmus", str(native))
    code, out, err = shell(*words, *where, "--json")
    assert (code, err) == (0, "")
    found = json.loads(out)
    rides = found["rides"]
    assert list(rides) == ["passive", "published", "recommended", "observer2", "SeatController"]
    assert rides["SeatController"] == rides["published"]
    assert round(rides["published"]["peak"], 2) == 1.39
    assert round(rides["observer2"]["peak"], 2) == 1.24
    assert rides["passive"]["force_peak"] == 0.0
    folder = tmp_path / found["folder"]
    assert (folder / "comparison.png").is_file()
    assert (folder / "observer2" / "result.csv").is_file()
    code, _, err = shell("compare", "best", *where)
    assert code == 2
    assert "or one of observer1, observer2, robust, off, passive, FILE.fmu" in err
    assert "got published twice" in shell("compare", "published", "published", *where)[2]


@pytest.mark.parametrize("name", ["fig8", "fig08"])
def test_a_single_figure_of_the_paper_is_reproduced(shell: Shell, tmp_path: Path, name: str):
    code, out, _ = shell("reproduce", name)
    assert code == 0
    assert "Fig. 8: Simulated transmissibility" in out
    assert {path.name for path in (tmp_path / "results" / "report").iterdir()} == {
        "fig08.csv",
        "fig08.png",
        "fig08.svg",
    }


# ---- messages --------------------------------------------------------------------------------------------------------


def test_messages_name_what_helps(shell: Shell, native: Path, foreign: Path, tmp_path: Path):
    seat_suspension(native / "fmi2").save(tmp_path / "Seat.ssp")
    for words, message in {
        (
            "--parameters",
            "pasive",
        ): "a set among load, passive, prototype, ride, got no such file (did you mean passive?)",
        ("--connect", "shaker.floor_velocity=seat.floor_velocity"): "--disconnect seat.floor_velocity",
        ("--connect", "seat.force=controller.force"): "to be an output, got an input",
        ("--replace", f"shaker={foreign / 'Cabin.fmu'}"): "--connect shaker.z=seat.floor_",
    }.items():
        code, _, err = shell("simulate", "Seat.ssp", *words)
        assert (code, message in err) == (2, True), err
    system = System()
    system.add("seat", native / "fmi2" / "SeatPlant.fmu")
    with pytest.raises(SetupError, match=r"for example: --connect COMPONENT\.OUTPUT=seat\.floor_displacement"):
        system.validate(1.0)


def test_one_problem_at_all_masses_is_reported_once(shell: Shell):
    code, _, err = shell("design", "--objective", "lambda")
    assert code == 1
    assert err.count("sampled loop") == 1
    assert "expected stable at all drivers, got unstable" in err


def test_what_is_asked_for_wrongly_in_python_is_named(native: Path):
    system = seat_suspension(native / "fmi2")
    assert repr(system) == "<System SeatSuspension: shaker, seat, controller; 6 connections>"
    result = system.simulate(0.1, record="seat.driver_acceleration", isolate="shaker")
    assert list(result.values) == ["seat.driver_acceleration"]
    with pytest.raises(KeyError, match=r"seat.driver_aceleration: expected .* \(did you mean seat.driver_acc"):
        result["seat.driver_aceleration"]


# ---- no tracebacks ---------------------------------------------------------------------------------------------------


def test_a_reader_that_leaves_is_no_traceback(tmp_path: Path):
    command = [sys.executable, "-m", "seat_cosim", "validate", "--list"]
    with subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        process.stdout.close()
        assert process.stderr is not None
        assert "Traceback" not in process.stderr.read()


def test_a_full_disk_is_one_line(shell: Shell, monkeypatch: pytest.MonkeyPatch):
    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "made/transmissibility.png")

    monkeypatch.setattr(seat_cosim.design_figures, "draw", full)
    code, _, err = shell("design", "--gains", "published", "--output", "made")
    assert code == 1
    assert err == (
        "seat-cosim: error: made/transmissibility.png: expected to read or write it, got: No space left on device\n"
    )


SWALLOWED = """
import os, signal, sys
from seat_cosim.__main__ import main


class Swallowing:
    def find_spec(self, name, path=None, target=None):
        if name == {name!r}:
            try:
                os.kill(os.getpid(), signal.SIGINT)
            except KeyboardInterrupt:
                pass


sys.meta_path.insert(0, Swallowing())
main()
"""
"""Ctrl-C while a module is looked for, in code that loses the exception, as callbacks of the garbage collector do."""


@pytest.mark.parametrize("name", ["click", "seat_cosim.cli.run"])
def test_an_interrupt_in_an_import_ends_the_command(name: str, tmp_path: Path):
    command = [sys.executable, "-c", SWALLOWED.format(name=name), "run", "bump"]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    ended = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout) == (1, "")
    assert ended.stderr == "seat-cosim: error: interrupted\n"
    assert not list(tmp_path.iterdir())


@pytest.mark.builds
def test_an_interrupt_of_a_run_is_no_traceback(native: Path, tmp_path: Path):
    command = [sys.executable, "-m", "seat_cosim", "run", "random", "--stop-time", "30000", "--fmus", str(native)]
    with subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        while not list(tmp_path.rglob("result.partial.csv")) and process.poll() is None:
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=60)
    assert process.returncode == 1
    assert err.strip().startswith("seat-cosim: error: interrupted at t = ")
    assert "Traceback" not in err


# ---- recordings in other units ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "note"),
    [
        ({"time_factor": 1000.0}, "is the time in ms?"),
        ({"factor": 1.0 / 9.80665}, "is it in g?"),
        ({"offset": 9.80665}, "does it contain gravity?"),
    ],
)
def test_a_recording_in_other_units_is_noted(shell: Shell, tmp_path: Path, changes: dict[str, float], note: str):
    path = recording(tmp_path / "floor.csv", **changes)
    assert [text for text in recording_notes(str(path)) if note in text]
    words = ("run", "file", "--set", "shaker.file.path=floor.csv", "--stop-time", "1")
    code, _, err = shell(*words)
    assert code == 0
    assert err.count(note) == 1
    assert list(recording_notes(str(recording(tmp_path / "right.csv")))) == []


# ---- the rest of the repository --------------------------------------------------------------------------------------


def test_examples_do_not_build_fmus_of_one_name():
    classes = [
        line.partition("class ")[2].partition("(")[0]
        for path in sorted((ROOT / "examples").glob("*/*.py"))
        for line in path.read_text(encoding="utf-8").splitlines()
        if line.startswith("class ")
    ]
    assert len(set(classes)) == len(classes) >= 7


def test_every_example_has_a_command():
    pages = [*(ROOT / "docs").rglob("*.md"), *(ROOT / "examples").rglob("README.md")]
    texts = "\n".join(path.read_text(encoding="utf-8") for path in pages)
    for path in (ROOT / "examples").glob("*/*.py"):
        assert f"build -f examples/{path.parent.name}/{path.name}" in texts, path


@pytest.mark.builds
def test_the_benchmark_of_isolation_runs(
    native: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    from benchmarks import isolation

    monkeypatch.setattr(isolation, "STEPS", 20)
    monkeypatch.setattr(isolation, "REPEATS", 1)
    monkeypatch.setattr(sys, "argv", ["isolation", str(native / "fmi2")])
    isolation.main()
    assert "isolation of a step" in capsys.readouterr().out
