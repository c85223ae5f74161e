"""The command ``seat-cosim rerun``: a run again from its run.json, and whether it gives the same bytes."""

from __future__ import annotations

from pathlib import Path

import click
import numpy as np

from cosim.engine.run_options import RunOptions
from cosim.errors import RunError, SetupError, reading
from cosim.manifest import Manifest, sha256
from cosim.results.formats import ResultTable, read_table
from cosim.results.result import MANIFEST
from cosim.run_folder import run_to_folder
from seat_cosim.cli.console import command_line, conclude, console, progress_shown, stderr


@click.command()
@click.argument("manifest", type=click.Path(path_type=Path), metavar="RUN.JSON")
@click.option("--output", type=click.Path(path_type=Path), help="Where to [default: rerun, beside RUN.JSON].")
def rerun(manifest: Path, output: Path | None) -> None:
    """Run again what a run.json tells of, and compare the result with that of the first time, byte by byte.

    Paths of FMUs start from the folder the first run was started in; FMUs that are not those of the run are refused.
    What was paced in real time is not.

    \b
    Example:
      seat-cosim run bump --driver-mass 70
      seat-cosim rerun results/run/bump/run.json
    """
    first = Manifest.read(manifest)
    folder = output or manifest.parent / "rerun"
    if folder.resolve() == manifest.parent.resolve():
        raise SetupError(f"--output {folder}: expected another folder than that of {manifest}, got the same")
    with reading(manifest):
        system = first.system()
        system.validate(record=first.record)
    with progress_shown("running again") as report:
        result = run_to_folder(
            system,
            folder,
            RunOptions(
                record=first.record,
                record_every=first.record_every,
                formats=first.formats,
                progress=lambda time: report(f"{time:.1f} of {first.stop_time:g} s"),
                keep=False,
                isolate=first.isolate,
                time_limit=first.time_limit,
            ),
            command=command_line(),
        )
    again = Manifest.read(folder / MANIFEST)
    _tell_versions(first, again)
    conclude(result)
    _compare(manifest.parent, first, folder, again)


def _tell_versions(first: Manifest, again: Manifest) -> None:
    """Say which versions are not those of the first run."""
    for name, version in first.versions.items():
        if again.versions.get(name) != version:
            stderr.print(f"note: {name} {again.versions.get(name)}, {version} in the first run", markup=False)


def _compare(before: Path, first: Manifest, folder: Path, again: Manifest) -> None:
    """Say that all files have the bytes of the first run, or fail."""
    if not first.complete:
        console.print(
            f"{again.rows} rows in {folder}; the first run was not complete, there is nothing to compare with"
        )
        return
    problems = []
    for name, expected in first.files.items():
        old, new, found = before / name, folder / name, again.files.get(name, "no such file")
        if old.is_file() and sha256(old) != expected:
            stderr.print(f"warning: {old} is not what the first run left", markup=False, soft_wrap=True)
        if found == expected:
            console.print(f"{new}: {again.rows} rows, the same bytes as in the first run", soft_wrap=True)
        else:
            problems.append(f"{new}: expected sha256 {expected:.12}…, got {found:.12}…{_difference(old, new)}")
    if problems:
        raise RunError("; ".join(problems))


def _difference(old: Path, new: Path) -> str:
    """Say where the numbers of two files differ first, as far as that can be told."""
    try:
        return f" ({first_difference(read_table(old), read_table(new))})"
    except SetupError:
        return ""


def first_difference(expected: ResultTable, got: ResultTable) -> str:
    """Name the first row and column at which two tables differ, and how many numbers do."""
    if expected.names != got.names or expected.rows.shape != got.rows.shape:
        shapes = [f"{rows} rows of {columns} columns" for rows, columns in (expected.rows.shape, got.rows.shape)]
        return f"expected {shapes[0]}, got {shapes[1]}"
    places = np.argwhere(expected.rows != got.rows)
    if not len(places):
        return "all numbers are the same"
    row, column = places[0]
    return (
        f"{len(places)} numbers differ, first {expected.names[column]} in row {row}: "
        f"expected {expected.rows[row, column].item()!r}, got {got.rows[row, column].item()!r}"
    )
