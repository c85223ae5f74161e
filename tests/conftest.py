"""What the tests share: FMUs built once, a system of them, an independent solver, readers of golden data."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from cosim import System
from cosim.scenarios import seat_suspension
from fmus.build import build

ROOT = Path(__file__).parent.parent
DATA = Path(__file__).parent / "data"


@pytest.fixture(scope="session")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of freshly built Python FMUs."""
    folder = tmp_path_factory.mktemp("fmus")
    for _ in build(folder, ["python"]):
        pass
    return folder / "python"


@pytest.fixture
def system(fmus: Path) -> System:
    return seat_suspension(fmus)


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
