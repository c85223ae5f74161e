"""``seat-cosim run``: one scenario of the seat suspension."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from cosim.engine.run_options import RunOptions
from cosim.fmi.values import Value
from cosim.results.result import Result
from cosim.run_folder import run_to_folder
from cosim.system import System
from seat_cosim.cli.console import command_line, conclude, console, progress_shown
from seat_cosim.cli.options import parameter_sets, parameters_option, run_options, set_option, settings_of
from seat_cosim.cli.seat_options import (
    control_option,
    flavour_option,
    fmus_option,
    gains_of,
    gains_option,
    mass_option,
    observer_of,
    observer_option,
)
from seat_cosim.scenarios import SCENARIOS, control, driver_mass, seat_suspension


@click.command()
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
            RunOptions(
                stop_time, step_size, parameters, progress=lambda time: report(f"{time:.1f} of {stop_time:g} s"), **how
            ),
            command=command_line(),
        )
    conclude(result)
    _overview(system, result, folder, scenario)
    console.print(f"{len(result.time)} rows and figure in {folder}")


def _driver(mass: float | None) -> dict[str, Value]:
    return {} if mass is None else driver_mass(mass)


def _overview(system: System, result: Result, folder: Path, scenario: str) -> None:
    """Draw a run's main signals over time."""
    from seat_cosim.plotting import Curve, Panel, draw
    from seat_cosim.scenarios import OVERVIEW

    panels = [
        Panel(f"{label} ({system.unit(signals[0])})", result.time, [Curve(s, result[s], {}) for s in signals], {})
        for label, signals in OVERVIEW.items()
    ]
    draw(folder / "overview.png", f"Seat suspension, {scenario}", panels)
