"""What the tests share: FMUs built once, a system of them, an independent solver, a shell, readers of golden data."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from cosim import System
from cosim.engine import native_stepper as stepper
from fmus.export.build import build_library
from seat_cosim.components import build
from seat_cosim.scenarios import seat_suspension
from tests.helpers.driven import Driven, driven
from tests.helpers.paths import NATIVE, ROOT
from tests.helpers.shell import Shell


@pytest.fixture(scope="session", autouse=True)
def core() -> None:
    """Build the loop in C, unless it lies there already."""
    for _ in build_library(stepper.NAME, stepper.sources(), stepper.fingerprint(), stepper.BUILT):
        pass


@pytest.fixture(scope="session")
def fmu_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the FMUs are built, each flavour in its subfolder."""
    return tmp_path_factory.mktemp("fmus")


@pytest.fixture(scope="session")
def fmus(fmu_folder: Path) -> Path:
    """Folder of freshly built Python FMUs."""
    for _ in build(fmu_folder, ["python"]):
        pass
    return fmu_folder / "python"


@pytest.fixture(scope="session")
def native(fmu_folder: Path) -> Path:
    """Folder of the folders ``fmi2`` and ``fmi3`` of freshly built native FMUs, for this machine."""
    for _ in build(fmu_folder, NATIVE):
        pass
    return fmu_folder


@pytest.fixture(scope="session")
def foreign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of FMUs that are not ours, from ``examples/foreign``, built by their own tools."""
    folder = tmp_path_factory.mktemp("foreign")
    for script in sorted((ROOT / "examples" / "foreign").glob("*.py")):
        tool = "pythonfmu3" if "pythonfmu3" in script.read_text() else "pythonfmu"
        command = [sys.executable, "-m", tool, "build", "-f", str(script), "-d", str(folder)]
        subprocess.run(command, check=True, capture_output=True)
    return folder


@pytest.fixture(autouse=True)
def ctrl_c_is_heard() -> Iterator[None]:
    """Let SIGINT interrupt, as it does in a terminal; workers and jobs in the background ignore it."""
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
