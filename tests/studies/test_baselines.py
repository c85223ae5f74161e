"""The controllers of examples/controllers: their ports, their samples, what they are worth, how they were tuned."""

from __future__ import annotations

import csv
import importlib.util
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

from seat_cosim.scenarios import seat_suspension
from studies.tune_baselines import LQG_CORNER, LQG_WEIGHTS, OFFSET, ROOM, lqg_gains
from tests.helpers.paths import ROOT
from tests.helpers.shell import Shell

SCRIPTS = {"Skyhook": "skyhook", "Pid": "pid", "Lqg": "lqg"}


def module(name: str) -> ModuleType:
    path = ROOT / "examples" / "controllers" / f"{SCRIPTS[name]}.py"
    spec = importlib.util.spec_from_file_location(f"controllers_{path.stem}", path)
    assert spec is not None
    assert spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


def controller(name: str):
    return getattr(module(name), name)(instance_name="controller")


@pytest.fixture(scope="module")
def baselines(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("baselines")
    for script in SCRIPTS.values():
        path = ROOT / "examples" / "controllers" / f"{script}.py"
        command = [sys.executable, "-m", "pythonfmu", "build", "-f", str(path), "-d", str(folder)]
        subprocess.run(command, check=True, capture_output=True)
    return folder


@pytest.mark.parametrize("name", SCRIPTS)
def test_the_ports_are_those_of_the_controller(name: str, baselines: Path, native: Path):
    system = seat_suspension(native / "fmi2")
    before = dict(system.connections)
    system.replace("controller", baselines / f"{name}.fmu")
    assert {sink: feed.source for sink, feed in system.connections.items()} == {
        sink: feed.source for sink, feed in before.items()
    }
    system.check_parameters({"controller.driver_mass": 80.0, "controller.force_limit": 100.0})
    force = system.models["controller"].variables["force"]
    assert force.variability == "discrete"


def rocked(name: str, step: int) -> list[float]:
    """Let a controller sample 200 times a sine that it hears every ``step`` samples; returns its forces then."""
    found, forces = controller(name), []
    for k in range(0, 200, step):
        if k % 4 == 0:
            found.seat_acceleration, found.suspension_deflection = 1.0 - 0.01 * k, 0.0001 * k
        assert found.do_step(k * 0.002, step * 0.002)
        if (k + step) % 4 == 0:
            forces.append(found.force)
    return forces


@pytest.mark.parametrize("name", SCRIPTS)
def test_every_sample_due_is_taken_whatever_the_communication_step(name: str):
    assert rocked(name, 1) == rocked(name, 2) == rocked(name, 4)
    assert any(rocked(name, 1))


@pytest.mark.parametrize("name", SCRIPTS)
def test_the_force_stays_within_its_limit(name: str):
    found = controller(name)
    found.force_limit = 40.0
    forces = []
    for k in range(500):
        found.seat_acceleration = 5.0 if k < 250 else -5.0
        found.do_step(k * 0.002, 0.002)
        forces.append(found.force)
    assert (min(forces), max(forces)) == (-40.0, 40.0)


@pytest.mark.parametrize("name", SCRIPTS)
def test_an_offset_of_the_accelerometer_moves_the_seat_somewhere_and_no_further(name: str):
    """One mass on a spring, without the friction that would hold it, on a still floor for two minutes."""
    found, h, stiffness = controller(name), 0.002, 4600.0
    mass = found.driver_mass + 28.0
    x = v = acceleration = 0.0
    places = []
    for k in range(60_000):
        found.seat_acceleration, found.suspension_deflection = acceleration + OFFSET, x
        found.do_step(k * h, h)
        acceleration = (found.force - stiffness * x) / mass
        v += h * acceleration
        x += h * v
        places.append(x)
    assert abs(places[-1] - places[30_000]) < 1e-4
    assert abs(places[-1]) < 0.5 * ROOM
    assert abs(found.force) < found.force_limit


def test_the_lqg_has_the_gains_of_its_weights():
    script = module("Lqg")
    assert lqg_gains(**LQG_WEIGHTS) == pytest.approx(script.GAINS, rel=5e-4)
    assert controller("Lqg").corner == LQG_CORNER


@pytest.mark.long
@pytest.mark.parametrize("name", SCRIPTS)
def test_they_isolate_as_tuned(name: str, baselines: Path, shell: Shell, tmp_path: Path):
    """In a process of their own. SEAT on EM3, 80 kg: 0.55 uncontrolled, 0.26 with Observer 1."""
    words = ("--classes", "EM3", "--masses", "80", "--seeds", "1", "--duration", "20", "--processes", "2")
    replaced = ("--replace", f"controller={baselines / f'{name}.fmu'}")
    code, out, err = shell("evaluate", *words, *replaced, "--output", "out")
    assert (code, err) == (0, "")
    assert f"SeatSuspension, {name}" in out
    with (tmp_path / "out" / "evaluation.csv").open(encoding="utf-8") as stream:
        first = next(csv.DictReader(stream))
    assert float(first["seat"]) < 0.2
