"""run.json: complete, failed and killed runs are described so that they can be run again."""

from __future__ import annotations

import json
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cosim import Manifest, Result, SetupError, System, run_to_folder
from cosim.engine.run_options import RunOptions
from cosim.manifest import sha256
from cosim.results.formats import FORMATS
from cosim.units import Linear
from seat_cosim.scenarios import seat_suspension
from tests.helpers.files import read_csv
from tests.helpers.shell import Shell

H = 0.002


@pytest.fixture
def swapped(native: Path) -> System:
    """A system with all that a manifest describes: transformations, parameters of all types."""
    system = seat_suspension(native / "fmi3")
    system.disconnect("controller.suspension_deflection")
    system.connect("seat.suspension_deflection", "controller.suspension_deflection", Linear(0.1 + 0.2, -1e-9))
    system.parameters["shaker.profile"] = "sine"
    system.stop_time = 1.0
    return system


PARAMETERS = {"seat.driver_mass": "70", "controller.anti_windup": "true", "shaker.profile": 2}


def run(system: System, folder: Path, command: Sequence[str] = (), **options: Any) -> Result:
    return run_to_folder(system, folder, RunOptions(0.1, parameters=PARAMETERS, **options), command=command)


def test_run_json_describes_the_run_and_its_end(swapped: System, tmp_path: Path):
    record = ["controller.force", "seat.driver_acceleration"]
    run(swapped, tmp_path, record=record, record_every=2, formats=["parquet"], command=["seat-cosim", "run"])
    content = json.loads((tmp_path / "run.json").read_text())
    assert (content["format"], content["complete"], content["rows"], content["error"]) == (1, True, 26, None)
    assert content["files"] == {name: sha256(tmp_path / name) for name in ("result.csv", "result.parquet")}
    assert content["command"] == ["seat-cosim", "run"]
    assert set(content["versions"]) == {"python", "fmpy", "numpy", "pyarrow", "seat-cosim"}
    assert content["components"]["seat"]["fmu"] == str(swapped.models["seat"].path)
    assert content["components"]["seat"]["model"] == "SeatPlant"
    assert content["components"]["seat"]["fmi"] == "3.0"
    assert content["order"] == ["controller", "seat", "shaker"]
    assert content["algorithm"] == "gauss-seidel"
    assert content["connections"][-1]["factor"] == 0.1 + 0.2
    assert content["parameters"] == {
        "controller.anti_windup": True,
        "seat.driver_mass": 70.0,
        "shaker.profile": "sine",
    }
    assert list(content["parameters"]) == sorted(content["parameters"])
    assert (content["stop_time"], content["step_size"]) == (0.1, H)
    assert (content["record"], content["record_every"], content["formats"]) == (record, 2, ["csv", "parquet"])
    assert content["units"] == {"controller.force": "N", "seat.driver_acceleration": "m/s2"}


def test_a_csv_file_has_the_units_of_the_run_json_that_describes_it(swapped: System, tmp_path: Path):
    units = run(swapped, tmp_path / "run").units
    table = tmp_path / "run" / "result.csv"
    assert "seat.driver_acceleration" in units
    assert Result.read(table).units == units
    assert set(Result.read(table.rename(tmp_path / "run" / "other.csv")).units.values()) == {None}
    (tmp_path / "run" / "run.json").write_text("[]")
    assert set(Result.read(tmp_path / "run" / "other.csv").units.values()) == {None}


def test_equal_runs_write_the_same_bytes(swapped: System, tmp_path: Path):
    contents = []
    for folder in (tmp_path / "one", tmp_path / "two"):
        run(swapped, folder, formats=FORMATS)
        contents.append({path.name: path.read_bytes() for path in folder.iterdir()})
    assert len(contents[0]) == 4
    assert contents[0] == contents[1]


def test_a_manifest_reads_back_and_rebuilds_its_system(swapped: System, tmp_path: Path):
    swapped.component_steps["seat"] = 0.004
    manifest = Manifest.of(swapped, RunOptions(0.3, 0.1, PARAMETERS, algorithm="jacobi"))
    manifest.write(tmp_path)
    read = Manifest.read(tmp_path / "run.json")
    assert read == manifest
    again = read.system()
    assert {sink: connection[:2] for sink, connection in again.connections.items()} == {
        sink: connection[:2] for sink, connection in swapped.connections.items()
    }
    assert again.order == swapped.order
    assert again.component_steps == {"seat": 0.004}
    assert again.algorithm == "jacobi"
    assert again.check_parameters({}) == swapped.check_parameters(PARAMETERS)
    assert Manifest.of(again) == manifest


def test_the_error_of_a_failed_run_names_its_rows_and_file(fmus: Path, tmp_path: Path):
    result = run_to_folder(
        seat_suspension(fmus), tmp_path, RunOptions(0.1, parameters={"controller.driver_mass_min": 90.0})
    )
    assert f"(no rows of 0.1 s in {tmp_path}/result.partial.csv)" in str(result.error)
    manifest = Manifest.read(tmp_path / "run.json")
    assert not manifest.complete
    assert manifest.error
    assert "result.partial" not in manifest.error
    assert manifest.files == {"result.partial.csv": sha256(tmp_path / "result.partial.csv")}


def test_a_run_that_is_not_kept_is_in_its_files_all_the_same(swapped: System, tmp_path: Path):
    kept = run(swapped, tmp_path / "one")
    assert not len(run(swapped, tmp_path / "two", keep=False).time)
    assert np.array_equal(Result.read(tmp_path / "two" / "result.csv").rows, kept.rows)
    assert (tmp_path / "one" / "run.json").read_bytes() == (tmp_path / "two" / "run.json").read_bytes()


def test_a_session_runs_to_many_folders(swapped: System, tmp_path: Path):
    with swapped.open() as session:
        for mass in (60.0, 70.0):
            run_to_folder(
                swapped, tmp_path / f"{mass}", RunOptions(0.1, parameters={"seat.driver_mass": mass}), session=session
            )
    manifests = [Manifest.read(tmp_path / name / "run.json") for name in ("60.0", "70.0")]
    assert [m.parameters["seat.driver_mass"] for m in manifests] == [60.0, 70.0]
    assert manifests[0].files != manifests[1].files


@pytest.mark.parametrize("option", [{"record": ["nothing"]}, {"formats": ["xlsx"]}, {"record_every": 0}])
def test_an_invalid_run_does_not_touch_the_folder(swapped: System, tmp_path: Path, option: dict[str, Any]):
    run(swapped, tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    with pytest.raises(SetupError):
        run(swapped, tmp_path, **option)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


Edit = Callable[[dict[str, Any]], object]


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (lambda content: content.update(format=2), "run.json: format: expected 1, got 2"),
        (lambda content: content.pop("order"), "run.json: expected a key order, got none"),
        (lambda content: content.update(recrd=[]), r"run.json: unknown key recrd \(did you mean record"),
        (lambda content: content.update(record="all"), 'run.json: record: expected a list, got "all"'),
        (lambda content: content.update(record=[1]), r"run.json: record\[0\]: expected a text, got 1"),
        (lambda content: content.update(stop_time="3 s"), 'run.json: stop_time: expected a number, got "3 s"'),
        (lambda content: content.update(record_every=1.5), "run.json: record_every: expected a whole number, got 1.5"),
        (lambda content: content.update(complete=1), "run.json: complete: expected true or false, got 1"),
        (lambda content: content.update(error=1), "run.json: error: expected a text or null, got 1"),
        (lambda content: content.update(algorithm="euler"), 'expected one of gauss-seidel, jacobi, got "euler"'),
        (
            lambda content: content["components"].update(seat=[]),
            r"run.json: components: seat: expected an object, got \[\]",
        ),
        (lambda content: content["components"]["seat"].pop("fmu"), "run.json: components: seat: expected a key fmu"),
        (lambda content: content["connections"][0].update(input="seat.flor"), r"seat\.flor: expected a variable"),
        (
            lambda content: content.update(order=["seat"]),
            "order: expected each of shaker, seat, controller once, got seat",
        ),
        (
            lambda content: content["parameters"].update({"seat.driver_mass": -5.0}),
            "seat.driver_mass: expected a value in",
        ),
        (lambda content: content.update(record=["seat.nothing"]), "record seat.nothing: expected an output"),
        (lambda content: content.update(step_size=-1.0), "step size: expected a finite number of seconds above 0"),
        (
            lambda content: content["components"]["seat"].update(fmu="x.fmu"),
            r"seat: x\.fmu: expected an FMU, got no such file",
        ),
        (
            lambda content: content["components"]["seat"].update(member="x"),
            "/x: expected an FMU in the archive, got none",
        ),
        (
            lambda content: content["components"]["seat"].update(sha256="0" * 64),
            r"fmu: expected .*\(sha256 0{12}…\), got",
        ),
    ],
)
def test_a_run_json_that_does_not_fit_is_one_line_and_exit_code_2(
    shell: Shell, tmp_path: Path, swapped: System, edit: Edit, message: str
):
    run(swapped, tmp_path)
    content = json.loads((tmp_path / "run.json").read_text())
    edit(content)
    (tmp_path / "run.json").write_text(json.dumps(content))
    code, out, err = shell("rerun", "run.json")
    assert (code, out) == (2, "")
    assert err.startswith("seat-cosim: error: ")
    assert err.count("\n") == 1
    with pytest.raises(AssertionError, match=message):  # pytest's match searches, and shows both where it fails
        raise AssertionError(err)
    assert not (tmp_path / "rerun").exists()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "run.json: expected the run.json of a run, got: No such file or directory"),
        ("", "run.json: expected JSON, got: Expecting value"),
        ("time,seat.force\n", "run.json: expected JSON, got: Expecting value"),
        ("[" * 100_000, "run.json: expected JSON, got: "),
        ("[]", "run.json: expected an object, got []"),
    ],
)
def test_a_file_that_is_no_run_json_is_an_error(tmp_path: Path, content: str | None, message: str):
    if content is not None:
        (tmp_path / "run.json").write_text(content)
    with pytest.raises(SetupError) as error:
        Manifest.read(tmp_path / "run.json")
    assert message in str(error.value)


def test_all_problems_of_a_run_json_are_reported_at_once(swapped: System, tmp_path: Path):
    run(swapped, tmp_path)
    content = json.loads((tmp_path / "run.json").read_text())
    content.update(format=2, extra=1, rows="many")
    (tmp_path / "run.json").write_text(json.dumps(content))
    with pytest.raises(SetupError) as error:
        Manifest.read(tmp_path / "run.json")
    assert len(error.value.problems) == 3


def test_rerun_gives_the_same_bytes(shell: Shell, tmp_path: Path):
    words = ("--driver-mass", "70", "--observer", "2", "--record-every", "3", "--format", "parquet", "--format", "mdf4")
    assert shell("run", "sine", "--stop-time", "0.5", "--output", "first", *words)[0] == 0
    code, out, err = shell("rerun", "first/run.json")
    assert (code, err) == (0, "")
    for name in ("result.csv", "result.parquet", "result.mf4"):
        assert f"first/rerun/{name}: 85 rows, the same bytes as in the first run" in out
        assert (tmp_path / "first" / "rerun" / name).read_bytes() == (tmp_path / "first" / name).read_bytes()
    first, again = (Manifest.read(tmp_path / name / "run.json") for name in ("first", "first/rerun"))
    assert again.command == ["seat-cosim", "rerun", "first/run.json"]
    assert first.command[:3] == ["seat-cosim", "run", "sine"]
    assert again.files == first.files
    assert shell("rerun", "first/rerun/run.json", "--output", "third")[0] == 0


def test_rerun_fails_where_the_bytes_are_not_the_same(shell: Shell, tmp_path: Path):
    assert shell("run", "sine", "--stop-time", "0.1", "--output", "here")[0] == 0
    content = json.loads((tmp_path / "here" / "run.json").read_text())
    content["parameters"]["shaker.sine.amplitude"] = 0.005
    content["versions"]["numpy"] = "1.0"
    (tmp_path / "here" / "run.json").write_text(json.dumps(content))
    code, _, err = shell("rerun", "here/run.json")
    note, error = err.splitlines()
    assert code == 1
    assert note == f"note: numpy {np.__version__}, 1.0 in the first run"
    assert f"here/rerun/result.csv: expected sha256 {content['files']['result.csv'][:12]}…, got " in error
    expected, got = (
        read_csv(tmp_path / "here" / name)["shaker.floor_velocity"][0] for name in ("result.csv", "rerun/result.csv")
    )
    assert f"first shaker.floor_velocity in row 0: expected {expected!s}, got {got!s})" in error


def test_rerun_warns_of_a_result_that_was_edited(shell: Shell, tmp_path: Path):
    assert shell("run", "sine", "--stop-time", "0.1", "--output", "here")[0] == 0
    with (tmp_path / "here" / "result.csv").open("a") as stream:
        stream.write("\n")
    code, out, err = shell("rerun", "here/run.json")
    assert code == 0
    assert err == "warning: here/result.csv is not what the first run left\n"
    assert "the same bytes" in out


def test_rerun_does_not_overwrite_what_it_compares_with(shell: Shell):
    assert shell("run", "sine", "--stop-time", "0.1", "--output", "here")[0] == 0
    code, _, err = shell("rerun", "here/run.json", "--output", "here/../here")
    assert code == 2
    assert "expected another folder than that of here/run.json, got the same" in err


def test_changed_and_missing_fmus_are_all_named(shell: Shell, native: Path, tmp_path: Path):
    shutil.copytree(native / "fmi2", tmp_path / "mine" / "fmi2")
    assert shell("run", "sine", "--stop-time", "0.1", "--output", "here", "--fmus", "mine", fmus=False)[0] == 0
    assert shell("rerun", "here/run.json")[0] == 0
    shutil.copy(native / "fmi3" / "Shaker.fmu", tmp_path / "mine" / "fmi2" / "Shaker.fmu")
    (tmp_path / "mine" / "fmi2" / "SeatPlant.fmu").unlink()
    code, _, err = shell("rerun", "here/run.json")
    assert code == 2
    assert "shaker: mine/fmi2/Shaker.fmu: expected the FMU of the run (sha256 " in err
    assert (
        f"seat: mine/fmi2/SeatPlant.fmu: expected an FMU, got no such file in {tmp_path}, where its path starts" in err
    )
    assert "controller" not in err


def test_fmus_inside_a_system_file_are_described_and_run_again(swapped: System, shell: Shell, tmp_path: Path):
    swapped.save("mine.ssp")
    run(System.load("mine.ssp"), tmp_path / "here")
    component = Manifest.read(tmp_path / "here" / "run.json").components["seat"]
    assert (component.fmu, component.member) == ("mine.ssp", "resources/SeatPlant.fmu")
    assert component.sha256 == sha256(swapped.models["seat"].path)
    assert shell("rerun", "here/run.json")[0] == 0


def test_a_process_that_is_killed_leaves_its_rows_and_can_be_run_again(shell: Shell, native: Path, tmp_path: Path):
    folder, stop_time = tmp_path / "killed", 400.0
    script = (
        "from pathlib import Path\nfrom cosim.engine.run_options import RunOptions\n"
        "from cosim.run_folder import run_to_folder\nfrom seat_cosim.scenarios import *\n"
        f"system = seat_suspension(Path({str(native / 'fmi2')!r}))\n"
        f"run_to_folder(system, Path('killed'), RunOptions({stop_time}, real_time=True, keep=False))"
    )
    process = subprocess.Popen([sys.executable, "-c", script], cwd=tmp_path)
    partial = folder / "result.partial.csv"
    try:
        for _ in range(6000):
            if process.poll() is not None or (partial.exists() and partial.read_bytes().count(b"\n") > 100):
                break
            time.sleep(0.01)
    finally:
        process.kill()
    assert process.wait() == -signal.SIGKILL
    assert {path.name for path in folder.iterdir()} == {"result.partial.csv", "run.json", ".lock"}
    left = Result.read(partial)
    assert 100 <= len(left.time) < stop_time / H
    assert list(left.time) == [k * H for k in range(len(left.time))]
    assert not left.complete
    content = json.loads((folder / "run.json").read_text())
    assert (content["complete"], content["stop_time"], content["real_time"]) == (False, stop_time, True)
    content["stop_time"] = float(left.time[-1])
    (folder / "run.json").write_text(json.dumps(content))
    code, out, _ = shell("rerun", "killed/run.json")
    assert code == 0
    assert "the first run was not complete, there is nothing to compare with" in out
    again = Result.read(folder / "rerun" / "result.csv")
    assert np.array_equal(again.time, left.time)
    assert np.array_equal(again.rows[:-1], left.rows[:-1])
