"""What a run leaves: a table of values over time, in memory and as CSV."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, Protocol

import numpy as np

COMPLETE = "result.csv"
PARTIAL = "result.partial.csv"


class Sink(Protocol):
    """Takes the rows of a run while it goes on."""

    def begin(self, names: Sequence[str], units: Sequence[str | None]) -> None:
        """Take the names of the recorded outputs, as ``component.variable``, and their units."""

    def write(self, rows: np.ndarray[Any, Any]) -> None:
        """Take complete rows, shape (n, 1 + names), time in s first; the array is the run's: copy what is to stay."""

    def end(self, complete: bool) -> None:
        """Hear that no more rows come, and whether the run reached its stop time."""


LoopName = Literal["c", "python"]
"""Which loop turned the crank."""


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
    loop
        Which loop turned the crank.
    missed_deadlines, worst_lateness
        Of a run in real time: how many steps were not finished when the next was due, and by how much at worst, in s.
    """

    time: np.ndarray[Any, Any]
    values: Mapping[str, np.ndarray[Any, Any]]
    units: Mapping[str, str | None]
    complete: bool = True
    error: Exception | None = None
    warnings: Sequence[str] = ()
    loop: LoopName = "python"
    missed_deadlines: int = 0
    worst_lateness: float = 0.0

    def __getitem__(self, name: str) -> np.ndarray[Any, Any]:
        """Return the values of ``component.variable``."""
        return self.values[name]

    def to_csv(self, path: str | Path) -> None:
        """Write time and all values; floats are written so that reading them gives the same bits."""
        columns = [self.time.tolist(), *(values.tolist() for values in self.values.values())]
        with Path(path).open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(["time", *self.values])
            writer.writerows(zip(*columns, strict=True))

    def save(self, folder: Path) -> Path:
        """Write ``result.csv``, or ``result.partial.csv`` of an incomplete run; returns which.

        A result of an earlier run does not stay beside it.
        """
        clear(folder)
        target = folder / (COMPLETE if self.complete else PARTIAL)
        unfinished = target.with_suffix(".tmp")
        self.to_csv(unfinished)
        unfinished.replace(target)
        return target


def clear(folder: Path) -> None:
    """Make a folder for results, without those of an earlier run."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in (COMPLETE, PARTIAL):
        (folder / name).unlink(missing_ok=True)
