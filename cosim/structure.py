"""Structure: which FMUs there are, what is connected to what, in which order they step."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from fmpy.model_description import ModelVariable

from cosim.errors import SetupError
from cosim.model import KINDS, NUMERIC, Model, Value, nearest


class Port(NamedTuple):
    """One variable of one component."""

    component: str
    variable: str

    def __str__(self) -> str:
        return f"{self.component}.{self.variable}"

    @classmethod
    def parse(cls, text: str) -> Port:
        """Split ``component.variable``; the variable's name may hold further dots."""
        component, dot, variable = text.partition(".")
        if not (component and dot and variable):
            raise SetupError(f"{text}: expected COMPONENT.VARIABLE")
        return cls(component, variable)


class Structure:
    """FMUs and their connections, by their descriptions alone: nothing is loaded.

    Every check that a description allows is made as soon as its two ends are known.
    """

    def __init__(self) -> None:
        self.models: dict[str, Model] = {}
        self.connections: dict[Port, Port] = {}
        """Input to the output that feeds it."""
        self._order: tuple[str, ...] | None = None

    # ---- building ----------------------------------------------------------------------------------------------------

    def add(self, name: str, fmu: str | Path) -> None:
        """Add a component.

        Parameters
        ----------
        name
            The component's name, without dots.
        fmu
            Its ``.fmu`` file.

        Raises
        ------
        SetupError
            If the name is taken or unfit, or the file is no FMU that can be used here.
        """
        if not name or "." in name:
            raise SetupError(f"component {name!r}: expected a name without dots")
        if name in self.models:
            raise SetupError(f"component {name}: expected a new name, got one that is there already")
        self.models[name] = Model.read(fmu)

    def connect(self, output: str, input: str) -> None:  # noqa: A002
        """Connect an output to an input.

        Parameters
        ----------
        output, input
            ``component.variable`` of each end.

        Raises
        ------
        SetupError
            If an end does not exist, has the wrong causality, the input is fed already, or types or units differ.
        """
        source, sink = Port.parse(output), Port.parse(input)
        ends = {"output": (source, self._variable(source)), "input": (sink, self._variable(sink))}
        between = f"connection {source} -> {sink}"
        problems = [
            f"{between}: expected {port} to be an {causality}, got a {variable.causality}"
            for causality, (port, variable) in ends.items()
            if variable.causality != causality
        ]
        if sink in self.connections:
            problems.append(f"{between}: expected a free input, got one that {self.connections[sink]} feeds")
        problems += self._mismatch(between, source, sink)
        if problems:
            raise SetupError(*problems)
        self.connections[sink] = source

    def _variable(self, port: Port) -> ModelVariable:
        if port.component not in self.models:
            raise SetupError(
                f"{port}: expected a component among {', '.join(self.models) or 'none'}, got {port.component}"
                + nearest(port.component, self.models)
            )
        return self.models[port.component].variable(port.component, port.variable)

    def _mismatch(self, between: str, source: Port, sink: Port) -> list[str]:
        """Compare type and unit of two ends; a unit that is missing or undefined at one end is not compared."""
        (model_out, out), (model_in, in_) = ((self.models[p.component], self._variable(p)) for p in (source, sink))
        problems = []
        if KINDS[out.type] != KINDS[in_.type] or KINDS[out.type] not in NUMERIC:
            problems.append(f"{between}: expected two ends of one numeric type, got {out.type} and {in_.type}")
        dimensions = model_out.dimension(out), model_in.dimension(in_)
        if None not in dimensions and dimensions[0] != dimensions[1]:
            problems.append(
                f"{between}: expected two ends of one unit, got {model_out.unit(out)} and {model_in.unit(in_)}"
            )
        return problems

    @property
    def order(self) -> tuple[str, ...]:
        """Order in which the components step: as set, then what was added since."""
        order = self._order or ()
        return (*order, *(name for name in self.models if name not in order))

    @order.setter
    def order(self, names: Sequence[str]) -> None:
        if sorted(names) != sorted(self.models):
            raise SetupError(f"order: expected each of {', '.join(self.models)} once, got {', '.join(names)}")
        self._order = tuple(names)

    # ---- checks ------------------------------------------------------------------------------------------------------

    def check(self, parameters: Mapping[str, Value]) -> dict[str, dict[str, float | str]]:
        """Check parameters against the descriptions.

        Parameters
        ----------
        parameters
            ``component.variable`` to value.

        Returns
        -------
        dict
            Component to variable to the value as its FMU takes it.

        Raises
        ------
        SetupError
            With all problems found.
        """
        values: dict[str, dict[str, float | str]] = {name: {} for name in self.models}
        problems: list[str] = []
        for text, given in parameters.items():
            try:
                port = Port.parse(text)
                self._variable(port)
                if port in self.connections:
                    raise SetupError(f"{port}: expected a free input, got one that {self.connections[port]} feeds")
                values[port.component][port.variable] = self.models[port.component].value(*port, given)
            except SetupError as error:
                problems += error.problems
        if problems:
            raise SetupError(*problems)
        return values

    def outputs(self) -> list[str]:
        """Name all outputs as ``component.variable``, in order."""
        return [f"{name}.{v.name}" for name, model in self.models.items() for v in model.outputs]

    def recorded(self, record: Iterable[str] | None) -> list[str]:
        """Check which outputs to record; all where None is given."""
        if record is None:
            return self.outputs()
        known = self.outputs()
        problems = [f"record {name}: expected an output{nearest(name, known)}" for name in record if name not in known]
        if problems:
            raise SetupError(*problems)
        return list(record)

    def unit(self, port: str) -> str | None:
        """Return the unit of ``component.variable``."""
        component, variable = Port.parse(port)
        return self.models[component].unit(self._variable(Port(component, variable)))

    def start(self, port: str) -> float:
        """Return the start value of the number ``component.variable``."""
        return float(self._variable(Port.parse(port)).start)
