"""What a vibration means for a working day and for comfort: Directive 2002/44/EC and ISO 2631-1, annex C."""

from __future__ import annotations

import math
from typing import NamedTuple

from cosim.metrics.samples import positive

DAY = 8.0
"""h, the reference period of the directive."""


class ExposureValue(NamedTuple):
    """A daily exposure to whole-body vibration, normalised to eight hours.

    Attributes
    ----------
    name
        As the directive calls it.
    a8
        A(8) in m/s2.
    vdv
        Vibration dose value in m/s^1.75, which a member state may choose instead.
    """

    name: str
    a8: float
    vdv: float


ACTION = ExposureValue("exposure action value", 0.5, 9.1)
"""From here on the employer has to reduce vibration; Directive 2002/44/EC, article 3 (2) (b)."""

LIMIT = ExposureValue("exposure limit value", 1.15, 21.0)
"""Not to be exceeded; Directive 2002/44/EC, article 3 (2) (a)."""


def a8(a_w: float, hours: float) -> float:
    """Daily exposure A(8) = a_w sqrt(T / 8 h), in m/s2 (Directive 2002/44/EC, annex, part B).

    Parameters
    ----------
    a_w
        Weighted RMS acceleration in m/s2, vertical: its factor is 1.
    hours
        T, daily, in h.

    Raises
    ------
    SignalError
        If one is negative or not finite.
    """
    return positive("a_w", a_w, "m/s2", zero=True) * math.sqrt(positive("hours", hours, "h", zero=True) / DAY)


def daily_vdv(vdv: float, duration: float, hours: float = DAY) -> float:
    """Daily vibration dose value of a sample that goes on alike: VDV (T / T_sample)^(1/4), in m/s^1.75.

    Parameters
    ----------
    vdv
        Of the sample, in m/s^1.75.
    duration
        T_sample in s.
    hours
        T, daily, in h.

    Raises
    ------
    SignalError
        If one is negative or not finite, or the duration 0.
    """
    day = 3600.0 * positive("hours", hours, "h", zero=True)
    growth = math.sqrt(math.sqrt(day / positive("duration", duration, "s")))
    return positive("vdv", vdv, "m/s^1.75", zero=True) * growth


def hours_to_a8(a_w: float, value: ExposureValue) -> float:
    """Hours after which A(8) reaches a value: 8 h (A / a_w)^2; more than 24: not in a day; infinite for a_w = 0.

    Parameters
    ----------
    a_w
        Weighted RMS acceleration in m/s2.
    value
        :data:`ACTION` or :data:`LIMIT`.

    Raises
    ------
    SignalError
        If a_w is negative or not finite.
    """
    if positive("a_w", a_w, "m/s2", zero=True) == 0.0:
        return math.inf
    ratio = value.a8 / a_w
    return DAY * ratio * ratio  # a power would raise where this is infinite


def hours_to_vdv(vdv: float, duration: float, value: ExposureValue) -> float:
    """Hours after which the dose reaches a value, if a sample goes on alike: T_sample (VDV_value / VDV)^4.

    Parameters
    ----------
    vdv
        Of the sample, in m/s^1.75.
    duration
        T_sample in s.
    value
        :data:`ACTION` or :data:`LIMIT`.

    Raises
    ------
    SignalError
        If one is negative or not finite, or the duration 0.
    """
    hours = positive("duration", duration, "s") / 3600.0
    if positive("vdv", vdv, "m/s^1.75", zero=True) == 0.0:
        return math.inf
    ratio = value.vdv / vdv
    return hours * ratio * ratio * ratio * ratio


_REACTIONS = (
    (0.0, 0.315, "not uncomfortable"),
    (0.315, 0.63, "a little uncomfortable"),
    (0.5, 1.0, "fairly uncomfortable"),
    (0.8, 1.6, "uncomfortable"),
    (1.25, 2.5, "very uncomfortable"),
    (2.0, math.inf, "extremely uncomfortable"),
)


def comfort(a_w: float) -> tuple[str, ...]:
    """Name the likely reactions of passengers (ISO 2631-1, annex C.2.3): one band or, where they overlap, two.

    Parameters
    ----------
    a_w
        Weighted RMS acceleration in m/s2. The standard means the total over all directions; of a ride that is
        vertical alone it is the same.

    Raises
    ------
    SignalError
        If it is negative or not finite.

    Examples
    --------
    >>> comfort(0.58)
    ('a little uncomfortable', 'fairly uncomfortable')
    """
    positive("a_w", a_w, "m/s2", zero=True)
    return tuple(words for low, high, words in _REACTIONS if low <= a_w < high)
