"""Values of parameters with types and units, and their transfer from one connector to the next.

Connections and parameters are transferred alike: the unit is converted, then the transformation is applied. Where a
connector declares no unit, the quantity keeps its own, so that it is not lost at the border of a nested system.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from cosim.errors import SetupError
from cosim.fmi.description import ModelDescription
from cosim.fmi.values import Value
from cosim.fmi.variable_types import KINDS
from cosim.ssp.ssv import Transformation, TypedValue
from cosim.units import IDENTITY, Linear, Unit, conversion


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
        The unit; None for the unit of the connector or variable to which the value is transferred.
    """

    kind: str
    value: Value
    unit: Unit | None = None

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
            The value with its unit, None where none is declared.

        Raises
        ------
        SetupError
            If the unit is unknown, or the type is Binary.
        """
        if typed_value.kind == "Binary":
            raise SetupError(f"{where}: expected a number, Boolean or text, got Binary")
        return cls(typed_value.kind, typed_value.value, find_unit(typed_value.unit, units, where))

    def transferred(self, transfer: Transfer, unit: Unit | None, where: str) -> Quantity:
        """Apply a transfer to the value.

        Parameters
        ----------
        transfer
            The transfer.
        unit
            Unit at its end; None where it is not declared.
        where
            Name of the parameter or connection in messages.

        Returns
        -------
        Quantity
            The value at the end of the transfer.

        Raises
        ------
        SetupError
            If the dimensions of the units differ, or the transformation is not for the type of the value.
        """
        linear, unit = transfer.linear(self.unit, unit, where)
        transformation = transfer.transformation
        if transformation is not None and transformation.linear is None:
            return replace(self, value=_mapped_value(self, transformation, where), unit=unit)
        if linear == IDENTITY:
            return replace(self, unit=unit)
        if self.kind not in ("Real", "Integer"):
            raise SetupError(f"{where}: expected no linear transformation of a {self.kind}, got one")
        assert isinstance(self.value, int | float)
        return Quantity("Real", linear(float(self.value)), unit)


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

    def linear(self, source: Unit | None, sink: Unit | None, where: str) -> tuple[Linear, Unit | None]:
        """Return the linear transformation of numbers; a table of values is ignored.

        Parameters
        ----------
        source, sink
            Units of the two ends; None where they are not declared.
        where
            Name of the parameter or connection in messages.

        Returns
        -------
        tuple
            The conversion of units followed by the transformation, and the unit at the end.

        Raises
        ------
        SetupError
            If the dimensions of the units differ.
        """
        converted: Linear | None = IDENTITY
        if not self.suppress_unit_conversion:
            converted = conversion(source, sink)
            sink = sink or source
        if converted is None:
            names = " and ".join(unit.name for unit in (source, sink) if unit)
            raise SetupError(f"{where}: expected two units of one dimension, got {names}")
        own = (self.transformation and self.transformation.linear) or IDENTITY
        return own.after(converted), sink


def _mapped_value(quantity: Quantity, table: Transformation, where: str) -> Value:
    """Return the value to which a mapping transformation maps a value."""
    kind = table.kind.removesuffix("MappingTransformation")
    if quantity.kind != kind:
        raise SetupError(f"{where}: expected a value of type {kind} for its transformation, got {quantity.kind}")
    for entry in table.entries:
        if TypedValue(kind=kind, text=entry.source).value == quantity.value:
            return TypedValue(kind=kind, text=entry.target).value
    raise SetupError(f"{where}: expected a value in the table of its transformation, got {quantity.value}")


def find_unit(name: str | None, units: Iterable[Unit], where: str) -> Unit | None:
    """Find a unit by name.

    Parameters
    ----------
    name
        Name of the unit; None where none is declared.
    units
        Known units; of several with one name, the first counts.
    where
        Name of the parameter or connector in messages.

    Returns
    -------
    Unit or None
        None if ``name`` is None.

    Raises
    ------
    SetupError
        If there is no unit of that name.
    """
    if name is None:
        return None
    for unit in units:
        if unit.name == name:
            return unit
    raise SetupError(f"{where}: expected a unit that is defined, got {name}")


def check_value(model: ModelDescription, component: str, variable: str, quantity: Quantity) -> Value:
    """Check a value for a variable of an FMU.

    Parameters
    ----------
    model
        The FMU.
    component
        Name of the component in messages.
    variable
        Name of the variable.
    quantity
        The value, in the variable's unit.

    Returns
    -------
    Value
        The value as a user gives it.

    Raises
    ------
    SetupError
        If there is no such variable, it must not be set, or the value is of a wrong type or out of range.
    """
    elements = model.elements(component, variable, model.sizes())
    kind = KINDS[model.variables[elements.variable].type]
    if (quantity.kind == "String") != (kind == "String") and (quantity.kind, kind) != ("String", "Enumeration"):
        raise SetupError(f"{component}.{variable}: expected a value of type {kind}, got {quantity.kind}")
    model.value(component, elements, quantity.value)
    return quantity.value
