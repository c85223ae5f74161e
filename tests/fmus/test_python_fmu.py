"""The Python FMUs through fmpy, as a foreign host would use them."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from cosim.fmi.description import ModelDescription
from cosim.fmi.instance import Instance
from cosim.fmi.versions import instantiate
from seat_cosim.components import COMPONENTS, EXPERIMENT

H = 0.002


class Host:
    """An instance with names for variables and its messages at hand."""

    def __init__(self, instance: Instance) -> None:
        self.fmu = instance.fmu
        self.instance = instance
        self.references = {name: v.valueReference for name, v in instance.model.variables.items()}

    def set(self, **values: float) -> None:
        for name, value in values.items():
            self.fmu.setReal([self.references[name.replace("__", ".")]], [value])

    def get(self, name: str) -> float:
        return self.fmu.getReal([self.references[name]])[0]

    def outputs(self) -> list[float]:
        return [self.get(v.name) for v in self.instance.model.outputs if v.type == "Real"]

    def initialise(self, start_time: float = 0.0) -> None:
        self.fmu.setupExperiment(startTime=start_time)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def step(self, k: int, h: float = H) -> None:
        self.fmu.doStep(k * h, h)

    @property
    def messages(self) -> list[str]:
        return [message.text for message in self.instance.messages.messages]


@contextmanager
def hosted(path: Path, folder: Path) -> Iterator[Host]:
    model = ModelDescription.read(path)
    if not folder.exists():
        model.extract(folder)
    instance = instantiate("it", model, folder)
    try:
        yield Host(instance)
    finally:
        instance.free()


@pytest.fixture
def controller(fmus: Path, tmp_path: Path) -> Iterator[Host]:
    with hosted(fmus / "SeatController.fmu", tmp_path / "controller") as host:
        yield host


@pytest.fixture
def seat(fmus: Path, tmp_path: Path) -> Iterator[Host]:
    with hosted(fmus / "SeatPlant.fmu", tmp_path / "seat") as host:
        yield host


def drive(host: Host, k: int) -> list[float]:
    """One step with inputs that depend on k alone; returns all outputs."""
    if "suspension_deflection" in host.references and "force_demand" in host.references:
        host.set(seat_acceleration=np.sin(0.3 * k), suspension_deflection=0.02 * np.sin(0.1 * k))
    elif "floor_velocity" in host.references and "force" in host.references:
        host.set(floor_displacement=0.01 * np.sin(0.1 * k), floor_velocity=0.5 * np.cos(0.1 * k), force=40 * np.sin(k))
    elif "seat_velocity" in host.references and "contact_force" in host.references:
        host.set(seat_displacement=0.01 * np.sin(0.1 * k), seat_velocity=0.5 * np.cos(0.1 * k))
    host.step(k)
    return host.outputs()


@pytest.mark.parametrize("name", ["SeatController", "SeatPlant", "Shaker", "SeatedDriver"])
def test_state_round_trips_continue_bit_identically(fmus: Path, tmp_path: Path, name: str):
    random = np.random.default_rng(2)
    path = fmus / f"{name}.fmu"
    with hosted(path, tmp_path / "fmu") as one, hosted(path, tmp_path / "fmu") as other:
        for host in (one, other):
            host.initialise()
        straight = [drive(one, k) for k in range(120)]
        one.fmu.reset()
        one.initialise()
        for k in range(120):
            if random.random() < 0.2:
                state = one.fmu.getFMUstate()
                if random.random() < 0.5:  # into another instance, as bytes
                    restored = other.fmu.deSerializeFMUstate(one.fmu.serializeFMUstate(state))
                    other.fmu.setFMUstate(restored)
                    one, other = other, one
                    other.fmu.freeFMUstate(state)
                else:  # a detour that is undone
                    for detour in range(3):
                        drive(one, k + detour)
                    one.fmu.setFMUstate(state)
                    one.fmu.freeFMUstate(state)
            assert drive(one, k) == straight[k]


def test_state_holds_tuned_parameters_and_time(controller: Host):
    controller.initialise()
    controller.step(0)
    controller.set(driver_mass=70.0)
    state = controller.fmu.getFMUstate()
    controller.set(driver_mass=50.0)
    controller.step(1)
    controller.fmu.setFMUstate(state)
    assert controller.get("driver_mass") == 70.0
    assert controller.get("time") == H


@pytest.mark.parametrize("content", [b"", b"\xff\x00", b"[]", b"{}", b'{"guid": "{0}"}'])
def test_a_foreign_state_is_refused_and_changes_nothing(controller: Host, content: bytes):
    controller.initialise()
    drive(controller, 0)
    before = controller.outputs()
    controller.fmu.setFMUstate(controller.fmu.deSerializeFMUstate(content))
    assert "state: expected one of SeatController" in controller.messages[-1]
    assert controller.outputs() == before


def test_state_of_another_component_is_refused(controller: Host, seat: Host):
    for host in (controller, seat):
        host.initialise()
    content = seat.fmu.serializeFMUstate(seat.fmu.getFMUstate())
    assert json.loads(content)["guid"] == seat.fmu.guid
    controller.fmu.setFMUstate(controller.fmu.deSerializeFMUstate(content))
    with pytest.raises(FMICallException, match="discard"):
        controller.step(0)


def test_reset_is_as_good_as_new(seat: Host):
    seat.initialise()
    first = [drive(seat, k) for k in range(20)]
    seat.set(floor_acceleration=3.0)
    seat.fmu.reset()
    seat.initialise()
    assert [drive(seat, k) for k in range(20)] == first


def test_nan_input_discards_the_step_and_leaves_the_state(seat: Host):
    seat.initialise()
    drive(seat, 0)
    before = seat.outputs()
    seat.set(force=float("nan"))
    with pytest.raises(FMICallException, match=r"discard"):
        seat.step(1)
    assert seat.messages[-1] == "step at t = 0.002 s refused: force: expected a finite number, got nan"
    assert seat.outputs() == before
    seat.set(force=1.0)
    seat.step(1)
    assert seat.outputs() != before


def test_parameter_out_of_range_keeps_the_old_value(controller: Host):
    controller.set(driver_mass=300.0)
    assert controller.get("driver_mass") == 55.0
    controller.initialise()
    with pytest.raises(FMICallException):
        controller.step(0)
    assert "driver_mass: expected a value in [20.0, 250.0] kg, got 300.0" in controller.messages[-1]
    controller.step(0)  # reported once, then the old value is used


def test_a_legal_value_clears_the_error_of_an_illegal_one(controller: Host):
    controller.set(driver_mass=300.0)
    controller.set(driver_mass=60.0)
    controller.initialise()
    controller.step(0)


@pytest.mark.parametrize(("name", "what"), [("observer_gamma", "fixed parameter"), ("force", "discrete output")])
def test_setting_a_fixed_or_calculated_variable_is_refused(controller: Host, name: str, what: str):
    controller.initialise()
    before = controller.get(name)
    controller.set(**{name: -1e-6})
    assert controller.get(name) == before
    assert f"{name}: a {what} may not be set while stepping" in controller.messages[-1]


def test_a_tuned_mass_takes_effect_at_the_next_sample(controller: Host, fmus: Path, tmp_path: Path):
    with hosted(fmus / "SeatController.fmu", tmp_path / "second") as fresh:
        fresh.set(driver_mass=75.0)
        for host in (controller, fresh):
            host.initialise()
        controller.set(driver_mass=75.0)
        assert drive(controller, 0) == drive(fresh, 0)


def test_contradicting_parameters_discard_every_step(controller: Host):
    controller.set(driver_mass_min=90.0)
    controller.initialise()
    for _ in range(2):
        with pytest.raises(FMICallException, match="discard"):
            controller.step(0)
    assert "expected driver_mass_min < driver_mass_max" in controller.messages[-1]


def test_driver_outside_the_range_is_warned_of_once(controller: Host):
    controller.set(driver_mass=120.0)
    controller.initialise()
    for k in range(3):
        controller.step(k)
    assert len([text for text in controller.messages if "outside [45.0, 80.0] kg" in text]) == 1


@pytest.mark.parametrize(("time", "step"), [(1.0, H), (0.0, 0.0), (0.0, -H), (float("nan"), H), (0.0, float("inf"))])
def test_wrong_times_are_refused(seat: Host, time: float, step: float):
    seat.initialise()
    with pytest.raises(FMICallException, match="discard"):
        seat.fmu.doStep(time, step)
    seat.step(0)


def test_a_step_before_initialisation_is_refused(seat: Host):
    with pytest.raises(FMICallException, match="discard"):
        seat.step(0)
    assert "got one while instantiated" in seat.messages[-1]


def test_wrong_references_and_types_discard_one_step(controller: Host):
    assert np.isnan(controller.fmu.getReal([999])[0])
    assert controller.fmu.getInteger([1]) == [0]
    assert controller.fmu.getString([1]) == [b""]
    controller.fmu.setBoolean([1], [True])
    controller.fmu.setReal([controller.references["enabled"]], [0.0])
    controller.fmu.setString([3], ["x"])
    controller.initialise()
    with pytest.raises(FMICallException, match="discard"):
        controller.step(0)
    controller.step(0)


def test_initial_outputs_follow_parameters_and_inputs(fmus: Path, tmp_path: Path):
    with hosted(fmus / "Shaker.fmu", tmp_path / "shaker") as shaker:
        assert shaker.get("floor_acceleration") == pytest.approx(2.158975963)
        shaker.set(bump__height=0.035)
        assert shaker.get("floor_acceleration") == pytest.approx(2.158975963 / 2)
        shaker.fmu.setInteger([shaker.references["profile"]], [2])
        assert shaker.get("floor_acceleration") == 0.0
        shaker.initialise(start_time=1 / 12)
        assert shaker.get("floor_displacement") == pytest.approx(0.006)


def test_time_may_start_anywhere_and_need_not_be_exact(controller: Host):
    controller.initialise(start_time=10.0)
    time = 10.0
    for _ in range(50):
        controller.fmu.doStep(time, H)
        time += H
    assert controller.get("time") == pytest.approx(10.1)


def test_a_percent_sign_in_a_message_is_text(controller: Host):
    controller.fmu.setFMUstate(controller.fmu.deSerializeFMUstate(b'{"guid": "100 %s %n"}'))
    assert controller.messages[-1].endswith("got 100 %s %n")


def test_many_instances_leave_the_host_as_it_was(fmus: Path):
    """pythonfmu alone would crash here: see main_script.py."""
    script = f"""
import shutil, sys
import fmpy
from fmpy.fmi2 import FMU2Slave
before = list(sys.path)
description = fmpy.read_model_description({str(fmus / "SeatPlant.fmu")!r})
for _ in range(40):
    folder = fmpy.extract({str(fmus / "SeatPlant.fmu")!r})
    fmu = FMU2Slave(guid=description.guid, modelIdentifier="SeatPlant", unzipDirectory=str(folder), instanceName="x")
    fmu.instantiate()
    fmu.setupExperiment()
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    fmu.doStep(0.0, 0.002)
    fmu.reset()
    fmu.freeInstance()
    shutil.rmtree(folder)
assert sys.path == before, "the search path has grown"
print("fine", flush=True)
"""
    for _ in range(2):
        run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
        assert (run.returncode, run.stdout) == (0, "fine\n"), run.stderr


def test_the_fmu_prints_nothing(fmus: Path, capfd: pytest.CaptureFixture[str], tmp_path: Path):
    with hosted(fmus / "SeatController.fmu", tmp_path / "c") as host:
        host.set(driver_mass=1e9)
        host.initialise()
        with pytest.raises(FMICallException):
            host.step(0)
    assert capfd.readouterr() == ("", "")


def test_two_versions_of_an_fmu_run_in_one_process(fmus: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    import fmus.export.build as builder

    component = next(c for c in COMPONENTS if c.name == "Shaker")
    sources = builder.source_files(component.module, "fmus.pythonfmu.component_slave")
    changed = tmp_path / "profiles.py"
    text = sources["plant_models/shaker/profiles.py"].read_text(encoding="utf-8")
    changed.write_text(text.replace("half = 0.5 * height", "half = 5.0 * height"), encoding="utf-8")
    monkeypatch.setattr(builder, "source_files", lambda *_: {**sources, "plant_models/shaker/profiles.py": changed})
    tenfold = builder.build_python_fmu(component, EXPERIMENT, tmp_path / "tenfold").path

    def height(path: Path, folder: str) -> Any:
        with hosted(path, tmp_path / folder) as shaker:
            shaker.initialise(start_time=0.4)
            return shaker.get("floor_displacement")

    assert height(fmus / "Shaker.fmu", "a") == pytest.approx(0.07)
    assert height(tenfold, "b") == pytest.approx(0.7)
    assert height(fmus / "Shaker.fmu", "c") == pytest.approx(0.07)


def test_plain_fmpy_simulates_each_fmu(fmus: Path):
    for path in fmus.glob("*.fmu"):
        assert len(fmpy.simulate_fmu(str(path), stop_time=0.1, output_interval=0.002)) == 51
