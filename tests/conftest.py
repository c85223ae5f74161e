"""What the tests share: FMUs built once, a system of them, an independent solver, a shell, readers of golden data."""

from __future__ import annotations

import csv
import signal
import subprocess
import sys
import zipfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cosim import System, cli, stepper
from cosim.instance import Instance, extract, instantiate
from cosim.model import Model
from cosim.scenarios import seat_suspension
from fmus.build import build, build_library

ROOT = Path(__file__).parent.parent
DATA = Path(__file__).parent / "data"
NATIVE = ("fmi2", "fmi3")


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


class Driven:
    """An instance stepped by hand, whatever its version of FMI."""

    def __init__(self, instance: Instance) -> None:
        three = instance.model.description.fmiMajorVersion == 3
        self._instance = instance
        self._real, self._state = ("Float64", "State") if three else ("Real", "state")

    def begin(self, **parameters: float) -> None:
        """Start anew; an underscore that follows another is a point."""
        values = {name.replace("__", "."): value for name, value in parameters.items()}
        self._instance.start(1000.0, values)
        self._instance.finish_initialisation()

    def end(self) -> None:
        self._instance.terminate()

    def _call(self, function: str, *arguments: Any) -> Any:
        return getattr(self._instance.fmu, function)(*arguments)

    def _references(self, names: Iterable[str]) -> list[int]:
        return [self._instance.model.variables[name].valueReference for name in names]

    def set(self, **values: float) -> None:
        self._call(f"set{self._real}", self._references(values), list(values.values()))

    def get(self, *names: str) -> list[float]:
        return list(self._call(f"get{self._real}", self._references(names)))

    def step(self, time: float, step_size: float) -> None:
        self._call("doStep", time, step_size)

    def state(self) -> Any:
        return self._call(f"getFMU{self._state}")

    def saved(self) -> bytes:
        return bytes(self._call(f"serializeFMU{self._state}", self.state()))

    def restore(self, state: Any) -> None:
        self._call(f"setFMU{self._state}", state)

    @property
    def said(self) -> str:
        return self._instance.journal.entries[-1].text


@pytest.fixture(params=[*NATIVE, "python"])
def flavour_folder(request: pytest.FixtureRequest, fmus: Path, native: Path) -> Path:
    """Folder of FMUs of each flavour."""
    return (fmus.parent if request.param == "python" else native) / request.param


@contextmanager
def driven(fmu: Path, folder: Path) -> Iterator[Driven]:
    """Load an FMU, to be stepped by hand."""
    model = Model.read(fmu)
    extract(model, folder)
    instance = instantiate(fmu.stem, model, folder)
    try:
        yield Driven(instance)
    finally:
        instance.free()


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


class Shell:
    """Runs commands in a folder that holds the FMUs."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], fmus: Path) -> None:
        self.monkeypatch = monkeypatch
        self.capfd = capfd
        self.fmus = fmus

    def __call__(self, *words: str, fmus: bool = True) -> tuple[int, str, str]:
        where = ["--fmus", str(self.fmus)] if fmus and words[:1] in (("run",), ("reproduce",), ("evaluate",)) else []
        self.monkeypatch.setattr(sys, "argv", ["seat-cosim", *words, *where])
        with pytest.raises(SystemExit) as end:
            cli.main()
        out, err = self.capfd.readouterr()
        return int(end.value.code or 0), out, err


@pytest.fixture
def shell(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], native: Path, tmp_path: Path) -> Shell:
    monkeypatch.chdir(tmp_path)
    return Shell(monkeypatch, capfd, native)


def edited(fmu: Path, target: Path, *replacements: tuple[str, str]) -> Path:
    """Copy an FMU with another description."""
    with zipfile.ZipFile(fmu) as archive, zipfile.ZipFile(target, "w") as copy:
        for name in archive.namelist():
            content = archive.read(name)
            if name == "modelDescription.xml":
                text = content.decode()
                for old, new in replacements:
                    assert old in text
                    text = text.replace(old, new)
                content = text.encode()
            copy.writestr(name, content)
    return target


def read_csv(path: Path) -> dict[str, np.ndarray]:
    """Read columns of numbers by name."""
    with path.open(newline="", encoding="utf-8") as stream:
        names, *rows = csv.reader(stream)
    values = np.array([[float(cell) for cell in row] for row in rows]).reshape(len(rows), len(names))
    return dict(zip(names, values.T, strict=True))


def relative_rms(found: np.ndarray, expected: np.ndarray) -> float:
    """RMS of the difference over RMS of what is expected."""
    return float(np.sqrt(np.mean((found - expected) ** 2) / np.mean(expected**2)))


def relative_peak(found: np.ndarray, expected: np.ndarray) -> float:
    """Relative difference of the largest magnitudes."""
    return float(abs(np.abs(found).max() / np.abs(expected).max() - 1.0))
