"""What the tests share: FMUs built once, a system of them, an independent solver, a shell, readers of golden data."""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import numpy as np
import pytest

from cosim import System, cli, stepper
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


@pytest.fixture
def system(fmus: Path) -> System:
    return seat_suspension(fmus)


class Shell:
    """Runs commands in a folder that holds the FMUs."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], fmus: Path) -> None:
        self.monkeypatch = monkeypatch
        self.capfd = capfd
        self.fmus = fmus

    def __call__(self, *words: str, fmus: bool = True) -> tuple[int, str, str]:
        where = ["--fmus", str(self.fmus)] if fmus and words[:1] in (("run",), ("reproduce",)) else []
        self.monkeypatch.setattr(sys, "argv", ["seat-cosim", *words, *where])
        with pytest.raises(SystemExit) as end:
            cli.main()
        out, err = self.capfd.readouterr()
        return int(end.value.code or 0), out, err


@pytest.fixture
def shell(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], native: Path, tmp_path: Path) -> Shell:
    monkeypatch.chdir(tmp_path)
    return Shell(monkeypatch, capfd, native)


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
