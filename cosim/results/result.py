"""The result of a run in memory, and the interface of sinks that take its rows."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, Protocol, get_args

import numpy as np

from cosim.errors import did_you_mean
from cosim.results.csv_file import format_header, format_rows
from cosim.results.file_sink import result_file_name
from cosim.results.folder_lock import locked_folder
from cosim.results.formats import CsvSink, create_sinks, read_table, result_file_names

COMPLETE = result_file_name(CsvSink.suffix, complete=True)
"""Name of the CSV file of a complete run."""

PARTIAL = result_file_name(CsvSink.suffix, complete=False)
"""Name of the CSV file of an incomplete run."""

MANIFEST = "run.json"
"""Name of the file that describes a run, see :mod:`cosim.manifest`."""


class Sink(Protocol):
    """Takes the rows of a run as they come."""

    def begin(self, names: Sequence[str], units: Sequence[str | None]) -> None:
        """Take the columns at the beginning of a run.

        Parameters
        ----------
        names
            The recorded outputs as ``component.variable``.
        units
            Their units; None for outputs without a unit.
        """

    def write(self, rows: np.ndarray[Any, Any]) -> None:
        """Take complete rows of the table.

        Parameters
        ----------
        rows
            Shape (rows, 1 + names), time in s first. The array is reused after the call.
        """

    def end(self, complete: bool) -> None:
        """Take the end of a run.

        Parameters
        ----------
        complete
            Whether the run reached its stop time.
        """


StepperName = Literal["c", "python"]
"""Name of the loop that steps the components."""

STEPPERS: tuple[StepperName, ...] = get_args(StepperName)
"""All names of steppers."""


@dataclass(frozen=True)
class Result:
    """Values at the communication points of a run.

    Where every N-th step is recorded, there are rows for the times t_0, t_N, t_2N, ... and for the last communication
    point. The row of t_k holds the values at t_k: continuous outputs as they were at the beginning of step k, discrete
    outputs as step k computed them. The last row repeats the last discrete values, because no step follows.

    Attributes
    ----------
    time
        Communication points t_k in s, shape (rows,).
    values
        ``component.variable`` to its values in its unit, shape (rows,); Booleans as 0 and 1.
    units
        ``component.variable`` to its unit; None for outputs without a unit.
    complete
        Whether the run reached its stop time.
    error
        Why the run is incomplete; None where it is complete.
    warnings
        Warnings of the FMUs.
    stepper
        Name of the loop that stepped the components.
    missed_deadlines
        In a real-time run, the number of steps that were not finished when the next one was due.
    worst_lateness
        In a real-time run, the largest delay of a step in s.
    """

    time: np.ndarray[Any, Any]
    values: Mapping[str, np.ndarray[Any, Any]]
    units: Mapping[str, str | None]
    complete: bool = True
    error: Exception | None = None
    warnings: Sequence[str] = ()
    stepper: StepperName = "python"
    missed_deadlines: int = 0
    worst_lateness: float = 0.0

    def __getitem__(self, name: str) -> np.ndarray[Any, Any]:
        """Return the values of ``component.variable``."""
        if name not in self.values:
            raise KeyError(f"{name}: expected a recorded output, got none{did_you_mean(name, self.values)}")
        return self.values[name]

    @property
    def rows(self) -> np.ndarray[Any, Any]:
        """The table, shape (rows, columns): time first, then the values."""
        return np.column_stack([self.time, *self.values.values()])

    def to_csv(self, path: str | Path) -> None:
        """Write time and all values to a CSV file; the numbers read back to the same bits.

        Parameters
        ----------
        path
            The file.
        """
        with Path(path).open("w", newline="", encoding="utf-8") as stream:
            stream.write(format_header(["time", *self.values]))
            stream.write(format_rows(self.rows))

    def save(self, folder: Path, formats: Iterable[str] = ()) -> Path:
        """Write result files to a folder; those of an earlier run there are removed.

        Parameters
        ----------
        folder
            The folder; created where it does not exist.
        formats
            Names of further formats beside CSV, see :data:`cosim.results.formats.FORMATS`.

        Returns
        -------
        Path
            The CSV file: ``result.csv``, or ``result.partial.csv`` of an incomplete run.

        Raises
        ------
        SetupError
            If a format does not exist or its package is not installed, or a run writes to the folder.
        RunError
            If a file cannot be written.
        """
        sinks = create_sinks(folder, formats)
        with locked_folder(folder):
            prepare_folder(folder)
            for sink in sinks:
                sink.begin(list(self.values), [self.units[name] for name in self.values])
                sink.write(self.rows)
                sink.end(self.complete)
        return sinks[0].path

    @classmethod
    def read(cls, path: str | Path) -> Result:
        """Read a result from a file.

        Parameters
        ----------
        path
            A ``.csv``, ``.parquet`` or ``.mf4`` file.

        Returns
        -------
        Result
            Incomplete where the name has ``.partial``. A CSV file does not keep units: they are those of the
            ``run.json`` beside it that describes the file, and None where there is none.

        Raises
        ------
        SetupError
            If the file cannot be read, see :func:`cosim.results.formats.read_table`.
        """
        path = Path(path)
        table = read_table(path)
        return cls(
            time=table.rows[:, 0],
            values={name: table.rows[:, i] for i, name in enumerate(table.names) if i > 0},
            units=dict(zip(table.names[1:], table.units[1:], strict=True)) | _units_beside(path, table.names),
            complete=".partial" not in path.suffixes,
        )


def _units_beside(path: Path, names: Iterable[str]) -> dict[str, str]:
    """Return the units that the ``run.json`` beside a CSV file has for columns of these names."""
    if path.suffix != CsvSink.suffix:
        return {}
    try:
        about = json.loads((path.parent / MANIFEST).read_text(encoding="utf-8"))
        units = about["units"] if path.name in about["files"] else {}
        return {name: str(units[name]) for name in names if name in units}
    except (OSError, ValueError, LookupError, TypeError):  # no description of this file
        return {}


def prepare_folder(folder: Path) -> None:
    """Create a folder for results and remove the result files of an earlier run from it.

    Parameters
    ----------
    folder
        The folder; other files in it are not touched.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for name in (MANIFEST, *result_file_names()):
        (folder / name).unlink(missing_ok=True)
