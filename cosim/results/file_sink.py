"""What all formats share: how a file is named while it grows and when it is done, and what is said when it cannot."""

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
"""Some rows of a table, shape (rows, columns), time in s first."""

BLOCK_ROWS = 2**14
"""Rows that a format of blocks writes at once: some MB at 20 columns."""


class Table(NamedTuple):
    """A table as a file holds it.

    Attributes
    ----------
    names
        Of the columns, ``time`` first.
    units
        Of the columns; None where there is none, or where the format does not keep them.
    rows
        Shape (rows, columns).
    """

    names: list[str]
    units: list[str | None]
    rows: Rows


def file_name(suffix: str, complete: bool) -> str:
    """Name the file of a result: only a complete one is called so."""
    return f"result{suffix}" if complete else f"result.partial{suffix}"


def imported(name: str, extra: str) -> Any:
    """Import what only one format needs.

    Raises
    ------
    SetupError
        If it is not installed, with the extra that brings it.
    """
    try:
        return import_module(name)
    except ImportError as error:
        expected = f"expected the package {name.partition('.')[0]}"
        raise SetupError(f'{extra} files: {expected}, got: {error}; run: pip install "seat-cosim[{extra}]"') from None


class FileSink(ABC):
    """Writes a run's table to a file of a folder, ``result.partial.*`` until the run is complete.

    Parameters
    ----------
    folder
        Where to; it exists when the run begins.

    Attributes
    ----------
    path
        The file as it is called now.
    rows
        How many were written.
    reached
        Time of the last, in s.

    Raises
    ------
    SetupError
        If the format needs a package that is not installed.
    """

    suffix: ClassVar[str]
    package: ClassVar[str | None] = None
    """What the format needs beyond this package's own dependencies."""

    def __init__(self, folder: Path) -> None:
        self._complete = folder / file_name(self.suffix, complete=True)
        self._partial = folder / file_name(self.suffix, complete=False)
        self.path = self._partial
        self.rows = 0
        self.reached = 0.0
        self._open = self._failed = False

    def begin(self, names: Sequence[str], units: Sequence[str | None]) -> None:
        """Open the file.

        Parameters
        ----------
        names, units
            Of all columns but time, which comes first and is in s.

        Raises
        ------
        RunError
            Here and below, if the file cannot be written.
        """
        with self._writing():
            self._begin(["time", *names], ["s", *units])
            self._open = True

    def write(self, rows: Rows) -> None:
        """Write some rows, time first; they are not kept. After a failure, which a run hears of once, nothing is."""
        if self._failed:
            return
        with self._writing():
            self._write(rows)
        self.rows += len(rows)
        self.reached = float(rows[-1, 0]) if len(rows) else self.reached

    def end(self, complete: bool) -> None:
        """Close the file, and give it its final name if the run is complete; ``path`` tells which it has."""
        if not self._open:
            return
        if self._failed:
            with suppress(Exception):  # whatever the half-written file still raises: what went wrong is said already
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
    def read(cls, path: Path) -> Table:
        """Read what was written.

        Raises
        ------
        SetupError
            If the file is not of this format, or its package is not installed.
        """


class Blocks:
    """Hands rows on in blocks of one size: a file's bytes then depend on the rows, not on how many came at a time.

    Parameters
    ----------
    hand_on
        Takes a block.
    size
        Rows of all blocks but the last.
    """

    def __init__(self, hand_on: Callable[[Rows], None], size: int = BLOCK_ROWS) -> None:
        self._hand_on = hand_on
        self._size = size
        self._waiting: list[Rows] = []
        self._count = 0

    def add(self, rows: Rows) -> None:
        """Take rows; the array may be used anew afterwards."""
        while len(rows):
            taken = rows[: self._size - self._count]
            self._waiting.append(taken.copy())
            self._count += len(taken)
            rows = rows[len(taken) :]
            if self._count == self._size:
                self.flush()

    def flush(self) -> None:
        """Hand on what waits, if anything."""
        if self._waiting:
            self._hand_on(np.concatenate(self._waiting))
        self._waiting, self._count = [], 0
