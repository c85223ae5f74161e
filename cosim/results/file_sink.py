"""Base of all file formats: names of complete and incomplete files, errors in writing, and buffering of rows."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np

from cosim.errors import RunError, SetupError

Rows = np.ndarray[Any, Any]
"""Rows of a table, shape (rows, columns), float64, time in s in the first column."""

BLOCK_ROWS = 2**14
"""Number of rows that formats with blocks write at once: some MB at 20 columns."""


class ResultTable(NamedTuple):
    """The content of a result file.

    Attributes
    ----------
    names
        Names of the columns, ``time`` first.
    units
        Units of the columns; None for a column without a unit and for formats that do not keep units.
    rows
        Values, shape (rows, columns).
    """

    names: list[str]
    units: list[str | None]
    rows: Rows


def result_file_name(suffix: str, complete: bool) -> str:
    """Return the name of a result file.

    Parameters
    ----------
    suffix
        Suffix of the format.
    complete
        Whether the run reached its stop time.

    Examples
    --------
    >>> result_file_name(".csv", complete=True), result_file_name(".csv", complete=False)
    ('result.csv', 'result.partial.csv')
    """
    return f"result{suffix}" if complete else f"result.partial{suffix}"


def import_optional(name: str, extra: str, what: str | None = None) -> Any:
    """Import a module that only one format needs.

    Parameters
    ----------
    name
        Name of the module.
    extra
        The extra of this distribution that installs it.
    what
        What needs it, for the message; files of the extra's name where None.

    Returns
    -------
    module
        The imported module.

    Raises
    ------
    SetupError
        If it is not installed; the message names the extra.
    """
    try:
        return import_module(name)
    except ImportError as error:
        expected = f"expected the package {name.partition('.')[0]}"
        where = what or f"{extra} files"
        raise SetupError(f'{where}: {expected}, got: {error}; run: pip install "seat-cosim[{extra}]"') from None


class FileSink(ABC):
    """Writes the rows of a run to a file, which is named ``result.partial.*`` until the run is complete.

    Parameters
    ----------
    folder
        Folder of the file; it must exist when the run begins.

    Attributes
    ----------
    path
        The file's current name.
    rows
        Number of rows written.
    reached
        Time of the last row written, in s.

    Raises
    ------
    SetupError
        If the format needs a package that is not installed.
    """

    suffix: ClassVar[str]
    """Suffix of the file."""

    package: ClassVar[str | None] = None
    """Name of the optional package that the format needs."""

    def __init__(self, folder: Path) -> None:
        self._complete = folder / result_file_name(self.suffix, complete=True)
        self._partial = folder / result_file_name(self.suffix, complete=False)
        self.path = self._partial
        self.rows = 0
        self.reached = 0.0
        self._open = self._failed = False

    def begin(self, names: Sequence[str], units: Sequence[str | None]) -> None:
        """Open the file and write its head.

        Parameters
        ----------
        names, units
            Names and units of all columns but the first one, which is ``time`` in s.

        Raises
        ------
        RunError
            If the file cannot be written.
        """
        with self._writing():
            self._begin(["time", *names], ["s", *units])
            self._open = True

    def write(self, rows: Rows) -> None:
        """Write rows; after an error, further rows are ignored.

        Parameters
        ----------
        rows
            Shape (rows, columns), time in s first; not kept.

        Raises
        ------
        RunError
            If the file cannot be written.
        """
        if self._failed:
            return
        with self._writing():
            self._write(rows)
        self.rows += len(rows)
        self.reached = float(rows[-1, 0]) if len(rows) else self.reached

    def end(self, complete: bool) -> None:
        """Close the file, and rename it if the run is complete.

        Parameters
        ----------
        complete
            Whether the run reached its stop time.

        Raises
        ------
        RunError
            If the file cannot be written.
        """
        if not self._open:
            return
        if self._failed:
            with suppress(Exception):  # the error in writing was reported already
                self._end()
            return
        with self._writing():
            self._end()
            if complete:
                self._partial.replace(self._complete)
                self.path = self._complete

    @contextmanager
    def _writing(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            self._failed = True
            raise RunError(f"{self._partial}: expected to write the result, got: {error.strerror or error}") from error

    @abstractmethod
    def _begin(self, names: list[str], units: list[str | None]) -> None: ...

    @abstractmethod
    def _write(self, rows: Rows) -> None: ...

    @abstractmethod
    def _end(self) -> None: ...

    @classmethod
    @abstractmethod
    def read(cls, path: Path) -> ResultTable:
        """Read a file of this format.

        Parameters
        ----------
        path
            The file.

        Returns
        -------
        ResultTable
            The content of the file.

        Raises
        ------
        SetupError
            If the file is not of this format, or its package is not installed.
        """


class RowBuffer:
    """Collects rows into blocks of a fixed size, so that a file's bytes do not depend on how the rows arrive.

    Parameters
    ----------
    write_block
        Called with each block, shape (rows, columns).
    size
        Number of rows of all blocks but the last.
    """

    def __init__(self, write_block: Callable[[Rows], None], size: int = BLOCK_ROWS) -> None:
        self._write_block = write_block
        self._size = size
        self._parts: list[Rows] = []
        self._count = 0

    def add(self, rows: Rows) -> None:
        """Add rows and write the blocks that are full.

        Parameters
        ----------
        rows
            Shape (rows, columns); copied.
        """
        while len(rows):
            part = rows[: self._size - self._count]
            self._parts.append(part.copy())
            self._count += len(part)
            rows = rows[len(part) :]
            if self._count == self._size:
                self.flush()

    def flush(self) -> None:
        """Write the remaining rows, if any."""
        if self._parts:
            self._write_block(np.concatenate(self._parts))
        self._parts, self._count = [], 0


class BlockSink(FileSink):
    """Base of the formats that write blocks of :data:`BLOCK_ROWS` rows.

    Parameters
    ----------
    folder
        As of :class:`FileSink`.
    """

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._buffer = RowBuffer(self._write_block)

    def _write(self, rows: Rows) -> None:
        self._buffer.add(rows)

    @abstractmethod
    def _write_block(self, block: Rows) -> None: ...
