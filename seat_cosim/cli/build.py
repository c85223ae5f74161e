"""``seat-cosim build`` and ``fmus``: FMUs, systems of them and the loop in C, built or copied out of a wheel."""

from __future__ import annotations

from pathlib import Path

import click
from rich.table import Table

from cosim.errors import RunError, SetupError, writing_to
from fmus import FLAVOURS
from seat_cosim.cli.console import console, progress_shown


@click.command()
@click.option("--flavour", type=click.Choice(FLAVOURS), multiple=True, help="Which FMUs to build [default: all].")
@click.option(
    "--platforms", default="", metavar="NAMES", help="all, or names with commas between [default: this machine's]."
)
@click.option("--output", type=click.Path(path_type=Path), default=Path("fmus"), show_default=True, help="Where to.")
def build(flavour: tuple[str, ...], platforms: str, output: Path) -> None:
    """Build the FMUs, the systems of them (.ssp) and the master's loop in C; unchanged files are not written.

    \b
    Flavours: fmi2 and fmi3 are native, for FMI 2.0 and 3.0; python is FMI 2.0 and needs Python in the host.
    Platforms: x86_64-linux, aarch64-linux, x86_64-windows, x86_64-darwin, aarch64-darwin.
    Examples:
      seat-cosim build
      seat-cosim build --flavour fmi3 --platforms all
    """
    from fmus.export.fmu_file import BuildError
    from seat_cosim.build import PLATFORMS, build_all

    chosen = tuple(PLATFORMS) if platforms == "all" else tuple(filter(None, platforms.split(",")))
    if unknown := [name for name in chosen if name not in PLATFORMS]:
        raise SetupError(f"--platforms {platforms}: expected all or names of {', '.join(PLATFORMS)}, got {unknown[0]}")
    table = Table("file", "size", "state", box=None)
    try:
        with progress_shown("building FMUs") as report:
            for built in build_all(output, flavour, chosen):
                report(built.path.name)
                size = f"{built.path.stat().st_size / 1024:.0f} kB"
                table.add_row(str(built.path), size, "built" if built.fresh else "up to date")
    except (BuildError, OSError) as error:
        raise RunError(str(error)) from error
    console.print(table)


@click.command()
@click.option("--export", "folder", type=click.Path(path_type=Path), required=True, metavar="DIR", help="Where to.")
def fmus(folder: Path) -> None:
    """Copy the native FMUs, for all platforms, out of an installed wheel; needs no compiler.

    \b
    Example:
      seat-cosim fmus --export fmus
    """
    from fmus.export.fmu_file import CARRIED, BuildError, export

    try:
        with writing_to(folder):
            for path in export(CARRIED, folder):
                console.print(str(path))
    except BuildError as error:
        raise SetupError(str(error)) from error
