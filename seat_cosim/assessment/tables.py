"""Tables of an assessment: the numbers with names and units, for terminal, page, CSV and JSON alike."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

from cosim.metrics import ACTION, LIMIT
from seat_cosim.assessment.numbers import Assessment, ChannelNumbers

CHANNELS = ("floor", "seat")
"""Channels in the order of columns."""

DAY = 24.0


@dataclass(frozen=True)
class Row:
    """One number of each channel.

    Attributes
    ----------
    key
        Name in files.
    title
        Name in tables.
    unit
        Unit; ``"1"`` where it has none.
    value
        Function that returns the number.
    is_duration
        Whether it is a daily duration, which is shown in h up to a day.
    """

    key: str
    title: str
    unit: str
    value: Callable[[ChannelNumbers], float]
    is_duration: bool = False

    def text(self, channel: ChannelNumbers) -> str:
        """Return the number as tables show it; a dash where there is none.

        Parameters
        ----------
        channel
            Numbers of a channel.
        """
        if math.isnan(value := self.value(channel)):
            return "–"
        if self.is_duration:
            return f"over {DAY:g}" if value > DAY else f"{value:.2f}" if value < 10.0 else f"{value:.1f}"
        return f"{value:#.3g}" if value < 100.0 else f"{value:.0f}"


METRICS = (
    Row("a_w", "weighted acceleration a_w", "m/s²", lambda channel: channel.ride.a_w),
    Row("vdv", "vibration dose value VDV", "m/s^1.75", lambda channel: channel.ride.vdv),
    Row("mtvv", "maximum transient vibration value MTVV", "m/s²", lambda channel: channel.ride.mtvv),
    Row("crest_factor", "crest factor, weighted", "1", lambda channel: channel.ride.crest_factor),
    Row("rms", "acceleration, RMS", "m/s²", lambda channel: channel.rms),
    Row("peak", "acceleration, peak", "m/s²", lambda channel: channel.peak),
)
"""Metrics of a ride."""

_ACTION_DOSE, _LIMIT_DOSE = (
    f"time to the {name} value, {value.vdv:g} m/s^1.75" for name, value in (("action", ACTION), ("limit", LIMIT))
)

EXPOSURE = (
    Row("a8", "A(8)", "m/s²", lambda channel: channel.exposure.a8),
    Row("daily_vdv", "VDV of the day", "m/s^1.75", lambda channel: channel.exposure.vdv),
    Row("hours_to_action", f"time to the action value, {ACTION.a8:g} m/s²", "h", lambda c: c.exposure.to_action, True),
    Row("hours_to_limit", f"time to the limit value, {LIMIT.a8:g} m/s²", "h", lambda c: c.exposure.to_limit, True),
    Row("hours_to_action_vdv", _ACTION_DOSE, "h", lambda c: c.exposure.to_action_vdv, True),
    Row("hours_to_limit_vdv", _LIMIT_DOSE, "h", lambda c: c.exposure.to_limit_vdv, True),
)
"""Daily exposure by Directive 2002/44/EC."""


def shown_channels(assessment: Assessment) -> list[str]:
    """Return the channels that were measured, in the order of columns.

    Parameters
    ----------
    assessment
        The assessment.
    """
    return [key for key in CHANNELS if key in assessment.channels]


def numbers(assessment: Assessment, key: str) -> dict[str, float | None]:
    """Return the numbers of a channel by their names in files; None for what JSON cannot hold.

    Parameters
    ----------
    assessment
        The assessment.
    key
        ``floor`` or ``seat``.
    """
    channel = assessment.channels[key]
    values = {row.key: row.value(channel) for row in (*METRICS, *EXPOSURE)}
    return {name: value if math.isfinite(value) else None for name, value in values.items()}


def summary(assessment: Assessment) -> str:
    """Return the main result as a sentence.

    Parameters
    ----------
    assessment
        The assessment.
    """
    main = assessment.channels[assessment.main]
    if assessment.seat_factor is None:
        return f"a_w on the {assessment.main} is {main.ride.a_w:.2f} m/s²: {main.comfort}"
    factor, floor = assessment.seat_factor, assessment.channels["floor"]
    change = "reduces" if factor.rms < 1.0 else "increases"
    return (
        f"SEAT {factor.rms:.2f}: the seat {change} a_w from {floor.ride.a_w:.2f} to {main.ride.a_w:.2f} m/s² "
        f"({main.comfort}); SEAT by VDV {factor.vdv:.2f}"
    )


def table_rows(
    assessment: Assessment, rows: Iterable[Row], channels: Sequence[str]
) -> Iterator[tuple[str, str, list[str]]]:
    """Yield title, unit and one text for each channel.

    Parameters
    ----------
    assessment
        The assessment.
    rows
        Rows of the table.
    channels
        Its columns.

    Yields
    ------
    tuple
        A row.
    """
    for row in rows:
        texts = [row.text(assessment.channels[key]) for key in channels]
        yield row.title, "" if row.unit == "1" else row.unit, texts
