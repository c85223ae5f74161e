"""Whether an output can feed an input: types, enumerations, units, and the range of values."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

from fmpy.model_description import ModelVariable

from cosim.fmi.description import ModelDescription
from cosim.fmi.values import items_of, value_range
from cosim.fmi.variable_types import KINDS, NUMERIC
from cosim.units import IDENTITY, Linear, Unit, conversion, named_unit

_EXACT_AS_FLOAT32 = 2.0**24
"""Whole numbers up to this magnitude are exact as float32."""


@dataclass
class Compatibility:
    """How an output can feed an input.

    Attributes
    ----------
    transformation
        From the output's value to the input's: the conversion of units.
    notes
        What a user should know.
    problems
        What forbids the connection.
    """

    transformation: Linear = IDENTITY
    notes: list[str] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)


def check_types(source: ModelVariable, sink: ModelVariable) -> list[str]:
    """Find what is wrong with the types of two variables.

    Conversions that lose nothing are accepted; SSP leaves them to the tool (SSP 1.0, 5.3.3).

    Parameters
    ----------
    source, sink
        The output and the input.
    """
    kinds = KINDS[source.type], KINDS[sink.type]
    if not set(kinds) <= set(NUMERIC):
        refused = next(kind for kind in kinds if kind not in NUMERIC)
        return [
            f"expected two numeric types, got {source.type} and {sink.type}: {refused} is not supported in connections"
        ]
    if not _is_lossless(source, sink):
        return [f"expected a type that takes {source.type} without loss, got {sink.type}"]
    if kinds == ("Enumeration", "Enumeration"):
        items, known = items_of(source), items_of(sink).values()
        missing = [name for name, value in items.items() if value not in known]
        if missing:
            return [f"expected an enumeration with the items {', '.join(items)}, got one without {', '.join(missing)}"]
    return []


def _is_lossless(source: ModelVariable, sink: ModelVariable) -> bool:
    """Whether a type takes all values of another, but for those that are out of its range or not exact as float64."""
    kinds = KINDS[source.type], KINDS[sink.type]
    if kinds[1] == "Real":
        largest = max(map(abs, value_range(source)))
        return kinds[0] == "Real" or sink.type != "Float32" or largest <= _EXACT_AS_FLOAT32
    return kinds[0] == kinds[1] or kinds in (
        ("Boolean", "Integer"),
        ("Enumeration", "Integer"),
        ("Integer", "Enumeration"),
    )


def range_to_check(source: ModelVariable, sink: ModelVariable) -> tuple[float, float] | None:
    """Return the range in which the values of a connection have to be; None where all of them are.

    Parameters
    ----------
    source, sink
        The output and the input.
    """
    (least, most), (low, high) = value_range(source), value_range(sink)
    return None if low <= least and most <= high else (low, high)


class QuantityUnit(NamedTuple):
    """The unit of a variable, a connector or a value.

    Attributes
    ----------
    name
        None where there is no unit.
    definition
        In base units; None where it is not defined.
    relative
        Whether values are differences of two quantities, which offsets do not change.
    """

    name: str | None = None
    definition: Unit | None = None
    relative: bool = False

    @classmethod
    def of(cls, model: ModelDescription, variable: ModelVariable) -> QuantityUnit:
        """Return the unit of an FMU's variable.

        Parameters
        ----------
        model, variable
            The FMU and its variable.
        """
        return cls(model.unit(variable), model.defined_unit(variable), model.is_relative(variable))

    @property
    def known(self) -> Unit | None:
        """The definition; where there is none, that of the unit's name."""
        return self.definition or (named_unit(self.name) if self.name else None)


def convert_units(source: QuantityUnit, sink: QuantityUnit) -> Compatibility:
    """Find the conversion between two units.

    Units that are not defined are looked up by their names. Where that fails, values are taken as they are, with a note
    if the names differ.

    Parameters
    ----------
    source, sink
        The unit of each end.
    """
    found = Compatibility()
    ends = (source, sink)
    if source.name is None or sink.name is None or (source.name == sink.name and not _differ(source, sink)):
        return found
    units = [end.known for end in ends]
    text = f"{source.name} and {sink.name}"
    unknown = [str(end.name) for end, unit in zip(ends, units, strict=True) if unit is None]
    if unknown:
        found.notes.append(f"units {text} are not converted: {' and '.join(unknown)} is not defined and not known")
        return found
    converted = conversion(units[0], units[1], relative=source.relative and sink.relative)
    if converted is None:
        found.problems.append(f"expected two units of one dimension, got {text}")
    elif source.relative != sink.relative and (converted.offset or any(unit.offset for unit in units if unit)):
        got = [f"{'a difference' if end.relative else 'an absolute value'} in {end.name}" for end in ends]
        found.problems.append(f"expected two differences or two absolute values, got {' and '.join(got)}")
    else:
        found.transformation = converted
    return found


def _differ(source: QuantityUnit, sink: QuantityUnit) -> bool:
    """Whether a unit of one name is defined differently at both ends, or its values are differences at one end only."""
    definitions = (source.definition, sink.definition)
    return (None not in definitions and definitions[0] != definitions[1]) or source.relative != sink.relative
