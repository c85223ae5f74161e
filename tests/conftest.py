"""What the tests share: FMUs built once, a system of them, an independent solver, readers of golden data."""

from __future__ import annotations

import csv
import zipfile
from pathlib import Path

import numpy as np
import pytest

from cosim import System, stepper
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
