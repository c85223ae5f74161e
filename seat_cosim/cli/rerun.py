"""``seat-cosim rerun``: a run again from its run.json, and whether it gives the same bytes."""

from __future__ import annotations

from pathlib import Path

import click

from cosim import rerun as repetition
from cosim.errors import RunError, SetupError
from cosim.manifest import Manifest
from cosim.results.result import MANIFEST
from seat_cosim.cli.console import command_line, console, print_outcome, progress_shown, stderr
from seat_cosim.cli.folders import lock


@click.command()
@click.argument("manifest", type=click.Path(path_type=Path), metavar="RUN.JSON|FOLDER")
@click.option("--output", type=click.Path(path_type=Path), help="Where to [default: rerun, beside RUN.JSON].")
def rerun(manifest: Path, output: Path | None) -> None:
    """Run again what a run.json describes, and compare the result with that of the first time, byte by byte.

    Paths of FMUs start from the folder the first run was started in; FMUs that are not those of the run are refused.
    What was paced in real time is not.

    \b
    Example:
      seat-cosim run bump --driver-mass 70
      seat-cosim rerun results/run/bump/run.json
    """
    manifest = manifest / MANIFEST if manifest.is_dir() else manifest
    folder = output or manifest.parent / "rerun"
    if folder.resolve() == manifest.parent.resolve():
        raise SetupError(f"--output {folder}: expected another folder than that of {manifest}, got the same")
    lock(folder)
    with progress_shown("running again") as report:
        found = repetition.rerun(
            manifest, folder, lambda time, stop_time: report(f"{time:.1f} of {stop_time:g} s"), command_line()
        )
    _print_versions(found.first, found.again)
    print_outcome(found.result)
    if found.first.complete:
        _print_comparison(found, manifest.parent, folder)
    else:
        console.print(
            f"{found.again.rows} rows in {folder}; the first run was not complete, there is nothing to compare with"
        )


def _print_versions(first: Manifest, again: Manifest) -> None:
    """Print the versions that are not those of the first run."""
    for name, version in first.versions.items():
        if again.versions.get(name) != version:
            stderr.print(f"note: {name} {again.versions.get(name)}, {version} in the first run")


def _print_comparison(found: repetition.Rerun, before: Path, folder: Path) -> None:
    """Print which files have the bytes of the first run; raise an error for those that do not."""
    problems = []
    for file in repetition.compare(found, before, folder):
        if file.is_changed:
            stderr.print(f"warning: {file.old} is not what the first run left", soft_wrap=True)
        if file.problem:
            problems.append(file.problem)
        else:
            console.print(f"{file.new}: {found.again.rows} rows, the same bytes as in the first run", soft_wrap=True)
    if problems:
        raise RunError("; ".join(problems))
