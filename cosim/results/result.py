"""What a run leaves: a table of values over time, in memory and in files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, Protocol, get_args

import numpy as np

from cosim.results.formats import CsvSink, file_names, read, sinks
from cosim.results.file_sink import file_name
from cosim.results.csv_file import head, lines

COMPLETE = file_name(CsvSink.suffix, complete=True)
PARTIAL = file_name(CsvSink.suffix, complete=False)
MANIFEST = "run.json"
"""What tells of a run beside its result, see :mod:`cosim.manifest`."""


class Sink(Protocol):
    """Takes the rows of a run while it goes on."""

    def begin(self, names: Sequence[str], units: Sequence[str | None]) -> None:
        """Take the names of the recorded outputs, as ``component.variable``, and their units."""

    def write(self, rows: np.ndarray[Any, Any]) -> None:
        """Take complete rows, shape (n, 1 + names), time in s first; the array is the run's: copy what is to stay."""

    def end(self, complete: bool) -> None:
        """Hear that no more rows come, and whether the run reached its stop time."""


StepperName = Literal["c", "python"]
"""Which loop steps the components."""

STEPPERS: tuple[StepperName, ...] = get_args(StepperName)


@dataclass(frozen=True)
class Result:
    """Values at the communication points of a run.

    There is a row for the instants t_0, t_N, t_2N, ... and for the last one, where every N-th step is recorded. The row
    of t_k holds the values at t_k: what is continuous as it was when step k began, what is discrete as step k computed
    it. The last row repeats the last discrete values, as nothing steps past the stop.

    Attributes
    ----------
    time
        t_k in s, shape (rows,).
    values
        ``component.variable`` to its values, shape (rows,); Booleans as 0 and 1.
    units
        ``component.variable`` to its unit, None where it has none.
    complete
        Whether the run reached its stop time.
    error
        Why it did not.
    warnings
        What the FMUs warned of.
    stepper
        Which loop stepped the components.
    missed_deadlines, worst_lateness
        Of a run in real time: how many steps were not finished when the next was due, and by how much at worst, in s.
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
        return self.values[name]

    @property
    def rows(self) -> np.ndarray[Any, Any]:
        """The table, shape (rows, columns): time first, then the values."""
        return np.column_stack([self.time, *self.values.values()])

    def to_csv(self, path: str | Path) -> None:
        """Write time and all values; floats are written so that reading them gives the same bits."""
        with Path(path).open("w", newline="", encoding="utf-8") as stream:
            stream.write(head(["time", *self.values]))
            stream.write(lines(self.rows))

    def save(self, folder: Path, formats: Iterable[str] = ()) -> Path:
        """Write ``result.csv``, or ``result.partial.csv`` of an incomplete run; returns which.

        What an earlier run left does not stay beside it.

        Parameters
        ----------
        folder
            Where to; made if need be.
        formats
            Further ones: ``parquet``, ``mdf4``.

        Raises
        ------
        SetupError
            If a format needs a package that is not installed.
        """
        wanted = sinks(folder, formats)
        clear(folder)
        for sink in wanted:
            sink.begin(list(self.values), [self.units[name] for name in self.values])
            sink.write(self.rows)
            sink.end(self.complete)
        return wanted[0].path

    @classmethod
    def read(cls, path: str | Path) -> Result:
        """Read what a run left.

        Parameters
        ----------
        path
            A ``.csv``, ``.parquet`` or ``.mf4`` file. A name with ``.partial`` is that of an incomplete run; units are
            None where the format (CSV) does not keep them.

        Raises
        ------
        SetupError
            If it cannot be read.
        """
        path = Path(path)
        table = read(path)
        return cls(
            time=table.rows[:, 0],
            values={name: table.rows[:, i] for i, name in enumerate(table.names) if i > 0},
            units=dict(zip(table.names[1:], table.units[1:], strict=True)),
            complete=".partial" not in path.suffixes,
        )


def clear(folder: Path) -> None:
    """Make a folder for results, without what an earlier run left in it."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in (MANIFEST, *file_names()):
        (folder / name).unlink(missing_ok=True)
