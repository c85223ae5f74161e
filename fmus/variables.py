"""Declaration of the variables of an FMU.

A model declares its interface as dataclasses with fields from :func:`input_`, :func:`output`,
:func:`parameter`, :func:`file_parameter` and :func:`constant`. The dataclasses serve the functions of the model as
typed records, and :func:`variables_of` reads the same fields as FMI variables. A record can hold others: :func:`group`
and :func:`same_as` take over declarations of another model, so that a component of several models has none twice.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from types import MappingProxyType
from typing import Any

from fmus.units import dimension

POSITIVE = 1e-9
"""Minimum that stands for "greater than zero": FMI has inclusive bounds only. In the unit of the variable."""

MAX_TEXT_SIZE = 1023
"""Largest size of a text, in bytes of UTF-8."""

LEGAL_COMBINATIONS = {
    ("independent", "continuous", None),
    ("input", "continuous", "exact"),
    ("output", "continuous", "calculated"),
    ("output", "discrete", "calculated"),
    ("parameter", "fixed", "exact"),
    ("parameter", "tunable", "exact"),
    ("local", "constant", "exact"),
}
"""Combinations of causality, variability and initial in use, a subset of FMI 2.0.4, table in section 2.2.7."""


@dataclass(frozen=True)
class Quantity:
    """A number with its unit, its symbol in the paper and its source.

    Attributes
    ----------
    value
        In ``unit``.
    unit
        Unit name, see :mod:`fmus.units`; ``"1"`` for pure numbers.
    symbol
        As in NOMENCLATURE.md.
    source
        Source of the value, e.g. ``"Table 1"``, or ``"assumed"``.
    """

    value: float
    unit: str
    symbol: str
    source: str


@dataclass(frozen=True)
class VariableDeclaration:
    """Declaration of one variable of an FMU.

    Attributes
    ----------
    name
        FMI name, structured (``friction.alpha``).
    field
        Name of the field in the dataclass of the model; in a record that holds others the names that lead to it, joined
        by dots.
    type
        ``float``, ``int``, ``bool``, an ``IntEnum`` with members from 1, or ``str`` for the name of a file.
    causality, variability, initial
        As in FMI, see :data:`LEGAL_COMBINATIONS`.
    description
        Text for the model description.
    unit
        Unit name, see :mod:`fmus.units`; None for other types than ``float``.
    start
        Start value, in ``unit``; None for an output.
    minimum, maximum
        Inclusive bounds, in ``unit``; None where there are none.
    nominal
        Typical magnitude, in ``unit``.
    dependencies
        Names of the knowns that an output depends on during initialisation. After a step no output depends directly on
        an input, as the step has used the inputs already.
    added
        Whether the variable came later and stands after all others, whose value references stay.
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
    added: bool = False

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
        """Return what is wrong with a value for this variable, or None.

        Parameters
        ----------
        value
            Number in the unit of the variable, number of an enumeration item, or name of a file.

        Returns
        -------
        str or None
            Message with the name of the variable, what was expected and the value.
        """
        if isinstance(value, str):
            size = len(value.encode(errors="replace"))
            return None if size <= MAX_TEXT_SIZE else f"{self.name}: expected at most {MAX_TEXT_SIZE} bytes, got {size}"
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
    """A terminal of FMI 3 with the matching rule ``plug``: it fits a terminal with the same member names.

    Attributes
    ----------
    name, description
        As in the terminal's description.
    members
        Member name, the same at both terminals, to the name of the variable.
    """

    name: str
    description: str
    members: Mapping[str, str]


TIME = VariableDeclaration(
    name="time",
    field="time",
    type=float,
    causality="independent",
    variability="continuous",
    initial=None,
    description="Simulation time",
    unit="s",
)
"""The independent variable, the first of every component."""


def _declare(start: Any, name: str | None = None, **attributes: Any) -> Any:
    return dataclasses.field(default=start, metadata={"name": name, **attributes})


def input_(unit: str, description: str, *, nominal: float, added: bool = False) -> Any:
    """Declare an input: continuous, with the start value zero.

    Parameters
    ----------
    unit
        Unit name, see :mod:`fmus.units`.
    description
        Text for the model description.
    nominal
        Typical magnitude, in ``unit``.
    added
        As of :func:`output`.

    Returns
    -------
    dataclass field
        With the declaration in its metadata.
    """
    return _declare(
        0.0,
        causality="input",
        variability="continuous",
        initial="exact",
        unit=unit,
        description=description,
        nominal=nominal,
        added=added,
    )


def output(
    unit: str | None,
    description: str,
    *,
    nominal: float | None = None,
    discrete: bool = False,
    start: float = 0.0,
    dependencies: Sequence[str] = (),
    added: bool = False,
) -> Any:
    """Declare an output, calculated by the model.

    Parameters
    ----------
    unit
        Unit name, see :mod:`fmus.units`; None for a Boolean.
    description
        Text for the model description.
    nominal
        Typical magnitude, in ``unit``.
    discrete
        True if the value changes at samples only.
    start
        Default of the dataclass field; not part of the model description.
    dependencies
        FMI names of the knowns that the value depends on during initialisation.
    added
        Whether the variable stands after all that are not added, so that their value references stay.

    Returns
    -------
    dataclass field
        With the declaration in its metadata.
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
        added=added,
    )


def parameter(
    start: Quantity | bool | int | IntEnum,
    description: str,
    *,
    name: str | None = None,
    tunable: bool = False,
    minimum: float | None = None,
    maximum: float | None = None,
    added: bool = False,
) -> Any:
    """Declare a parameter of a component.

    Parameters
    ----------
    start
        Start value; a physical one with its unit, symbol and source.
    description
        Text for the model description; symbol and source are appended.
    name
        FMI name if it differs from that of the field, e.g. ``"friction.alpha"``.
    tunable
        Whether it may change between steps.
    minimum, maximum
        Inclusive bounds, in the unit of ``start``.
    added
        As of :func:`output`.

    Returns
    -------
    dataclass field
        With the declaration in its metadata.
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
        added=added,
    )


def file_parameter(start: str, description: str, *, name: str | None = None) -> Any:
    """Declare a parameter that is the path of a file, absolute or relative to the resources of the FMU.

    The model receives the whole path.

    Parameters
    ----------
    start
        Start value.
    description
        Text for the model description.
    name
        FMI name if it differs from that of the field.

    Returns
    -------
    dataclass field
        With the declaration in its metadata.
    """
    return _declare(
        start, name, causality="parameter", variability="fixed", initial="exact", unit=None, description=description
    )


def constant(value: Quantity, description: str) -> Any:
    """Declare a local constant that a host can read.

    Parameters
    ----------
    value
        Value with its unit, symbol and source.
    description
        Text for the model description; symbol and source are appended.

    Returns
    -------
    dataclass field
        With the declaration in its metadata.
    """
    return _declare(
        value.value,
        causality="local",
        variability="constant",
        initial="exact",
        unit=value.unit,
        description=f"{description}; {value.symbol} ({value.source})",
    )


@dataclass(frozen=True)
class _Group:
    """What :func:`group` declares of a field."""

    record: type
    prefix: str
    without: frozenset[str]
    starts: Mapping[str, Quantity | bool | int]
    minimums: Mapping[str, float]
    dependencies: Mapping[str, Sequence[str]]

    def values(self) -> dict[str, Any]:
        """Return the values of the fields that do not start as the record declares."""
        return {name: s.value if isinstance(s, Quantity) else s for name, s in self.starts.items()}

    def default(self) -> Any:
        return record_of(self.record, self.values())


def group(
    record: type,
    prefix: str = "",
    *,
    without: Sequence[str] = (),
    starts: Mapping[str, Quantity | bool | int] = MappingProxyType({}),
    minimums: Mapping[str, float] = MappingProxyType({}),
    dependencies: Mapping[str, Sequence[str]] = MappingProxyType({}),
) -> Any:
    """Declare a field that holds another record with the declarations of all its variables.

    Parameters
    ----------
    record
        Dataclass with fields from the functions of this module.
    prefix
        FMI names are those of the record after this prefix and a dot; empty for the names as they are.
    without
        Fields of the record that are no variables: they keep their start values.
    starts
        Field to its start value, where it is another than in the record. A physical one has the symbol of the other.
    minimums
        Field to its minimum, where it is another than in the record, in the unit of the variable.
    dependencies
        FMI name of a known to those by which it is replaced in the dependencies of outputs.

    Returns
    -------
    dataclass field
        With the declaration in its metadata; its default is the record with these start values.

    Raises
    ------
    ValueError
        If the record has no such field, or one that is left out is a file.

    Examples
    --------
    >>> @dataclass
    ... class Spring:
    ...     stiffness: float = parameter(Quantity(2.0, "N/m", "k", "here"), "Stiffness")
    >>> @dataclass
    ... class Springs:
    ...     front: Spring = group(Spring, "front")
    ...     rear: Spring = group(Spring, "rear", starts={"stiffness": Quantity(3.0, "N/m", "k", "there")})
    >>> [(variable.name, variable.field, variable.start) for variable in variables_of(Springs)]
    [('front.stiffness', 'front.stiffness', 2.0), ('rear.stiffness', 'rear.stiffness', 3.0)]
    >>> Springs().rear.stiffness
    3.0
    """
    known = {variable.field: variable for variable in variables_of(record)}
    for name in (*without, *starts, *minimums):
        if name not in known or (name in without and known[name].type is str):
            raise ValueError(f"group of {record.__name__}: expected a field that is no file, got {name}")
    declared = _Group(record, prefix, frozenset(without), dict(starts), dict(minimums), dict(dependencies))
    return dataclasses.field(default_factory=declared.default, metadata={"group": declared})


def same_as(record: type, name: str, *, dependencies: Sequence[str] | None = None) -> Any:
    """Declare a field with the declaration of another record's field.

    Parameters
    ----------
    record
        Dataclass with fields from the functions of this module.
    name
        Name of the field.
    dependencies
        As of :func:`output`, if they differ.

    Returns
    -------
    dataclass field
        With the same metadata, except that the variable is none that came later.

    Examples
    --------
    >>> @dataclass
    ... class Spring:
    ...     force: float = output("N", "Force of the spring", added=True)
    >>> @dataclass
    ... class Block:
    ...     force: float = same_as(Spring, "force")
    >>> [(variable.name, variable.unit, variable.added) for variable in variables_of(Block)]
    [('force', 'N', False)]
    """
    (field,) = [field for field in dataclasses.fields(record) if field.name == name]
    metadata = {**field.metadata, **({"added": False} if "added" in field.metadata else {})}
    if dependencies is not None:
        metadata["dependencies"] = tuple(dependencies)
    return dataclasses.field(default=field.default, metadata=metadata)


def _in_group(variable: VariableDeclaration, field: str, group: _Group) -> VariableDeclaration:
    """Return the declaration of a variable of a record that is held in a field of another one."""
    changes: dict[str, Any] = {}
    if variable.field in group.starts:
        start = group.starts[variable.field]
        changes["start"] = start
        if isinstance(start, Quantity):
            text, mark, _ = variable.description.rpartition(f"; {start.symbol} (")
            if not mark or start.unit != variable.unit:
                raise ValueError(f"start of {field}.{variable.field}: expected its symbol and unit, got {start}")
            changes |= {"start": float(start.value), "description": f"{text}{mark}{start.source})"}
    if variable.field in group.minimums:
        changes["minimum"] = group.minimums[variable.field]
    return dataclasses.replace(
        variable,
        name=f"{group.prefix}.{variable.name}" if group.prefix else variable.name,
        field=f"{field}.{variable.field}",
        dependencies=tuple(other for name in variable.dependencies for other in group.dependencies.get(name, (name,))),
        **changes,
    )


def _declarations(record: type) -> list[tuple[VariableDeclaration, bool]]:
    """Return the declarations of all fields of a record, and whether each is left out."""
    found: list[tuple[VariableDeclaration, bool]] = []
    for field in dataclasses.fields(record):
        if group := field.metadata.get("group"):
            for variable, left_out in _declarations(group.record):
                found.append((_in_group(variable, field.name, group), left_out or variable.field in group.without))
            continue
        attributes = dict(field.metadata)
        name = attributes.pop("name") or field.name
        start: Any = field.default
        kind = type(start)
        if attributes["initial"] == "calculated":
            start = None
        found.append((VariableDeclaration(name=name, field=field.name, type=kind, start=start, **attributes), False))
    return found


def variables_of(record: type) -> tuple[VariableDeclaration, ...]:
    """Read the fields of an interface dataclass as FMI variables, in their order.

    The type of a variable is that of the default of its field.

    Parameters
    ----------
    record
        Dataclass with fields from the functions of this module.

    Returns
    -------
    tuple of VariableDeclaration
        One for each field, and for each field of a record in it that is not left out.

    Raises
    ------
    ValueError
        If a declaration contradicts itself (combination, unit, start outside its bounds).

    Examples
    --------
    >>> @dataclass
    ... class Inputs:
    ...     force: float = input_("N", "Force on the seat", nominal=100.0)
    >>> [(variable.name, variable.unit) for variable in variables_of(Inputs)]
    [('force', 'N')]
    """
    return tuple(variable for variable, left_out in _declarations(record) if not left_out)


def left_out_of(record: type) -> tuple[VariableDeclaration, ...]:
    """Return the declarations of the fields that are no variables, as a :func:`group` leaves them out.

    Parameters
    ----------
    record
        Dataclass with fields from the functions of this module.

    Returns
    -------
    tuple of VariableDeclaration
        With the start values that they keep.
    """
    return tuple(variable for variable, left_out in _declarations(record) if left_out)


def record_of(record: type, values: Mapping[str, Any]) -> Any:
    """Build a record, and the records in it, from values of its fields.

    Parameters
    ----------
    record
        Dataclass with fields from the functions of this module.
    values
        Field, in records in it the path as in :attr:`VariableDeclaration.field`, to value. Others keep their start
        values.

    Returns
    -------
    record
        Instance of the dataclass.

    Examples
    --------
    >>> @dataclass
    ... class Spring:
    ...     stiffness: float = parameter(Quantity(2.0, "N/m", "k", "here"), "Stiffness")
    >>> @dataclass
    ... class Block:
    ...     spring: Spring = group(Spring, "spring")
    >>> record_of(Block, {"spring.stiffness": 5.0})
    Block(spring=Spring(stiffness=5.0))
    """
    arguments: dict[str, Any] = {path: value for path, value in values.items() if "." not in path}
    for field in dataclasses.fields(record):
        if group := field.metadata.get("group"):
            begin = f"{field.name}."
            inner = {path.removeprefix(begin): value for path, value in values.items() if path.startswith(begin)}
            arguments[field.name] = record_of(group.record, {**group.values(), **inner})
    return record(**arguments)
