"""Running a system: rows and their times, repeated runs, failures that lose nothing."""

from __future__ import annotations

import csv
import re
import tempfile
import zipfile
from pathlib import Path

import numpy as np
import pytest

import fmus.export.build as builder
from cosim import RunError, SetupError, System
from cosim.engine.clock import Clock
from cosim.results.result import COMPLETE, PARTIAL, StepperName
from seat_cosim.components import COMPONENTS, EXPERIMENT
from tests.helpers.files import edited_text
from tests.helpers.hosts import LOOPS

H = 0.002

FAULT = "if time + step_size > 0.1001: {}"
FAULTS = {
    "discards": "raise ArithmeticError('out of order')",
    "raises": "raise RuntimeError('out of order')",
    "nan": "return state, Outputs(float('nan'), 0.0, 0.0)",
}
"""What a real, but faulty shaker does at t = 0.1 s."""


@pytest.fixture(scope="module")
def faulty(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Faulty shakers, built from edited sources."""
    shaker = next(component for component in COMPONENTS if component.name == "Shaker")
    sources = builder.source_files(shaker.module, "fmus.pythonfmu.component_slave")
    step = "    return state, _evaluate_outputs(end, state, coefficients)"
    fmus = {}
    for name, fault in FAULTS.items():
        folder = tmp_path_factory.mktemp(name)
        model, slave = (
            sources[path].read_text() for path in ("plant_models/shaker/shaker.py", "fmus/pythonfmu/component_slave.py")
        )
        (folder / "shaker.py").write_text(edited_text(model, step, f"    {FAULT.format(fault)}\n{step}"))
        (folder / "component_slave.py").write_text(edited_text(slave, "if not math.isfinite(value)", "if False"))
        edited = {
            "plant_models/shaker/shaker.py": folder / "shaker.py",
            "fmus/pythonfmu/component_slave.py": folder / "component_slave.py",
        }
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(builder, "source_files", lambda *_, edited=edited: {**sources, **edited})
            fmus[name] = builder.build_python_fmu(shaker, EXPERIMENT, folder).path
    return fmus


@pytest.fixture(autouse=True)
def own_temporary_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Others may run on this machine."""
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))


def left_behind() -> list[str]:
    return sorted(path.name for path in Path(tempfile.gettempdir()).glob("seat-cosim-*"))


def test_rows_are_exact_multiples_of_the_step(system: System):
    result = system.simulate(0.2, H, record=["seat.driver_acceleration"])
    assert result.complete
    assert result.error is None
    assert list(result.time) == [k * H for k in range(101)]
    assert result.units == {"seat.driver_acceleration": "m/s2"}
    assert len(result["seat.driver_acceleration"]) == 101


def test_a_row_holds_the_floor_and_the_force_of_its_own_instant(system: System):
    result = system.simulate(0.1, H)
    exact = 0.035 * (1 - np.cos(2 * np.pi / 0.8 * result.time))
    assert result["shaker.floor_displacement"] == pytest.approx(exact, abs=1e-15)
    assert result["seat.seat_acceleration"][0] == 0.0
    assert result["controller.force"][0] == 0.0
    assert result["controller.force"][1] == pytest.approx(-2.395876, rel=1e-3)
    assert result["controller.force"][-1] == result["controller.force"][-2]
    assert result["seat.driver_acceleration"][-1] != result["seat.driver_acceleration"][-2]


def test_a_session_runs_again_bit_identically(system: System):
    with system.open() as session:
        first = session.run(0.3, H)
        heavy = session.run(0.3, H, {"seat.driver_mass": 70.0})
        again = session.run(0.3, H)
    assert all(np.array_equal(first[name], again[name]) for name in first.values)
    assert not np.array_equal(first["seat.driver_acceleration"], heavy["seat.driver_acceleration"])


def test_two_sessions_do_not_disturb_each_other(system: System):
    alone = system.simulate(0.1, H)
    with system.open() as one, system.open() as other:
        other.run(0.05, H, {"seat.driver_mass": 70.0})
        beside = one.run(0.1, H)
    assert all(np.array_equal(alone[name], beside[name]) for name in alone.values)


def test_csv_reads_back_to_the_same_bits(system: System, tmp_path: Path):
    result = system.simulate(0.1, H)
    path = result.save(tmp_path)
    assert path == tmp_path / COMPLETE
    with path.open(newline="") as stream:
        names, *rows = csv.reader(stream)
    assert names == ["time", *result.values]
    assert names[1] == "shaker.floor_displacement"
    read = np.array(rows, dtype=float).T
    assert np.array_equal(read[0], result.time)
    assert all(np.array_equal(column, result[name]) for column, name in zip(read[1:], names[1:], strict=True))


@pytest.mark.parametrize("stepper", LOOPS)
@pytest.mark.parametrize(
    ("name", "said", "rows"),
    [
        ("discards", r"bad: fmi2DoStep failed at t = 0\.1 s \(discard\): .*ArithmeticError: out of order", 50),
        ("raises", r"bad: fmi2DoStep failed at t = 0\.1 s \(fatal\): .*out of order", 50),
        ("nan", r"bad\.floor_displacement: expected a finite output, got nan at t = 0\.102 s", 51),
    ],
)
def test_a_failing_fmu_loses_nothing(
    system: System, faulty: dict[str, Path], tmp_path: Path, name: str, said: str, rows: int, stepper: StepperName
):
    good = system.simulate(0.2, H)
    system.add("bad", faulty[name])
    before = left_behind()
    result = system.simulate(1.0, H, stepper=stepper)
    assert not result.complete
    assert isinstance(result.error, RunError)
    assert re.search(said, str(result.error)), result.error
    assert len(result.time) == rows
    assert np.array_equal(result["seat.driver_acceleration"], good["seat.driver_acceleration"][:rows])
    (tmp_path / COMPLETE).write_text("of an earlier run")
    assert result.save(tmp_path).name == PARTIAL
    assert not (tmp_path / COMPLETE).exists()
    assert left_behind() == before


@pytest.mark.parametrize("stepper", LOOPS)
def test_an_interrupted_run_keeps_its_rows(system: System, stepper: StepperName):
    reached: list[float] = []

    def interrupt(time: float) -> None:
        reached.append(time)
        if time > 0.1:
            raise KeyboardInterrupt

    result = system.simulate(30.0, H, progress=interrupt, stepper=stepper)
    assert not result.complete
    assert str(result.error) == f"interrupted at t = {reached[-1]:g} s"
    assert len(result.time) * H == reached[-1] < 30.0


def test_progress_reaches_the_end(system: System):
    times: list[float] = []
    system.simulate(1.0, H, progress=times.append)
    assert times == sorted(set(times))
    assert times[-1] == 1.0


def test_warnings_of_the_fmus_come_with_the_result(system: System):
    result = system.simulate(0.01, H, {"controller.driver_mass": 100.0})
    assert len(result.warnings) == 1
    assert result.warnings[0].startswith("controller: driver_mass 100.0 kg lies outside")


def test_warnings_are_those_of_their_own_run(system: System):
    with system.open() as session:
        assert session.run(0.01, H, {"controller.driver_mass": 100.0}).warnings
        assert not session.run(0.01, H).warnings
        assert session.run(0.01, H, {"controller.driver_mass": 100.0}).warnings


@pytest.mark.parametrize(
    ("stop", "step"), [(1.0, 0.0), (1.0, -1.0), (float("inf"), H), (1.0, float("nan")), (0.0031, H)]
)
def test_impossible_times_are_refused_before_anything_is_loaded(system: System, stop: float, step: float):
    before = left_behind()
    with pytest.raises(SetupError, match="(step size|stop time): expected"):
        system.simulate(stop, step)
    assert left_behind() == before


def test_all_problems_are_reported_at_once(system: System):
    with pytest.raises(SetupError) as error:
        system.simulate(1.0, 0.0, {"seat.driver_mass": -1.0}, record=["nothing"])
    assert len(error.value.problems) == 3


def test_a_minute_has_30001_rows():
    clock = Clock.until(60.0, H)
    assert clock.steps == 30_000
    assert clock.time(30_000) == 60.0


def test_an_fmu_that_cannot_be_loaded_is_named_and_the_others_are_freed(system: System, fmus: Path, tmp_path: Path):
    with zipfile.ZipFile(fmus / "Shaker.fmu") as archive, zipfile.ZipFile(tmp_path / "bad.fmu", "w") as copy:
        for name in archive.namelist():
            copy.writestr(name, b"no library" if name.endswith(".so") else archive.read(name))
    system.add("bad", tmp_path / "bad.fmu")
    before = left_behind()
    here = Path.cwd()
    with pytest.raises(RunError, match="bad: load failed"):
        system.simulate(0.1, H)
    assert left_behind() == before
    assert Path.cwd() == here
