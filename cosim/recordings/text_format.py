"""Form of a text file of measurements: encoding, separator, decimal sign, comments, names and units of its columns.

The form is found from the first lines: of all separators and decimal signs, those count with which most columns hold
numbers or times, under a header with as many names.
"""

from __future__ import annotations

import codecs
import csv
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from cosim.errors import SetupError
from cosim.recordings.columns import Column, read_column
from cosim.recordings.quantities import is_unit
from cosim.recordings.requests import TextOptions

BLANKS = " "
"""The separator that stands for any number of blanks."""

SEPARATORS = (";", "\t", ",", "|", BLANKS)
DECIMALS = (".", ",")

MISSING = frozenset(("", "-", "--", "---", "*", "na", "n/a", "#n/a", "nan", "-nan", "null", "none"))
"""Cells without a value, in lower case."""

TIME_OF_DAY = re.compile(r"\d{1,2}:\d{2}(?::\d{2}(?:[.,:]\d+)?)?(?:\s*[AaPp][Mm])?")
DATE = re.compile(r"\d{4}[-/.]\d{1,2}[-/.]\d{1,2}|\d{1,2}[-/.]\d{1,2}[-/.]\d{2,4}")
ZONE = re.compile(r"(?:Z|[+-]\d{2}:?\d{2})")

_MOMENT = re.compile(rf"(?:{DATE.pattern})?(?:[T\s]\s*)?(?:{TIME_OF_DAY.pattern})?\s*(?:{ZONE.pattern})?")
_NUMBERS = {
    sign: re.compile(rf"[+-]?(?:\d+{re.escape(sign)}?\d*|{re.escape(sign)}\d+)(?:[eE][+-]?\d+)?") for sign in DECIMALS
}
_COMMENTS = ("#", "%", "//", "!", "'")
_HEAD_BYTES, _HEAD_LINES = 2**18, 400
_SURE_ROWS = 3
"""Rows of data in sequence that cannot be a header."""

_MOSTLY = 0.9
_BOMS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF32_LE: "utf-32",
    codecs.BOM_UTF32_BE: "utf-32",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}
"""Marks at the beginning of a file, longer ones first, to the encoding."""


@dataclass(frozen=True)
class TextFormat:
    """Form of a text file.

    Attributes
    ----------
    encoding, separator, decimal
        As in :class:`cosim.recordings.requests.TextOptions`.
    comment
        Character at the beginning of comment lines; None where there are none.
    first_row
        Number of lines before the first row of values.
    width
        Number of cells of a row.
    columns
        Names and units; numbers are names where the file has none.
    header
        Cells of the line above the rows where it does not fit them; None where it does, or there is none.
    """

    encoding: str
    separator: str
    decimal: str
    comment: str | None
    first_row: int
    width: int
    columns: tuple[Column, ...]
    header: tuple[str, ...] | None = None


def find_encoding(path: Path) -> str:
    """Find the encoding of a text file: by its mark, by zero bytes, else UTF-8 where the whole file is, else Latin-1.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    str
        Name of the encoding.

    Raises
    ------
    SetupError
        If the file is empty or holds no text.
    """
    with path.open("rb") as stream:
        head = stream.read(4096)
        if not head.strip():
            raise SetupError(f"{path}: expected a measurement file, got an empty one")
        for mark, name in _BOMS.items():
            if head.startswith(mark):
                return name
        zeros = [head[side::2].count(0) / len(head[side::2] or b"0") for side in (0, 1)]
        if max(zeros) > 0.3 and min(zeros) < 0.05:
            return "utf-16-le" if zeros[1] > zeros[0] else "utf-16-be"
        if 0 in head:
            raise SetupError(
                f"{path}: expected text, MDF4, MAT or Parquet, got an unknown binary file; export it from the logger's "
                "program as CSV or MDF4"
            )
        decoder = codecs.getincrementaldecoder("utf-8")()
        stream.seek(0)
        try:
            while block := stream.read(2**20):
                decoder.decode(block)
            decoder.decode(b"", final=True)
        except UnicodeDecodeError:
            return "latin-1"  # the signs of units are those of Windows-1252
        return "utf-8"


def split_line(line: str, separator: str, *, is_header: bool = False) -> list[str]:
    """Split a line into cells.

    Parameters
    ----------
    line
        The line.
    separator
        As in :class:`TextFormat`.
    is_header
        Whether blanks before a unit in brackets do not separate cells.

    Returns
    -------
    list of str
        The cells without blanks and quotation marks around them.
    """
    if separator == BLANKS:
        return re.split(r"\s+(?![\[(])" if is_header else r"\s+", line.strip())
    (cells,) = csv.reader([line], delimiter=separator, skipinitialspace=True)
    return [cell.strip() for cell in cells]


def find_format(path: Path, options: TextOptions) -> TextFormat:
    """Find the form of a text file.

    Parameters
    ----------
    path
        The file.
    options
        What is known of its form.

    Returns
    -------
    TextFormat
        The form.

    Raises
    ------
    SetupError
        If the file cannot be read, or no form gives rows of numbers.
    """
    encoding = options.encoding or find_encoding(path)
    lines = _head(path, encoding)
    comment = _comment(lines)
    best: tuple[tuple[int, int], TextFormat] | None = None
    for separator in (options.separator,) if options.separator else SEPARATORS:
        for decimal in (options.decimal,) if options.decimal else DECIMALS:
            found = _try(lines, separator, decimal, comment)
            if found is not None and (best is None or found[0] > best[0]):
                best = found
    if best is None:
        raise SetupError(
            f"{path}: expected rows of numbers with ; tab , | or blanks between them, got none in the first "
            f"{len(lines)} lines; --separator, --decimal and --encoding say what they are"
        )
    form = best[1]
    return TextFormat(encoding, *(getattr(form, name) for name in list(TextFormat.__dataclass_fields__)[1:]))


def _head(path: Path, encoding: str) -> list[str]:
    """Return the first lines of a file."""
    with path.open("rb") as stream:
        data = stream.read(_HEAD_BYTES)
        is_whole = not stream.read(1)
    try:
        text = codecs.getincrementaldecoder(encoding)("strict").decode(data, final=is_whole)
    except LookupError:
        raise SetupError(f"--encoding {encoding}: expected the name of an encoding, such as utf-8 or latin-1") from None
    except UnicodeDecodeError as error:
        raise SetupError(f"{path}: expected text in {encoding}, got {error.reason} at byte {error.start}") from None
    lines = text.splitlines()
    return (lines if is_whole else lines[:-1])[:_HEAD_LINES]


def _comment(lines: Sequence[str]) -> str | None:
    """Return what comment lines begin with; None where there are none."""
    marks = Counter(mark for line in lines for mark in _COMMENTS if line.lstrip().startswith(mark))
    return marks.most_common(1)[0][0] if marks else None


def _is_number(cell: str, decimal: str) -> bool:
    return _NUMBERS[decimal].fullmatch(cell) is not None


def _is_moment(cell: str) -> bool:
    return bool(cell) and _MOMENT.fullmatch(cell) is not None


def _try(
    lines: Sequence[str], separator: str, decimal: str, comment: str | None
) -> tuple[tuple[int, int], TextFormat] | None:
    """Return the form with a separator and a decimal sign, and how well it fits; None where it does not."""
    rows = [
        (at, split_line(line, separator))
        for at, line in enumerate(lines)
        if line.strip() and not (comment and line.lstrip().startswith(comment))
    ]
    tail = [cells for _, cells in rows[len(rows) // 2 :]]
    if not tail:
        return None
    width = Counter(map(len, tail)).most_common(1)[0][0]
    tail = [cells for cells in tail if len(cells) == width]
    values = [i for i in range(width) if _holds_values([cells[i] for cells in tail], decimal)]
    words = [i for i in range(width) if i not in values and any(cells[i] for cells in tail)]
    first = _first_row(rows, width, values, decimal)
    if not values or first is None:
        return None
    above = _header_rows(lines, rows, first, separator, comment)
    used = width - all(not cells[-1] for cells in tail)
    fits = [cells for cells in above if used <= len(cells) - (not cells[-1]) <= width]
    columns, header = _columns(fits, width), None
    if not fits and above:
        header = tuple(above[-1])
    agreement = 1 if fits else -1 if above else 0
    score = (agreement, len(values) - len(words))
    line = rows[first][0]
    return score, TextFormat("", separator, decimal, comment, line, width, columns, header)


def _holds_values(cells: Sequence[str], decimal: str) -> bool:
    """Whether a column holds numbers or moments, but for a few cells."""
    present = [cell for cell in cells if cell.lower() not in MISSING]
    good = sum(_is_number(cell, decimal) or _is_moment(cell) for cell in present)
    return bool(present) and good >= _MOSTLY * len(present)


def _first_row(rows: Sequence[tuple[int, list[str]]], width: int, values: Sequence[int], decimal: str) -> int | None:
    """Return the index of the first row of values: the begin of several in sequence."""

    def is_data(cells: list[str]) -> bool:
        chosen = [cells[i] for i in values] if len(cells) == width else []
        good = [_is_number(cell, decimal) or _is_moment(cell) for cell in chosen if cell.lower() not in MISSING]
        return any(good) and all(good)

    run = 0
    for index, (_, cells) in enumerate(rows):
        run = run + 1 if is_data(cells) else 0
        if run == min(_SURE_ROWS, len(rows) - index + run - 1 if run else _SURE_ROWS) and run:
            return index - run + 1
    return None


def _header_rows(
    lines: Sequence[str], rows: Sequence[tuple[int, list[str]]], first: int, separator: str, comment: str | None
) -> list[list[str]]:
    """Return the cells of the lines above the values; those of comments where there are no others."""
    above = [split_line(lines[at], separator, is_header=True) for at, _ in rows[:first]]
    if above or comment is None:
        return above
    begin = rows[first][0]
    texts = [line.lstrip().removeprefix(comment).lstrip("".join(_COMMENTS)) for line in lines[:begin] if line.strip()]
    last = [split_line(text, separator, is_header=True) for text in texts if text.strip()]
    return last


def _columns(header: Sequence[Sequence[str]], width: int) -> tuple[Column, ...]:
    """Return the columns by the lines above the values: names, and perhaps units below them."""

    def padded(cells: Sequence[str]) -> list[str]:
        return [*cells, *[""] * (width - len(cells))][:width]

    if not header:
        return tuple(Column(str(i + 1), str(i + 1)) for i in range(width))
    names, units = padded(header[-1]), [""] * width
    for at in range(len(header) - 1, 0, -1):
        if _is_units(header[at]) and not _is_units(header[at - 1]):
            names, units = padded(header[at - 1]), padded(header[at])
            break
    return tuple(read_column(name or str(i + 1), unit) for i, (name, unit) in enumerate(zip(names, units, strict=True)))


def _is_units(cells: Sequence[str]) -> bool:
    """Whether cells are a row of units."""
    return any(cell.strip("[]()- ") for cell in cells) and all(is_unit(cell) for cell in cells)


def describe(form: TextFormat) -> Iterator[str]:
    """Yield what was found of a text file's form, as words.

    Parameters
    ----------
    form
        The form.

    Yields
    ------
    str
        A few words.
    """
    names = {";": "semicolons", "\t": "tabs", ",": "commas", "|": "strokes", BLANKS: "blanks"}
    yield f"text in {form.encoding}"
    if form.width > 1:
        yield f"{names.get(form.separator, form.separator)} between columns"
    yield "decimal comma" if form.decimal == "," else "decimal point"
