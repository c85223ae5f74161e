"""Units by their definition in base units or by their name, and the conversion of values between two of them."""

from __future__ import annotations

import math
import re
from functools import cache
from typing import Any, NamedTuple

BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
"""The base units of FMI and SSP, in the order of :attr:`Unit.exponents`."""

GRAVITY = 9.80665
"""Standard acceleration of gravity in m/s2."""


class Unit(NamedTuple):
    """A unit by its definition: value in base units = ``factor`` * value + ``offset``.

    Attributes
    ----------
    name
        The unit's name in its FMU or SSP file.
    exponents
        Exponents of :data:`BASE_UNITS`.
    factor, offset
        Conversion to the base units.
    """

    name: str
    exponents: tuple[int, ...]
    factor: float = 1.0
    offset: float = 0.0

    @classmethod
    def from_base_unit(cls, name: str, base_unit: Any) -> Unit:
        """Create a unit from an object that mirrors the element ``BaseUnit`` of FMI and SSP.

        Parameters
        ----------
        name
            The unit's name.
        base_unit
            An object with the attributes :data:`BASE_UNITS`, ``factor`` and ``offset``.

        Returns
        -------
        Unit
            The unit with the definition of the element.
        """
        exponents = tuple(getattr(base_unit, symbol) for symbol in BASE_UNITS)
        return cls(name, exponents, base_unit.factor, base_unit.offset)

    def is_close(self, other: Unit) -> bool:
        """Whether another unit is the same but for rounding, whatever its name.

        Parameters
        ----------
        other
            The other unit.

        Returns
        -------
        bool
            True where exponents, factor and offset agree.
        """
        return self.exponents == other.exponents and all(
            math.isclose(one, two, rel_tol=1e-9) for one, two in zip(self[2:], other[2:], strict=True)
        )


class Linear(NamedTuple):
    """A linear transformation: new = ``factor`` * value + ``offset``.

    Attributes
    ----------
    factor, offset
        Its coefficients.
    """

    factor: float = 1.0
    offset: float = 0.0

    def __call__(self, value: float) -> float:
        """Transform a value; the identity returns it unchanged."""
        return value if self == IDENTITY else self.factor * value + self.offset

    def after(self, first: Linear) -> Linear:
        """Compose two transformations into one.

        Parameters
        ----------
        first
            The transformation that is applied before this one.

        Returns
        -------
        Linear
            Both in one.

        Examples
        --------
        >>> Linear(2.0, 1.0).after(Linear(10.0))
        Linear(factor=20.0, offset=1.0)
        """
        if first == IDENTITY or self == IDENTITY:
            return self if first == IDENTITY else first
        return Linear(self.factor * first.factor, self(first.offset))


IDENTITY = Linear()
"""The transformation that returns each value unchanged."""


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
        The conversion; None if the dimensions differ.

    Examples
    --------
    >>> metre, second = Unit("m", (0, 1, 0, 0, 0, 0, 0, 0)), Unit("s", (0, 0, 1, 0, 0, 0, 0, 0))
    >>> conversion(Unit("mm", metre.exponents, 0.001), metre)
    Linear(factor=0.001, offset=0.0)
    >>> conversion(metre, second) is None
    True
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
    if len(name) > _LONGEST_NAME or re.search(r"\s", name):  # in pint's grammar, a space is a product
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
