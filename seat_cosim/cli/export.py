"""``seat-cosim export`` and its alias ``fmus``: the files that the package carries, copied to a folder."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import click

from seat_cosim.carried import BUILT_FOLDER
from seat_cosim.cli.console import console


@click.command()
@click.argument("folder", type=click.Path(path_type=Path), default=BUILT_FOLDER, metavar="[DIR]")
@click.option("--force", is_flag=True, help="Replace files that differ.")
def export(folder: Path, force: bool) -> None:
    """Copy FMUs, systems (.ssp), parameter sets, gains, cross-check files and examples to DIR [default: fmus].

    Needs no compiler: an installed wheel carries the native FMUs for Linux, Windows and macOS. Commands use the FMUs
    of the folder fmus, where there are any, instead of those of the package.

    \b
    Examples:
      seat-cosim export
      seat-cosim export my-folder
    """
    _export(folder, force)


@click.command()
@click.option("--export", "folder", type=click.Path(path_type=Path), required=True, metavar="DIR", help="Where to.")
@click.option("--force", is_flag=True, help="Replace files that differ.")
def fmus(folder: Path, force: bool) -> None:
    """Copy what the package carries to DIR; the same as `export DIR`.

    \b
    Example:
      seat-cosim fmus --export fmus
    """
    _export(folder, force)


def _export(folder: Path, force: bool) -> None:
    from seat_cosim.carried import export as copied

    counts: Counter[Path] = Counter()
    for path in copied(folder.expanduser(), force=force):
        if path.suffix in (".fmu", ".ssp"):
            console.print(str(path), soft_wrap=True)
        else:
            counts[path.parent] += 1
    for parent, count in counts.items():
        console.print(f"{parent}: {count} more file{'s' if count > 1 else ''}", soft_wrap=True)
