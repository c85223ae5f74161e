"""``seat-cosim build``: FMUs, systems of them and the loop in C."""

from __future__ import annotations

from pathlib import Path

import click
from rich.table import Table

from cosim.errors import RunError, SetupError
from fmus import FLAVOURS
from seat_cosim.cli.console import console, progress_shown
from seat_cosim.cli.effect import refuse_without_effect


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
    if flavour == ("python",):
        refuse_without_effect(["platforms"], "--flavour python", "an FMU in Python has no platform")
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
