"""SI base exponents of unit names such as ``"N.s/m"``.

Unit names follow the grammar of Modelica, which FMI tools expect: symbols with an optional integer exponent, joined by
``.``, and at most one ``/`` before the denominator, e.g. ``kg``, ``m/s2``, ``N.s/m``, ``1/m2``.
"""

from __future__ import annotations

import re
from typing import NamedTuple


class Dimension(NamedTuple):
    """Exponents of the SI base units in use; all units have factor 1 and offset 0.

    Attributes
    ----------
    kg, m, s, rad
        Exponents of kilogram, metre, second and radian.
    """

    kg: int = 0
    m: int = 0
    s: int = 0
    rad: int = 0


_SYMBOLS = {
    "1": Dimension(),
    "kg": Dimension(kg=1),
    "m": Dimension(m=1),
    "s": Dimension(s=1),
    "Hz": Dimension(s=-1),
    "N": Dimension(kg=1, m=1, s=-2),
    "rad": Dimension(rad=1),
}

_FACTOR = re.compile(r"(?P<symbol>1|[A-Za-z]+)(?P<exponent>\d*)")


def dimension(unit: str) -> Dimension:
    """Return the SI base exponents of a unit name.

    Parameters
    ----------
    unit
        Unit name in the grammar of this module, e.g. ``"N.s/m"``.

    Returns
    -------
    Dimension
        Exponents of kg, m, s and rad.

    Raises
    ------
    ValueError
        If the name does not follow the grammar or contains an unknown symbol.

    Examples
    --------
    >>> dimension("N.s/m")
    Dimension(kg=1, m=0, s=-1, rad=0)
    """
    numerator, _, denominator = unit.partition("/")
    total = Dimension()
    for side, sign in ((numerator, 1), (denominator, -1)):
        for factor in filter(None, side.split(".")):
            match = _FACTOR.fullmatch(factor)
            if match is None or match["symbol"] not in _SYMBOLS:
                raise ValueError(f"unit {unit!r}: factor {factor!r} is not one of {', '.join(_SYMBOLS)}")
            power = sign * int(match["exponent"] or 1)
            total = Dimension(*(t + power * f for t, f in zip(total, _SYMBOLS[match["symbol"]], strict=True)))
    return total
