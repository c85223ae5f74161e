"""Daily exposure to whole-body vibration by Directive 2002/44/EC, and comfort by ISO 2631-1, annex C."""

from __future__ import annotations

import math
from typing import NamedTuple

from cosim.metrics.samples import check_positive

DAY = 8.0
"""Reference period of the directive, in h."""


class ExposureValue(NamedTuple):
    """An exposure value of the directive, for a reference period of eight hours.

    Attributes
    ----------
    name
        Its name in the directive.
    a8
        A(8) in m/s2.
    vdv
        Vibration dose value in m/s^1.75, which a member state may choose instead.
    """

    name: str
    a8: float
    vdv: float


ACTION = ExposureValue("exposure action value", 0.5, 9.1)
"""Above it, the employer must reduce vibration; Directive 2002/44/EC, article 3 (2) (b)."""

LIMIT = ExposureValue("exposure limit value", 1.15, 21.0)
"""Must not be exceeded; Directive 2002/44/EC, article 3 (2) (a)."""


def a8(a_w: float, hours: float) -> float:
    """Calculate the daily exposure A(8) = a_w sqrt(T / 8 h), Directive 2002/44/EC, annex, part B.

    Parameters
    ----------
    a_w
        Weighted vertical RMS acceleration in m/s2; its factor is 1.
    hours
        Daily duration T of the exposure in h.

    Returns
    -------
    float
        A(8) in m/s2.

    Raises
    ------
    SignalError
        If an argument is negative or not finite.

    Examples
    --------
    >>> a8(0.5, hours=2.0)
    0.25
    """
    return check_positive("a_w", a_w, "m/s2", zero=True) * math.sqrt(
        check_positive("hours", hours, "h", zero=True) / DAY
    )


def daily_vdv(vdv: float, duration: float, hours: float = DAY) -> float:
    """Extrapolate the vibration dose value of a measurement to a day: VDV (T / T_measurement)^(1/4).

    Parameters
    ----------
    vdv
        Vibration dose value of the measurement in m/s^1.75.
    duration
        Duration T_measurement in s.
    hours
        Daily duration T of the exposure in h.

    Returns
    -------
    float
        Daily vibration dose value in m/s^1.75.

    Raises
    ------
    SignalError
        If an argument is negative or not finite, or the duration is 0.
    """
    day = 3600.0 * check_positive("hours", hours, "h", zero=True)
    growth = math.sqrt(math.sqrt(day / check_positive("duration", duration, "s")))
    return check_positive("vdv", vdv, "m/s^1.75", zero=True) * growth


def hours_to_a8(a_w: float, value: ExposureValue) -> float:
    """Calculate the daily duration after which A(8) reaches an exposure value: 8 h (A / a_w)^2.

    Parameters
    ----------
    a_w
        Weighted vertical RMS acceleration in m/s2.
    value
        :data:`ACTION` or :data:`LIMIT`.

    Returns
    -------
    float
        In h. Above 24, the value is not reached in a day; infinite for a_w = 0.

    Raises
    ------
    SignalError
        If a_w is negative or not finite.
    """
    if check_positive("a_w", a_w, "m/s2", zero=True) == 0.0:
        return math.inf
    ratio = value.a8 / a_w
    return DAY * ratio * ratio  # a power would raise where this is infinite


def hours_to_vdv(vdv: float, duration: float, value: ExposureValue) -> float:
    """Calculate the daily duration after which the dose reaches an exposure value: T_measurement (VDV_value / VDV)^4.

    Parameters
    ----------
    vdv
        Vibration dose value of a measurement in m/s^1.75.
    duration
        Duration T_measurement in s.
    value
        :data:`ACTION` or :data:`LIMIT`.

    Returns
    -------
    float
        In h. Above 24, the value is not reached in a day; infinite for vdv = 0.

    Raises
    ------
    SignalError
        If an argument is negative or not finite, or the duration is 0.
    """
    hours = check_positive("duration", duration, "s") / 3600.0
    if check_positive("vdv", vdv, "m/s^1.75", zero=True) == 0.0:
        return math.inf
    ratio = value.vdv / vdv
    return hours * ratio * ratio * ratio * ratio


_REACTIONS = (
    # from, below, in m/s2
    (0.0, 0.315, "not uncomfortable"),
    (0.315, 0.63, "a little uncomfortable"),
    (0.5, 1.0, "fairly uncomfortable"),
    (0.8, 1.6, "uncomfortable"),
    (1.25, 2.5, "very uncomfortable"),
    (2.0, math.inf, "extremely uncomfortable"),
)


def comfort(a_w: float) -> tuple[str, ...]:
    """Return the likely reactions of passengers in public transport (ISO 2631-1, annex C.2.3).

    Parameters
    ----------
    a_w
        Weighted RMS acceleration in m/s2. The standard uses the vibration total value of all directions, which equals
        the vertical one where there is no other vibration.

    Returns
    -------
    tuple of str
        One reaction, or two where the standard's ranges overlap.

    Raises
    ------
    SignalError
        If a_w is negative or not finite.

    Examples
    --------
    >>> comfort(0.58)
    ('a little uncomfortable', 'fairly uncomfortable')
    """
    check_positive("a_w", a_w, "m/s2", zero=True)
    return tuple(words for low, high, words in _REACTIONS if low <= a_w < high)
