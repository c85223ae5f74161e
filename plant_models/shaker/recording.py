"""Recorded motion in CSV files: the samples of a file, or one message why it cannot be used.

The first line names the columns: ``time`` in s and either ``acceleration`` in m/s2 or ``displacement`` in m. Other
columns are ignored. Rows may come at any rate up to 1 MHz, if time rises and no step is longer than ten times the
median step.
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
"""Shortest step, in s: differences over a much shorter one may overflow."""

QUANTITIES = ("acceleration", "displacement")
"""Quantities that a recording can hold."""

_MAX_EXCERPT = 40
_NUMBER = re.compile(rb"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_BLANKS = b" \t"


class Samples(NamedTuple):
    """Samples of a recording.

    Attributes
    ----------
    quantity
        One of :data:`QUANTITIES`.
    times
        In s, rising from 0.
    values
        In m/s2 or m.
    """

    quantity: str
    times: list[float]
    values: list[float]


def _excerpt(text: bytes) -> str:
    """Return the begin of a text for a message."""
    return "".join(chr(c) if 32 <= c < 127 else "?" for c in text[:_MAX_EXCERPT]) or "nothing"


class _Header(NamedTuple):
    """Columns of a file: their number, the positions of time and value, and the quantity of the value."""

    columns: int
    time: int
    value: int
    quantity: str


class _Reader:
    """Reads the lines of a file and counts them."""

    def __init__(self, path: str, stream: BinaryIO) -> None:
        self.path = path
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
        found = [name for name in QUANTITIES if name.encode() in names]
        if names.count(b"time") != 1 or len(found) != 1 or names.count(found[0].encode()) != 1:
            raise self.error(f"the columns time and one of {', '.join(QUANTITIES)}", _excerpt(header))
        return _Header(len(names), names.index(b"time"), names.index(found[0].encode()), found[0])

    def read_number(self, cell: bytes, name: str) -> float:
        """Read the number in a cell; ``name`` is that of its column."""
        text = cell.strip(_BLANKS)
        value = float(text) if len(text) <= MAX_NUMBER_SIZE and _NUMBER.fullmatch(text) else float("nan")
        if not abs(value) <= MAX_MAGNITUDE:
            raise self.error(f"a number of up to {MAX_MAGNITUDE:g} either way as {name}", _excerpt(text))
        return value

    def read_row(self, text: bytes, header: _Header) -> tuple[float, float]:
        """Read time and value of a line."""
        cells = text.split(b",")
        if len(cells) != header.columns:
            raise self.error(f"{header.columns} columns", str(len(cells)))
        time = self.read_number(cells[header.time], "time")
        return time, self.read_number(cells[header.value], header.quantity)


def _unquoted(name: bytes) -> bytes:
    return name[1:-1] if len(name) >= 2 and name[:1] == name[-1:] == b'"' else name


def _read_rows(reader: _Reader, header: _Header) -> tuple[list[float], list[float]]:
    """Read all rows; times rise, and only the end may have empty lines."""
    times: list[float] = []
    values: list[float] = []
    empty = 0
    while (text := reader.next_line()) is not None:
        if not text.strip(_BLANKS):
            empty = empty or reader.line
            continue
        if empty:
            raise reader.error("no empty line but at the end", "one", empty)
        time, value = reader.read_row(text, header)
        if times and not time > times[-1]:
            raise reader.error(f"a time above {times[-1]:.10g} s", f"{time:.10g} s")
        if len(times) == MAX_ROWS:
            raise reader.error(f"at most {MAX_ROWS} rows", "more")
        times.append(time)
        values.append(value)
    return times, values


def _check_rows(reader: _Reader, times: list[float]) -> None:
    """Check the number of rows and the steps between them."""
    if len(times) < MIN_ROWS:
        raise reader.error(f"at least {MIN_ROWS} rows", str(len(times)))
    steps = [after - before for before, after in pairwise(times)]
    median = sorted(steps)[(len(steps) - 1) // 2]
    for i, step in enumerate(steps):
        if step < MIN_STEP:
            raise reader.error(f"a step of at least {MIN_STEP:g} s", f"{step:.10g} s", i + 3)
        if step > MAX_GAP * median:
            allowed = f"a step of at most {MAX_GAP:g} times the median of {median:.10g} s"
            raise reader.error(allowed, f"{step:.10g} s", i + 3)


def read(path: str) -> Samples:
    """Read a recording from a file.

    Parameters
    ----------
    path
        Path of the CSV file.

    Returns
    -------
    Samples
        With times from 0.

    Raises
    ------
    ParameterError
        If there is no such file or it is not as described above; with file, line, what was expected and what was found.
    """
    try:
        with open(path, "rb") as stream:  # noqa: PTH123
            reader = _Reader(path, stream)
            header = reader.read_header()
            times, values = _read_rows(reader, header)
            _check_rows(reader, times)
            return Samples(header.quantity, [time - times[0] for time in times], values)
    except (OSError, ValueError) as error:
        if isinstance(error, ParameterError):
            raise
        raise ParameterError(f"{path}: expected a file that can be read, got none") from None
