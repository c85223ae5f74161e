"""Text files of measurements, read by pandas."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any
from warnings import catch_warnings

import numpy as np

from cosim.errors import SetupError
from cosim.recordings.columns import Column
from cosim.recordings.measurement_file import Floats, package
from cosim.recordings.requests import TextOptions
from cosim.recordings.text_format import BLANKS, MISSING, describe, find_format

_ALL_READ = 16
"""Number of columns up to which all are read: only then pandas refuses a row with too many cells."""

_MISSING = [*MISSING - {""}, *(word.upper() for word in MISSING - {""}), "NaN"]


class TextFile:
    """A text file of measurements.

    Parameters
    ----------
    path
        The file.
    options
        What is known of its form.

    Raises
    ------
    SetupError
        If its form is not found.
    """

    def __init__(self, path: Path, options: TextOptions) -> None:
        self.path = path
        self._pandas = package("pandas")
        self._form = find_format(path, options)
        self.columns: Sequence[Column] = self._form.columns
        self.description = ", ".join(describe(self._form))
        self._values: dict[int, np.ndarray[Any, Any]] = {}

    @property
    def misfit(self) -> str:
        """Words about a header that does not fit the rows; empty where there is none."""
        header = self._form.header
        if header is None:
            return ""
        return (
            f" (the line above the values has {len(header)} cells, the rows have {self._form.width}: columns are named "
            "by their numbers; are there decimal commas and commas between columns?)"
        )

    def load(self, indices: Sequence[int]) -> None:
        """Read columns of the file.

        Parameters
        ----------
        indices
            Indices of the columns.
        """
        form, wanted = self._form, sorted(set(indices))
        try:
            # pandas infers types by blocks, and warns where they differ; such a column is checked cell by cell
            with catch_warnings(action="ignore"):
                table = self._read(wanted)
        except (ValueError, OverflowError, self._pandas.errors.ParserError) as error:
            text = " ".join(str(error).split()).removeprefix("Error tokenizing data. C error: ")
            raise SetupError(f"{self.path}: expected rows of {form.width} cells, got: {text}") from None
        for index in wanted:
            column = table[index]
            numeric = column.dtype.kind in "iuf"
            self._values[index] = column.to_numpy(dtype=np.float64 if numeric else object)

    def _read(self, wanted: list[int]) -> Any:
        form = self._form
        return self._pandas.read_csv(
            self.path,
            sep=r"\s+" if form.separator == BLANKS else form.separator,
            decimal=form.decimal,
            encoding=form.encoding,
            comment=form.comment if form.comment and len(form.comment) == 1 else None,
            skiprows=form.first_row,
            header=None,
            names=range(form.width),
            usecols=None if form.width <= _ALL_READ else wanted,
            na_values=_MISSING,
            skipinitialspace=True,
            float_precision="round_trip",
            engine="c",
        )

    def values(self, index: int) -> np.ndarray[Any, Any]:
        """Return the values of a column.

        Parameters
        ----------
        index
            Index of a loaded column.
        """
        return self._values[index]

    def times(self, index: int) -> Floats | None:
        """Return None: times are in a column.

        Parameters
        ----------
        index
            Index of a loaded column.
        """
        return None

    def place(self, row: int) -> str:
        """Return the line of a row, where no comments or empty lines are among the rows.

        Parameters
        ----------
        row
            Number of the row from 0.
        """
        return f"line {self._form.first_row + row + 1}"
