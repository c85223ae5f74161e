"""Units as FMUs define them, and the conversion of values between two of one dimension."""

from __future__ import annotations

from typing import NamedTuple


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
        """Transform a value; the identity leaves its bits alone."""
        return value if self == IDENTITY else self.factor * value + self.offset

    def after(self, first: Linear) -> Linear:
        """Compose: what ``first`` and then this one do."""
        if first == IDENTITY or self == IDENTITY:
            return self if first == IDENTITY else first
        return Linear(self.factor * first.factor, self(first.offset))


IDENTITY = Linear()


def conversion(source: Unit | None, sink: Unit | None) -> Linear | None:
    """Find what converts values in one unit to another.

    Parameters
    ----------
    source, sink
        None for a unit that is missing or not defined: values are then taken as they are.

    Returns
    -------
    Linear or None
        None if the dimensions differ.
    """
    if source is None or sink is None or source[1:] == sink[1:]:
        return IDENTITY
    if source.exponents != sink.exponents:
        return None
    return Linear(source.factor / sink.factor, (source.offset - sink.offset) / sink.factor)
