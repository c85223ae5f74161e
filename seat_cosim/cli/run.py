"""``seat-cosim run``: one scenario of the seat suspension."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from cosim.engine.run_options import RunOptions
from cosim.run_folder import run_to_folder
from seat_cosim.cli.console import command_line, console, print_outcome, progress_shown
from seat_cosim.cli.options import run_options
from seat_cosim.cli.seat_options import OPTIONS, SeatOptions, seat_options
from seat_cosim.scenarios import SCENARIOS


@click.command()
@click.argument("scenario", type=click.Choice(list(SCENARIOS)))
@seat_options(*OPTIONS)
@click.option("--stop-time", type=float, metavar="S", help="[default: the scenario's]")
@click.option("--step-size", type=float, metavar="S", help="[default: the FMUs']")
@run_options
@click.option("--output", type=click.Path(path_type=Path), help="Where to [default: results/run/SCENARIO].")
def run(
    scenario: str,
    seat: SeatOptions,
    stop_time: float | None,
    step_size: float | None,
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
      seat-cosim run random --mode robust --set seat.actuator.time_constant=0.005
      seat-cosim run sine --set shaker.sine.frequency=2 --control off --output results/sine2
      seat-cosim run random --set shaker.random.class=EM5 --set shaker.random.seed=7
      seat-cosim run random --parameters ride --control passive
      seat-cosim run file --set shaker.file.path=/data/cab_floor.csv --stop-time 120
    """
    from seat_cosim.overview import draw_scenario

    chosen = SCENARIOS[scenario]
    stop_time = chosen.stop_time if stop_time is None else stop_time
    system = seat.system()
    parameters = {**chosen.parameters, **seat.parameters(system)}
    folder = output or Path("results", "run", scenario)
    with progress_shown(f"running {scenario}") as report:
        options = RunOptions(
            stop_time, step_size, parameters, progress=lambda time: report(f"{time:.1f} of {stop_time:g} s"), **how
        )
        result = run_to_folder(system, folder, options, command=command_line())
    print_outcome(result)
    draw_scenario(folder / "overview.png", scenario, system, result)
    console.print(f"{len(result.time)} rows and figure in {folder}")
