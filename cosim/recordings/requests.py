"""What a caller wants of a measurement file."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from cosim.recordings.quantities import ACCELERATION, Quantity


@dataclass(frozen=True)
class ChannelRequest:
    """A channel to read.

    Attributes
    ----------
    name
        Name of its column.
    option
        The option that names it, for messages.
    quantities
        Quantities that it may have; the first one where neither the file nor the caller says.
    unit
        Unit of the values, which wins over that of the file; None for the file's.
    """

    name: str
    option: str
    quantities: tuple[Quantity, ...] = (ACCELERATION,)
    unit: str | None = None


@dataclass(frozen=True)
class ClockRequest:
    """Where the times of the samples are.

    Attributes
    ----------
    name
        Name of the column of times; one with a usual name where None.
    unit
        Unit of the times, which wins over that of the file; None for the file's.
    rate
        Sampling rate in Hz of a file without times; None for the column.
    """

    name: str | None = None
    unit: str | None = None
    rate: float | None = None


@dataclass(frozen=True)
class TextOptions:
    """Form of a text file; what is None is found in the file.

    Attributes
    ----------
    separator
        Character between columns; a blank for any number of blanks.
    decimal
        Decimal sign.
    encoding
        Name of the encoding.
    """

    separator: str | None = None
    decimal: str | None = None
    encoding: str | None = None


@dataclass(frozen=True)
class ReadOptions:
    """How a file is read.

    Attributes
    ----------
    clock
        Where the times are.
    text
        Form of a text file.
    gaps
        ``error`` refuses gaps, ``split`` makes a part of what is between them.
    start, stop
        Time from the first sample from which, and to which, samples are used, in s; None for the ends.
    """

    clock: ClockRequest = field(default_factory=ClockRequest)
    text: TextOptions = field(default_factory=TextOptions)
    gaps: Literal["error", "split"] = "error"
    start: float | None = None
    stop: float | None = None
