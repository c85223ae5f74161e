"""What a command prints at the end of a run: its numbers beside those of the passive seat, notes, the next command."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import reduce
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click
from rich.box import SIMPLE
from rich.table import Table

from cosim.results.result import MANIFEST, Result
from cosim.system import System
from seat_cosim.cli.console import console, print_notes, print_warnings
from seat_cosim.plausibility import explained, notes_after

if TYPE_CHECKING:  # the metrics take long to load
    from seat_cosim.ride_summary import RideSummary

Command = TypeVar("Command", bound=Callable[..., Any])


@dataclass(frozen=True)
class OutputOptions:
    """How much a command prints.

    Attributes
    ----------
    quiet
        Print warnings and errors only.
    as_json
        Print one JSON object instead of tables.
    """

    quiet: bool = False
    as_json: bool = False

    @property
    def prints_text(self) -> bool:
        """Whether tables and sentences are printed."""
        return not (self.quiet or self.as_json)


_OPTIONS = (
    click.option("--quiet", is_flag=True, help="Print warnings and errors only."),
    click.option("--json", "as_json", is_flag=True, help="Print the numbers as one JSON object."),
)


OVERVIEW = "overview.png"
"""Name of a run's figure."""

figure_option = click.option(
    "--figure/--no-figure", "with_figure", default=True, show_default=True, help=f"Draw {OVERVIEW}."
)
"""Gives a command ``with_figure``."""


def output_options(command: Command) -> Command:
    """Give a command ``--quiet`` and ``--json``; it gets ``quiet`` and ``as_json``."""
    return reduce(lambda decorated, option: option(decorated), reversed(_OPTIONS), command)


@dataclass(frozen=True)
class Outcome:
    """A run that has ended.

    Attributes
    ----------
    folder
        Where its files lie.
    result
        Its result.
    warnings
        Warnings of the FMUs, as the user reads them.
    notes
        What is doubtful about it.
    rides
        Title to the numbers of a ride, the run's first; empty for a system without a driver.
    signals
        Rows of :func:`seat_cosim.ride_summary.signal_table`, for such a system.
    next_command
        What a user may want to do next.
    """

    folder: Path
    result: Result
    warnings: list[str]
    notes: list[str]
    rides: Mapping[str, RideSummary] = field(default_factory=dict)
    signals: list[tuple[str, ...]] = field(default_factory=list)
    next_command: str | None = None


def print_run(outcome: Outcome, options: OutputOptions) -> None:
    """Print a run's warnings, notes, numbers, folder and the next command.

    Parameters
    ----------
    outcome
        The run.
    options
        How much to print.
    """
    print_warnings(outcome.warnings)
    if not options.quiet:
        print_notes(outcome.notes)
    if options.as_json:
        click.echo(json.dumps(_data(outcome), indent=2))
    if not options.prints_text:
        return
    if outcome.rides:
        print_rides(outcome.rides)
    elif outcome.signals:
        table = Table("signal", "unit", box=SIMPLE)
        for column in ("smallest", "largest", "RMS"):
            table.add_column(column, justify="right")
        for row in outcome.signals:
            table.add_row(*row)
        console.print(table)
    files = "rows and figure" if (outcome.folder / OVERVIEW).exists() else "rows"
    console.print(f"{len(outcome.result.time)} {files} in {outcome.folder}", soft_wrap=True)
    if outcome.next_command:
        console.print(f"next: {outcome.next_command}", soft_wrap=True, markup=False)


def simulated(system: System, folder: Path, result: Result, notes: Iterable[str]) -> Outcome:
    """Collect the end of a run of any system: a driver's numbers, or the signals that are connected.

    Parameters
    ----------
    system
        The system, with all parameters of the run.
    folder, result
        Folder and result of the run.
    notes
        What was doubtful before it began.

    Returns
    -------
    Outcome
        Of a run that reached its stop time.

    Raises
    ------
    CosimError
        The run's error, if it did not.
    """
    from seat_cosim.ride_summary import evaluated_system, signal_table, summarize

    warnings = explained(result.warnings)
    if result.error is not None:
        print_warnings(warnings)
        raise result.error
    evaluated = evaluated_system(system)
    has_driver = evaluated is not None and evaluated.signals.seat_acceleration in result.values
    sources = dict.fromkeys(str(connection.source) for connection in system.connections.values())
    return Outcome(
        folder,
        result,
        warnings,
        [*notes, *notes_after(result)],
        {"this ride": summarize(evaluated, result)} if evaluated is not None and has_driver else {},
        []
        if has_driver
        else signal_table(result, [name for name in result.values if name in sources] or result.values),
        f"seat-cosim rerun {folder / MANIFEST}",
    )


def print_rides(rides: Mapping[str, RideSummary]) -> None:
    """Print the numbers of rides beside each other; rows without any number are left out.

    Parameters
    ----------
    rides
        Title of a column to its ride.
    """
    from seat_cosim.ride_summary import ROWS

    table = Table("", "unit", box=SIMPLE)
    for title in rides:
        table.add_column(title, justify="right")
    for row in ROWS:
        values = [ride.values[row.key] for ride in rides.values()]
        if any(value is not None for value in values):
            table.add_row(row.title, "" if row.unit == "1" else row.unit, *map(row.text, values))
    if any(ride.comfort for ride in rides.values()):
        table.add_row("comfort by ISO 2631-1", "", *(" or ".join(ride.comfort) or "–" for ride in rides.values()))
    console.print(table)
    if next(iter(rides.values())).shocks:
        console.print("- The ride has shocks, which a_w underestimates: compare VDV (ISO 2631-1, 6.3).")


def _data(outcome: Outcome) -> dict[str, object]:
    """Return the run for ``--json``."""
    return {
        "folder": str(outcome.folder),
        "rows": len(outcome.result.time),
        "complete": outcome.result.complete,
        "warnings": outcome.warnings,
        "notes": outcome.notes,
        "rides": {title: ride.as_json() for title, ride in outcome.rides.items()},
        "signals": [dict(zip(("name", "unit", "min", "max", "rms"), row, strict=True)) for row in outcome.signals],
    }
