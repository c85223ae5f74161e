"""What the tests share: FMUs built once, a system of them, an independent solver, readers of golden data."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cosim import System
from cosim.instance import Instance, extract, instantiate
from cosim.model import Model
from cosim.scenarios import seat_suspension
from fmus.build import build

ROOT = Path(__file__).parent.parent
DATA = Path(__file__).parent / "data"
NATIVE = ("fmi2", "fmi3")


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

    def restore(self, state: Any) -> None:
        self._call(f"setFMU{self._state}", state)

    @property
    def said(self) -> str:
        return self._instance.journal[-1][1]


@pytest.fixture(params=[*NATIVE, "python"])
def seat(request: pytest.FixtureRequest, fmus: Path, native: Path, tmp_path: Path) -> Iterator[Driven]:
    """A seat in each flavour."""
    model = Model.read((fmus.parent if request.param == "python" else native) / request.param / "SeatPlant.fmu")
    extract(model, tmp_path)
    instance = instantiate("seat", model, tmp_path)
    try:
        yield Driven(instance)
    finally:
        instance.free()


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
