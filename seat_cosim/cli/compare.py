"""``seat-cosim compare``: the same ride with several controllers, in one table and one figure."""

from __future__ import annotations

import json
from pathlib import Path

import click

from cosim.errors import writing_to
from cosim.fmi.values import Value
from cosim.system import System
from seat_controller_fmu.parameters import SAMPLE_TIME
from seat_cosim.cli.console import command_line, console, print_notes, print_warnings, progress_shown
from seat_cosim.cli.folders import EVALUATION, choose_folder, force_option, write_command
from seat_cosim.cli.options import settings
from seat_cosim.cli.outcome import OutputOptions, output_options, print_rides
from seat_cosim.cli.reading_options import RECORDING, ReadingOptions, play, read_scenario, recording_options
from seat_cosim.cli.seat_options import SeatOptions, seat_options
from seat_cosim.idle_parameters import refuse_idle
from seat_cosim.plausibility import explained, notes_after
from seat_cosim.scenarios import SCENARIOS, SHAKER, Scenario

WITHOUT_GAINS = ("off", "passive", "robust")
"""What can be compared without the published law, whose range of drivers then does not matter."""


@click.command()
@click.argument("controllers", nargs=-1, required=True, metavar="A B...")
@click.option("--scenario", type=click.Choice(list(SCENARIOS)), default="bump", show_default=True)
@seat_options("driver_mass", "parameter_files", "settings")
@recording_options
@click.option("--stop-time", type=float, metavar="S", help="[default: the scenario's, or the recording's end]")
@output_options
@force_option
@click.option("--output", type=click.Path(path_type=Path), help="Where to [default: results/compare/SCENARIO].")
def compare(
    controllers: tuple[str, ...],
    scenario: str,
    seat: SeatOptions,
    recording_file: Path | None,
    channel: str | None,
    reading: ReadingOptions,
    stop_time: float | None,
    quiet: bool,
    as_json: bool,
    force: bool,
    output: Path | None,
) -> None:
    """Ride the same with several controllers: a table and a figure (comparison.png), a folder with result.csv for each.

    \b
    Each of A B... is a preset of gains (published, table1-printed, recommended, equal-rate), a gains.json, observer1,
    observer2, robust (the mode robust), off (no force), passive (the passive seat), or the FMU of another controller
    with our variables.
    Examples:
      seat-cosim compare passive published recommended
      seat-cosim compare passive published robust --scenario random
      seat-cosim compare observer1 observer2 --scenario random --driver-mass 80
      seat-cosim compare passive robust --scenario file --recording ride.mf4 --channel Floor_Z --unit g
    """
    from seat_cosim import compare as comparison

    chosen, floor = SCENARIOS[scenario], read_scenario(scenario, recording_file, channel, reading)
    if stop_time is None:
        stop_time = chosen.stop_time if floor is None else floor.stop_time(SAMPLE_TIME.value)
    folder = choose_folder(output, Path("results", "compare", scenario), command_line(), force=force, marker=EVALUATION)
    ridden = []
    _refuse_idle_floor(seat, chosen)

    def parameters(system: System) -> dict[str, Value]:
        given = seat.ride(chosen, system)
        return given if floor is None else given | play(SHAKER, folder / RECORDING, given)

    if floor is not None:
        floor.write(folder / RECORDING)
    with progress_shown("comparing") as report:
        for ride in comparison.rides(
            controllers,
            lambda: seat.system(chosen.floor),
            parameters,
            stop_time,
            folder,
            command_line(),
        ):
            report(ride.variant.title)
            ridden.append(ride)
        with writing_to(folder):
            comparison.draw_comparison(folder / "comparison.png", scenario, ridden)
    write_command(folder / EVALUATION, command_line())
    for ride in ridden:
        print_warnings(
            f"{ride.variant.title}: {text}"
            for text in explained(
                ride.result.warnings, ride.variant.title, control=ride.variant.title not in WITHOUT_GAINS
            )
        )
    shown = OutputOptions(quiet, as_json)
    if not quiet:
        print_notes([] if floor is None else floor.notes)
        print_notes(dict.fromkeys(note for ride in ridden for note in notes_after(ride.result)))
    rides = {ride.variant.title: ride.summary for ride in ridden}
    if as_json:
        click.echo(json.dumps({"folder": str(folder), "rides": {k: v.as_json() for k, v in rides.items()}}, indent=2))
    if shown.prints_text:
        print_rides(rides)
        console.print(f"comparison.png and {len(ridden)} runs in {folder}", soft_wrap=True)


def _refuse_idle_floor(seat: SeatOptions, scenario: Scenario) -> None:
    """Raise an error for parameters of another floor; those of the controller may concern one of the compared."""
    system = seat.system(scenario.floor)
    given = settings(seat.settings, system)
    of_floor = (name for name in given if name.startswith(f"{scenario.floor}."))
    refuse_idle(of_floor, system, {**scenario.parameters, **given})
