"""What all files of measurements offer: columns with names and units, and the values of one."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from cosim.recordings.columns import Column
from cosim.results.file_sink import import_optional

Floats = npt.NDArray[np.float64]

EXTRA = "measurements"
"""Extra of this distribution that installs the packages that read measurement files."""


class MeasurementFile(Protocol):
    """A file of measurements.

    Attributes
    ----------
    path
        The file.
    columns
        Its columns or channels.
    description
        Its form, for notes.
    """

    path: Path
    columns: Sequence[Column]
    description: str

    def load(self, indices: Sequence[int]) -> None:
        """Read columns, before their values are asked for.

        Parameters
        ----------
        indices
            Indices of the columns.
        """

    def values(self, index: int) -> np.ndarray[Any, Any]:
        """Return the values of a column: floats with NaN for missing ones, texts, or moments; shape (rows,).

        Parameters
        ----------
        index
            Index of a loaded column.
        """

    def times(self, index: int) -> Floats | None:
        """Return the times of a channel's samples in s; None where they are in another column.

        Parameters
        ----------
        index
            Index of a loaded column.
        """

    def place(self, row: int) -> str:
        """Return where a row is, for messages.

        Parameters
        ----------
        row
            Number of the row from 0.
        """


def package(name: str) -> Any:
    """Import a package that reads measurement files.

    Parameters
    ----------
    name
        Name of the module.

    Returns
    -------
    module
        The imported module.

    Raises
    ------
    SetupError
        If it is not installed; the message names the extra.
    """
    return import_optional(name, EXTRA, "measurement files")
