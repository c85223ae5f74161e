"""CSV files: rows are on disk as soon as they come; the ``run.json`` beside a file keeps its units."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import TextIO

import numpy as np

from cosim.errors import SetupError
from cosim.results.file_sink import FileSink, ResultTable, Rows


def format_header(names: Sequence[str]) -> str:
    """Return the header line; names with commas or quotes are quoted.

    Parameters
    ----------
    names
        Names of the columns.
    """
    line = io.StringIO()
    csv.writer(line, lineterminator="\n").writerow(names)
    return line.getvalue()


def format_rows(rows: Rows) -> str:
    """Return rows as text, one line for each.

    Parameters
    ----------
    rows
        Shape (rows, columns).

    Returns
    -------
    str
        Numbers that read back to the same bits.
    """
    return "".join([",".join(map(repr, row)) + "\n" for row in rows.tolist()])


class CsvSink(FileSink):
    """Writes a CSV file; a process that is killed leaves the rows so far in ``result.partial.csv``.

    Parameters
    ----------
    folder
        As of :class:`FileSink`.
    """

    suffix = ".csv"
    _stream: TextIO

    def _begin(self, names: list[str], units: list[str | None]) -> None:
        self._stream = self._partial.open("w", newline="", encoding="utf-8")
        self._write_text(format_header(names))

    def _write(self, rows: Rows) -> None:
        self._write_text(format_rows(rows))

    def _write_text(self, text: str) -> None:
        self._stream.write(text)
        self._stream.flush()

    def _end(self) -> None:
        self._stream.close()

    @classmethod
    def read(cls, path: Path) -> ResultTable:
        """Read a table; an incomplete last line, as a crash leaves it, is ignored.

        Parameters
        ----------
        path
            The file.

        Returns
        -------
        ResultTable
            Without units.

        Raises
        ------
        SetupError
            If the file cannot be read or is not a table of numbers.
        """
        try:
            text = path.read_bytes().decode("utf-8", errors="replace")
        except OSError as error:
            raise SetupError(f"{path}: expected a CSV table of numbers, got: {error.strerror}") from None
        body = io.StringIO(text[: text.rfind("\n") + 1], newline="")
        try:
            names = next(csv.reader(body), [])
            found = [line for line in body.read().splitlines() if line.strip()]
            rows = np.loadtxt(found, delimiter=",", ndmin=2, comments=None) if found else np.empty((0, len(names)))
        except (ValueError, csv.Error) as error:
            raise SetupError(f"{path}: expected a CSV table of numbers, got: {error}") from None
        if rows.shape[1] != len(names):
            raise SetupError(f"{path}: expected rows of {len(names)} numbers, got {rows.shape[1]}")
        return ResultTable(names, [None] * len(names), rows)
