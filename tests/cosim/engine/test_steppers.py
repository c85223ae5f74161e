"""The master's loops in C and in Python: one plan, the same bits, the same words when something fails."""

from __future__ import annotations

import ctypes
import re
import time
import tracemalloc
from collections.abc import Callable, Sequence
from pathlib import Path

import cffi
import numpy as np
import pytest

from cosim import Result, SetupError, System
from cosim.engine import native_stepper
from cosim.engine.recorder import BLOCK
from cosim.engine.structure import ALGORITHMS, Algorithm
from cosim.fmi.instance import Instance
from cosim.results.result import StepperName
from cosim.units import Linear
from seat_cosim.scenarios import OVERVIEW, SCENARIOS, seat_suspension
from tests.cosim.engine.test_structure import edited
from tests.helpers.echo import FAULTS, TYPES, build_echo
from tests.helpers.rig import Rig, bump
from tests.helpers.waiting import interrupt_when

H = 0.002


@pytest.fixture(scope="module")
def echo(tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    """FMUs of every type and every fault, by major version of FMI."""
    folder = tmp_path_factory.mktemp("echo")
    return {version: build_echo(version, folder) for version in TYPES}


def pair(echo: dict[int, Path], versions: Sequence[int] = (3, 3)) -> System:
    """Two echoes that feed each other with every type they have in common."""
    system = System()
    for name, version in zip("ab", versions, strict=True):
        system.add(name, echo[version])
    for kind in TYPES[versions[0]] if versions[0] == versions[1] else ():
        system.connect(f"a.out.{kind}", f"b.in.{kind}")
        system.connect(f"b.out.{kind}", f"a.in.{kind}")
    return system


def both(system: System, *arguments, **options) -> Result:
    """Run in both loops, compare, and return what came out."""
    in_c, in_python = (system.simulate(*arguments, **options, stepper=stepper) for stepper in ("c", "python"))
    assert (in_c.stepper, in_python.stepper) == ("c", "python")
    assert in_c.complete == in_python.complete
    assert str(in_c.error) == str(in_python.error)
    assert in_c.time.tobytes() == in_python.time.tobytes()
    assert in_c.values.keys() == in_python.values.keys()
    for name in in_c.values:
        assert in_c[name].tobytes() == in_python[name].tobytes(), name
    return in_c


# ---- the same bits ---------------------------------------------------------------------------------------------------


@pytest.fixture(params=["fmi2", "fmi3", "python", "mixed"])
def suspension(request: pytest.FixtureRequest, native: Path, fmus: Path) -> System:
    """The seat suspension in every flavour, and of components of different flavours."""
    if request.param != "mixed":
        return seat_suspension(native / request.param)
    mixed = System()
    for name, file in {
        "shaker": "python/Shaker",
        "seat": "fmi3/SeatPlant",
        "controller": "fmi2/SeatController",
    }.items():
        mixed.add(name, native / f"{file}.fmu")
    for sink, feed in seat_suspension(native / "fmi2").connections.items():
        mixed.connect(str(feed.source), str(sink))
    mixed.order = ("controller", "seat", "shaker")
    return mixed


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_the_bump_comes_out_alike(suspension: System, algorithm: Algorithm):
    result = both(suspension, 0.5, H, SCENARIOS["bump"].parameters, algorithm=algorithm)
    assert result.complete
    assert all(result[name].any() for signals in OVERVIEW.values() for name in signals)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
@pytest.mark.parametrize("steps", [{"controller": 2 * H, "shaker": H / 4}, {"seat": H / 3}, {"seat": 4 * H}])
def test_own_steps_come_out_alike(native: Path, steps: dict[str, float], algorithm: Algorithm):
    system = seat_suspension(native / "fmi2")
    plain = system.simulate(0.4, H)
    system.component_steps = steps
    result = both(system, 0.4, H, algorithm=algorithm)
    assert result.complete
    assert not np.array_equal(result["seat.driver_acceleration"], plain["seat.driver_acceleration"])


def test_transformed_values_come_out_alike(native: Path, tmp_path: Path):
    system = System()
    millimetres = ('<BaseUnit m="1"/>', '<BaseUnit m="1" factor="0.001"/>')
    system.add("shaker", edited(native / "fmi2" / "Shaker.fmu", tmp_path / "mm.fmu", millimetres))
    system.add("seat", native / "fmi3" / "SeatPlant.fmu")
    system.connect("shaker.floor_displacement", "seat.floor_displacement", Linear(1.1, 0.003))
    result = both(system, 0.2, H, {"seat.floor_signals": "all"})
    floor = result["seat.seat_displacement"] - result["seat.suspension_deflection"]
    held = 1.1 * 0.001 * result["shaker.floor_displacement"] + 0.003
    assert floor[1:] == pytest.approx(held[:-1], abs=1e-12)  # of the step before


@pytest.mark.parametrize("algorithm", ALGORITHMS)
@pytest.mark.parametrize("versions", [(2, 2), (3, 3)])
def test_every_type_passes_both_ways(echo: dict[int, Path], versions: tuple[int, int], algorithm: Algorithm):
    result = both(pair(echo, versions), 0.04, H, algorithm=algorithm)
    added = 2 if algorithm == "gauss-seidel" else 1  # a number passes one component per step or both
    for kind in TYPES[versions[0]]:
        found, rows = result[f"b.out.{kind}"], np.arange(21)
        if kind == "Boolean" and versions[0] == 3:
            assert found[1:].all()
        else:
            assert found.tolist() == (added * rows).tolist(), kind


# ---- who steps when --------------------------------------------------------------------------------------------------


def test_jacobi_delays_the_force_by_one_sample(native: Path):
    steps = 500
    parameters = {**SCENARIOS["bump"].parameters, "controller.observer_gamma": -1e-6}
    result = seat_suspension(native / "fmi2").simulate(steps * H, H, parameters, algorithm="jacobi")
    with Rig(native / "fmi2") as rig:
        prompt, delayed, late = (
            rig.run(bump(steps * H), {"controller.observer_gamma": -1e-6}, delay).acceleration for delay in (0, 1, 2)
        )
    found = result["seat.driver_acceleration"][:-1]
    difference = {name: np.abs(found - a).max() for name, a in (("0", prompt), ("1", delayed), ("2", late))}
    assert difference["1"] < 1e-9 < 1e-3 < min(difference["0"], difference["2"])


def test_a_larger_step_holds_its_outputs_until_its_time_has_come(echo: dict[int, Path]):
    system = System()
    system.add("a", echo[3])
    system.component_steps = {"a": 5 * H}
    result = both(system, 0.02, H)
    assert result["a.reached"].tolist() == [0.0] * 5 + [5 * H] * 5 + [10 * H]
    assert result["a.count"].tolist() == [0] * 5 + [1] * 5 + [2]


def test_a_smaller_step_fills_the_communication_step(echo: dict[int, Path]):
    system = System()
    system.add("a", echo[2])
    system.component_steps = {"a": H / 4}
    result = both(system, 0.02, H)
    assert result["a.reached"] == pytest.approx(result.time, rel=1e-15)
    assert result["a.count"].tolist() == [*range(0, 41, 4)]


@pytest.mark.parametrize(
    ("steps", "said"),
    [
        ({"seat": 0.003}, "step size of seat: expected a multiple or a whole part of 0.002 s, got 0.003 s"),
        ({"seat": -1.0}, "step size of seat: expected a finite number of seconds above 0, got -1.0"),
        ({"seat": 0.008}, "step size of seat: expected one that fits into 0.1 s, got 0.008 s"),
        ({"chair": 0.004}, "step size of chair: expected a component among shaker, seat, controller"),
    ],
)
def test_steps_that_do_not_fit_are_refused(system: System, steps: dict[str, float], said: str):
    system.component_steps = steps
    with pytest.raises(SetupError, match=re.escape(said)):
        system.validate(0.1, H)
    with system.open() as session, pytest.raises(SetupError, match=re.escape(said)):
        session.run(0.1, H)


@pytest.mark.parametrize(
    ("choice", "said"),
    [
        ({"algorithm": "newton"}, "algorithm: expected gauss-seidel or jacobi, got newton"),
        ({"record_every": 0}, "record every: expected a whole number of steps above 0, got 0"),
        ({"stepper": "rust"}, "stepper: expected c or python, got rust"),
    ],
)
def test_choices_there_are_not_are_refused(system: System, choice: dict[str, object], said: str):
    with pytest.raises(SetupError, match=said):
        system.simulate(0.1, H, **choice)


def test_real_time_is_kept_and_what_comes_late_is_counted(echo: dict[int, Path]):
    system = System()
    system.add("a", echo[3])
    begin = time.monotonic()
    system.simulate(0.06, 0.02, real_time=True)
    assert time.monotonic() - begin >= 0.06
    late = system.simulate(0.006, H, {"a.fault": FAULTS.index("slow")}, real_time=True)
    assert late.complete
    assert late.missed_deadlines == 3
    assert late.worst_lateness >= 3 * 0.02 - 0.006


# ---- rows ------------------------------------------------------------------------------------------------------------


class Collector:
    """A sink that keeps what it gets."""

    def __init__(self) -> None:
        self.rows: list[np.ndarray] = []
        self.begun: tuple[Sequence[str], Sequence[str | None]] | None = None
        self.complete: bool | None = None

    def begin(self, names: Sequence[str], units: Sequence[str | None]) -> None:
        self.begun = names, units

    def write(self, rows: np.ndarray) -> None:
        assert self.complete is None
        assert len(rows)
        self.rows.append(rows.copy())

    def end(self, complete: bool) -> None:
        self.complete = complete


@pytest.mark.parametrize("every", [1, 7, 50, 1000])
def test_rows_every_few_steps_are_those_of_all_steps(native: Path, every: int):
    system = seat_suspension(native / "fmi2")
    full, thin = system.simulate(0.3, H), both(system, 0.3, H, record_every=every)
    ticks = sorted({*range(0, 150, every), 150})
    assert thin.time.tolist() == [tick * H for tick in ticks]
    assert all(np.array_equal(thin[name], full[name][ticks]) for name in full.values)


@pytest.mark.parametrize(
    ("every", "stepper"),
    [(1, "c"), (3, "c"), (1, "python"), pytest.param(3, "python", marks=pytest.mark.long)],  # 200,000 steps in Python
)
def test_sinks_get_every_row_once_whether_rows_are_kept_or_not(echo: dict[int, Path], every: int, stepper: StepperName):
    system, names = pair(echo), ["b.reached", "a.out.Int8", "a.count"]
    stop = (2 * BLOCK * every + 10) * H
    kept, streamed = Collector(), Collector()
    result = system.simulate(stop, H, record=names, record_every=every, sinks=[kept], stepper=stepper)
    empty = system.simulate(stop, H, record=names, record_every=every, sinks=[streamed], keep=False, stepper=stepper)
    assert streamed.begun == (names, [None] * 3)
    assert kept.complete is streamed.complete is True
    expected = np.column_stack([result.time, *result.values.values()])
    assert len(expected) > 2 * BLOCK
    assert np.array_equal(np.concatenate(kept.rows), expected)
    assert np.array_equal(np.concatenate(streamed.rows), expected)
    assert empty.complete
    assert (len(empty.time), empty.values) == (0, {})


def test_memory_does_not_grow_with_a_run_that_keeps_nothing(echo: dict[int, Path]):
    system = pair(echo)
    with system.open() as session:
        session.run(H, H, keep=False)
        tracemalloc.start()
        session.run(100_000 * H, H, keep=False)
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    assert peak < 2 * BLOCK * 8 * (1 + len(system.outputs()))  # of 100 001 rows


def test_a_sink_that_fails_ends_the_others_and_the_session_runs_on(echo: dict[int, Path]):
    class Full(Collector):
        def write(self, rows: np.ndarray) -> None:
            raise OSError("disk full")

    sinks = [Collector(), Full()]
    with pair(echo).open() as session:
        with pytest.raises(OSError, match="disk full"):
            session.run(0.1, H, sinks=sinks)
        assert [sink.complete for sink in sinks] == [False, False]
        assert session.run(0.1, H).complete


# ---- faults ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("version", TYPES)
@pytest.mark.parametrize(
    ("fault", "said", "rows"),
    [
        ("setting", r"b: fmi.Set(Real|Float32) failed at t = 0\.1 s \(error\): .*", 50),
        ("getting", r"b: fmi.Get(Real|Float32) failed at t = 0\.098 s \(error\): .*", 49),
        ("stepping", r"b: fmi.DoStep failed at t = 0\.1 s \(error\): .*", 50),
        ("not a number", r"b\.out\.(Real|Float64): expected a finite output, got nan at t = 0\.102 s", 51),
        ("ending", r"b: fmi3DoStep asked to end the run at t = 0\.102 s", 50),
        ("early", r"b: fmi3DoStep returned early, at t = 0\.1 s", 50),
    ],
)
def test_faults_say_the_same_and_keep_the_same_rows(
    echo: dict[int, Path], version: int, fault: str, said: str, rows: int
):
    if "fmi3" in said and version == 2:
        pytest.skip("FMI 2.0 has no such thing")
    sink = Collector()
    system = pair(echo, (version, version))
    result = both(system, 0.2, H, {"b.fault": FAULTS.index(fault)})
    assert re.fullmatch(said, str(result.error)), result.error
    assert len(result.time) == rows
    streamed = system.simulate(0.2, H, {"b.fault": FAULTS.index(fault)}, sinks=[sink], keep=False)
    assert not streamed.complete
    assert sink.complete is False
    assert np.array_equal(np.concatenate(sink.rows)[:, 0], result.time)


def test_a_warning_goes_on(echo: dict[int, Path]):
    assert both(pair(echo), 0.2, H, {"b.fault": FAULTS.index("warning")}).complete


def test_ctrl_c_ends_a_run_between_two_steps(echo: dict[int, Path]):
    system = System()
    system.add("a", echo[3])
    reached: list[float] = []
    with interrupt_when(lambda: bool(reached)):
        result = system.simulate(1000 * H, H, {"a.fault": FAULTS.index("slow")}, progress=reached.append, stepper="c")
    assert not result.complete
    assert str(result.error) == f"interrupted at t = {len(result.time) * H:g} s"
    assert result["a.count"].tolist() == [*range(len(result.time))]


# ---- which loop ------------------------------------------------------------------------------------------------------


def of_another_source(patch: pytest.MonkeyPatch, folder: Path) -> None:
    changed = folder / "native_stepper.c"
    changed.write_bytes(native_stepper.sources()["native_stepper.c"] + b"\n")
    patch.setattr(native_stepper, "_SOURCES", [changed])


def not_built(patch: pytest.MonkeyPatch, folder: Path) -> None:
    patch.setattr(native_stepper, "BUILT", folder)


@pytest.mark.parametrize("missing", [of_another_source, not_built])
def test_without_a_core_of_this_source_the_loop_is_in_python(
    native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, missing: Callable[..., None]
):
    system = seat_suspension(native / "fmi2")
    expected = system.simulate(0.02, H)
    missing(monkeypatch, tmp_path)
    monkeypatch.setattr(native_stepper, "load", native_stepper.load.__wrapped__)
    result = system.simulate(0.02, H)
    assert (expected.stepper, result.stepper) == ("c", "python")
    assert all(np.array_equal(expected[name], result[name]) for name in expected.values)
    with pytest.raises(SetupError, match="stepper: expected the one in C to be built, got none of this version"):
        system.simulate(0.02, H, stepper="c")


def test_an_fmu_that_cannot_be_called_from_c_is_stepped_in_python(native: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(Instance, "native_calls", lambda self: None)
    system = seat_suspension(native / "fmi2")
    assert system.simulate(0.02, H).stepper == "python"
    with pytest.raises(SetupError, match="stepper: expected FMUs that can be called from C"):
        system.simulate(0.02, H, stepper="c")


# ---- the structures in C and in Python -------------------------------------------------------------------------------


def declared() -> cffi.FFI:
    """Read the header by a parser of C."""
    ffi = cffi.FFI()
    text = Path(native_stepper.__file__).with_suffix(".h").read_text(encoding="utf-8")
    ffi.cdef(text)
    return ffi


@pytest.mark.parametrize("mirror", native_stepper.STRUCTURES, ids=lambda mirror: mirror.__name__)
def test_structures_are_laid_out_as_the_header_declares_them(mirror: type[ctypes.Structure]):
    ffi = declared()
    expected = ffi.typeof(mirror.__name__)
    assert [name for name, _ in mirror._fields_] == [name for name, _ in expected.fields]
    for name, field in expected.fields:
        assert getattr(mirror, name).offset == field.offset, name
        assert getattr(mirror, name).size == ffi.sizeof(field.type), name
    assert ctypes.sizeof(mirror) == ffi.sizeof(expected)


def test_enumerations_are_those_of_the_header():
    ffi = declared()
    assert {cause.name: cause.value for cause in native_stepper.Cause} == ffi.typeof("Cause").relements
    types = dict(sorted(ffi.typeof("ValueType").elements.items()))
    assert [name.replace("bool8", "bool") for name in types.values()] == list(native_stepper.TYPES)
