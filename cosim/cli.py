"""The command line: parses, calls the rooms' front doors, prints, and turns errors into exit codes."""

from __future__ import annotations

import sys
import traceback
from collections.abc import Iterable, Iterator
from itertools import chain
from pathlib import Path
from typing import Any

import click
from rich.table import Table

from cosim.cli_design import design
from cosim.cli_evaluate import evaluate
from cosim.cli_options import parameter_sets, parameters_option, run_options, set_option, settings_of
from cosim.cli_reproduce import reproduce
from cosim.cli_rerun import rerun
from cosim.cli_seat import (
    control_option,
    flavour_option,
    fmus_option,
    gains_of,
    gains_option,
    mass_option,
    observer_of,
    observer_option,
)
from cosim.cli_simulate import simulate
from cosim.cli_validate import validate_command
from cosim.console import command_line, conclude, console, progress_shown
from cosim.errors import CosimError, RunError, SetupError, writing_to
from cosim.model import Value
from cosim.results import Result
from cosim.run_folder import run_to_folder
from cosim.scenarios import SCENARIOS, SYSTEM_FILES, control, driver_mass, seat_suspension
from cosim.system import System
from fmus import FLAVOURS


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.version_option(package_name="seat-cosim")
@click.option("--debug", is_flag=True, help="Show the traceback of an error; goes anywhere on the line.")
def app(debug: bool) -> None:
    """Active seat suspension as FMI co-simulation components.

    \b
    Examples:
      seat-cosim build
      seat-cosim run bump --driver-mass 70 --observer 1
      seat-cosim reproduce
    """


@app.command()
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
    from cosim import stepper
    from fmus.build import PLATFORMS, BuildError, build_library
    from fmus.build import build as build_all

    table = Table("file", "size", "state", box=None)
    chosen = tuple(PLATFORMS) if platforms == "all" else tuple(filter(None, platforms.split(",")))
    if unknown := [name for name in chosen if name not in PLATFORMS]:
        raise SetupError(f"--platforms {platforms}: expected all or names of {', '.join(PLATFORMS)}, got {unknown[0]}")
    try:
        with progress_shown("building FMUs") as report:
            files = [build_all(output, flavour or FLAVOURS, chosen)]
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
    from fmus.build import host_platform

    host = host_platform()
    for flavour, name in SYSTEM_FILES.items():
        if flavour in flavours and host in (tuple(platforms) or (host,)):
            system = seat_suspension(folder / flavour)
            system.stop_time = SCENARIOS["bump"].stop_time
            yield name, system


app.add_command(design)
app.add_command(evaluate)
app.add_command(reproduce)
app.add_command(rerun)
app.add_command(simulate)
app.add_command(validate_command)


@app.command()
@click.option("--export", "folder", type=click.Path(path_type=Path), required=True, metavar="DIR", help="Where to.")
def fmus(folder: Path) -> None:
    """Take the native FMUs, for all platforms, out of an installed wheel; needs no compiler.

    \b
    Example:
      seat-cosim fmus --export fmus
    """
    from fmus.archive import CARRIED, BuildError, export

    try:
        with writing_to(folder):
            for path in export(CARRIED, folder):
                console.print(str(path))
    except BuildError as error:
        raise SetupError(str(error)) from error


@app.command()
@click.argument("scenario", type=click.Choice(list(SCENARIOS)))
@mass_option
@gains_option
@observer_option
@control_option
@parameters_option
@set_option
@click.option("--stop-time", type=float, metavar="S", help="[default: the scenario's]")
@click.option("--step-size", type=float, metavar="S", help="[default: the FMUs']")
@flavour_option
@fmus_option
@run_options
@click.option("--output", type=click.Path(path_type=Path), help="Where to [default: results/run/SCENARIO].")
def run(
    scenario: str,
    driver_mass: float | None,
    gains: str | None,
    number: str | None,
    switch: str | None,
    parameter_files: tuple[str, ...],
    settings: tuple[str, ...],
    stop_time: float | None,
    step_size: float | None,
    flavour: str,
    fmus_folder: Path,
    output: Path | None,
    **how: Any,
) -> None:
    """Run one scenario of the seat suspension; writes result.csv, a figure and run.json, which `rerun` takes.

    \b
    Scenarios: bump (the paper's, 3 s), sine (3 Hz, 6 mm, 5 s), sweep (0.5 to 20 Hz at 1 m/s2, 60 s),
    random (ISO 7096 EM1, 60 s), file (a recorded CSV, an example by default, 10 s).
    Examples:
      seat-cosim run bump --driver-mass 70 --observer 2
      seat-cosim run bump --driver-mass 110 --gains recommended
      seat-cosim run sine --set shaker.sine.frequency=2 --control off --output results/sine2
      seat-cosim run random --set shaker.random.class=EM5 --set shaker.random.seed=7
      seat-cosim run random --parameters ride --control passive
      seat-cosim run file --set shaker.file.path=/data/cab_floor.csv --stop-time 120
    """
    chosen = SCENARIOS[scenario]
    stop_time = chosen.stop_time if stop_time is None else stop_time
    system = seat_suspension(fmus_folder / flavour)
    parameters = dict(chosen.parameters)
    parameters |= parameter_sets(parameter_files, system)
    parameters |= gains_of(gains) if gains else {}
    parameters |= observer_of(int(number)) if number else {}
    parameters |= control(switch == "on") if switch else {}
    parameters |= parameter_sets(["passive"], system) if switch == "passive" else {}
    parameters |= _driver(driver_mass)
    parameters |= settings_of(settings)
    folder = output or Path("results", "run", scenario)
    with progress_shown(f"running {scenario}") as report:
        result = run_to_folder(
            system,
            folder,
            stop_time=stop_time,
            step_size=step_size,
            parameters=parameters,
            progress=lambda time: report(f"{time:.1f} of {stop_time:g} s"),
            command=command_line(),
            **how,
        )
    conclude(result)
    _overview(system, result, folder, scenario)
    console.print(f"{len(result.time)} rows and figure in {folder}")


def _driver(mass: float | None) -> dict[str, Value]:
    return {} if mass is None else driver_mass(mass)


def _overview(system: System, result: Result, folder: Path, scenario: str) -> None:
    """Draw a run's main signals over time."""
    from cosim.figures import Curve, Panel, draw
    from cosim.scenarios import OVERVIEW

    panels = [
        Panel(f"{label} ({system.unit(signals[0])})", result.time, [Curve(s, result[s], {}) for s in signals], {})
        for label, signals in OVERVIEW.items()
    ]
    draw(folder / "overview.png", f"Seat suspension, {scenario}", panels)


def main() -> None:
    """Run the command line; exits with 0, 2 (seen before an FMU was instantiated) or 1 (failed later)."""
    arguments = [argument for argument in sys.argv[1:] if argument != "--debug"]
    debug = len(arguments) < len(sys.argv) - 1
    try:
        app.main(arguments, standalone_mode=False)
    except (CosimError, click.ClickException, click.Abort, KeyboardInterrupt) as error:
        code, message = _judge(error)
        if debug:
            traceback.print_exc()
        click.echo(message, err=True)
        sys.exit(code)
    sys.exit(0)


def _judge(error: BaseException) -> tuple[int, str]:
    """Say an error in one line, and which exit code it is."""
    if isinstance(error, click.exceptions.NoArgsIsHelpError):
        return 2, error.format_message()
    if isinstance(error, click.ClickException):
        code, text = error.exit_code, error.format_message()
    elif isinstance(error, CosimError):
        code, text = 2 if isinstance(error, SetupError) else 1, str(error)
    else:
        code, text = 1, "interrupted"
    return code, f"seat-cosim: error: {' '.join(text.split())}"
