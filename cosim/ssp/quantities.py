"""Values on their way through a system structure: each hop converts units, then transforms.

Connections and parameters take the same hops; a unit that a connector does not state is carried along, so that it is
not lost at the border of a nested system.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from cosim.errors import SetupError
from cosim.fmi.description import ModelDescription, Value
from cosim.fmi.variable_types import KINDS
from cosim.ssp.ssv import Given, Transformation
from cosim.units import IDENTITY, Linear, Unit, conversion


@dataclass(frozen=True)
class Quantity:
    """A parameter's value with its type and unit.

    Attributes
    ----------
    kind
        As SSP calls the type.
    value
        In ``unit``, or in that of whatever it goes to where that is None.
    """

    kind: str
    value: Value
    unit: Unit | None = None

    @classmethod
    def of(cls, given: Given, units: Iterable[Unit], where: str) -> Quantity:
        """Take a value as it is written.

        Parameters
        ----------
        given
            What is written.
        units
            Known units, those that count first in front.
        where
            The parameter; for the message.

        Raises
        ------
        SetupError
            If its unit is not known, or its type is of no use here.
        """
        if given.kind == "Binary":
            raise SetupError(f"{where}: expected a number, Boolean or text, got Binary")
        return cls(given.kind, given.value, defined(given.unit, units, where))

    def passed(self, hop: Hop, unit: Unit | None, where: str) -> Quantity:
        """Take a hop.

        Parameters
        ----------
        hop
            How.
        unit
            Unit at its end, if that is known.
        where
            From where to where; for the message.

        Raises
        ------
        SetupError
            If the dimensions differ, or the transformation does not fit the type.
        """
        linear, unit = hop.linear(self.unit, unit, where)
        transformation = hop.transformation
        if transformation is not None and transformation.linear is None:
            return replace(self, value=_looked_up(self, transformation, where), unit=unit)
        if linear == IDENTITY:
            return replace(self, unit=unit)
        if self.kind not in ("Real", "Integer"):
            raise SetupError(f"{where}: expected no linear transformation of a {self.kind}, got one")
        return Quantity("Real", linear(float(self.value)), unit)


@dataclass(frozen=True)
class Hop:
    """How a value gets from one end to the next.

    Attributes
    ----------
    transformation
        After the conversion of units.
    suppress_unit_conversion
        Whether there is none.
    """

    transformation: Transformation | None = None
    suppress_unit_conversion: bool = False

    def linear(self, source: Unit | None, sink: Unit | None, where: str) -> tuple[Linear, Unit | None]:
        """Find what the hop does to a number, and in which unit it arrives; a table is left out.

        Raises
        ------
        SetupError
            If the dimensions differ.
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


def _looked_up(quantity: Quantity, table: Transformation, where: str) -> Value:
    """Find a value in a table."""
    kind = table.kind.removesuffix("MappingTransformation")
    if quantity.kind != kind:
        raise SetupError(f"{where}: expected a value of type {kind} for its transformation, got {quantity.kind}")
    for entry in table.entries:
        if Given(kind=kind, text=entry.source).value == quantity.value:
            return Given(kind=kind, text=entry.target).value
    raise SetupError(f"{where}: expected a value in the table of its transformation, got {quantity.value}")


def defined(name: str | None, units: Iterable[Unit], where: str) -> Unit | None:
    """Find a unit by name.

    Raises
    ------
    SetupError
        If there is a name, but no unit of it.
    """
    if name is None:
        return None
    for unit in units:
        if unit.name == name:
            return unit
    raise SetupError(f"{where}: expected a unit that is defined, got {name}")


def set_value(model: ModelDescription, component: str, variable: str, quantity: Quantity) -> Value:
    """Check a value for a variable of an FMU, in whose unit it has to be.

    Returns
    -------
    Value
        As a user would give it.

    Raises
    ------
    SetupError
        If there is no such variable, it may not be set, or the value does not fit it.
    """
    kind = KINDS[model.variable(component, variable).type]
    if (quantity.kind == "String") != (kind == "String") and (quantity.kind, kind) != ("String", "Enumeration"):
        raise SetupError(f"{component}.{variable}: expected a value of type {kind}, got {quantity.kind}")
    model.value(component, variable, quantity.value)
    return quantity.value
