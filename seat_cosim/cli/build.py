"""``seat-cosim build`` and ``fmus``: FMUs, systems of them and the loop in C, built or copied out of a wheel."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain
from pathlib import Path

import click
from rich.table import Table

from cosim.errors import RunError, SetupError, writing_to
from cosim.system import System
from fmus import FLAVOURS
from seat_cosim import components
from seat_cosim.cli.console import console, progress_shown
from seat_cosim.scenarios import SCENARIOS, SYSTEM_FILES, seat_suspension


@click.command()
@click.option("--flavour", type=click.Choice(FLAVOURS), multiple=True, help="Which FMUs to build [default: all].")
@click.option(
    "--platforms", default="", metavar="NAMES", help="all, or names with commas between [default: this machine's]."
)
@click.option("--output", type=click.Path(path_type=Path), default=Path("fmus"), show_default=True, help="Where to.")
def build(flavour: tuple[str, ...], platforms: str, output: Path) -> None:
    """Build the FMUs, the systems of them (.ssp) and the master's loop in C; what has not changed is left alone.

    \b
    Flavours: fmi2 and fmi3 are native, for FMI 2.0 and 3.0; python is FMI 2.0 and needs Python in the host.
    Platforms: x86_64-linux, aarch64-linux, x86_64-windows, x86_64-darwin, aarch64-darwin.
    Examples:
      seat-cosim build
      seat-cosim build --flavour fmi3 --platforms all
    """
    from cosim.engine import native_stepper as stepper
    from fmus.export.build import PLATFORMS, BuildError, build_library

    table = Table("file", "size", "state", box=None)
    chosen = tuple(PLATFORMS) if platforms == "all" else tuple(filter(None, platforms.split(",")))
    if unknown := [name for name in chosen if name not in PLATFORMS]:
        raise SetupError(f"--platforms {platforms}: expected all or names of {', '.join(PLATFORMS)}, got {unknown[0]}")
    try:
        with progress_shown("building FMUs") as report:
            files = [components.build(output, flavour or FLAVOURS, chosen)]
            if set(flavour) != {"python"}:  # which is all that can be built without a compiler
                files.append(
                    build_library(stepper.NAME, stepper.sources(), stepper.fingerprint(), stepper.BUILT, chosen)
                )
            for built in chain(*files):
                report(built.path.name)
                table.add_row(*_built(built.path, built.fresh))
            for name, system in _systems(output, flavour or FLAVOURS, chosen):
                report(name)
                table.add_row(*_built(output / name, system.save(output / name)))
    except (BuildError, OSError) as error:
        raise RunError(str(error)) from error
    console.print(table)


def _built(path: Path, fresh: bool) -> tuple[str, str, str]:
    """Describe a built file: name, size, state."""
    return str(path), f"{path.stat().st_size / 1024:.0f} kB", "built" if fresh else "up to date"


def _systems(folder: Path, flavours: Iterable[str], platforms: Iterable[str]) -> Iterator[tuple[str, System]]:
    """Wire the native FMUs that were just built, with the bump to run; FMUs for other machines cannot be wired here."""
    from fmus.export.build import host_platform

    host = host_platform()
    for flavour, name in SYSTEM_FILES.items():
        if flavour in flavours and host in (tuple(platforms) or (host,)):
            system = seat_suspension(folder / flavour)
            system.stop_time = SCENARIOS["bump"].stop_time
            yield name, system


@click.command()
@click.option("--export", "folder", type=click.Path(path_type=Path), required=True, metavar="DIR", help="Where to.")
def fmus(folder: Path) -> None:
    """Take the native FMUs, for all platforms, out of an installed wheel; needs no compiler.

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
