"""``seat-cosim simulate``: any system of FMUs, with changes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
from rich.box import SIMPLE
from rich.table import Table

from cosim.engine.editing import edit
from cosim.engine.run_options import RunOptions
from cosim.engine.step_order import delay
from cosim.engine.structure import ALGORITHMS, Algorithm
from cosim.run_folder import run_to_folder
from cosim.system import System
from seat_controller_fmu.parameters import SAMPLE_TIME
from seat_cosim.carried import system_file
from seat_cosim.cli.console import command_line, console, progress_shown
from seat_cosim.cli.effect import refuse_without_effect
from seat_cosim.cli.folders import choose_folder, force_option
from seat_cosim.cli.options import (
    check_run_options,
    names,
    parameters_option,
    replace_option,
    replacements,
    run_options,
    seconds,
    set_option,
)
from seat_cosim.cli.options import settings as read_settings
from seat_cosim.cli.outcome import OVERVIEW, OutputOptions, figure_option, output_options, print_run, simulated
from seat_cosim.cli.paths import with_user_paths
from seat_cosim.cli.reading_options import (
    RECORDING,
    ReadingOptions,
    play,
    read_recording,
    recording_options,
    shaker_of,
)
from seat_cosim.idle_parameters import refuse_idle
from seat_cosim.plausibility import notes_before
from seat_cosim.scenarios import read_parameter_sets


@click.command()
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE.ssp|NAME")
@replace_option
@click.option(
    "--connect",
    multiple=True,
    metavar="A.x=B.y",
    help="Feed input B.y with output A.x; FACTOR*A.x+OFFSET transforms its values.",
)
@click.option("--disconnect", multiple=True, metavar="B.y", help="Free input B.y.")
@parameters_option
@set_option
@recording_options
@click.option("--start-time", type=float, metavar="S", help="[default: the system's, else the FMUs', else 0]")
@click.option("--stop-time", type=float, metavar="S", help="[default: the recording's, else the system's]")
@click.option("--step-size", type=float, metavar="S", help="Communication step [default: the system's]")
@click.option("--component-step", multiple=True, metavar="COMPONENT=S", help="A component's own step; repeatable.")
@click.option("--tolerance", type=float, metavar="X", help="Relative tolerance [default: each FMU's own]")
@click.option("--algorithm", type=click.Choice(ALGORITHMS), help="[default: the system's, else gauss-seidel]")
@click.option("--order", metavar="A,B,C", help="In which components step [default: the system's, else a proposal]")
@click.option("--record", multiple=True, metavar="A.x", help="Record this output [default: all]; repeatable.")
@run_options
@output_options
@figure_option
@force_option
@click.option("--save", type=click.Path(path_type=Path), metavar="FILE.ssp", help="Write the system as it is run.")
@click.option("--output", type=click.Path(path_type=Path), help="Where to [default: results/simulate/NAME].")
def simulate(
    file: Path,
    replace: tuple[str, ...],
    connect: tuple[str, ...],
    disconnect: tuple[str, ...],
    parameter_files: tuple[str, ...],
    settings: tuple[str, ...],
    recording_file: Path | None,
    channel: str | None,
    reading: ReadingOptions,
    start_time: float | None,
    stop_time: float | None,
    step_size: float | None,
    component_step: tuple[str, ...],
    tolerance: float | None,
    algorithm: Algorithm | None,
    order: str | None,
    record: tuple[str, ...],
    with_figure: bool,
    save: Path | None,
    output: Path | None,
    **how: Any,
) -> None:
    """Run any system of FMUs (SSP 1.0); writes result.csv, a figure and run.json, which `rerun` takes.

    SeatSuspension and SeatSuspension-fmi3 are names of this project's systems; anything else is a file.

    \b
    Examples:
      seat-cosim simulate SeatSuspension --set seat.driver_mass=70 --set controller.driver_mass=70
      seat-cosim simulate SeatSuspension --algorithm jacobi --stop-time 5
      seat-cosim simulate SeatSuspension --replace seat=fmus/fmi3/SeatPlant.fmu
      seat-cosim simulate SeatSuspension --recording cab_floor.csv --channel acc_z --unit g
      seat-cosim simulate SeatSuspension --replace shaker=Cabin.fmu \\
          --connect "0.001*shaker.z=seat.floor_displacement" --isolate shaker
    """
    file = system_file(file)
    check_run_options(how)
    shown = OutputOptions(how.pop("quiet"), how.pop("as_json"))
    system = System.load(file)
    edit(system, replacements(replace), disconnect, connect)
    system.parameters |= read_parameter_sets(parameter_files, system)
    given = with_user_paths(read_settings(settings, system), system)
    system.parameters |= given
    system.start_time = system.start_time if start_time is None else start_time
    system.stop_time = system.stop_time if stop_time is None else stop_time
    system.step_size = system.step_size if step_size is None else step_size
    floor = read_recording(recording_file, channel, reading)
    shaker = "" if floor is None else shaker_of(system)
    if floor is not None and stop_time is None:
        system.stop_time = (system.start_time or 0.0) + floor.stop_time(system.step_size or SAMPLE_TIME.value)
    system.component_steps |= seconds("--component-step", component_step)
    system.algorithm = algorithm or system.algorithm
    if order:
        if system.algorithm == "jacobi":
            refuse_without_effect(["order"], "--algorithm jacobi", "jacobi steps all components from the same values")
        system.order = names(order)
    system.validate(record=record or None, tolerance=tolerance)
    refuse_idle(given, system, {f"{shaker}.profile": "file"} if shaker else {})
    end = system.clock().stop_time
    notes = [*([] if floor is None else floor.notes), *notes_before(system, {}, stop_time=end)]
    folder = choose_folder(output, Path("results", "simulate", file.stem), command_line(), force=how.pop("force"))
    if floor is not None:
        system.parameters |= play(shaker, folder / RECORDING, given)
        system.validate(record=record or None, tolerance=tolerance)
        floor.write(folder / RECORDING)
    if save:
        system.save(save)
    if shown.prints_text:
        _print_exchange(system)
    with progress_shown(f"running {file.name}") as report:
        options = RunOptions(
            record=record or None,
            tolerance=tolerance,
            progress=lambda time: report(f"{time:.1f} of {end:g} s"),
            **how,
        )
        result = run_to_folder(system, folder, options, command=command_line())
    (folder / OVERVIEW).unlink(missing_ok=True)
    if with_figure:
        from seat_cosim.overview import draw_system  # takes long to load

        draw_system(folder / OVERVIEW, system, result, record)
    if how["real_time"] and shown.prints_text:
        console.print(f"{result.missed_deadlines} deadlines missed, the worst by {result.worst_lateness * 1e3:.1f} ms")
    print_run(simulated(system, folder, result, notes), shown)


def _print_exchange(system: System) -> None:
    """Print the connections with the delay of their values, and the order in which components step."""
    order, jacobi = system.order, system.algorithm == "jacobi"
    table = Table("from", "to", "transformation", "samples late", box=SIMPLE)
    ahead = []
    for sink, edge in system.edges().items():
        connection = system.connections[sink]
        late = delay(edge, order, jacobi)
        factor, offset = connection.transformation
        text = "" if connection.transformation == (1.0, 0.0) else f"{factor:g} x{f' {offset:+g}' if offset else ''}"
        table.add_row(str(connection.source), str(sink), text, f"{late:d}")
        ahead += [f"{connection.source} -> {sink}"] if late < 0 else []
    console.print(table)
    if jacobi:
        console.print("all components exchange their values at once, then step (jacobi)")
    else:
        origin = "" if system.order_is_given else ", proposed from what is sampled and what is continuous"
        console.print(f"components step in the order {', '.join(order)}{origin}", soft_wrap=True)
    for text in ahead:
        console.print(f"note: {text} hands over the value of the step's end: one sample ahead", soft_wrap=True)
