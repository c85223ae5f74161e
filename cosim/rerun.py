"""Running again what a ``run.json`` describes, and comparing the files of both runs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from cosim.engine.run_options import RunOptions
from cosim.errors import SetupError, reading
from cosim.manifest import Manifest, sha256
from cosim.results.formats import ResultTable, read_table
from cosim.results.result import MANIFEST, Result
from cosim.run_folder import run_to_folder


class Rerun(NamedTuple):
    """A run, and its repetition.

    Attributes
    ----------
    first, again
        Manifests of the first run and of its repetition.
    result
        Result of the repetition.
    """

    first: Manifest
    again: Manifest
    result: Result


def rerun(manifest: Path, folder: Path, progress: Callable[[float, float], None], command: Sequence[str] = ()) -> Rerun:
    """Run again what a ``run.json`` describes; a run that was paced in real time is not paced.

    Parameters
    ----------
    manifest
        The ``run.json``.
    folder
        Folder of the new result.
    progress
        Called with the simulated time reached and the stop time, in s.
    command
        The user's command line, for the new ``run.json``.

    Returns
    -------
    Rerun
        Both manifests, and the new result.

    Raises
    ------
    SetupError
        If the run cannot be repeated: no such FMUs, or others than those of the run.
    RunError
        If an FMU failed during loading or initialization.
    """
    first = Manifest.read(manifest)
    with reading(manifest):
        system = first.system()
        system.validate(record=first.record)
    options = RunOptions(
        record=first.record,
        record_every=first.record_every,
        formats=first.formats,
        progress=lambda time: progress(time, first.stop_time),
        keep=False,
        isolate=first.isolate,
        time_limit=first.time_limit,
    )
    result = run_to_folder(system, folder, options, command=command)
    return Rerun(first, Manifest.read(folder / MANIFEST), result)


class ComparedFile(NamedTuple):
    """A file of a run, compared with that of its repetition.

    Attributes
    ----------
    old, new
        Paths of both files.
    is_changed
        Whether the old file is no longer the one that the first run wrote.
    problem
        How the new file differs from what the first run wrote; empty where it has the same bytes.
    """

    old: Path
    new: Path
    is_changed: bool
    problem: str


def compare(found: Rerun, before: Path, folder: Path) -> Iterator[ComparedFile]:
    """Compare all files of a run with those of its repetition.

    Parameters
    ----------
    found
        The run and its repetition.
    before, folder
        Folders of their files.

    Yields
    ------
    ComparedFile
        One for each file of the first run.
    """
    for name, expected in found.first.files.items():
        old, new, got = before / name, folder / name, found.again.files.get(name, "no such file")
        problem = ""
        if got != expected:
            problem = f"{new}: expected sha256 {expected:.12}…, got {got:.12}…{_difference(old, new)}"
        yield ComparedFile(old, new, old.is_file() and sha256(old) != expected, problem)


def _difference(old: Path, new: Path) -> str:
    """Describe the first difference of two tables; empty where they cannot be read."""
    try:
        return f" ({first_difference(read_table(old), read_table(new))})"
    except SetupError:
        return ""


def first_difference(expected: ResultTable, got: ResultTable) -> str:
    """Describe the first difference of two tables, and how many numbers differ.

    Parameters
    ----------
    expected, got
        The tables.

    Returns
    -------
    str
        Row, column and values of the first difference.
    """
    if expected.names != got.names or expected.rows.shape != got.rows.shape:
        shapes = [f"{rows} rows of {columns} columns" for rows, columns in (expected.rows.shape, got.rows.shape)]
        return f"expected {shapes[0]}, got {shapes[1]}"
    differing = np.argwhere(expected.rows != got.rows)
    if not len(differing):
        return "all numbers are the same"
    row, column = differing[0]
    return (
        f"{len(differing)} numbers differ, first {expected.names[column]} in row {row}: "
        f"expected {expected.rows[row, column].item()!r}, got {got.rows[row, column].item()!r}"
    )
