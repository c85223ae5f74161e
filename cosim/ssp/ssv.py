"""Parameters and their mappings as SSP 1.0 has them, in ``.ssv`` and ``.ssm`` files or inline, and what all share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cosim.fmi.values import Value
from cosim.ssp.xml import BOOLEAN, INTEGER, REAL, attribute, child, children, read_document, tag
from cosim.units import IDENTITY, Linear, Unit

KINDS = ("Real", "Integer", "Boolean", "String", "Enumeration", "Binary")
"""Types of connectors and parameters, as their elements are called."""

VERSION = "1.0"

PARAMETER_SET = "application/x-ssp-parameter-set"
PARAMETER_MAPPING = "application/x-ssp-parameter-mapping"


@dataclass(frozen=True, kw_only=True)
class BaseUnit:
    """What a unit is made of: exponents of the base units, factor and offset to them."""

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
    """A unit by name."""

    name: str = attribute("name")
    base: BaseUnit = child({"ssc:BaseUnit": BaseUnit})

    @property
    def unit(self) -> Unit:
        """The same as the rest of this package knows it."""
        b = self.base
        return Unit(self.name, (b.kg, b.m, b.s, b.A, b.K, b.mol, b.cd, b.rad), b.factor, b.offset)

    @classmethod
    def of(cls, unit: Unit) -> UnitDefinition:
        """Define a unit."""
        kg, m, s, A, K, mol, cd, rad = unit.exponents
        base = BaseUnit(kg=kg, m=m, s=s, A=A, K=K, mol=mol, cd=cd, rad=rad, factor=unit.factor, offset=unit.offset)
        return cls(name=unit.name, base=base)


@dataclass(frozen=True, kw_only=True)
class Item:
    """An item of an enumeration."""

    name: str = attribute("name")
    value: int = attribute("value", INTEGER)


@dataclass(frozen=True, kw_only=True)
class Enumeration:
    """An enumeration by name."""

    name: str = attribute("name")
    items: tuple[Item, ...] = children({"ssc:Item": Item})


@dataclass(frozen=True, kw_only=True)
class MapEntry:
    """One line of a table of values."""

    source: str = attribute("source")
    target: str = attribute("target")


@dataclass(frozen=True, kw_only=True)
class Transformation:
    """What happens to a value after units were converted: linear, or a table from value to value."""

    kind: str = tag()
    factor: float = attribute("factor", REAL, 1.0)
    offset: float = attribute("offset", REAL, 0.0)
    entries: tuple[MapEntry, ...] = children({"ssc:MapEntry": MapEntry})

    LINEAR = "LinearTransformation"

    @property
    def linear(self) -> Linear | None:
        """The linear transformation; None if it is a table."""
        return Linear(self.factor, self.offset) if self.kind == self.LINEAR else None

    @classmethod
    def of(cls, linear: Linear) -> Transformation | None:
        """Write down a linear transformation; the identity needs none."""
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
"""Element to what describes it."""


# ---- parameters ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Given:
    """A parameter's value as it is written."""

    kind: str = tag()
    text: str = attribute("value")
    unit: str | None = attribute("unit", default=None)
    enumeration: str | None = attribute("name", default=None)

    @property
    def value(self) -> Value:
        """The value: a number, a Boolean or a text."""
        codec = {"Real": REAL, "Integer": INTEGER, "Boolean": BOOLEAN}.get(self.kind)
        value: Value = codec.read(self.text) if codec else self.text
        return value


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A parameter by name."""

    name: str = attribute("name")
    description: str | None = attribute("description", default=None)
    given: Given = child({f"ssv:{kind}": Given for kind in KINDS})


@dataclass(frozen=True, kw_only=True)
class ParameterSet:
    """What stands in a ``.ssv`` file."""

    ROOT: ClassVar[str] = "ssv:ParameterSet"

    version: str = attribute("version")
    name: str = attribute("name")
    description: str | None = attribute("description", default=None)
    parameters: tuple[Parameter, ...] = children({"ssv:Parameter": Parameter}, container="ssv:Parameters")
    enumerations: tuple[Enumeration, ...] = children({"ssc:Enumeration": Enumeration}, container="ssv:Enumerations")
    units: tuple[UnitDefinition, ...] = children({"ssc:Unit": UnitDefinition}, container="ssv:Units")


@dataclass(frozen=True, kw_only=True)
class MappingEntry:
    """To which parameter the value of another name goes, and how it is transformed."""

    source: str = attribute("source")
    target: str = attribute("target")
    suppress_unit_conversion: bool = attribute("suppressUnitConversion", BOOLEAN, False)
    transformation: Transformation | None = child(TRANSFORMATIONS)


@dataclass(frozen=True, kw_only=True)
class ParameterMapping:
    """What stands in a ``.ssm`` file."""

    ROOT: ClassVar[str] = "ssm:ParameterMapping"

    version: str = attribute("version")
    entries: tuple[MappingEntry, ...] = children({"ssm:MappingEntry": MappingEntry})


def read_parameter_set(data: bytes, where: str) -> ParameterSet:
    """Read a ``.ssv`` file.

    Parameters
    ----------
    data
        Its bytes.
    where
        What to call it in messages.

    Raises
    ------
    SetupError
        If it is none, of another version, or against the schema.
    """
    return read_document(ParameterSet, data, where)


def read_parameter_mapping(data: bytes, where: str) -> ParameterMapping:
    """Read a ``.ssm`` file; as :func:`read_parameter_set`."""
    return read_document(ParameterMapping, data, where)
