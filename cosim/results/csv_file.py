"""CSV: the format everybody reads; on disk as soon as the rows come, without units."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import TextIO

import numpy as np

from cosim.errors import SetupError
from cosim.results.file_sink import FileSink, Rows, Table


def head(names: Sequence[str]) -> str:
    """Write the first line; names that hold commas or quotes are quoted."""
    line = io.StringIO()
    csv.writer(line, lineterminator="\n").writerow(names)
    return line.getvalue()


def lines(rows: Rows) -> str:
    """Write rows, one a line, so that reading a number gives the same bits."""
    return "".join([",".join(map(repr, row)) + "\n" for row in rows.tolist()])


class CsvSink(FileSink):
    """Writes CSV; a process that dies leaves in ``result.partial.csv`` what had come."""

    suffix = ".csv"
    _stream: TextIO

    def _begin(self, names: list[str], units: list[str | None]) -> None:
        self._stream = self._partial.open("w", newline="", encoding="utf-8")
        self._put(head(names))

    def _write(self, rows: Rows) -> None:
        self._put(lines(rows))

    def _put(self, text: str) -> None:
        self._stream.write(text)
        self._stream.flush()

    def _end(self) -> None:
        self._stream.close()

    @classmethod
    def read(cls, path: Path) -> Table:
        """Read a table; a last line that was cut off by a crash is left out."""
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
        return Table(names, [None] * len(names), rows)
