"""Values of parameters with types and units, and their transfer from one connector to the next.

Connections and parameters are transferred alike: the unit is converted, then the transformation is applied. Where a
connector declares no unit, the quantity keeps its own, so that it is not lost at the border of a nested system.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import NamedTuple

from cosim.engine.compatibility import Compatibility, QuantityUnit, convert_units
from cosim.errors import SetupError
from cosim.fmi.description import ModelDescription
from cosim.fmi.elements import Elements
from cosim.fmi.values import Value, items_of
from cosim.fmi.variable_types import KINDS
from cosim.ssp.ssv import Transformation, TypedValue
from cosim.units import IDENTITY, Linear, Unit


@dataclass(frozen=True)
class Quantity:
    """A value of a parameter with its type and unit.

    Attributes
    ----------
    kind
        Type as SSP names it, see :data:`cosim.ssp.ssv.KINDS`.
    value
        The value in ``unit``.
    unit
        The unit; without a name that of the connector or variable to which the value is transferred.
    """

    kind: str
    value: Value
    unit: QuantityUnit = QuantityUnit()

    @classmethod
    def of(cls, typed_value: TypedValue, units: Iterable[Unit], where: str) -> Quantity:
        """Convert a value as it is written.

        Parameters
        ----------
        typed_value
            The value as it is written.
        units
            Known units; of several with one name, the first counts.
        where
            Name of the parameter in messages.

        Returns
        -------
        Quantity
            The value with its unit.

        Raises
        ------
        SetupError
            If the type is Binary.
        """
        if typed_value.kind == "Binary":
            raise SetupError(f"{where}: expected a number, Boolean or text, got Binary")
        return cls(typed_value.kind, typed_value.value, find_unit(typed_value.unit, units))

    def transferred(self, transfer: Transfer, unit: QuantityUnit, where: str) -> Quantity:
        """Apply a transfer to the value.

        Parameters
        ----------
        transfer
            The transfer.
        unit
            Unit at its end.
        where
            Name of the parameter or connection in messages.

        Returns
        -------
        Quantity
            The value at the end of the transfer.

        Raises
        ------
        SetupError
            If the unit of the value is not known or has another dimension than that at the end, or the transformation
            is not for the type of the value.
        """
        linear, unit, notes = transfer.linear(self.unit, unit, where)
        if notes and self.unit.known is None:
            raise SetupError(f"{where}: expected a unit that is defined or known by its name, got {self.unit.name}")
        transformation = transfer.transformation
        if transformation is not None and transformation.linear is None:
            return replace(self, value=_mapped_value(self, transformation, where), unit=unit)
        if linear == IDENTITY:
            return replace(self, unit=unit)
        if self.kind not in ("Real", "Integer"):
            raise SetupError(f"{where}: expected no linear transformation of a {self.kind}, got one")
        assert isinstance(self.value, int | float)
        return Quantity("Real", linear(float(self.value)), unit)


class Conversion(NamedTuple):
    """The linear part of a transfer between two units.

    Attributes
    ----------
    linear
        The conversion of units followed by the transformation.
    unit
        The unit at the end.
    notes
        What a user should know.
    """

    linear: Linear
    unit: QuantityUnit
    notes: list[str]


@dataclass(frozen=True)
class Transfer:
    """How a value is transferred from one connector to the next.

    Attributes
    ----------
    transformation
        The transformation after the conversion of units; None for none.
    suppress_unit_conversion
        Whether units are not converted.
    """

    transformation: Transformation | None = None
    suppress_unit_conversion: bool = False

    def linear(self, source: QuantityUnit, sink: QuantityUnit, where: str) -> Conversion:
        """Return the linear transformation of numbers; a table of values is ignored.

        Parameters
        ----------
        source, sink
            Units of the two ends.
        where
            Name of the parameter or connection in messages.

        Raises
        ------
        SetupError
            If the units do not fit.
        """
        units = Compatibility()
        if not self.suppress_unit_conversion:
            units = convert_units(source, sink)
            sink = sink if sink.name else source
        if units.problems:
            raise SetupError(*(f"{where}: {problem}" for problem in units.problems))
        own = (self.transformation and self.transformation.linear) or IDENTITY
        return Conversion(own.after(units.transformation), sink, [f"{where}: {note}" for note in units.notes])


def _mapped_value(quantity: Quantity, table: Transformation, where: str) -> Value:
    """Return the value to which a mapping transformation maps a value."""
    kind = table.kind.removesuffix("MappingTransformation")
    if quantity.kind != kind:
        raise SetupError(f"{where}: expected a value of type {kind} for its transformation, got {quantity.kind}")
    for entry in table.entries:
        if TypedValue(kind=kind, text=entry.source).value == quantity.value:
            return TypedValue(kind=kind, text=entry.target).value
    raise SetupError(f"{where}: expected a value in the table of its transformation, got {quantity.value}")


def find_unit(name: str | None, units: Iterable[Unit]) -> QuantityUnit:
    """Find a unit by name.

    Parameters
    ----------
    name
        Name of the unit; None or blank where none is declared.
    units
        Known units; of several with one name, the first counts.

    Returns
    -------
    QuantityUnit
        Without a definition where there is no unit of that name.
    """
    if name is None or not name.strip():
        return QuantityUnit()
    return QuantityUnit(name, next((unit for unit in units if unit.name == name), None))


def check_value(model: ModelDescription, elements: Elements, component: str, quantity: Quantity) -> Value:
    """Check a value for a variable of an FMU, or for an element of it.

    Conversions that lose nothing are made, as SSP leaves them to the tool: of whole numbers and Booleans to other
    numbers, and of whole numbers to the items of enumerations by their values. Other values are refused.

    Parameters
    ----------
    model
        The FMU.
    elements
        The variable.
    component
        Name of the component in messages.
    quantity
        The value, in the variable's unit.

    Returns
    -------
    Value
        The value as a user gives it.

    Raises
    ------
    SetupError
        If the variable must not be set, or the value is of a wrong type or out of range.
    """
    variable = model.variables[elements.variable]
    where, kind, value = f"{component}.{elements.alias}", KINDS[variable.type], quantity.value
    is_text = quantity.kind in ("String", "Enumeration")
    if (is_text or kind == "String") and quantity.kind != kind and kind != "Enumeration":
        raise SetupError(f"{where}: expected a value of type {kind}, got {quantity.kind} {value}")
    if is_text and kind == "Enumeration" and value not in items_of(variable):
        raise SetupError(f"{where}: expected one of {', '.join(items_of(variable))}, got {value}")
    if quantity.kind == "Boolean" and kind in ("Real", "Integer"):
        value = int(bool(value))
    model.value(component, elements, value)
    return value
