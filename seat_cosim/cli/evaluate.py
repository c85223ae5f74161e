"""``seat-cosim evaluate``: SEAT and its relatives over excitation classes and drivers, against a passive seat."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click
from rich.box import SIMPLE
from rich.table import Table

from cosim.engine.editing import edit
from cosim.errors import SetupError, writing_to
from cosim.system import System
from seat_cosim.cli.console import command_line, console, progress_shown, stderr
from seat_cosim.cli.options import assignments, parameter_sets, parameters_option, set_option, settings_of
from seat_cosim.cli.seat_options import (
    control_option,
    flavour_option,
    fmus_option,
    gains_of,
    gains_option,
    observer_of,
    observer_option,
)
from seat_cosim.evaluation.seat import passive_seat, ports
from seat_cosim.evaluation.system import EvaluatedSystem
from seat_cosim.scenarios import control, seat_suspension

if TYPE_CHECKING:
    from seat_cosim.evaluation.evaluation import Evaluation, Protocol

T = TypeVar("T")

_PORTS = ports()

_LIMITS = "The SEAT limits are those of ISO 7096 as recalled: check them in the standard before relying on them."
_MODEL = "Everything is computed by co-simulation; no person and no seat was measured."
_PASSIVE = (
    "The passive seat is not the paper's, of which nothing is published: its damping is fitted on one of its numbers, "
    "its friction is assumed; docs/explanation/calibration.md tells how."
)
_NAMED = {"gains": "gains", "Observer": "number", "control": "switch"}
"""What a system's title says of the choices: word to option."""


@click.command()
@click.argument("file", type=click.Path(path_type=Path), required=False, metavar="[FILE.ssp]")
@click.option("--classes", metavar="EM1,EM3", help="Of ISO 7096 [default: all nine].")
@click.option("--masses", metavar="KG,KG", help="Drivers [default: 45,55,70,80,100,120].")
@click.option("--seeds", metavar="N,N", help="A run each [default: 1,2,3].")
@click.option("--duration", type=float, metavar="S", help="Evaluated of each run [default: 180].")
@click.option("--settle", type=float, metavar="S", help="Left out before it [default: 10].")
@gains_option
@observer_option
@control_option
@click.option("--replace", multiple=True, metavar="COMPONENT=FILE.fmu", help="Put another FMU in a component's place.")
@parameters_option
@set_option
@click.option("--seat-signal", metavar="A.x", help=f"Acceleration where the driver sits [default: {_PORTS.seat}].")
@click.option("--floor-signal", metavar="A.x", help=f"Acceleration of the floor [default: {_PORTS.floor}].")
@click.option("--deflection-signal", metavar="A.x", help=f"[default: {_PORTS.deflection}, if there]")
@click.option("--force-signal", metavar="A.x", help=f"[default: {_PORTS.force}, if there]")
@click.option(
    "--driver-mass-parameter",
    "mass_parameters",
    multiple=True,
    metavar="A.x",
    help=f"Takes the driver's mass; repeatable [default: {' and '.join(_PORTS.driver_mass)}, if there].",
)
@click.option("--shaker", metavar="COMPONENT", default="shaker", show_default=True, help="Which is our Shaker.")
@click.option(
    "--travel-parameter", metavar="A.x", help=f"Travel to the end stops [default: {_PORTS.travel}, if there]."
)
@click.option(
    "--passive", metavar="FILE.ssv|NAME", default="passive", show_default=True, help="What makes the passive seat."
)
@click.option("--processes", type=click.IntRange(min=1), metavar="N", help="[default: one for each core]")
@flavour_option
@fmus_option
@click.option("--output", type=click.Path(path_type=Path), help="Where to [default: results/evaluate/NAME].")
def evaluate(
    file: Path | None,
    seat_signal: str | None,
    floor_signal: str | None,
    deflection_signal: str | None,
    force_signal: str | None,
    mass_parameters: tuple[str, ...],
    shaker: str,
    travel_parameter: str | None,
    passive: str,
    processes: int | None,
    flavour: str,
    fmus_folder: Path,
    output: Path | None,
    **choices: Any,
) -> None:
    """Judge a seat by ISO 7096 and ISO 2631-1: SEAT, VDV, stroke, force over machines and drivers.

    Without FILE.ssp it is the seat suspension; any other system will do whose shaker is ours, with the names of its
    signals. The passive seat rides along. Leaves a page (evaluation.html), a table (evaluation.csv), a figure
    (seat.svg, seat.png) and the system as it was evaluated (system.ssp).

    \b
    Examples:
      seat-cosim evaluate
      seat-cosim evaluate --observer 2 --classes EM1,EM3 --masses 55,100
      seat-cosim evaluate --replace controller=Skyhook.fmu
      seat-cosim evaluate Chair.ssp --seat-signal chair.acc --driver-mass-parameter chair.load
    """
    from seat_cosim.evaluation.evaluation import check
    from seat_cosim.evaluation.evaluation import evaluate as evaluate_all
    from seat_cosim.evaluation.report import verdict, write

    names = {
        "seat": seat_signal,
        "floor": floor_signal,
        "deflection": deflection_signal,
        "force": force_signal,
        "driver_mass": mass_parameters,
        "travel": travel_parameter,
    }
    protocol = _protocol(choices)
    seats = fmus_folder / flavour
    system = System.load(file) if file else seat_suspension(seats)
    _change(system, choices)
    found = ports(shaker).found_in(system, {name: text for name, text in names.items() if text})
    reference = seat_suspension(seats)
    subjects = [
        EvaluatedSystem(_title(system, choices), system, found),
        passive_seat(reference, parameter_sets([passive], reference)),
    ]
    for subject in subjects:
        check(subject, protocol)
    folder = output or Path("results", "evaluate", file.stem if file else system.name)
    with writing_to(folder):
        folder.mkdir(parents=True, exist_ok=True)
    with progress_shown("evaluating") as report:
        evaluations = evaluate_all(
            subjects,
            protocol,
            processes or os.cpu_count() or 1,
            lambda done, of: report(f"{done} of {of} classes"),
        )
        report("page")
        notes = [_MODEL, _LIMITS, *([_PASSIVE] if passive == "passive" else [])]
        files = write(folder, evaluations, protocol, command_line(), notes)
    for evaluation in evaluations:
        _print(evaluation, protocol)
    for text in evaluations[0].warnings:
        stderr.print(f"warning: {text}", markup=False, soft_wrap=True)
    console.print(f"{verdict(evaluations[0])}.")
    for note in notes:
        console.print(f"- {note}", markup=False)
    console.print(f"{', '.join(path.name for path in files)} in {folder}", soft_wrap=True)


def _protocol(choices: dict[str, Any]) -> Protocol:
    """Read classes, masses, seeds and times."""
    from seat_cosim.evaluation.evaluation import Protocol

    given: dict[str, Any] = {name: choices[name] for name in ("duration", "settle") if choices[name] is not None}
    for name, kind, what in (("classes", str, "names"), ("masses", float, "numbers"), ("seeds", int, "whole numbers")):
        if choices[name] is not None:
            given[name] = _listed(f"--{name}", choices[name], kind, what)
    return Protocol(**given)


def _listed(option: str, text: str, kind: Callable[[str], T], what: str) -> tuple[T, ...]:
    """Read words with commas between."""
    try:
        return tuple(kind(word.strip()) for word in text.split(",") if word.strip())
    except ValueError:
        raise SetupError(f"{option} {text}: expected {what} with commas between") from None


def _change(system: System, choices: dict[str, Any]) -> None:
    """Put in other FMUs and give parameters, later ones over earlier."""
    edit(system, assignments("--replace", choices["replace"], "COMPONENT=FILE.fmu"), (), ())
    system.parameters |= parameter_sets(choices["parameter_files"], system)
    system.parameters |= gains_of(choices["gains"]) if choices["gains"] else {}
    system.parameters |= observer_of(int(choices["number"])) if choices["number"] else {}
    system.parameters |= control(choices["switch"] == "on") if choices["switch"] else {}
    system.parameters |= parameter_sets(["passive"], system) if choices["switch"] == "passive" else {}
    system.parameters |= settings_of(choices["settings"])
    system.check_parameters({})


def _title(system: System, choices: dict[str, Any]) -> str:
    """Name a system by what was changed of it."""
    words = [f"{name} {choices[key]}" for name, key in _NAMED.items() if choices[key]]
    words += [Path(text).stem for text in choices["parameter_files"]]
    words += [Path(text.partition("=")[2].strip()).stem for text in choices["replace"]]
    return ", ".join([system.name, *words])


def _print(evaluation: Evaluation, protocol: Protocol) -> None:
    """Print the SEAT of all rides, those above the limit marked, and the largest of the other numbers."""
    from seat_cosim.evaluation.evaluation import COLUMNS
    from seat_cosim.evaluation.report import limit, shown, too_high

    table = Table("SEAT", title=evaluation.subject.title, title_justify="left", box=SIMPLE)
    for kind in protocol.classes:
        table.add_column(kind, justify="right")
    table.add_row("limit", *("–" if limit(kind) is None else f"{limit(kind):.1f}" for kind in protocol.classes))
    for mass in protocol.masses:
        cells = {kind: evaluation.cells[kind, mass] for kind in protocol.classes}
        marks = (f"{cell.seat:.2f}{'!' if too_high(kind, cell) else ''}" for kind, cell in cells.items())
        table.add_row(f"{mass:g} kg", *marks)
    table.add_section()
    for column in COLUMNS[1:]:
        worst = (
            max((evaluation.cells[kind, mass] for mass in protocol.masses), key=lambda cell: column.number(cell) or 0.0)
            for kind in protocol.classes
        )
        unit = "" if column.unit == "1" else f", {column.unit}"
        table.add_row(f"worst {column.title}{unit}", *(shown(column, cell) for cell in worst))
    console.print(table)
