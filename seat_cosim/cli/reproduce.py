"""``seat-cosim reproduce``: the paper's figures and tables beside its numbers."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click
from rich.box import SIMPLE
from rich.table import Table

from cosim.errors import SetupError, writing_to
from cosim.results.result import Result
from cosim.system import System
from seat_cosim.cli.console import command_line, console, print_outcome, print_warnings, progress_shown
from seat_cosim.cli.effect import is_given
from seat_cosim.cli.folders import RUN, choose_folder, force_option, lock
from seat_cosim.cli.seat_options import SeatOptions, seat_options
from seat_cosim.paper.contents import CONTENTS, ON_RIG
from seat_cosim.scenarios import OBSERVERS

if TYPE_CHECKING:
    from seat_cosim.paper.bump_test import Case


FIGURES = {
    name: entry.key
    for entry in CONTENTS
    for name in dict.fromkeys((entry.key, re.sub(r"(?<=\D)0+(?=\d)", "", entry.key)))
}
"""Name of a figure or table on the command line, with and without leading zeros, to the key of its entry."""


@click.command()
@click.argument("what", type=click.Choice(["bump", *FIGURES]), required=False, metavar="[bump|fig05|…|table2]")
@seat_options("driver_mass", "observer")
@click.option("--output", type=click.Path(path_type=Path), default=Path("results"), show_default=True, help="Where to.")
@force_option
def reproduce(what: str | None, seat: SeatOptions, output: Path, force: bool) -> None:
    """Reproduce the paper: all its figures and tables beside its numbers, as a page to open in a browser.

    The page is report/index.html in the folder of --output; CSV, PNG and SVG of each figure lie beside it. With a
    figure or table, for example fig8 or table2: that one alone. With bump: the simulated bump test alone (Fig. 5-7),
    with all its results and for any driver. --observer is that of the prototype on the rig, which the paper does not
    state: Fig. 10 to 16 and Table 2.

    \b
    Examples:
      seat-cosim reproduce
      seat-cosim reproduce fig8
      seat-cosim reproduce table2 --observer equal-rate
      seat-cosim reproduce bump --driver-mass 70
    """
    system = seat.system()
    _check_observer(what, seat.observer)
    if what == "bump":
        mass = system.start("seat.driver_mass") if seat.driver_mass is None else seat.driver_mass
        given = output if is_given("output") else None
        folder = choose_folder(
            None if given is None else given.expanduser() / "bump",
            output / "bump",
            command_line(),
            force=force,
            marker=f"uncontrolled/{RUN}",
        )
        _reproduce_bump(system, mass, folder)
    elif seat.driver_mass is not None:
        raise SetupError(
            f"--driver-mass {seat.driver_mass:g}: expected with bump only; the paper's drivers weigh 55 and 70 kg"
        )
    elif what is not None:
        _reproduce_figure(system, FIGURES[what], output.expanduser() / "report", seat.observer)
    else:
        _reproduce_all(system, output.expanduser() / "report", seat.observer)


def _check_observer(what: str | None, observer: str | None) -> None:
    """Refuse an observer where the paper's simulation decides on it, or nothing is controlled."""
    if observer is None or what is None or (what in FIGURES and FIGURES[what] in ON_RIG):
        return
    raise SetupError(f"--observer {observer}: expected with the figures of the rig ({', '.join(ON_RIG)}), got {what}")


def _reproduce_all(system: System, folder: Path, observer: str | None) -> None:
    """Run all experiments, write the report, and print the rows for which the paper prints a number."""
    from seat_cosim.paper import report
    from seat_cosim.paper.experiments import findings
    from seat_cosim.paper.runner import open_runner

    lock(folder)
    with (
        progress_shown("the paper") as progress,
        open_runner(system, progress, observer or OBSERVERS[0]) as runner,
    ):
        found = findings(runner)
        with writing_to(folder):
            page = report.write(folder, found, progress)
    print_warnings(runner.warnings)
    for kind, rows in report.summary(found):
        table = Table("", "", "unit", "the paper", "here", title=kind.value, title_justify="left", box=SIMPLE)
        for entry, row in rows:
            table.add_row(entry.number, row.quantity, row.unit, row.paper, row.ours)
        console.print(table)
    console.print(f"page {page}", soft_wrap=True)
    console.print(f"figures and tables {folder}/*.png, *.svg, *.csv", soft_wrap=True)


def _reproduce_figure(system: System, key: str, folder: Path, observer: str | None) -> None:
    """Run the experiment of one figure or table, write its files, and print its rows."""
    from seat_cosim.paper import report
    from seat_cosim.paper.contents import CONTENTS
    from seat_cosim.paper.experiments import finding
    from seat_cosim.paper.runner import open_runner

    (entry,) = (each for each in CONTENTS if each.key == key)
    lock(folder)
    with (
        progress_shown(entry.number) as progress,
        open_runner(system, progress, observer or OBSERVERS[0]) as runner,
    ):
        found = finding(runner, key)
        with writing_to(folder):
            files = report.write_entry(folder, entry, found)
    print_warnings(runner.warnings)
    table = Table(
        "", "unit", "the paper", "here", "", title=f"{entry.number}: {entry.title}", title_justify="left", box=SIMPLE
    )
    for row in found.rows:
        table.add_row(row.quantity, row.unit, row.paper, row.ours, row.kind.value)
    console.print(table)
    for path in files:
        console.print(str(path), soft_wrap=True)


def _reproduce_bump(system: System, mass: float, folder: Path) -> None:
    """Run the bump test of a driver of a mass in kg, draw the figures, and print the table."""
    from seat_controller_fmu.parameters import OBSERVERS
    from seat_cosim.paper import bump_test

    cases = bump_test.cases({number: gamma.value for number, gamma in OBSERVERS.items()})
    results: dict[str, Result] = {}
    with progress_shown("bump") as report:
        for name, result in bump_test.run(
            system, cases, mass, folder, lambda name, share: report(f"{name} {share:.0%}"), command_line()
        ):
            print_outcome(result)
            results[name] = result
        report("figures")
        figures = bump_test.draw_figures(folder, results, cases, mass)
    _print_bump(results, cases, system.start("controller.force_limit"), mass)
    for path in figures:
        console.print(f"figure {path}")
    console.print(f"results {folder}/<case>/result.csv")


def _print_bump(results: Mapping[str, Result], cases: Mapping[str, Case], force_limit: float, mass: float) -> None:
    """Print the table of the bump test, with the paper's numbers where it prints any."""
    from seat_cosim.paper.bump_test import NOTES, measures

    table = Table(title=f"Bump test, {mass:g} kg driver", title_justify="left", box=SIMPLE)
    table.add_column("")
    table.add_column("unit")
    for case in cases.values():
        table.add_column(case.title, justify="right")
    table.add_column("the paper")
    for measure in measures(force_limit):
        values = [f"{measure.factor * measure.value(result):.2f}" for result in results.values()]
        table.add_row(measure.title, measure.unit, *values, measure.paper)
    console.print(table)
    for note in NOTES:
        console.print(f"- {note}")
