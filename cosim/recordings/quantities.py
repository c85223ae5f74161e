"""Physical quantities of recorded channels, and units in the spellings of data loggers."""

from __future__ import annotations

import re
from typing import NamedTuple

from cosim.units import GRAVITY, Unit, named_unit


class Quantity(NamedTuple):
    """A physical quantity that a channel may have.

    Attributes
    ----------
    name
        Its name in messages.
    unit
        Its SI unit, to which values are converted.
    """

    name: str
    unit: str


TIME = Quantity("time", "s")
ACCELERATION = Quantity("acceleration", "m/s2")
DISPLACEMENT = Quantity("displacement", "m")

_EXPONENTS = {
    TIME.name: (0, 0, 1, 0, 0, 0, 0, 0),
    ACCELERATION.name: (0, 1, -2, 0, 0, 0, 0, 0),
    DISPLACEMENT.name: (0, 1, 0, 0, 0, 0, 0, 0),
}
"""Quantity to the exponents of its base units."""

_G = Unit("g", _EXPONENTS[ACCELERATION.name], GRAVITY)
_MILLI_G = Unit("mg", _EXPONENTS[ACCELERATION.name], 1e-3 * GRAVITY)

_LOGGER_UNITS = {
    **dict.fromkeys(("g", "gn", "g0", "g_n", "g_0", "g's", "gee"), _G),
    **dict.fromkeys(("mg", "mgn"), _MILLI_G),
}
"""Units of data loggers that mean something else, or nothing, in FMI; in lower case."""

_SPELLINGS = {"mps2": "m/s2", "mpss": "m/s2", "m/ss": "m/s2", "ms-2": "m.s-2", "mm/ss": "mm/s2", "secs": "s"}
"""Spellings of data loggers, in lower case, to names of FMI."""

_PLAIN = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻−·⋅∙*μ", "0123456789--....µ")
"""Typographic characters to those of FMI's names."""


def find_unit(text: str, quantity: Quantity) -> Unit | None:
    """Look up a unit of a quantity, in any spelling of data loggers.

    Capitals count only where they make the difference: ``MS`` is a millisecond where a time is expected.

    Parameters
    ----------
    text
        The unit's name: ``m/s^2``, ``m/s²``, ``m s⁻²``, ``g``, ``msec`` and others.
    quantity
        The quantity that it must have.

    Returns
    -------
    Unit or None
        None where the text is no unit of that quantity.

    Examples
    --------
    >>> find_unit("M/S²", ACCELERATION).factor, find_unit("MS", TIME).factor
    (1.0, 0.001)
    >>> find_unit("mm", ACCELERATION) is None
    True
    """
    plain = re.sub(r"\s+", ".", text.strip().translate(_PLAIN).replace("..", "").replace("^", "").strip("[](){}<> "))
    for name in dict.fromkeys((plain, plain.lower())):
        known = _LOGGER_UNITS.get(name.lower()), named_unit(_SPELLINGS.get(name.lower(), name)) if name else None
        for unit in known:
            if unit is not None and unit.exponents == _EXPONENTS[quantity.name] and unit.offset == 0.0:
                return unit
    return None


def is_unit(text: str) -> bool:
    """Return whether a text is a unit of any quantity, or a mark of none, as in a row of units.

    Parameters
    ----------
    text
        The text.
    """
    plain = text.strip().strip("[](){}<> ").translate(_PLAIN).replace("^", "")
    return (
        plain in _NO_UNITS
        or any(find_unit(text, each) for each in (TIME, ACCELERATION, DISPLACEMENT))
        or (named_unit(plain) is not None)
    )


_NO_UNITS = ("", "-", "--", "n/a", "none", "1", "EU", "eu")
"""What a row of units has where there is no unit."""
