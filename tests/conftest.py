"""What the tests share: FMUs built once, a system of them, instances and a shell; and which tests build something.

Tests that build FMUs or compile C are marked ``builds``: those that use a fixture of :data:`BUILDING`, directly or not,
and those that say so themselves. Other tests may not start a compiler.
"""

from __future__ import annotations

import functools
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from cosim import System
from cosim.engine import native_stepper as stepper
from cosim.file_lock import FileLock
from fmus.export.build import build_library
from seat_cosim.components import build
from seat_cosim.scenarios import seat_suspension
from tests.helpers.driven import Driven, driven
from tests.helpers.paths import NATIVE, ROOT
from tests.helpers.shell import Shell
from tests.helpers.waiting import wait_until

BUILDING = {
    "baselines",
    "echo",
    "everywhere",
    "faulty_folder",
    "fmus",
    "foreign",
    "in_c",
    "native",
    "paths",
    "program",
    "reference_fmus",
    "workshop",
}
"""Fixtures that build FMUs or compile C."""

COMPILERS = {"cc", "clang", "gcc", "pythonfmu", "pythonfmu3", "zig", "ziglang"}
"""Commands and Python modules that build FMUs or compile C."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the tests that build FMUs."""
    for item in items:
        if BUILDING.intersection(getattr(item, "fixturenames", ())):
            item.add_marker(pytest.mark.builds)


@functools.cache
def build_core() -> None:
    """Build the loop in C, unless it exists already."""
    for _ in build_library(stepper.NAME, stepper.sources(), stepper.fingerprint(), stepper.BUILT):
        pass


_running: list[pytest.Item] = []
"""The test that runs."""


def _refuse_compilers(event: str, arguments: tuple[Any, ...]) -> None:
    """Raise an error where a test starts a compiler that is not marked ``builds``."""
    if event == "subprocess.Popen" and _running and not _running[-1].get_closest_marker("builds"):
        command = [arguments[1]] if isinstance(arguments[1], str | bytes) else arguments[1]
        if found := COMPILERS.intersection(Path(str(word)).name for word in command):
            raise RuntimeError(f"{_running[-1].nodeid}: expected the mark `builds`, got a test that runs {found.pop()}")


sys.addaudithook(_refuse_compilers)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[Any]:
    """Note which test runs."""
    _running.append(item)
    try:
        return (yield)
    finally:
        _running.pop()


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Build the loop in C before the first test that builds."""
    if item.get_closest_marker("builds"):
        build_core()


@pytest.fixture(scope="session")
def fmu_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the built FMUs, each flavour in its subfolder."""
    return tmp_path_factory.mktemp("fmus")


@pytest.fixture(scope="session")
def fmus(fmu_folder: Path) -> Path:
    """Folder of freshly built Python FMUs."""
    for _ in build(fmu_folder, ["python"]):
        pass
    return fmu_folder / "python"


@pytest.fixture(scope="session")
def native(fmu_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the folders ``fmi2`` and ``fmi3`` of freshly built native FMUs, for this machine.

    The first of pytest's workers builds them, the others wait and copy.
    """
    base = tmp_path_factory.getbasetemp()
    shared = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "native"
    shared.mkdir(exist_ok=True)
    lock = FileLock(shared / "lock")
    wait_until(lock.acquire)
    try:
        for _ in build(shared, NATIVE):
            pass
    finally:
        lock.release()
    for flavour in NATIVE:
        shutil.copytree(shared / flavour, fmu_folder / flavour)
    return fmu_folder


@pytest.fixture(scope="session")
def foreign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of foreign FMUs, from ``examples/foreign``, built by their own tools."""
    folder = tmp_path_factory.mktemp("foreign")
    for script in sorted((ROOT / "examples" / "foreign").glob("*.py")):
        tool = "pythonfmu3" if "pythonfmu3" in script.read_text() else "pythonfmu"
        command = [sys.executable, "-m", tool, "build", "-f", str(script), "-d", str(folder)]
        subprocess.run(command, check=True, capture_output=True)
    return folder


@pytest.fixture(autouse=True)
def sigint_interrupts() -> Iterator[None]:
    """Let SIGINT interrupt, as in a terminal; workers and jobs in the background ignore it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture
def system(fmus: Path) -> System:
    return seat_suspension(fmus)


@pytest.fixture(params=[*NATIVE, "python"])
def flavour_folder(request: pytest.FixtureRequest, fmus: Path, native: Path) -> Path:
    """Folder of FMUs of each flavour."""
    return (fmus.parent if request.param == "python" else native) / request.param


@pytest.fixture
def seat(flavour_folder: Path, tmp_path: Path) -> Iterator[Driven]:
    """A seat in each flavour."""
    with driven(flavour_folder / "SeatPlant.fmu", tmp_path) as loaded:
        yield loaded


@pytest.fixture
def controller(flavour_folder: Path, tmp_path: Path) -> Iterator[Driven]:
    """A controller in each flavour."""
    with driven(flavour_folder / "SeatController.fmu", tmp_path) as loaded:
        yield loaded


@pytest.fixture
def shell(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], native: Path, tmp_path: Path) -> Shell:
    monkeypatch.chdir(tmp_path)
    return Shell(monkeypatch, capfd, native)
