"""An FMU stepped by hand."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from cosim.fmi.description import ModelDescription
from cosim.fmi.instance import Experiment, Instance
from cosim.fmi.versions import instantiate


class Driven:
    """An instance stepped by hand, whatever its version of FMI."""

    def __init__(self, instance: Instance) -> None:
        three = instance.model.description.fmiMajorVersion == 3
        self._instance = instance
        self._real, self._state = ("Float64", "State") if three else ("Real", "state")

    def begin(self, **parameters: float) -> None:
        """Restart; an underscore that follows another is a point."""
        values = {name.replace("__", "."): value for name, value in parameters.items()}
        self._instance.enter_initialization(Experiment(0.0, 1000.0), values)
        self._instance.exit_initialization()

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
        return self._instance.messages.messages[-1].text


@contextmanager
def driven(fmu: Path, folder: Path) -> Iterator[Driven]:
    """Load an FMU, to be stepped by hand."""
    model = ModelDescription.read(fmu)
    model.extract(folder)
    instance = instantiate(fmu.stem, model, folder)
    try:
        yield Driven(instance)
    finally:
        instance.free()
