"""Units as FMUs define them, units known by their names, and the conversion of values between two of one dimension."""

from __future__ import annotations

import re
from functools import cache
from typing import Any, NamedTuple


class Unit(NamedTuple):
    """A unit by its definition: value in base units = ``factor`` * value + ``offset``.

    Attributes
    ----------
    name
        As its FMU calls it.
    exponents
        Of kg, m, s, A, K, mol, cd, rad.
    factor, offset
        To the base units.
    """

    name: str
    exponents: tuple[int, ...]
    factor: float = 1.0
    offset: float = 0.0


class Linear(NamedTuple):
    """A linear transformation: new = ``factor`` * value + ``offset``."""

    factor: float = 1.0
    offset: float = 0.0

    def __call__(self, value: float) -> float:
        """Transform a value; the identity does not change its bits."""
        return value if self == IDENTITY else self.factor * value + self.offset

    def after(self, first: Linear) -> Linear:
        """Compose two transformations: ``first``, then this one."""
        if first == IDENTITY or self == IDENTITY:
            return self if first == IDENTITY else first
        return Linear(self.factor * first.factor, self(first.offset))


IDENTITY = Linear()


def conversion(source: Unit | None, sink: Unit | None, relative: bool = False) -> Linear | None:
    """Return the transformation of values from one unit to another.

    Parameters
    ----------
    source, sink
        None for a unit that is missing or not defined: values are then taken as they are.
    relative
        Whether the values are differences, which offsets do not change.

    Returns
    -------
    Linear or None
        None if the dimensions differ.
    """
    if source is None or sink is None or source[1:] == sink[1:]:
        return IDENTITY
    if source.exponents != sink.exponents:
        return None
    offset = 0.0 if relative else (source.offset - sink.offset) / sink.factor
    return Linear(source.factor / sink.factor, offset)


@cache
def _registry() -> Any:
    import pint  # loaded only where a unit is not defined: it takes longer than most runs

    return pint.UnitRegistry()


_LONGEST_NAME = 100

_BASE = ("kilogram", "meter", "second", "ampere", "kelvin", "mole", "candela", "radian")
_EXPONENT = re.compile(r"(?<=[A-Za-z°µ])([-+]?\d+)")


@cache
def named_unit(name: str) -> Unit | None:
    """Look up a unit by its name, in the grammar of FMI unit names (Modelica's): ``m/s2``, ``N.m``, ``km/h``, ``degC``.

    Parameters
    ----------
    name
        The name.

    Returns
    -------
    Unit or None
        None where the name is not known.

    Examples
    --------
    >>> named_unit("mm")
    Unit(name='mm', exponents=(0, 1, 0, 0, 0, 0, 0, 0), factor=0.001, offset=0.0)
    """
    if len(name) > _LONGEST_NAME:
        return None
    import pint

    registry = _registry()
    text = _EXPONENT.sub(r"**(\1)", name.strip().replace(".", "*").replace("°C", "degC"))
    try:
        unit = registry.parse_units(text)
        one, zero = (registry.Quantity(value, unit).to_base_units() for value in (1.0, 0.0))
    except (pint.PintError, AttributeError, TypeError, ValueError, ArithmeticError, SyntaxError, AssertionError):
        return None
    base = dict(registry.Quantity(1.0, one.units).unit_items())
    if set(base) - set(_BASE) or any(not float(power).is_integer() for power in base.values()):
        return None
    exponents = tuple(int(base.get(each, 0)) for each in _BASE)
    offset = float(zero.magnitude)
    return Unit(name, exponents, float(one.magnitude) - offset if offset else float(one.magnitude), offset)
