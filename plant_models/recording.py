"""Recorded signals in CSV files: the samples of a file, or one message why it cannot be used.

The first line names the columns: of a motion ``time`` in s and either ``acceleration`` in m/s2 or ``displacement`` in
m, of a road ``distance`` in m and ``elevation`` in m. Other columns are ignored. Rows may lie as close as 1 us or 1 um,
if time or distance rises and no step is longer than ten times the median step.
"""

from __future__ import annotations

import re
from itertools import pairwise
from typing import BinaryIO, NamedTuple

from fmus.component import ParameterError

MIN_ROWS = 10
"""Smallest number of rows."""

MAX_ROWS = 1_000_000
"""Largest number of rows."""

MAX_LINE_SIZE = 1000
"""Largest size of a line, in bytes."""

MAX_NUMBER_SIZE = 60
"""Largest size of a number, in bytes."""

MAX_MAGNITUDE = 1e12
"""Largest magnitude of a number, in its unit."""

MAX_GAP = 10.0
"""Longest step, in medians of all steps."""

MIN_STEP = 1e-6
"""Shortest step, in s or m: differences over a much shorter one may overflow."""

_MAX_EXCERPT = 40
_NUMBER = re.compile(rb"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_BLANKS = b" \t"


class Columns(NamedTuple):
    """Columns that a file must have.

    Attributes
    ----------
    axis
        Name of the column that rises.
    unit
        Its unit.
    quantities
        Names of the columns of which there must be exactly one.
    """

    axis: str
    unit: str
    quantities: tuple[str, ...]

    @property
    def expected(self) -> str:
        """What a message says about them."""
        several = len(self.quantities) > 1
        return f"the columns {self.axis} and {'one of ' if several else ''}{', '.join(self.quantities)}"


MOTION = Columns("time", "s", ("acceleration", "displacement"))
"""Columns of a recorded motion."""

ROAD = Columns("distance", "m", ("elevation",))
"""Columns of a recorded road."""


class Samples(NamedTuple):
    """Samples of a recording.

    Attributes
    ----------
    quantity
        One of the quantities of its columns.
    axis
        Times in s or distances in m, rising from 0.
    values
        In m/s2 or m.
    """

    quantity: str
    axis: list[float]
    values: list[float]


def _excerpt(text: bytes) -> str:
    """Return the begin of a text for a message."""
    return "".join(chr(c) if 32 <= c < 127 else "?" for c in text[:_MAX_EXCERPT]) or "nothing"


class _Header(NamedTuple):
    """Columns of a file: their number, the positions of axis and value, and the quantity of the value."""

    columns: int
    axis: int
    value: int
    quantity: str


class _Reader:
    """Reads the lines of a file and counts them."""

    def __init__(self, path: str, stream: BinaryIO, columns: Columns) -> None:
        self.path = path
        self.columns = columns
        self.line = 0
        self._stream = stream

    def error(self, expected: str, got: str, line: int | None = None) -> ParameterError:
        """Return an error with file and line; the line is the present one where None."""
        return ParameterError(f"{self.path}, line {line or self.line}: expected {expected}, got {got}")

    def next_line(self) -> bytes | None:
        """Read a line without its end; None at the end of the file."""
        read = self._stream.readline(MAX_LINE_SIZE + 2)
        if not read:
            return None
        self.line += 1
        text = read.removesuffix(b"\n").removesuffix(b"\r")
        if len(text) > MAX_LINE_SIZE:
            raise self.error(f"at most {MAX_LINE_SIZE} characters", "more")
        return text

    def read_header(self) -> _Header:
        """Read the names of the columns."""
        header = (self.next_line() or b"").removeprefix(b"\xef\xbb\xbf")
        self.line = 1
        names = [_unquoted(cell.strip(_BLANKS)) for cell in header.split(b",")]
        axis = self.columns.axis.encode()
        found = [name for name in self.columns.quantities if name.encode() in names]
        if names.count(axis) != 1 or len(found) != 1 or names.count(found[0].encode()) != 1:
            raise self.error(self.columns.expected, _excerpt(header))
        return _Header(len(names), names.index(axis), names.index(found[0].encode()), found[0])

    def read_number(self, cell: bytes, name: str) -> float:
        """Read the number in a cell; ``name`` is that of its column."""
        text = cell.strip(_BLANKS)
        value = float(text) if len(text) <= MAX_NUMBER_SIZE and _NUMBER.fullmatch(text) else float("nan")
        if not abs(value) <= MAX_MAGNITUDE:
            raise self.error(f"a number of up to {MAX_MAGNITUDE:g} either way as {name}", _excerpt(text))
        return value

    def read_row(self, text: bytes, header: _Header) -> tuple[float, float]:
        """Read the position on the axis and the value of a line."""
        cells = text.split(b",")
        if len(cells) != header.columns:
            raise self.error(f"{header.columns} columns", str(len(cells)))
        position = self.read_number(cells[header.axis], self.columns.axis)
        return position, self.read_number(cells[header.value], header.quantity)


def _unquoted(name: bytes) -> bytes:
    return name[1:-1] if len(name) >= 2 and name[:1] == name[-1:] == b'"' else name


def _read_rows(reader: _Reader, header: _Header) -> tuple[list[float], list[float]]:
    """Read all rows; the axis rises, and only the end may have empty lines."""
    axis: list[float] = []
    name, unit, _ = reader.columns
    values: list[float] = []
    empty = 0
    while (text := reader.next_line()) is not None:
        if not text.strip(_BLANKS):
            empty = empty or reader.line
            continue
        if empty:
            raise reader.error("no empty line but at the end", "one", empty)
        position, value = reader.read_row(text, header)
        if axis and not position > axis[-1]:
            raise reader.error(f"a {name} above {axis[-1]:.10g} {unit}", f"{position:.10g} {unit}")
        if len(axis) == MAX_ROWS:
            raise reader.error(f"at most {MAX_ROWS} rows", "more")
        axis.append(position)
        values.append(value)
    return axis, values


def _check_rows(reader: _Reader, axis: list[float]) -> None:
    """Check the number of rows and the steps between them."""
    unit = reader.columns.unit
    if len(axis) < MIN_ROWS:
        raise reader.error(f"at least {MIN_ROWS} rows", str(len(axis)))
    steps = [after - before for before, after in pairwise(axis)]
    median = sorted(steps)[(len(steps) - 1) // 2]
    for i, step in enumerate(steps):
        if step < MIN_STEP:
            raise reader.error(f"a step of at least {MIN_STEP:g} {unit}", f"{step:.10g} {unit}", i + 3)
        if step > MAX_GAP * median:
            allowed = f"a step of at most {MAX_GAP:g} times the median of {median:.10g} {unit}"
            raise reader.error(allowed, f"{step:.10g} {unit}", i + 3)


def read(path: str, columns: Columns = MOTION) -> Samples:
    """Read a recording from a file.

    Parameters
    ----------
    path
        Path of the CSV file.
    columns
        Columns that it must have.

    Returns
    -------
    Samples
        With the axis from 0.

    Raises
    ------
    ParameterError
        If there is no such file or it is not as described above; with file, line, what was expected and what was found.
    """
    try:
        with open(path, "rb") as stream:  # noqa: PTH123
            reader = _Reader(path, stream, columns)
            header = reader.read_header()
            axis, values = _read_rows(reader, header)
            _check_rows(reader, axis)
            return Samples(header.quantity, [position - axis[0] for position in axis], values)
    except (OSError, ValueError) as error:
        if isinstance(error, ParameterError):
            raise
        raise ParameterError(f"{path}: expected a file that can be read, got none") from None
