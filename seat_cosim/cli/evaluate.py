"""``seat-cosim evaluate``: SEAT and other metrics over excitation classes and drivers, against a passive seat."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from rich.box import SIMPLE
from rich.table import Table

from cosim.engine.editing import edit
from cosim.errors import SetupError
from cosim.system import System
from seat_cosim import carried
from seat_cosim.cli.console import command_line, console, print_warnings, progress_shown
from seat_cosim.cli.folders import EVALUATION, choose_folder, force_option
from seat_cosim.cli.options import listed, replace_option, replacements, settings
from seat_cosim.cli.seat_options import SeatOptions, seat_options
from seat_cosim.evaluation.installation import Installation
from seat_cosim.evaluation.seat import (
    PASSIVE_NOTE,
    SIGNALS,
    common_parameters,
    installed,
    passive_seat,
    seat_signals,
    semi_active_seat,
)
from seat_cosim.evaluation.system import EvaluatedSystem, Road
from seat_cosim.idle_parameters import refuse_idle
from seat_cosim.plausibility import explained
from seat_cosim.scenarios import SHAKER, TRUCK, read_parameter_sets, seat_block

if TYPE_CHECKING:  # the metrics take long to load
    from seat_cosim.evaluation.protocol import Protocol
    from seat_cosim.evaluation.results import Evaluation
    from seat_cosim.evaluation.verdict import SeatVerdict

_DEFAULT = seat_signals()


@click.command()
@click.argument("file", type=click.Path(path_type=Path), required=False, metavar="[FILE.ssp|NAME]")
@click.option(
    "--protocol",
    type=click.Choice(["iso7096", "survey"]),
    default="survey",
    show_default=True,
    help="Two persons on one repeated input and a damping test, or many drivers on several inputs.",
)
@click.option(
    "--travel",
    metavar="MM|none",
    help="Of the test, each way, with rubber end stops; for both seats [default: 40].",
)
@click.option(
    "--profile",
    type=click.Choice(["machines", "roads"]),
    default="machines",
    show_default=True,
    help="Floors of the standards' machines, or the cab of a truck on roads of ISO 8608.",
)
@click.option(
    "--classes",
    metavar="EM1,EM3",
    help="Of ISO 7096, EN 13490, ISO 5007 [default: EM1 to EM9]; roads: class and km/h [default: A30 to E90].",
)
@click.option("--masses", metavar="KG,KG", help="Drivers [default: 45,55,70,80,100,120; iso7096: 55,100].")
@click.option("--seeds", metavar="N,N", help="A run each [default: three that conform; iso7096: one].")
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
@click.option(
    "--shaker", metavar="COMPONENT", help="Which is our Shaker, or TruckCab on roads [default: shaker; roads: truck]."
)
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
    travel: str | None,
    seat_signal: str | None,
    floor_signal: str | None,
    deflection_signal: str | None,
    force_signal: str | None,
    mass_parameters: tuple[str, ...],
    profile: str,
    shaker: str | None,
    travel_parameter: str | None,
    passive: str,
    processes: int | None,
    output: Path | None,
    force: bool,
    **given: Any,
) -> None:
    """Evaluate a seat by ISO 7096 and ISO 2631-1: a verdict of named criteria over machines and drivers.

    Without FILE.ssp the seat suspension is evaluated, otherwise any system that has our Shaker, by the names of its
    signals; the passive seat is evaluated beside it, with the same floor, driver, travel and end stops. Writes a page
    (evaluation.html), tables (evaluation.csv, evaluation.json), figures (seat.svg, seat.png, inputs.svg) and the system
    as it was evaluated (system.ssp).

    \b
    Examples:
      seat-cosim evaluate
      seat-cosim evaluate --protocol iso7096
      seat-cosim evaluate --travel none --observer 2 --classes EM1,EM3 --masses 55,100
      seat-cosim evaluate --mode robust --set seat.actuator.time_constant=0.005
      seat-cosim evaluate --replace controller=Skyhook.fmu
      seat-cosim evaluate --profile roads --classes C60,D30 --masses 55,100
      seat-cosim evaluate Chair.ssp --seat-signal chair.acc --driver-mass-parameter chair.load
    """
    from seat_cosim.evaluation.evaluate_to_folder import evaluate_to_folder
    from seat_cosim.evaluation.verdict import LIMITS_NOTE, MODEL_NOTE, judge_all, protocol_notes

    names = {
        "seat_acceleration": seat_signal,
        "floor_acceleration": floor_signal,
        "suspension_deflection": deflection_signal,
        "actuator_force": force_signal,
        "driver_mass": mass_parameters,
        "end_stop_travel": travel_parameter,
    }
    floor = TRUCK if profile == "roads" else SHAKER
    protocol = _protocol(floor, **given)
    installation = Installation.of(travel) if travel else Installation()
    file = carried.system_file(file) if file else None
    system = System.load(file) if file else seat.system(floor)
    edit(system, replacements(replace), (), ())
    fixture = installed(system, installation)
    before = system.parameters | fixture if travel else fixture | system.parameters
    system.parameters |= before | seat.parameters(system, before)
    system.check_parameters({})
    component = shaker or floor
    ours = SIGNALS[floor](component)
    refuse_idle(
        settings(seat.settings, system),
        system,
        {name: value for name, value in ours.excitation.items() if system.has(name)},
    )
    signals = ours.for_system(system, {name: value for name, value in names.items() if value})
    reference = seat.system(floor)
    common = installed(reference, installation) | common_parameters(system, component, floor)
    systems = [
        EvaluatedSystem(_title(system, seat, replace), system, signals, installation.travel),
        passive_seat(
            reference,
            read_parameter_sets([passive], reference),
            common,
            _measured(names, reference),
            SIGNALS[floor](),
        ),
    ]
    if floor == TRUCK:
        block = seat_block(carried.fmu_folder(seat.flavour, seat.fmus_folder), "SemiActiveSeat", floor)
        systems.insert(1, semi_active_seat(block, common, floor))
    default = Path("results", "evaluate", file.stem if file else system.name)
    folder = choose_folder(output, default, command_line(), force=force, marker=EVALUATION)
    notes = [f"Installation of both seats: {_words(installation, systems)}.", *protocol_notes(protocol)]
    notes += [MODEL_NOTE, LIMITS_NOTE, *([PASSIVE_NOTE] if passive == "passive" else [])]
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
    verdicts = judge_all(evaluations, protocol)
    for evaluation, verdict in zip(evaluations, verdicts, strict=True):
        console.print(_table(evaluation, verdict, protocol))
    console.print(_criteria(verdicts[0], evaluations[0].evaluated.title))
    print_warnings(explained(evaluations[0].warnings, seat.gains))
    for evaluation, verdict in zip(evaluations[1:], verdicts[1:], strict=True):
        console.print(f"{evaluation.evaluated.title}: {verdict.sentence}.")
    console.print(f"{verdicts[0].sentence}.")
    for note in notes:
        console.print(f"- {note}")
    console.print(f"{', '.join(path.name for path in files)} in {folder}", soft_wrap=True)


def _protocol(floor: str, protocol: str, **given: Any) -> Protocol:
    """Make the protocol of the options that are given."""
    from seat_cosim.evaluation.protocol import ISO_7096, PROTOCOLS, ROAD_CLASSES

    for name, kind, what in (("classes", str, "names"), ("masses", float, "numbers"), ("seeds", int, "whole numbers")):
        if given[name] is not None:
            given[name] = listed(f"--{name}", given[name], kind, what)
            if not given[name]:
                raise SetupError(f"{name}: expected each once, got none")
    if floor == TRUCK:
        if protocol == ISO_7096:
            raise SetupError(f"--protocol {protocol} with --profile roads: expected one of them, got both")
        given["classes"] = tuple(str(Road.of(name)) for name in given["classes"] or ROAD_CLASSES)
    return PROTOCOLS[protocol](**{name: value for name, value in given.items() if value is not None})


def _measured(names: dict[str, Any], reference: System) -> dict[str, str]:
    """Return where the accelerations of the test are measured, if the passive seat has these outputs."""
    places = {name: names[name] for name in ("seat_acceleration", "floor_acceleration")}
    outputs = reference.outputs()
    return {name: place for name, place in places.items() if place and place in outputs}


def _words(installation: Installation, systems: list[EvaluatedSystem]) -> str:
    """Return the installation as words; that of the seats, where parameters changed it."""
    travels = {each.end_stop_travel for each in systems}
    if travels == {installation.travel}:
        return installation.words
    listed_travels = ", ".join("none" if each is None else f"{1e3 * each:g} mm" for each in travels)
    return f"travel each way, by parameters: {listed_travels}"


def _title(system: System, seat: SeatOptions, replace: tuple[str, ...]) -> str:
    """Return a title: the system's name, and what the options change."""
    files = (text.partition("=")[2].strip() for text in replace)
    return ", ".join([system.name, *seat.choices, *(Path(file).stem for file in files)])


def _table(evaluation: Evaluation, verdict: SeatVerdict, protocol: Protocol) -> Table:
    """Make a table of all SEAT, those of combinations that fail marked, and of the largest other metrics."""
    from seat_cosim.evaluation.criteria import Outcome
    from seat_cosim.evaluation.inputs import INPUTS
    from seat_cosim.evaluation.results import TABLE_METRICS

    results = evaluation.results
    title = f"{evaluation.evaluated.title} (!: fails a criterion)"
    table = Table("SEAT", title=title, title_justify="left", box=SIMPLE)
    for name in protocol.classes:
        table.add_column(name, justify="right")
    limits = [INPUTS[name].seat_limit if name in INPUTS else None for name in protocol.classes]
    table.add_row("limit", *("–" if limit is None else f"{limit:.1f}" for limit in limits))
    marks = {key: "!" if cell.outcome is Outcome.FAIL else "" for key, cell in verdict.cells.items()}
    for mass in protocol.masses:
        row = [(name, mass) for name in protocol.classes]
        table.add_row(f"{mass:g} kg", *(f"{results[key].seat:.2f}{marks[key]}" for key in row))
    table.add_section()
    for metric in TABLE_METRICS[1:]:
        worst = (
            max((results[name, mass] for mass in protocol.masses), key=lambda result: abs(metric.number(result) or 0.0))
            for name in protocol.classes
        )
        unit = f", {metric.unit_shown}" if metric.unit_shown else ""
        table.add_row(f"worst {metric.title}{unit}", *(metric.text(result) for result in worst))
    return table


def _criteria(verdict: SeatVerdict, title: str) -> Table:
    """Make a table of the criteria with their worst values."""
    from seat_cosim.evaluation.criteria import Outcome

    table = Table("criterion", title=f"Criteria: {title}", title_justify="left", box=SIMPLE)
    for name in ("worst", "limit", "where", "failed", "verdict"):
        table.add_column(name, justify="right")
    for each in verdict.criteria:
        criterion, worst = each.criterion, each.worst
        failed = f"{each.counts[Outcome.FAIL]} of {len(verdict.cells)}"
        numbers = (criterion.text(worst.value), criterion.text(worst.limit))
        table.add_row(criterion.words, *numbers, each.place, failed, str(worst.outcome))
    return table
