"""Recorded motion: the samples of a CSV file, or one clear reason why there are none.

The first line names the columns: ``time`` in s and either ``acceleration`` in m/s2 or ``displacement`` in m; others are
not looked at. Rows may come at any rate up to 1 MHz, as long as time rises and no step is ten times longer than the
median one.
"""

from __future__ import annotations

import re
from itertools import pairwise
from typing import BinaryIO, NamedTuple

from fmus.component import ParameterError

FEWEST_ROWS = 10
MOST_ROWS = 1_000_000
LONGEST_LINE = 1000
"""In bytes."""
LONGEST_NUMBER = 60
LARGEST = 1e12
"""Largest magnitude of a number, in its unit."""
WIDEST_GAP = 10.0
"""Longest step, in medians of all steps."""
SHORTEST_STEP = 1e-6
"""In s: the differences over a much shorter one may be no numbers any more."""

QUANTITIES = ("acceleration", "displacement")

_NUMBER = re.compile(rb"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_BLANKS = b" \t"


class Samples(NamedTuple):
    """A recording.

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


def _shown(text: bytes) -> str:
    """Show a piece of a file in a message."""
    return "".join(chr(c) if 32 <= c < 127 else "?" for c in text[:40]) or "nothing"


class _Columns(NamedTuple):
    """Where a line has what, and how many columns there are."""

    width: int
    time: int
    value: int
    quantity: str


class _Reader:
    """Reads lines of a file that it counts."""

    def __init__(self, path: str, stream: BinaryIO) -> None:
        self.path = path
        self.line = 0
        self._stream = stream

    def error(self, expected: str, got: str, line: int | None = None) -> ParameterError:
        return ParameterError(f"{self.path}, line {line or self.line}: expected {expected}, got {got}")

    def next_line(self) -> bytes | None:
        """Read a line without its end; None at the end of the file."""
        read = self._stream.readline(LONGEST_LINE + 2)
        if not read:
            return None
        self.line += 1
        text = read.removesuffix(b"\n").removesuffix(b"\r")
        if len(text) > LONGEST_LINE:
            raise self.error(f"at most {LONGEST_LINE} characters", "more")
        return text

    def columns(self) -> _Columns:
        """Read the header."""
        header = (self.next_line() or b"").removeprefix(b"\xef\xbb\xbf")
        self.line = 1
        names = [_unquoted(cell.strip(_BLANKS)) for cell in header.split(b",")]
        found = [name for name in QUANTITIES if name.encode() in names]
        if names.count(b"time") != 1 or len(found) != 1 or names.count(found[0].encode()) != 1:
            raise self.error(f"the columns time and one of {', '.join(QUANTITIES)}", _shown(header))
        return _Columns(len(names), names.index(b"time"), names.index(found[0].encode()), found[0])

    def number(self, cell: bytes, name: str) -> float:
        text = cell.strip(_BLANKS)
        value = float(text) if len(text) <= LONGEST_NUMBER and _NUMBER.fullmatch(text) else float("nan")
        if not abs(value) <= LARGEST:
            raise self.error(f"a number of up to {LARGEST:g} either way as {name}", _shown(text))
        return value

    def row(self, text: bytes, columns: _Columns) -> tuple[float, float]:
        """Read time and value of a line."""
        cells = text.split(b",")
        if len(cells) != columns.width:
            raise self.error(f"{columns.width} columns", str(len(cells)))
        return self.number(cells[columns.time], "time"), self.number(cells[columns.value], columns.quantity)


def _unquoted(name: bytes) -> bytes:
    return name[1:-1] if len(name) >= 2 and name[:1] == name[-1:] == b'"' else name


def _rows(reader: _Reader) -> Samples:
    columns = reader.columns()
    times: list[float] = []
    values: list[float] = []
    empty = 0
    while (text := reader.next_line()) is not None:
        if not text.strip(_BLANKS):
            empty = empty or reader.line
            continue
        if empty:
            raise reader.error("no empty line but at the end", "one", empty)
        time, value = reader.row(text, columns)
        if times and not time > times[-1]:
            raise reader.error(f"a time above {times[-1]:.10g} s", f"{time:.10g} s")
        if len(times) == MOST_ROWS:
            raise reader.error(f"at most {MOST_ROWS} rows", "more")
        times.append(time)
        values.append(value)
    if len(times) < FEWEST_ROWS:
        raise reader.error(f"at least {FEWEST_ROWS} rows", str(len(times)))
    steps = [after - before for before, after in pairwise(times)]
    median = sorted(steps)[(len(steps) - 1) // 2]
    for i, step in enumerate(steps):
        if step < SHORTEST_STEP:
            raise reader.error(f"a step of at least {SHORTEST_STEP:g} s", f"{step:.10g} s", i + 3)
        if step > WIDEST_GAP * median:
            allowed = f"a step of at most {WIDEST_GAP:g} times the median of {median:.10g} s"
            raise reader.error(allowed, f"{step:.10g} s", i + 3)
    return Samples(columns.quantity, [time - times[0] for time in times], values)


def read(path: str) -> Samples:
    """Read a recording.

    Parameters
    ----------
    path
        Of the file.

    Raises
    ------
    ParameterError
        If there is no such file or it is not as described above; with file, line, what was expected and what was found.
    """
    try:
        with open(path, "rb") as stream:  # noqa: PTH123
            return _rows(_Reader(path, stream))
    except (OSError, ValueError) as error:
        if isinstance(error, ParameterError):
            raise
        raise ParameterError(f"{path}: expected a file that can be read, got none") from None
