"""``seat-cosim evaluate``: SEAT and other metrics over excitation classes and drivers, against a passive seat."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from rich.box import SIMPLE
from rich.table import Table

from cosim.engine.editing import edit
from cosim.system import System
from seat_cosim.carried import system_file
from seat_cosim.cli.console import command_line, console, print_warnings, progress_shown
from seat_cosim.cli.folders import EVALUATION, choose_folder, force_option, write_command
from seat_cosim.cli.options import listed, replace_option, replacements, settings
from seat_cosim.cli.seat_options import SeatOptions, seat_options
from seat_cosim.evaluation.seat import PASSIVE_NOTE, passive_seat, seat_signals
from seat_cosim.evaluation.system import EvaluatedSystem
from seat_cosim.idle_parameters import refuse_idle
from seat_cosim.plausibility import explained
from seat_cosim.scenarios import read_parameter_sets

if TYPE_CHECKING:  # the metrics take long to load
    from seat_cosim.evaluation.protocol import Protocol
    from seat_cosim.evaluation.results import Evaluation

_DEFAULT = seat_signals()


@click.command()
@click.argument("file", type=click.Path(path_type=Path), required=False, metavar="[FILE.ssp|NAME]")
@click.option("--classes", metavar="EM1,EM3", help="Of ISO 7096 [default: all nine].")
@click.option("--masses", metavar="KG,KG", help="Drivers [default: 45,55,70,80,100,120].")
@click.option("--seeds", metavar="N,N", help="A run each [default: 1,2,3].")
@click.option("--duration", type=float, metavar="S", help="Evaluated of each run [default: 180].")
@click.option("--settle", "--warm-up", "warm_up", type=float, metavar="S", help="Left out before it [default: 10].")
@seat_options("mode", "gains", "observer", "control", "parameter_files", "settings")
@replace_option
@click.option(
    "--seat-signal",
    metavar="A.x",
    help=f"Acceleration where the driver sits [default: {_DEFAULT.seat_acceleration}].",
)
@click.option(
    "--floor-signal", metavar="A.x", help=f"Acceleration of the floor [default: {_DEFAULT.floor_acceleration}]."
)
@click.option("--deflection-signal", metavar="A.x", help=f"[default: {_DEFAULT.suspension_deflection}, if there]")
@click.option("--force-signal", metavar="A.x", help=f"[default: {_DEFAULT.actuator_force}, if there]")
@click.option(
    "--driver-mass-parameter",
    "mass_parameters",
    multiple=True,
    metavar="A.x",
    help=f"Takes the driver's mass; repeatable [default: {' and '.join(_DEFAULT.driver_mass)}, if there].",
)
@click.option("--shaker", metavar="COMPONENT", default="shaker", show_default=True, help="Which is our Shaker.")
@click.option(
    "--travel-parameter",
    metavar="A.x",
    help=f"Travel to the end stops [default: {_DEFAULT.end_stop_travel}, if there].",
)
@click.option(
    "--passive", metavar="FILE.ssv|NAME", default="passive", show_default=True, help="What makes the passive seat."
)
@click.option("--processes", type=click.IntRange(min=1), metavar="N", help="[default: one for each core]")
@click.option("--output", type=click.Path(path_type=Path), help="Where to [default: results/evaluate/NAME].")
@force_option
def evaluate(
    file: Path | None,
    seat: SeatOptions,
    replace: tuple[str, ...],
    seat_signal: str | None,
    floor_signal: str | None,
    deflection_signal: str | None,
    force_signal: str | None,
    mass_parameters: tuple[str, ...],
    shaker: str,
    travel_parameter: str | None,
    passive: str,
    processes: int | None,
    output: Path | None,
    force: bool,
    **given: Any,
) -> None:
    """Evaluate a seat by ISO 7096 and ISO 2631-1: SEAT, VDV, stroke, force over machines and drivers.

    Without FILE.ssp the seat suspension is evaluated, otherwise any system that has our Shaker, by the names of its
    signals; the passive seat is evaluated beside it. Writes a page (evaluation.html), a table (evaluation.csv), a
    figure (seat.svg, seat.png) and the system as it was evaluated (system.ssp).

    \b
    Examples:
      seat-cosim evaluate
      seat-cosim evaluate --observer 2 --classes EM1,EM3 --masses 55,100
      seat-cosim evaluate --mode robust --set seat.actuator.time_constant=0.005
      seat-cosim evaluate --replace controller=Skyhook.fmu
      seat-cosim evaluate Chair.ssp --seat-signal chair.acc --driver-mass-parameter chair.load
    """
    from seat_cosim.evaluation.evaluate_to_folder import evaluate_to_folder
    from seat_cosim.evaluation.verdict import LIMITS_NOTE, MODEL_NOTE, verdict

    names = {
        "seat_acceleration": seat_signal,
        "floor_acceleration": floor_signal,
        "suspension_deflection": deflection_signal,
        "actuator_force": force_signal,
        "driver_mass": mass_parameters,
        "end_stop_travel": travel_parameter,
    }
    protocol = _protocol(**given)
    file = system_file(file) if file else None
    system = System.load(file) if file else seat.system()
    edit(system, replacements(replace), (), ())
    system.parameters |= seat.parameters(system)
    system.check_parameters({})
    refuse_idle(
        settings(seat.settings, system),
        system,
        {f"{shaker}.profile": "random"} if system.has(f"{shaker}.profile") else {},
    )
    signals = seat_signals(shaker).for_system(system, {name: value for name, value in names.items() if value})
    reference = seat.system()
    systems = [
        EvaluatedSystem(_title(system, seat, replace), system, signals),
        passive_seat(reference, read_parameter_sets([passive], reference)),
    ]
    default = Path("results", "evaluate", file.stem if file else system.name)
    folder = choose_folder(output, default, command_line(), force=force, marker=EVALUATION)
    notes = [MODEL_NOTE, LIMITS_NOTE, *([PASSIVE_NOTE] if passive == "passive" else [])]
    with progress_shown("evaluating") as report:
        evaluations, files = evaluate_to_folder(
            systems,
            protocol,
            folder,
            processes=processes or os.cpu_count() or 1,
            progress=report,
            command=command_line(),
            notes=notes,
        )
    write_command(folder / EVALUATION, command_line())
    for evaluation in evaluations:
        console.print(_table(evaluation, protocol))
    print_warnings(explained(evaluations[0].warnings, seat.gains))
    console.print(f"{verdict(evaluations[0])}.")
    for note in notes:
        console.print(f"- {note}")
    console.print(f"{', '.join(path.name for path in files)} in {folder}", soft_wrap=True)


def _protocol(**given: Any) -> Protocol:
    """Make the protocol of the options that are given."""
    from seat_cosim.evaluation.protocol import Protocol

    for name, kind, what in (("classes", str, "names"), ("masses", float, "numbers"), ("seeds", int, "whole numbers")):
        if given[name] is not None:
            given[name] = listed(f"--{name}", given[name], kind, what)
    return Protocol(**{name: value for name, value in given.items() if value is not None})


def _title(system: System, seat: SeatOptions, replace: tuple[str, ...]) -> str:
    """Return a title: the system's name, and what the options change."""
    files = (text.partition("=")[2].strip() for text in replace)
    return ", ".join([system.name, *seat.choices, *(Path(file).stem for file in files)])


def _table(evaluation: Evaluation, protocol: Protocol) -> Table:
    """Make a table of all SEAT, those above the limit marked, and of the largest other metrics."""
    from seat_cosim.evaluation.protocol import seat_limit
    from seat_cosim.evaluation.results import METRICS
    from seat_cosim.evaluation.verdict import exceeds_limit

    results = evaluation.results
    table = Table("SEAT", title=evaluation.evaluated.title, title_justify="left", box=SIMPLE)
    for name in protocol.classes:
        table.add_column(name, justify="right")
    limits = [seat_limit(name) for name in protocol.classes]
    table.add_row("limit", *("–" if limit is None else f"{limit:.1f}" for limit in limits))
    for mass in protocol.masses:
        row = [(name, results[name, mass]) for name in protocol.classes]
        table.add_row(
            f"{mass:g} kg", *(f"{result.seat:.2f}{'!' if exceeds_limit(name, result) else ''}" for name, result in row)
        )
    table.add_section()
    for metric in METRICS[1:]:
        worst = (
            max((results[name, mass] for mass in protocol.masses), key=lambda result: metric.number(result) or 0.0)
            for name in protocol.classes
        )
        unit = f", {metric.unit_shown}" if metric.unit_shown else ""
        table.add_row(f"worst {metric.title}{unit}", *(metric.text(result) for result in worst))
    return table
