"""The one declaration: what a variable of an FMU is, and how a model writes it down.

A model declares its interface as dataclasses whose fields are made by :func:`input_`, :func:`output`,
:func:`parameter` and :func:`constant`. The dataclasses serve the model's step function as typed records, and
:func:`variables_of` reads the same fields as FMI variables. This module imports nothing of the project but units.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

from fmus.units import dimension

POSITIVE = 1e-9
"""Stands for "greater than zero" where FMI knows inclusive bounds only, in the variable's own unit."""

LONGEST_TEXT = 1023
"""Most bytes of a text, in UTF-8."""

LEGAL_COMBINATIONS = {
    ("independent", "continuous", None),
    ("input", "continuous", "exact"),
    ("output", "continuous", "calculated"),
    ("output", "discrete", "calculated"),
    ("parameter", "fixed", "exact"),
    ("parameter", "tunable", "exact"),
    ("local", "constant", "exact"),
}
"""Causality, variability and initial as this project uses them (a subset of FMI 2.0.4, table in section 2.2.7)."""


@dataclass(frozen=True)
class Quantity:
    """A number with its unit, its symbol in the paper and where it comes from.

    Attributes
    ----------
    value
        In ``unit``.
    unit
        Unit name, see :mod:`fmus.units`; ``"1"`` for pure numbers.
    symbol
        As in NOMENCLATURE.md.
    source
        Where the number comes from, e.g. ``"Table 1"``, or ``"assumed"``.
    """

    value: float
    unit: str
    symbol: str
    source: str


@dataclass(frozen=True)
class Variable:
    """One variable of an FMU, in the terms of FMI.

    Attributes
    ----------
    name
        FMI name, structured (``friction.alpha``).
    field
        Name of the dataclass field that holds it in the model's code.
    type
        ``float``, ``int``, ``bool``, an ``IntEnum`` whose members count from 1, or ``str`` for the name of a file.
    dependencies
        Names of the knowns this output depends on while initialising. After a step no output depends directly on an
        input: a step function has taken the inputs in already.
    """

    name: str
    field: str
    type: type
    causality: str
    variability: str
    initial: str | None
    description: str
    unit: str | None = None
    start: float | str | None = None
    minimum: float | None = None
    maximum: float | None = None
    nominal: float | None = None
    dependencies: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        combination = (self.causality, self.variability, self.initial)
        if combination not in LEGAL_COMBINATIONS:
            raise ValueError(f"variable {self.name}: {combination} is not a legal combination")
        if self.unit is not None:
            dimension(self.unit)
        if not self.description:
            raise ValueError(f"variable {self.name}: expected a description, got none")
        if self.start is not None and (problem := self.problem(self.start)):
            raise ValueError(f"start of {problem}")

    @property
    def items(self) -> dict[str, int]:
        """Items of an enumeration by name; empty for other types."""
        return {item.name: item.value for item in self.type} if issubclass(self.type, IntEnum) else {}

    def problem(self, value: float | str) -> str | None:
        """Say what is wrong with a value for this variable, or None.

        Parameters
        ----------
        value
            In the variable's unit; an enumeration's number; a file's name.
        """
        if isinstance(value, str):
            size = len(value.encode(errors="replace"))
            return None if size <= LONGEST_TEXT else f"{self.name}: expected at most {LONGEST_TEXT} bytes, got {size}"
        if not abs(value) < float("inf"):
            return f"{self.name}: expected a finite number, got {value}"
        if self.items and value not in self.items.values():
            items = ", ".join(f"{number} ({name})" for name, number in self.items.items())
            return f"{self.name}: expected one of {items}, got {value}"
        low, high = self.minimum, self.maximum
        if (low is not None and value < low) or (high is not None and value > high):
            bounds = f"[{'-inf' if low is None else low}, {'inf' if high is None else high}]"
            unit = f" {self.unit}" if self.unit else ""
            return f"{self.name}: expected a value in {bounds}{unit}, got {value}"
        return None


@dataclass(frozen=True)
class Terminal:
    """Variables that belong to one plug; a plug fits one with the same members.

    Attributes
    ----------
    name, description
        As in the FMU's description.
    members
        Name of a member, the same at both plugs, to the name of the variable.
    """

    name: str
    description: str
    members: Mapping[str, str]


TIME = Variable(
    name="time",
    field="time",
    type=float,
    causality="independent",
    variability="continuous",
    initial=None,
    description="Simulation time",
    unit="s",
)


def _declare(start: Any, name: str | None = None, **attributes: Any) -> Any:
    return dataclasses.field(default=start, metadata={"name": name, **attributes})


def input_(unit: str, description: str, *, nominal: float) -> Any:
    """Declare an input: continuous, zero until it is set.

    Parameters
    ----------
    unit, description
        As in the FMU's description.
    nominal
        Typical magnitude, in ``unit``.
    """
    return _declare(
        0.0,
        causality="input",
        variability="continuous",
        initial="exact",
        unit=unit,
        description=description,
        nominal=nominal,
    )


def output(
    unit: str | None,
    description: str,
    *,
    nominal: float | None = None,
    discrete: bool = False,
    start: float = 0.0,
    dependencies: Sequence[str] = (),
) -> Any:
    """Declare an output, calculated by the model.

    Parameters
    ----------
    unit
        Unit name; None for a Boolean.
    discrete
        True where the value changes at samples only.
    start
        Value of the dataclass field before the model has calculated it; not part of the FMU's description.
    dependencies
        FMI names of the knowns the value depends on while initialising.
    """
    return _declare(
        start,
        causality="output",
        variability="discrete" if discrete else "continuous",
        initial="calculated",
        unit=unit,
        description=description,
        nominal=nominal,
        dependencies=tuple(dependencies),
    )


def parameter(
    start: Quantity | bool | int | IntEnum,
    description: str,
    *,
    name: str | None = None,
    tunable: bool = False,
    minimum: float | None = None,
    maximum: float | None = None,
) -> Any:
    """Declare a parameter.

    Parameters
    ----------
    start
        Default, with its unit, symbol and source where it is a physical one.
    name
        FMI name where it differs from the field's, e.g. ``"friction.alpha"``.
    tunable
        Whether it may change between steps.
    minimum, maximum
        Inclusive bounds, in the unit of ``start``.
    """
    unit = None
    value: Any = start
    if isinstance(start, Quantity):
        value, unit = float(start.value), start.unit
        description = f"{description}; {start.symbol} ({start.source})"
    return _declare(
        value,
        name,
        causality="parameter",
        variability="tunable" if tunable else "fixed",
        initial="exact",
        unit=unit,
        description=description,
        minimum=minimum,
        maximum=maximum,
    )


def file_name(start: str, description: str, *, name: str | None = None) -> Any:
    """Declare a parameter that names a file, absolute or relative to the FMU's resources.

    An FMU hands its model the whole path.

    Parameters
    ----------
    start
        Default.
    description
        As in the FMU's description.
    name
        FMI name where it differs from the field's.
    """
    return _declare(
        start, name, causality="parameter", variability="fixed", initial="exact", unit=None, description=description
    )


def constant(value: Quantity, description: str) -> Any:
    """Declare a local constant that a host can read."""
    return _declare(
        value.value,
        causality="local",
        variability="constant",
        initial="exact",
        unit=value.unit,
        description=f"{description}; {value.symbol} ({value.source})",
    )


def variables_of(record: type) -> tuple[Variable, ...]:
    """Read the fields of an interface dataclass as FMI variables, in their order; a default's type is the variable's.

    Parameters
    ----------
    record
        Dataclass whose fields were made by the functions of this module.

    Raises
    ------
    ValueError
        If a declaration contradicts itself (combination, unit, start outside its bounds).
    """
    variables = []
    for field in dataclasses.fields(record):
        attributes = dict(field.metadata)
        name = attributes.pop("name") or field.name
        start: Any = field.default
        kind = type(start)
        if attributes["initial"] == "calculated":
            start = None
        variables.append(Variable(name=name, field=field.name, type=kind, start=start, **attributes))
    return tuple(variables)
