"""Elements of SSP 1.0 for parameters and mappings (``.ssv`` and ``.ssm`` files), and those shared with ``.ssd`` files.

The classes mirror the elements of the standard and have their names.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from typing import ClassVar

from cosim.errors import SetupError
from cosim.fmi.values import Value
from cosim.ssp.xml import BOOLEAN, INTEGER, REAL, attribute, child, children, read_document, tag
from cosim.units import BASE_UNITS, IDENTITY, Linear, Unit

KINDS = ("Real", "Integer", "Boolean", "String", "Enumeration", "Binary")
"""Types of connectors and parameters: the names of their elements."""

VERSION = "1.0"
"""Version of SSP that is written."""

PARAMETER_SET = "application/x-ssp-parameter-set"
"""MIME type of ``.ssv`` files."""

PARAMETER_MAPPING = "application/x-ssp-parameter-mapping"
"""MIME type of ``.ssm`` files."""


@dataclass(frozen=True, kw_only=True)
class BaseUnit:
    """A unit in base units: exponents, factor and offset."""

    kg: int = attribute("kg", INTEGER, 0)
    m: int = attribute("m", INTEGER, 0)
    s: int = attribute("s", INTEGER, 0)
    A: int = attribute("A", INTEGER, 0)
    K: int = attribute("K", INTEGER, 0)
    mol: int = attribute("mol", INTEGER, 0)
    cd: int = attribute("cd", INTEGER, 0)
    rad: int = attribute("rad", INTEGER, 0)
    factor: float = attribute("factor", REAL, 1.0)
    offset: float = attribute("offset", REAL, 0.0)


@dataclass(frozen=True, kw_only=True)
class UnitDefinition:
    """A unit with its name and definition."""

    name: str = attribute("name")
    base: BaseUnit = child({"ssc:BaseUnit": BaseUnit})

    @property
    def unit(self) -> Unit:
        """The unit as the other packages represent it."""
        return Unit.from_base_unit(self.name, self.base)

    @classmethod
    def of(cls, unit: Unit) -> UnitDefinition:
        """Return the definition of a unit.

        Parameters
        ----------
        unit
            The unit.
        """
        exponents = dict(zip(BASE_UNITS, unit.exponents, strict=True))
        return cls(name=unit.name, base=BaseUnit(**exponents, factor=unit.factor, offset=unit.offset))


@dataclass(frozen=True, kw_only=True)
class Item:
    """An item of an enumeration."""

    name: str = attribute("name")
    value: int = attribute("value", INTEGER)


@dataclass(frozen=True, kw_only=True)
class Enumeration:
    """An enumeration with its name and items."""

    name: str = attribute("name")
    items: tuple[Item, ...] = children({"ssc:Item": Item})


@dataclass(frozen=True, kw_only=True)
class MapEntry:
    """An entry of a mapping transformation: the value ``source`` becomes ``target``."""

    source: str = attribute("source")
    target: str = attribute("target")


@dataclass(frozen=True, kw_only=True)
class Transformation:
    """A transformation of values, applied after the conversion of units: linear, or a table of values."""

    kind: str = tag()
    factor: float = attribute("factor", REAL, 1.0)
    offset: float = attribute("offset", REAL, 0.0)
    entries: tuple[MapEntry, ...] = children({"ssc:MapEntry": MapEntry})

    LINEAR = "LinearTransformation"

    @property
    def linear(self) -> Linear | None:
        """The linear transformation; None for a table."""
        return Linear(self.factor, self.offset) if self.kind == self.LINEAR else None

    @classmethod
    def of(cls, linear: Linear) -> Transformation | None:
        """Return the element for a linear transformation; None for the identity.

        Parameters
        ----------
        linear
            The transformation.
        """
        return None if linear == IDENTITY else cls(kind=cls.LINEAR, factor=linear.factor, offset=linear.offset)


TRANSFORMATIONS: dict[str, type] = {
    f"ssc:{name}": Transformation
    for name in (
        Transformation.LINEAR,
        "BooleanMappingTransformation",
        "IntegerMappingTransformation",
        "EnumerationMappingTransformation",
    )
}
"""Element of each kind of transformation to its class."""


# ---- parameters ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class TypedValue:
    """The value of a parameter with its type, as it is written."""

    kind: str = tag()
    text: str = attribute("value")
    unit: str | None = attribute("unit", default=None)
    enumeration: str | None = attribute("name", default=None)

    @property
    def value(self) -> Value:
        """The value as a number, a Boolean or a text."""
        codec = {"Real": REAL, "Integer": INTEGER, "Boolean": BOOLEAN}.get(self.kind)
        value: Value = codec.read(self.text) if codec else self.text
        return value


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A parameter with its name and value."""

    name: str = attribute("name")
    description: str | None = attribute("description", default=None)
    typed_value: TypedValue = child({f"ssv:{kind}": TypedValue for kind in KINDS})


@dataclass(frozen=True, kw_only=True)
class ParameterSet:
    """A set of parameters, the root of an ``.ssv`` file."""

    ROOT: ClassVar[str] = "ssv:ParameterSet"

    version: str = attribute("version")
    name: str = attribute("name")
    description: str | None = attribute("description", default=None)
    parameters: tuple[Parameter, ...] = children({"ssv:Parameter": Parameter}, container="ssv:Parameters")
    enumerations: tuple[Enumeration, ...] = children({"ssc:Enumeration": Enumeration}, container="ssv:Enumerations")
    units: tuple[UnitDefinition, ...] = children({"ssc:Unit": UnitDefinition}, container="ssv:Units")


@dataclass(frozen=True, kw_only=True)
class MappingEntry:
    """Maps the parameter ``source`` of a set to the parameter ``target`` of an element, with a transformation."""

    source: str = attribute("source")
    target: str = attribute("target")
    suppress_unit_conversion: bool = attribute("suppressUnitConversion", BOOLEAN, False)
    transformation: Transformation | None = child(TRANSFORMATIONS)


@dataclass(frozen=True, kw_only=True)
class ParameterMapping:
    """A mapping of parameters, the root of an ``.ssm`` file."""

    ROOT: ClassVar[str] = "ssm:ParameterMapping"

    version: str = attribute("version")
    entries: tuple[MappingEntry, ...] = children({"ssm:MappingEntry": MappingEntry})


def check_names(values: ParameterSet, where: str) -> None:
    """Check that parameters and units of a set have names of their own.

    Parameters
    ----------
    values
        The set.
    where
        Its name in messages.

    Raises
    ------
    SetupError
        With all names that occur twice; a unit may be repeated with the same definition.
    """
    parameters = Counter(parameter.name for parameter in values.parameters)
    problems = [
        f"parameter {name}: expected one of this name, got {count}" for name, count in parameters.items() if count > 1
    ]
    problems += unit_problems(values.units)
    if problems:
        raise SetupError(*(f"{where}: {problem}" for problem in problems))


def unit_problems(units: Iterable[UnitDefinition]) -> list[str]:
    """Find units with one name and several definitions.

    Parameters
    ----------
    units
        Of a set of parameters or of a description.

    Returns
    -------
    list of str
        A line for each such name.
    """
    definitions = Counter(unit.name for unit in set(units))
    return [f"unit {name}: expected one definition, got {count}" for name, count in definitions.items() if count > 1]


def read_parameter_set(data: bytes, where: str) -> ParameterSet:
    """Read a set of parameters from an ``.ssv`` file.

    Parameters
    ----------
    data
        The bytes of the file.
    where
        Name of the file in messages.

    Returns
    -------
    ParameterSet
        The content of the file.

    Raises
    ------
    SetupError
        If the file is of another kind or version, or violates the schema, or a name occurs twice.
    """
    values = read_document(ParameterSet, data, where)
    check_names(values, where)
    return values


def read_parameter_mapping(data: bytes, where: str) -> ParameterMapping:
    """Read a mapping of parameters from an ``.ssm`` file.

    Parameters
    ----------
    data
        The bytes of the file.
    where
        Name of the file in messages.

    Returns
    -------
    ParameterMapping
        The content of the file.

    Raises
    ------
    SetupError
        If the file is of another kind or version, or violates the schema.
    """
    return read_document(ParameterMapping, data, where)
