"""Faults of foreign FMUs: each is provoked with a real FMU and ends in one line; nothing is lost or stays behind."""

from __future__ import annotations

import gc
import io
import itertools
import os
import re
import signal
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from cosim import Result, RunError, SetupError, System
from cosim.engine import python_stepper
from cosim.fmi import archive as archives
from cosim.fmi import isolated
from cosim.fmi.child_process import ChildProcess
from cosim.fmi.interrupts import critical_section, deferring_signals
from cosim.results.result import StepperName
from tests.helpers.faulty import faulty_fmu
from tests.helpers.waiting import interrupt_when, wait_until

H = 0.01
STRIKE = 10
"""Tick at which a fault of the stepping strikes, at t = 0.1 s."""

Build = Callable[..., System]
STEPPING = ("step", "set", "get")

linux = pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")


@pytest.fixture(scope="session")
def faulty_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("faulty")


@pytest.fixture
def trace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file into which the FMUs write the calls they get."""
    path = tmp_path / "trace"
    monkeypatch.setenv("FAULTY_TRACE", str(path))
    path.touch()
    return path


@pytest.fixture
def build(faulty_folder: Path) -> Build:
    """Make a system: a sound FMU before and after a component ``cab`` with a fault, each feeding the next."""

    def make(what: str = "ok", where: str = "step", fmi: int = 2) -> System:
        system = System()
        system.add("first", faulty_fmu(faulty_folder))
        system.add("cab", faulty_fmu(faulty_folder, what, where, fmi))
        system.add("last", faulty_fmu(faulty_folder))
        system.parameters["first.u"] = 0.0
        system.connect("first.y", "cab.u")
        system.connect("cab.y", "last.u")
        return system

    return make


def run(system: System, *isolate: str, time_limit: float = 100.0, stepper: StepperName | None = None) -> Result:
    return system.simulate(0.3, H, isolate=isolate, time_limit=time_limit, stepper=stepper)


WAYS = {"c": ((), "c"), "python": ((), "python"), "isolated": (("cab",), "python")}
"""What to isolate, and which loop steps."""

each_way = pytest.mark.parametrize(("isolate", "stepper"), WAYS.values(), ids=WAYS)
each_loop = pytest.mark.parametrize("stepper", ["c", "python"])


def children() -> list[int]:
    """Processes that this one started, dead ones that nobody asked about included."""
    tasks = Path("/proc/self/task").glob("*/children")
    return [int(pid) for task in tasks for pid in task.read_text().split()]


def resources() -> tuple[list[str], list[int], int, list[str]]:
    """What a run may not leave behind: temporary folders, child processes, file descriptors, loaded libraries."""
    gc.collect()
    folders = sorted(path.name for path in Path(tempfile.gettempdir()).iterdir())
    libraries = re.findall(r"\S*faulty\.so.*", Path("/proc/self/maps").read_text())
    return folders, children(), len(list(Path("/proc/self/fd").iterdir())), libraries


@pytest.fixture
def nothing_left(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Check that a test leaves nothing behind."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path_factory.mktemp("temporary")))
    before = resources()
    yield
    assert resources() == before


def calls(trace: Path, component: str) -> list[str]:
    """The calls that a component got."""
    return [line.split()[1] for line in trace.read_text().splitlines() if line.split()[0] == component]


def hangs(trace: Path) -> bool:
    """Whether an FMU hangs in a call."""
    return "sleeps" in trace.read_text()


@pytest.fixture
def limit_from_hang(trace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the time limit of a call begin when the FMU hangs in it: no other call is too slow on a busy machine."""
    has_answered = ChildProcess.has_answered

    def has_answered_or_hangs(process: ChildProcess, limit: float) -> bool:
        answered = False

        def ready() -> bool:
            nonlocal answered
            answered = has_answered(process, 0.02)
            return answered or hangs(trace)

        wait_until(ready)
        return answered or has_answered(process, limit)

    monkeypatch.setattr(ChildProcess, "has_answered", has_answered_or_hangs)


@pytest.fixture
def steady_chunks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Step in chunks of 1, 8, 64, ... ticks, whatever the speed of the machine."""
    microseconds = itertools.count()
    monkeypatch.setattr(python_stepper, "perf_counter", lambda: 1e-6 * next(microseconds))


WHOLE_LIFE = ["instantiate", "enter", "exit", "terminate", "free"]

pytestmark = [linux, pytest.mark.usefixtures("nothing_left")]


# ---- while stepping --------------------------------------------------------------------------------------------------


@each_way
@pytest.mark.parametrize(
    ("what", "where", "fmi", "said", "rows", "life"),
    [
        ("discard", "step", 2, r"cab: fmi2DoStep failed at t = 0\.1 s \(discard\): out of order", STRIKE, WHOLE_LIFE),
        ("error", "step", 2, r"cab: fmi2DoStep failed at t = 0\.1 s \(error\): out of order", STRIKE, None),
        ("error", "step", 3, r"cab: fmi3DoStep failed at t = 0\.1 s \(error\): out of order", STRIKE, None),
        ("fatal", "step", 2, r"cab: fmi2DoStep failed at t = 0\.1 s \(fatal\): out of order", STRIKE, WHOLE_LIFE[:3]),
        ("fatal", "step", 3, r"cab: fmi3DoStep failed at t = 0\.1 s \(fatal\): out of order", STRIKE, WHOLE_LIFE[:3]),
        ("error", "set", 2, r"cab: fmi2SetReal failed at t = 0\.1 s \(error\): out of order", STRIKE, None),
        ("error", "get", 2, r"cab: fmi2GetReal failed at t = 0\.09 s \(error\): out of order", STRIKE - 1, None),
        ("nan_output", "step", 2, r"cab\.y: expected a finite output, got nan at t = 0\.11 s", STRIKE + 1, WHOLE_LIFE),
        ("ends_early", "step", 2, r"cab: fmi2DoStep asked to end the run at t = 0\.1 s", STRIKE, WHOLE_LIFE),
        ("ends_early", "step", 3, r"cab: fmi3DoStep asked to end the run at t = 0\.11 s", STRIKE, WHOLE_LIFE),
        ("error", "terminate", 2, r"cab: fmi2Terminate failed at t = 0\.3 s \(error\): out of order", 31, WHOLE_LIFE),
        ("fatal", "terminate", 3, r"cab: fmi3Terminate failed at t = 0\.3 s \(fatal\): out of ord", 31, WHOLE_LIFE[:4]),
    ],
)
def test_a_failing_fmu_ends_the_run_and_loses_nothing(
    build: Build,
    trace: Path,
    isolate: tuple[str, ...],
    stepper: StepperName,
    what: str,
    where: str,
    fmi: int,
    said: str,
    rows: int,
    life: list[str] | None,
):
    sound = run(build(fmi=fmi))
    trace.write_text("")
    result = run(build(what, where, fmi), *isolate, stepper=stepper)
    assert not result.complete
    assert result.stepper == stepper
    assert isinstance(result.error, RunError)
    assert re.fullmatch(said + ".*", str(result.error)), result.error
    assert len(result.time) == rows
    assert all(np.array_equal(result[n][:STRIKE], sound[n][:rows][:STRIKE], equal_nan=True) for n in result.values)
    assert calls(trace, "first") == calls(trace, "last") == WHOLE_LIFE
    # no terminate after an error, no free after a fatal one
    assert calls(trace, "cab") == (life or [*WHOLE_LIFE[:3], "free"])


@pytest.mark.parametrize(
    ("where", "function", "when"),
    [
        ("set", "fmi2SetReal", 0.1),
        ("get", "fmi2GetReal", 0.09),
        ("step", "fmi2DoStep", 0.1),
        ("set", "fmi3SetFloat64", 0.1),
        ("get", "fmi3GetFloat64", 0.09),
        ("step", "fmi3DoStep", 0.1),
    ],
)
def test_a_warning_is_reported_once_a_run_and_the_run_goes_on(build: Build, where: str, function: str, when: float):
    for what, said in {"warning": "out of order", "silent_warning": f"{function} returned a warning"}.items():
        expected = [f"cab: {said} ({function}, t = {when:g} s)"]
        with build(what, where, int(function[3])).open() as session:
            runs = [session.run(0.3, H, stepper=stepper) for stepper in ("c", "python", "c")]
        assert [(result.complete, result.warnings) for result in runs] == 3 * [(True, expected)]


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_warning_of_an_isolated_fmu_is_reported_likewise(build: Build, fmi: int):
    for what, said in {"warning": "out of order", "silent_warning": f"fmi{fmi}DoStep returned a warning"}.items():
        result = run(build(what, fmi=fmi), "cab")
        assert (result.complete, result.warnings) == (True, [f"cab: {said} (fmi{fmi}DoStep, t = 0.1 s)"])


def test_the_first_failure_is_reported(build: Build, faulty_folder: Path):
    system = build("error")
    system.add("sore", faulty_fmu(faulty_folder, "error", "terminate"))
    assert "cab: fmi2DoStep failed" in str(run(system).error)


# ---- before the first step -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("isolate", [(), ("cab",)], ids=["inside", "isolated"])
@pytest.mark.parametrize(
    ("what", "where", "said"),
    [
        ("unresolved", "load", r"cab: load failed at t = 0 s: .*undefined symbol: nowhere"),
        ("missing", "load", r"cab: load failed at t = 0 s: .*undefined symbol: fmi2Reset"),
        ("nothing", "instantiate", r"cab: instantiate failed at t = 0 s: no licence"),
        ("error", "enter", r"cab: fmi2EnterInitializationMode failed at t = 0 s \(error\): out of order"),
        ("fatal", "leave", r"cab: fmi2ExitInitializationMode failed at t = 0 s \(fatal\): out of order"),
    ],
)
def test_an_fmu_that_fails_before_the_first_step_is_named_and_the_others_are_freed(
    build: Build, trace: Path, what: str, where: str, said: str, isolate: tuple[str, ...]
):
    with pytest.raises(RunError) as error:
        run(build(what, where), *isolate)
    assert re.fullmatch(said, str(error.value)), error.value
    first, last = calls(trace, "first"), calls(trace, "last")
    assert first[0] == "instantiate"
    assert first[-1] == "free"
    assert first.count("terminate") == first.count("exit")  # what is initialised is terminated, and only that
    assert last[-1:] == first[-1:] or not last
    assert ("free" in calls(trace, "cab")) == (what == "error")


@pytest.mark.parametrize("isolate", [(), ("cab",)], ids=["inside", "isolated"])
def test_a_failing_reset_is_named_and_another_run_is_possible_where_it_is_not_fatal(
    build: Build, isolate: tuple[str, ...]
):
    with build("error", "reset").open(isolate=isolate) as session:
        assert session.run(0.1, H).complete
        with pytest.raises(RunError, match=r"cab: fmi2Reset failed at t = 0 s \(error\): out of order"):
            session.run(0.1, H)
    with build("fatal", "reset").open(isolate=isolate) as session:
        assert session.run(0.1, H).complete
        for said in (r"cab: fmi2Reset failed at t = 0 s \(fatal\)", "cab: expected an FMU that can run again"):
            with pytest.raises(RunError, match=said):
                session.run(0.1, H)


# ---- isolation -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("fmi", [2, 3])
def test_an_isolated_fmu_computes_the_same_bits(build: Build, fmi: int):
    inside, apart = run(build(fmi=fmi)), run(build(fmi=fmi), "cab", "last")
    assert apart.complete
    assert all(np.array_equal(inside[name], apart[name]) for name in inside.values)


def test_an_isolated_session_runs_again_with_other_parameters(build: Build):
    with build("discard").open(isolate=["cab"]) as session:
        assert len(session.run(0.3, H).time) == STRIKE
        assert len(session.run(0.3, H, {"cab.strikes_at": 0.2}).time) == 2 * STRIKE
        assert session.run(0.3, H, {"cab.strikes_at": 1.0}).complete


HOW = {
    "sleeps": "expected an answer within 0.5 s, got none",
    "segfault": "expected an answer, but the process ended by signal 11 (SIGSEGV)",
    "aborts": "expected an answer, but the process ended by signal 6 (SIGABRT)",
    "exits": "expected an answer, but the process ended with exit code 3",
}


@pytest.mark.usefixtures("limit_from_hang")
@pytest.mark.parametrize("what", HOW)
def test_an_isolated_fmu_that_crashes_or_hangs_while_stepping_ends_the_run(build: Build, trace: Path, what: str):
    result = run(build(what), "cab", time_limit=0.5)
    assert str(result.error) == f"cab: doStep failed at t = 0.1 s: {HOW[what]}"
    assert len(result.time) == STRIKE
    assert calls(trace, "first") == calls(trace, "last") == WHOLE_LIFE


@pytest.mark.usefixtures("limit_from_hang")
@pytest.mark.parametrize("what", HOW)
@pytest.mark.parametrize(("where", "call"), [("load", "load or instantiate"), ("enter", "initialisation")])
def test_an_isolated_fmu_that_crashes_or_hangs_before_the_first_step_is_named(
    build: Build, trace: Path, monkeypatch: pytest.MonkeyPatch, what: str, where: str, call: str
):
    monkeypatch.setattr(isolated, "LOADING_LIMIT", 0.5)
    with pytest.raises(RunError) as error:
        run(build(what, where), "cab", time_limit=0.5)
    assert str(error.value) == f"cab: {call} failed at t = 0 s: {HOW[what]}"
    assert calls(trace, "first")[-1] == "free"


@pytest.mark.usefixtures("limit_from_hang")
@pytest.mark.parametrize("what", ["sleeps", "segfault"])
def test_an_isolated_fmu_that_crashes_or_hangs_in_the_end_spoils_nothing(build: Build, trace: Path, what: str):
    result = run(build(what, "terminate"), "cab", time_limit=0.5)
    assert str(result.error) == f"cab: terminate failed at t = 0.3 s: {HOW[what]}"
    assert len(result.time) == 31
    assert calls(trace, "first") == calls(trace, "last") == WHOLE_LIFE
    trace.write_text("")
    freed = run(build(what, "release"), "cab", time_limit=0.5)
    assert freed.complete
    assert freed.warnings == [f"cab: free failed at t = 0.3 s: {HOW[what]}"]
    assert calls(trace, "first") == calls(trace, "last") == WHOLE_LIFE


def test_what_is_to_be_isolated_is_checked(build: Build):
    with pytest.raises(SetupError, match=r"isolate cap: expected a component among first, cab, last, .*mean cab\?"):
        build().simulate(0.1, H, isolate=["cap"])
    for limit in (0.0, -1.0, float("nan"), float("inf")):
        with pytest.raises(SetupError, match="time limit: expected"):
            build().open(isolate=["cab"], time_limit=limit)


SCRIPT = """
import os, sys, signal
from cosim import System
system = System()
system.add("cab", sys.argv[1])
with system.open(isolate=["cab"], time_limit=1000.0) as session:
    print(next(iter(session._instances.values()))._process.pid, flush=True)
    result = session.run(0.3, 0.01)
    print(result.complete)
"""


def test_isolation_works_from_a_script_without_a_guard(faulty_folder: Path):
    command = [sys.executable, "-c", SCRIPT, str(faulty_fmu(faulty_folder))]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (found.returncode, found.stderr) == (0, "")
    assert found.stdout.split()[1] == "True"


@pytest.mark.parametrize("what", ["ok", "sleeps"])
def test_an_isolated_process_ends_when_its_parent_is_killed_also_in_the_middle_of_a_call(
    faulty_folder: Path, tmp_path: Path, trace: Path, what: str
):
    script = SCRIPT.replace("result = ", "sys.stdin.read() if sys.argv[2] == 'ok' else None; result = ")
    command = [sys.executable, "-c", script, str(faulty_fmu(faulty_folder, what)), what]
    environment = {**os.environ, "TMPDIR": str(tmp_path)}  # who is killed leaves a folder behind
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen(command, env=environment, text=True, **pipes) as parent:
        try:
            child = int(parent.stdout.readline())
            if what == "sleeps":
                wait_until(lambda: hangs(trace))
            assert alive(child)
        finally:
            parent.kill()
    wait_until(lambda: not alive(child))


def alive(pid: int) -> bool:
    """Whether a process runs; one that has ended, but which nobody asked about, does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


# ---- Ctrl-C ----------------------------------------------------------------------------------------------------------


@each_loop
@pytest.mark.parametrize(
    ("where", "rows"), [("step", STRIKE + 1), ("set", STRIKE + 1), ("get", STRIKE), ("terminate", 31)]
)
def test_ctrl_c_in_a_call_of_a_run_keeps_its_rows(
    build: Build, trace: Path, where: str, rows: int, stepper: StepperName
):
    result = run(build("interrupts", where), stepper=stepper)
    assert not result.complete
    reached = rows if stepper == "python" or rows == 31 else len(result.time)  # C looks after a chunk of steps
    assert rows <= reached <= 31
    assert str(result.error) == f"interrupted at t = {min(reached, 30) * H:g} s"
    assert len(result.time) == reached
    assert [calls(trace, name) for name in ("first", "cab", "last")] == 3 * [WHOLE_LIFE]


@pytest.mark.parametrize("where", ["load", "instantiate", "enter", "leave", "release"])
def test_ctrl_c_in_any_other_call_frees_everything(build: Build, trace: Path, where: str):
    with pytest.raises(KeyboardInterrupt):
        run(build("interrupts", where))
    for name in ("first", "cab", "last"):
        found = calls(trace, name)
        assert found.count("instantiate") == found.count("free")
        assert found.count("exit") == found.count("terminate")


def test_ctrl_c_does_not_wait_for_an_isolated_fmu_that_hangs(build: Build, trace: Path):
    with (
        build("sleeps").open(isolate=["cab"], time_limit=1000.0) as session,
        interrupt_when(lambda: hangs(trace)),
    ):
        result = session.run(0.3, H)
    assert str(result.error) == "interrupted at t = 0.1 s"  # neither the limit nor the FMU's answer has ended the run
    assert len(result.time) == STRIKE
    assert calls(trace, "first") == WHOLE_LIFE


def test_a_second_ctrl_c_does_not_wait():
    reached = []

    def insist() -> None:
        with deferring_signals(), critical_section():
            for time in (1, 2, 3):
                reached.append(time)
                signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        insist()
    assert reached == [1, 2]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


# ---- standard output -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("isolate", [(), ("cab",)], ids=["inside", "isolated"])
@pytest.mark.parametrize(
    ("where", "call", "when"),
    [
        ("load", "load", "0"),
        ("instantiate", "instantiate", "0"),
        ("enter", "initialisation", "0"),
        ("leave", "initialisation", "0"),
        ("terminate", "terminate", "0.3"),
        ("release", "free", "0.3"),
    ],
)
def test_what_an_fmu_prints_becomes_a_warning(
    build: Build,
    capfd: pytest.CaptureFixture[str],
    where: str,
    call: str,
    when: str,
    isolate: tuple[str, ...],
):
    result = run(build("prints", where), *isolate)
    assert result.complete
    assert result.warnings == [f"cab: printed to stdout in {call} at t = {when} s: hello from C"]
    assert capfd.readouterr().out == ""


@pytest.mark.usefixtures("steady_chunks")
def test_what_is_printed_in_a_step_is_attributed_as_far_as_it_can_be(build: Build, capfd: pytest.CaptureFixture[str]):
    system = build("prints_once")
    text = "printed to stdout in doStep at t = {} s: hello from C (and 1 more line)"
    chunk = text.format("0.09 to 0.3")
    for isolate, expected in {
        ("cab",): f"cab: {text.format(0.1)}",
        ("first", "last"): f"cab: {chunk}",
        (): f"first or cab or last: {chunk}",
    }.items():
        assert run(system, *isolate).warnings == [expected]
    assert run(build("prints"), "cab").warnings == ["cab: printed to stdout in doStep at t = 0.1 s: hello from C"]
    assert capfd.readouterr().out == ""


@pytest.mark.usefixtures("steady_chunks")
@each_loop
@pytest.mark.parametrize("where", STEPPING)
def test_what_is_printed_in_every_step_is_attributed(
    build: Build, capfd: pytest.CaptureFixture[str], where: str, stepper: StepperName
):
    system = build("prints", where)
    sound = build().simulate(30.0, H)
    with system.open() as session:
        for _ in range(2):
            result = session.run(30.0, H, stepper=stepper)
            # printed in the chunk from tick 9 to 73, attributed in the tick after it
            assert result.warnings == ["cab: printed to stdout in doStep at t = 0.73 s: hello from C"]
            assert all(np.array_equal(result[name], sound[name]) for name in sound.values)
    assert capfd.readouterr().out == ""


def test_our_own_output_is_not_diverted(build: Build, capfd: pytest.CaptureFixture[str]):
    system = build("prints")
    with system.open() as session:
        print("between")
        result = session.run(0.3, H, progress=lambda t: print(f"reached {t:g} s"))
        os.write(1, b"after\n")
    assert len(result.warnings) == 1
    first, *reached, last = capfd.readouterr().out.splitlines()
    assert (first, reached[-1], last) == ("between", "reached 0.3 s", "after")
    assert all(line.startswith("reached ") for line in reached)
    with system.open(capture_stdout=False) as session:
        assert session.run(0.15, H).warnings == []
    assert capfd.readouterr().out == 5 * "hello from C\n"


def test_standard_output_that_is_no_file_is_left_as_it_was(build: Build, monkeypatch: pytest.MonkeyPatch):
    notebook = io.StringIO()
    monkeypatch.setattr(sys, "stdout", notebook)
    assert len(run(build("prints")).warnings) == 1
    assert sys.stdout is notebook
    monkeypatch.setattr(sys, "stdout", None)
    assert len(run(build("prints")).warnings) == 1
    assert notebook.getvalue() == ""


def test_a_session_inside_another_ones_progress_leaves_standard_output_as_it_was(
    build: Build, capfd: pytest.CaptureFixture[str]
):
    inner = []
    outer = build("prints").simulate(0.3, H, progress=lambda _: inner.append(run(build("prints", "load"))))
    print("after")
    assert inner[0].warnings == ["cab: printed to stdout in load at t = 0 s: hello from C"]
    assert len(outer.warnings) == 1
    assert capfd.readouterr().out == "after\n"


def test_standard_output_comes_back_after_a_failure(build: Build, capfd: pytest.CaptureFixture[str]):
    with pytest.raises(RunError):
        run(build("nothing", "instantiate"))
    os.write(1, b"back\n")
    assert capfd.readouterr().out == "back\n"


def test_sinks_and_progress_have_their_standard_output(build: Build, capfd: pytest.CaptureFixture[str]):
    class Loud:
        def begin(self, names: list[str], units: list[str | None]) -> None:
            print("begin")

        def write(self, rows: np.ndarray) -> None:
            print("write")

        def end(self, complete: bool) -> None:
            print("end")

    result = build().simulate(H, H, sinks=[Loud()], progress=lambda _: print("progress"))
    assert result.warnings == []
    assert capfd.readouterr().out.split() == ["begin", "write", "progress", "write", "end"]


# ---- nothing piles up ------------------------------------------------------------------------------------------------


def resident() -> int:
    """Memory of this process in kB."""
    return int(re.search(r"VmRSS:\s+(\d+)", Path("/proc/self/status").read_text())[1])


def growth(action: Callable[[], object], times: int) -> float:
    """Memory that each of many repetitions costs, in kB; what comes in one piece now and then is no growth."""
    sizes = []
    for _ in range(3):  # the first to warm up
        for _ in range(times // 2):
            action()
        gc.collect()
        sizes.append(resident())
    return min(np.diff(sizes)) / (times // 2)


PER_RUN = 0.5
"""kB that a run may cost for good; measured: 0.00 to 0.05, an instance that is not freed costs more than that alone."""

PER_LOAD = 5.0
"""kB that loading and freeing may cost; measured: see docs/reference/faults.md."""


def test_a_thousand_runs_of_a_session_cost_no_memory(build: Build):
    with build("discard").open() as session:
        assert growth(lambda: session.run(0.2, H), 1000) < PER_RUN


def test_a_hundred_runs_of_an_isolated_session_cost_no_memory(build: Build):
    with build("discard").open(isolate=["cab"]) as session:
        assert growth(lambda: session.run(0.2, H), 100) < PER_LOAD


@pytest.mark.parametrize("times", [100, pytest.param(1000, marks=pytest.mark.long)])
def test_loading_and_freeing_costs_no_memory(build: Build, times: int):
    assert growth(lambda: run(build("prints")), times) < PER_LOAD


@pytest.mark.parametrize(("what", "where"), [("missing", "load"), ("nothing", "instantiate"), ("error", "enter")])
def test_failing_to_load_costs_no_memory(build: Build, what: str, where: str):
    def fail() -> None:
        with pytest.raises(RunError):
            run(build(what, where))

    assert growth(fail, 50) < 4 * PER_LOAD


def test_isolated_loading_and_freeing_costs_no_memory(build: Build):
    assert growth(lambda: run(build("segfault"), "cab"), 6) < 20 * PER_LOAD


# ---- archives --------------------------------------------------------------------------------------------------------


def archive(path: Path, *members: tuple[zipfile.ZipInfo | str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as target:
        for member, content in members:
            target.writestr(member, content)
    return path


def link(name: str) -> zipfile.ZipInfo:
    info = zipfile.ZipInfo(name)
    info.external_attr = 0o120777 << 16
    return info


@pytest.mark.parametrize(
    "name", ["../out.txt", "/out.txt", "a/../../out.txt", "C:/out.txt", "C:out.txt", "a\\..\\out.txt", "..", "//out"]
)
def test_paths_that_leave_the_folder_are_refused(tmp_path: Path, name: str):
    path = archive(tmp_path / "bad.fmu", (name, b""))
    with pytest.raises(SetupError, match=re.escape(f"member {name!r}: expected a relative path")):
        System().add("bad", path)


def test_links_doubles_and_encrypted_members_are_refused(tmp_path: Path):
    with pytest.raises(SetupError, match="member 'x': expected a file or folder, got a link"):
        System().add("bad", archive(tmp_path / "link.fmu", (link("x"), b"/etc/passwd")))
    with pytest.warns(UserWarning, match="Duplicate name"):
        double = archive(tmp_path / "double.fmu", ("x", b"1"), ("x", b"2"))
    with pytest.raises(SetupError, match="member 'x': expected it once"):
        System().add("bad", double)
    locked = archive(tmp_path / "locked.fmu", ("x", b"1"))
    content = bytearray(locked.read_bytes())
    content[content.index(b"PK\x01\x02") + 8] |= 1  # the flag in the table of contents
    locked.write_bytes(content)
    with pytest.raises(SetupError, match="member 'x': expected no encryption"):
        System().add("bad", locked)


def test_bombs_are_refused_and_large_tables_are_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(archives, "SAFE_SIZE", 2**20)
    bomb = archive(tmp_path / "bomb.fmu", ("zeros", bytes(4 * 2**20)))
    with pytest.raises(SetupError, match=r"expected at most 200 times .*got 4 MiB from .*'zeros'"):
        System().add("bad", bomb)
    monkeypatch.setattr(archives, "MAX_SIZE", 2**20)
    with pytest.raises(SetupError, match="expected at most 1 MiB when extracted, got 4 MiB"):
        System().add("bad", bomb)
    table = "\n".join(f"{k * 0.002:.3f},{np.sin(k):.6f}" for k in range(20_000)).encode()
    monkeypatch.setattr(archives, "MAX_SIZE", 8 * 2**20)
    monkeypatch.setattr(archives, "SAFE_SIZE", 2**10)
    path = archive(tmp_path / "table.zip", ("table.csv", table))
    with archives.open_archive(path, path) as opened:
        assert opened.read("table.csv") == table


def test_the_problems_of_an_archive_are_reported_together_but_not_all(tmp_path: Path):
    path = archive(tmp_path / "bad.fmu", *((f"../{i}", b"") for i in range(20)))
    with pytest.raises(SetupError) as error:
        System().add("bad", path)
    assert len(error.value.problems) == 6
    assert error.value.problems[-1].endswith("15 more problems")


def test_nothing_of_a_bad_archive_is_extracted(build: Build, tmp_path: Path):
    system = build()
    good = tmp_path / "good.fmu"
    good.write_bytes(system.models["cab"].path.read_bytes())
    system.add("new", good)
    with zipfile.ZipFile(good, "a") as target:
        target.writestr("../escaped.txt", "x")  # changed after it was read
    with pytest.raises(SetupError, match="escaped"):
        run(system)
    assert not list(Path(tempfile.gettempdir()).glob("escaped.txt"))
