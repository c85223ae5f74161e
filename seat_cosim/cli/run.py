"""``seat-cosim run``: one scenario of the seat suspension."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from cosim.engine.run_options import RunOptions
from cosim.errors import SetupError
from cosim.fmi.values import Value
from cosim.results.result import MANIFEST, Result
from cosim.run_folder import run_to_folder
from cosim.system import System
from seat_controller_fmu.parameters import SAMPLE_TIME
from seat_cosim.cli.console import command_line, print_warnings, progress_shown
from seat_cosim.cli.effect import refuse_without_effect
from seat_cosim.cli.folders import choose_folder, force_option
from seat_cosim.cli.options import check_run_options, run_options, settings
from seat_cosim.cli.outcome import OVERVIEW, Outcome, OutputOptions, figure_option, output_options, print_run
from seat_cosim.cli.reading_options import RECORDING, ReadingOptions, play, read_scenario, recording_options
from seat_cosim.cli.seat_options import OPTIONS, SeatOptions, seat_options
from seat_cosim.idle_parameters import refuse_idle
from seat_cosim.plausibility import explained, notes_after, notes_before
from seat_cosim.scenarios import ROAD, ROADS, SCENARIOS, SHAKER, SPEED, TRUCK, Scenario, control, road

if TYPE_CHECKING:
    from seat_cosim.ride_summary import RideSummary


@click.command()
@click.argument("scenario", type=click.Choice(list(SCENARIOS)))
@click.option("--road", "road_class", type=click.Choice(ROADS), help="Class of ISO 8608, of the truck [default: C].")
@click.option("--speed", type=float, metavar="KM/H", help="Of the truck [default: 60].")
@seat_options(*OPTIONS)
@recording_options
@click.option("--stop-time", type=float, metavar="S", help="[default: the scenario's, or the recording's end]")
@click.option("--step-size", type=float, metavar="S", help="[default: the FMUs']")
@run_options
@click.option(
    "--compare",
    type=click.Choice(["passive", "none"]),
    help="Numbers of the same ride on the passive seat [default: passive; none with --real-time or --isolate].",
)
@output_options
@figure_option
@force_option
@click.option("--output", type=click.Path(path_type=Path), help="Where to [default: results/run/SCENARIO].")
def run(
    scenario: str,
    road_class: str | None,
    speed: float | None,
    seat: SeatOptions,
    recording_file: Path | None,
    channel: str | None,
    reading: ReadingOptions,
    stop_time: float | None,
    step_size: float | None,
    compare: str | None,
    quiet: bool,
    as_json: bool,
    with_figure: bool,
    force: bool,
    output: Path | None,
    **how: Any,
) -> None:
    """Run one scenario of the seat suspension; writes result.csv, a figure and run.json, which `rerun` takes.

    Prints what a rider and an engineer want to know of the ride, beside the same ride on the passive seat.

    \b
    Scenarios: bump (the paper's, 3 s), sine (3 Hz, 6 mm, 5 s), sweep (0.5 to 20 Hz at 1 m/s2, 60 s),
    random (ISO 7096 EM1, 60 s), file (--recording or a recorded CSV, an example by default, 10 s),
    truck (the cab of a truck on a road of ISO 8608, with end stops at 40 mm, 60 s).
    Examples:
      seat-cosim run bump --driver-mass 70 --observer 2
      seat-cosim run bump --driver-mass 110 --gains recommended
      seat-cosim run random --mode robust --set seat.actuator.time_constant=0.005
      seat-cosim run sine --set shaker.sine.frequency=2 --control off --output results/sine2
      seat-cosim run random --set shaker.random.class=EM5 --set shaker.random.seed=7
      seat-cosim run random --parameters ride --control passive
      seat-cosim run file --set shaker.file.path=/data/cab_floor.csv --stop-time 120
      seat-cosim run file --recording ride.mf4 --channel Floor_Z --unit g
      seat-cosim run truck --road C --speed 60
    """
    check_run_options(how)
    if seat.control == "passive":
        refuse_without_effect(["compare"], "--control passive", "the ride is that of the passive seat already")
    floor = read_scenario(scenario, recording_file, channel, reading)
    chosen = _scenario(scenario, road_class, speed)
    system = seat.system(chosen.floor)
    if stop_time is None:
        stop_time = chosen.stop_time if floor is None else floor.stop_time(step_size or SAMPLE_TIME.value)
    parameters = seat.ride(chosen, system)
    refuse_idle(settings(seat.settings, system), system, parameters)
    notes = [*([] if floor is None else floor.notes), *notes_before(system, parameters, step_size, stop_time)]
    folder = choose_folder(output, Path("results", "run", scenario), command_line(), force=force)
    if floor is not None:
        parameters |= play(SHAKER, folder / RECORDING, parameters)
    with progress_shown(f"running {scenario}") as report:
        options = RunOptions(
            stop_time, step_size, parameters, progress=lambda time: report(f"{time:.1f} of {stop_time:g} s"), **how
        )
        if floor is not None:
            options.check(system)
            floor.write(folder / RECORDING)
        result = run_to_folder(system, folder, options, command=command_line())
        warnings = explained(result.warnings, seat.gains, control=seat.control not in ("off", "passive"))
        if result.error is not None:
            print_warnings(warnings)
            raise result.error
        (folder / OVERVIEW).unlink(missing_ok=True)
        if with_figure:
            report("figure")
            from seat_cosim.overview import draw_scenario  # takes long to load

            draw_scenario(folder / OVERVIEW, scenario, system, result)
        report("numbers")
        rides = _rides(system, result, options, seat, chosen, compare or _default_comparison(seat, how))
    outcome = Outcome(
        folder,
        result,
        warnings,
        [*notes, *notes_after(result)],
        rides,
        next_command=_next(folder, scenario, seat, floor is not None),
    )
    print_run(outcome, OutputOptions(quiet, as_json))


def _scenario(name: str, road_class: str | None, speed: float | None) -> Scenario:
    """Return a scenario, with the road that the options say."""
    chosen = SCENARIOS[name]
    if chosen.floor != TRUCK:
        refuse_without_effect(["road_class", "speed"], name, "its floor is no truck's")
        return chosen
    if speed is not None and not (math.isfinite(speed) and speed > 0.0):
        raise SetupError(f"--speed: expected more than 0 km/h, got {speed:g}")
    return replace(chosen, parameters=road(road_class or ROAD, SPEED if speed is None else speed))


def _default_comparison(seat: SeatOptions, how: Mapping[str, Any]) -> str:
    """Choose the passive seat where it costs little and is not what was run."""
    cheap = not how["real_time"] and not how["isolate"]
    return "passive" if cheap and seat.control != "passive" else "none"


def _rides(
    system: System, result: Result, options: RunOptions, seat: SeatOptions, chosen: Scenario, compare: str
) -> dict[str, RideSummary]:
    """Return the numbers of the run, and of the same ride on the passive seat where that is asked for."""
    from seat_cosim.ride_summary import evaluated_system, summarize

    def numbers(parameters: Mapping[str, Value], ridden: Result) -> RideSummary:
        system.parameters = dict(parameters)
        evaluated = evaluated_system(system)
        assert evaluated is not None
        return summarize(evaluated, ridden)

    rides = {"this ride": numbers(options.parameters or {}, result)}
    if compare == "passive":
        ours, prefix = options.parameters or {}, f"{chosen.floor}."
        floor = {name: value for name, value in ours.items() if name.startswith(prefix)}
        passive = {**replace(seat, control="passive").ride(chosen, system), **floor, **control(False)}
        system.parameters = {}
        same = replace(options, parameters=passive, formats=(), real_time=False, progress=None)
        with system.open(options.isolate, options.time_limit) as session:
            rides["passive seat"] = numbers(passive, session.execute(same, same.check(system)))
    return rides


def _next(folder: Path, scenario: str, seat: SeatOptions, recorded: bool) -> str:
    """Return a command that a user may want next: other gains for the same ride, or the same bytes again."""
    if recorded or seat.gains or seat.observer or seat.control or seat.parameter_files or seat.settings:
        return f"seat-cosim rerun {folder / MANIFEST}"
    mass = "" if seat.driver_mass is None else f" --driver-mass {seat.driver_mass:g}"
    chosen = "" if scenario == "bump" else f" --scenario {scenario}"
    return f"seat-cosim compare passive published recommended{chosen}{mass}"
