"""``seat-cosim reproduce``: the paper's figures and tables beside its numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
from rich.box import SIMPLE
from rich.table import Table

from cosim.errors import SetupError, writing_to
from cosim.results.result import Result, prepare_folder
from cosim.system import System
from plant_models.parameter_sets import NAMES
from seat_cosim.cli.console import command_line, conclude, console, progress_shown, stderr
from seat_cosim.cli.options import parameter_sets
from seat_cosim.cli.seat_options import flavour_option, fmus_option, gains_of, mass_option
from seat_cosim.scenarios import SCENARIOS, driver_mass, seat_suspension


@click.command()
@click.argument("what", type=click.Choice(["bump"]), required=False)
@mass_option
@flavour_option
@fmus_option
@click.option("--output", type=click.Path(path_type=Path), default=Path("results"), show_default=True, help="Where to.")
def reproduce(what: str | None, driver_mass: float | None, flavour: str, fmus_folder: Path, output: Path) -> None:
    """Reproduce the paper: all its figures and tables beside its numbers, as a page to open in a browser.

    The page is report/index.html in the folder of --output; CSV, PNG and SVG of each figure lie beside it. With bump:
    the simulated bump test alone (Fig. 5-7), with all its results and for any driver.

    \b
    Examples:
      seat-cosim reproduce
      seat-cosim reproduce bump --driver-mass 70
    """
    system = seat_suspension(fmus_folder / flavour)
    if what == "bump":
        _reproduce_bump(system, driver_mass, output)
    elif driver_mass is not None:
        raise SetupError(
            f"--driver-mass {driver_mass:g}: expected with bump only; the paper's drivers weigh 55 and 70 kg"
        )
    else:
        _reproduce_all(system, output / "report")


def _reproduce_all(system: System, folder: Path) -> None:
    """Run all experiments, leave the report, and print what the paper gives numbers for."""
    from seat_controller_fmu import parameters as design
    from seat_cosim.paper import report
    from seat_cosim.paper.experiments import findings
    from seat_cosim.paper.runner import Calibration, Lab

    with writing_to(folder):
        folder.mkdir(parents=True, exist_ok=True)
    calibration = Calibration(**{name: parameter_sets([name], system) for name in NAMES})
    with progress_shown("the paper") as progress, system.open() as session:
        lab = Lab(
            system,
            session,
            calibration,
            recommended=gains_of("recommended"),
            gammas={number: gamma.value for number, gamma in design.OBSERVERS.items()},
            settings={"alpha": design.ALPHA.value, "P_2": design.P_2.value, "lambda": design.LAMBDA.value},
            progress=progress,
        )
        found = findings(lab)
        with writing_to(folder):
            page = report.write(folder, found, progress)
    for text in lab.warnings:
        stderr.print(f"warning: {text}", markup=False, soft_wrap=True)
    for kind, rows in report.summary(found):
        table = Table("", "", "unit", "the paper", "here", title=kind.value, title_justify="left", box=SIMPLE)
        for entry, row in rows:
            table.add_row(entry.number, row.quantity, row.unit, row.paper, row.ours)
        console.print(table)
    console.print(f"page {page}", soft_wrap=True)
    console.print(f"figures and tables {folder}/*.png, *.svg, *.csv", soft_wrap=True)


def _reproduce_bump(system: System, kilograms: float | None, output: Path) -> None:
    """Run the bump test, leave results and figures, print the table."""
    from seat_controller_fmu.parameters import OBSERVERS
    from seat_cosim.paper import bump_test as bump

    mass = system.start("seat.driver_mass") if kilograms is None else kilograms
    folder = output / "bump"
    cases = bump.cases({number: gamma.value for number, gamma in OBSERVERS.items()})
    driver = {} if kilograms is None else driver_mass(kilograms)
    system.validate(SCENARIOS["bump"].stop_time, parameters=driver)
    for name in cases:
        with writing_to(output):
            prepare_folder(folder / name)
    results: dict[str, Result] = {}
    with progress_shown("bump") as report:
        for name, result in bump.run(
            system, cases, mass, folder, lambda name, share: report(f"{name} {share:.0%}"), command_line()
        ):
            conclude(result)
            results[name] = result
        report("figures")
        figures = bump.draw_figures(folder, results, cases, mass)
    _print_bump(bump, results, cases, system.start("controller.force_limit"), mass)
    for path in figures:
        console.print(f"figure {path}")
    console.print(f"results {folder}/<case>/result.csv")


def _print_bump(bump: Any, results: dict[str, Result], cases: dict[str, Any], force_limit: float, mass: float) -> None:
    """Print the table of the bump test, the paper's numbers where it gives any."""
    table = Table(title=f"Bump test, {mass:g} kg driver", title_justify="left", box=SIMPLE)
    table.add_column("")
    table.add_column("unit")
    for case in cases.values():
        table.add_column(case.title, justify="right")
    table.add_column("the paper")
    for measure in bump.measures(force_limit):
        values = [f"{measure.factor * measure.value(result):.2f}" for result in results.values()]
        table.add_row(measure.title, measure.unit, *values, measure.paper)
    console.print(table)
    for note in bump.NOTES:
        console.print(f"- {note}", markup=False)
