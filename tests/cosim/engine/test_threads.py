"""Sessions in threads, in processes that fork, and beside other users of standard output and the working folder."""

from __future__ import annotations

import asyncio
import multiprocessing
import os
import signal
import sys
import tempfile
import threading
import time
import zipfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from multiprocessing import resource_tracker
from pathlib import Path

import numpy as np
import pytest

from cosim import System
from cosim.errors import SetupError
from cosim.fmi import output_capture
from cosim.fmi.library import load_library
from cosim.fmi.output_capture import OutputCapture
from cosim.fmi.versions import instantiate
from cosim.results.result import Result
from seat_cosim.scenarios import seat_suspension
from tests.helpers.faulty import faulty_fmu

pytestmark = [pytest.mark.skipif(os.name != "posix", reason="descriptors and signals of POSIX"), pytest.mark.builds]

H = 0.002
SESSIONS = 10


@pytest.fixture(params=["fmi2", "fmi3"])
def seat_system(request: pytest.FixtureRequest, native: Path) -> System:
    return seat_suspension(native / request.param)


@pytest.fixture
def faulty_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("faulty")


def printing(folder: Path, where: str = "step") -> System:
    system = System()
    system.add("cab", faulty_fmu(folder, "prints", where))
    return system


@pytest.fixture(autouse=True)
def nothing_changed(capfd: pytest.CaptureFixture[str]) -> Iterator[None]:
    """Check that standard output, the working folder, descriptors and signals are those of before."""

    def state() -> tuple[object, ...]:
        handlers = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)]
        return (
            output_capture._captures[:],
            Path.cwd(),
            sorted(path.name for path in Path("/proc/self/fd").iterdir()),
            handlers,
        )

    resource_tracker.ensure_running()  # of multiprocessing, stays
    before = state()
    yield
    assert state() == before
    assert sys.stdout is not output_capture._stdout
    print("still open", flush=True)
    assert "still open" in capfd.readouterr().out


def same(one: Result, other: Result) -> bool:
    return all(np.array_equal(one[name], other[name]) for name in one.values)


def watched(done: threading.Event, here: Path) -> list[Path]:
    """Note every working folder but the one of before, until a set of threads is done."""
    found = []
    while not done.is_set():
        try:
            folder = Path.cwd()
        except FileNotFoundError:
            folder = Path("removed")
        if folder != here:
            found.append(folder)
        time.sleep(1e-4)
    return found


def test_sessions_in_threads_give_the_bits_of_one(seat_system: System):
    masses = (55.0, 60.0, 70.0)

    def sessions(mass: float) -> list[Result]:
        found = []
        for _ in range(SESSIONS):
            with seat_system.open() as session:
                found.append(session.run(0.1, H, {"seat.driver_mass": mass}))
        return found

    alone = {mass: seat_system.simulate(0.1, H, {"seat.driver_mass": mass}) for mass in masses}
    done = threading.Event()
    with ThreadPoolExecutor(4) as pool:
        folders = pool.submit(watched, done, Path.cwd())
        try:
            results = dict(zip(masses, pool.map(sessions, masses), strict=True))
        finally:
            done.set()
    assert folders.result() == []
    assert all(same(alone[mass], each) for mass, found in results.items() for each in found)
    assert sum(map(len, results.values())) == 3 * SESSIONS


def test_one_session_used_by_threads_in_turn(seat_system: System):
    with seat_system.open() as session, ThreadPoolExecutor(1) as pool:
        here = session.run(0.1, H)
        assert same(here, pool.submit(session.run, 0.1, H).result())


def test_sessions_of_asyncio_give_the_bits_of_one(seat_system: System):
    async def all_of_them() -> list[Result]:
        return await asyncio.gather(*(asyncio.to_thread(seat_system.simulate, 0.1, H) for _ in range(8)))

    alone = seat_system.simulate(0.1, H)
    assert all(same(alone, each) for each in asyncio.run(all_of_them()))


def test_output_in_another_thread_goes_where_it_went(faulty_folder: Path, capfd: pytest.CaptureFixture[str]):
    system = printing(faulty_folder, "load")
    with ThreadPoolExecutor(1) as pool:
        result = pool.submit(system.simulate, 0.3, 0.01).result()
    assert result.complete
    assert not any("printed" in text for text in result.warnings)
    assert capfd.readouterr().out == "hello from C\n"


@pytest.mark.parametrize("printer", [print, lambda text: sys.stdout.buffer.write(text.encode() + b"\n")])
def test_another_thread_prints_beside_a_capture(printer: Callable[[str], object], capfd: pytest.CaptureFixture[str]):
    capture = OutputCapture()
    with ThreadPoolExecutor(1) as pool:
        with capture.on():
            print("of an FMU")
            pool.submit(printer, "of a thread ☺").result()
        assert capture.take() == "of an FMU\n"
    capture.close()
    assert capfd.readouterr().out == "of a thread ☺\n"


def test_who_keeps_the_diverted_stream_can_print_for_ever(capfd: pytest.CaptureFixture[str]):
    first, second = OutputCapture(), OutputCapture()
    with first.on(), second.on():
        kept = sys.stdout
        print("captured", file=kept)
    assert second.take() == "captured\n"
    first.close(), second.close()
    print("printed", file=kept)
    kept.close()
    print("and again", file=kept, flush=True)
    assert capfd.readouterr().out == "printed\nand again\n"


def test_overlapping_captures_end_in_any_order(capfd: pytest.CaptureFixture[str]):
    before = sys.stdout
    first, second = OutputCapture(), OutputCapture()
    one, other = first.on(), second.on()
    one.__enter__()
    other.__enter__()
    one.__exit__(None, None, None)
    print("inner")
    assert second.take() == "inner\n"
    other.__exit__(None, None, None)
    first.close(), second.close()
    assert sys.stdout is before
    print("after")
    assert capfd.readouterr().out == "after\n"


def test_a_fork_refuses_the_sessions_of_its_parent_and_leaves_their_folders(seat_system: System):
    def in_child(session: object, pipe: int) -> None:
        try:
            session.run(0.1, H)  # type: ignore[attr-defined]
        except SetupError as error:
            os.write(pipe, str(error).encode())
        session.__exit__(None, None, None)  # type: ignore[attr-defined]
        os.write(pipe, b"; new one: " + str(seat_system.simulate(0.1, H).complete).encode())

    with seat_system.open() as session:
        alone = session.run(0.1, H)
        ours, theirs = os.pipe()
        child = os.fork()
        if not child:
            try:
                in_child(session, theirs)
            finally:
                os._exit(0)
        os.close(theirs)
        with os.fdopen(ours) as stream:
            text = stream.read()
        assert os.waitpid(child, 0)[1] == 0
        assert text == (
            f"session: expected the process that loaded the FMUs ({os.getpid()}), got a fork of it ({child}); open a "
            "session there, or start processes with spawn; new one: True"
        )
        assert same(alone, session.run(0.1, H))


def test_a_fork_leaves_isolated_fmus_alone(seat_system: System):
    with seat_system.open(isolate=["seat"]) as session:
        alone = session.run(0.1, H)
        child = os.fork()
        if not child:
            try:
                session.__exit__(None, None, None)
            finally:
                os._exit(0)
        os.waitpid(child, 0)
        assert same(alone, session.run(0.1, H))


def _simulate(folder: Path) -> np.ndarray:
    return seat_suspension(folder).simulate(0.1, H).rows


def test_spawned_processes_give_the_bits_of_one(native: Path):
    folder = native / "fmi3"
    with seat_suspension(folder).open() as session, multiprocessing.get_context("spawn").Pool(2) as pool:
        expected = session.run(0.1, H).rows
        assert all(np.array_equal(expected, rows) for rows in pool.map(_simulate, [folder] * 2))


@pytest.mark.parametrize("flavour", ["fmi2", "fmi3"])
def test_our_loader_sets_what_that_of_fmpy_sets(native: Path, flavour: str, tmp_path: Path):
    model = seat_suspension(native / flavour).models["seat"]
    model.extract(tmp_path)
    instance = instantiate("seat", model, tmp_path)
    instance.free()
    kind, identifier = instance.FMPY_CLASS, model.description.coSimulation.modelIdentifier
    theirs = kind(
        guid=model.description.guid, modelIdentifier=identifier, unzipDirectory=str(tmp_path), instanceName="seat"
    )
    ours = kind.__new__(kind)
    load_library(ours, instance.FMI_VERSION, model.description.guid, identifier, tmp_path, "seat")
    assert vars(ours).keys() == vars(theirs).keys()
    plain = {name for name, value in vars(theirs).items() if value is None or isinstance(value, str | bool)}
    assert {name: vars(ours)[name] for name in plain} == {name: vars(theirs)[name] for name in plain}
    for slave in (ours, theirs):
        slave.freeLibrary()


def test_a_library_is_found_from_a_folder_that_no_longer_exists(
    seat_system: System, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    gone = tmp_path / "gone"
    gone.mkdir()
    before = Path.cwd()
    os.chdir(gone)
    try:
        gone.rmdir()
        assert seat_system.simulate(0.1, H).complete
    finally:
        os.chdir(before)


def in_use() -> dict[str, object]:
    """Return what sessions must leave as it was: descriptors, temporary folders, working folder, stdout, handlers."""
    return {
        "descriptors": len(list(Path("/proc/self/fd").iterdir())),
        "folders": sorted(path.name for path in Path(tempfile.gettempdir()).iterdir()),
        "working folder": Path.cwd(),
        "stdout": sys.stdout,
        "threads": threading.active_count(),
        "handlers": [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)],
    }


def resident() -> float:
    """Return the memory of this process, in kB."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1024


def without_sources(fmu: Path, target: Path) -> Path:
    """Copy an FMU without what a run does not need: most of a session's time is for extraction."""
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(target, "w") as copy:
        for name in source.namelist():
            if not name.startswith(("sources", "documentation", "terminals")):
                copy.writestr(name, source.read(name))
    return target


def open_and_run(system: System, times: int) -> None:
    for _ in range(times):
        with system.open() as session:
            assert session.run(0.01, H).complete


@pytest.mark.parametrize(
    ("times", "overlapping"),
    [pytest.param(200, 80, id="short"), pytest.param(10_000, 1_000, id="long", marks=pytest.mark.long)],
)
def test_sessions_leave_nothing_however_many(
    native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, times: int, overlapping: int
):
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    systems = []
    for flavour in ("fmi2", "fmi3"):
        systems.append(System())
        systems[-1].add("shaker", without_sources(native / flavour / "Shaker.fmu", tmp_path / f"{flavour}.fmu"))
    for system in systems:
        open_and_run(system, 20)
    with ThreadPoolExecutor(4) as pool:  # each thread of C's allocator takes its share once
        list(pool.map(lambda i: open_and_run(systems[i % 2], 20), range(4)))
    before, memory = in_use(), resident()
    for system in systems:
        open_and_run(system, (times - overlapping) // 2)
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda i: open_and_run(systems[i % 2], overlapping // 4), range(4)))
    assert in_use() == before
    grown = resident() - memory
    print(f"{times} sessions, {overlapping} of them overlapping: memory grew by {grown:.0f} kB")
    assert grown < 4000.0 + 0.1 * times
