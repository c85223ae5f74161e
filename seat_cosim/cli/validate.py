"""``seat-cosim validate``: the conformance suite on any FMU."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click
from rich.box import SIMPLE
from rich.table import Table

from cosim.conformance import TIME_LIMIT
from cosim.errors import SetupError
from seat_cosim.cli.console import console, progress_shown
from seat_cosim.cli.effect import refuse_without_effect

if TYPE_CHECKING:  # the suite is loaded by this command alone
    from cosim.conformance.suite import ValidationReport


@click.command("validate")
@click.argument("files", type=click.Path(path_type=Path), nargs=-1, metavar="FILE.fmu...")
@click.option("--rule", "only", multiple=True, metavar="ID|GROUP", help="Show this rule, or group, alone; repeatable.")
@click.option("--skip", multiple=True, metavar="ID|GROUP", help="Leave this rule, or group, out; repeatable.")
@click.option("--strict", is_flag=True, help="Warnings count as errors.")
@click.option("--json", "target", metavar="FILE", help="Write the outcomes as JSON; - for standard output.")
@click.option("--full", is_flag=True, help="Show all messages of a rule.")
@click.option("--list", "listing", is_flag=True, help="List the rules and end.")
@click.option(
    "--time-limit",
    type=click.FloatRange(min=0.1, max=86400.0),
    default=TIME_LIMIT,
    show_default=True,
    metavar="S",
    help="For each rule that runs the FMU.",
)
def validate_command(
    files: tuple[Path, ...],
    only: tuple[str, ...],
    skip: tuple[str, ...],
    strict: bool,
    target: str | None,
    full: bool,
    listing: bool,
    time_limit: float,
) -> None:
    """Check FMUs for co-simulation (FMI 2.0 and 3.0) against the standard: archive, description, behaviour.

    Each rule that runs the FMU does so in a process of its own: a crash or a hang is a finding. A violation of the
    standard is an error, a deviation from good practice a warning. Exit code 0: no errors; 1: errors (with --strict
    also warnings); 2: wrong use or no such file.

    \b
    Examples:
      seat-cosim validate fmus/fmi3/SeatPlant.fmu
      seat-cosim validate --strict --json report.json *.fmu
      seat-cosim validate --rule lifecycle.reset --rule state.continues Foreign.fmu
      seat-cosim validate --skip lifecycle --skip steps Foreign.fmu
      seat-cosim validate --list
    """
    from cosim.conformance import report
    from cosim.conformance.process import RuleRunner
    from cosim.conformance.suite import validate

    if listing:
        refuse_without_effect(
            ("files", "only", "skip", "strict", "target", "full", "time_limit"), "--list", "it lists the rules and ends"
        )
        console.print(_rules())
        return
    if not files:
        raise click.UsageError("Missing argument 'FILE.fmu...'.")
    if missing := [path for path in files if not path.is_file()]:
        raise SetupError(*(f"{path}: expected an FMU, got no such file" for path in missing))
    if target == "-":
        refuse_without_effect(["full"], "--json -", "no table is printed")
    found = []
    with RuleRunner() as runner, progress_shown("validating") as report_progress:
        for path in files:
            found.append(
                validate(
                    path,
                    only=only,
                    skip=skip,
                    time_limit=time_limit,
                    runner=runner,
                    progress=lambda name, path=path: report_progress(f"{path.name} {name}"),  # type: ignore[misc]
                )
            )
            if target != "-":
                console.print(report.table(found[-1], full))
    _print_summary(found, target)
    if any(f.severity == "error" or strict for one in found for f in one.findings):
        sys.exit(1)


def _print_summary(found: list[ValidationReport], target: str | None) -> None:
    """Write JSON to a file or standard output, where ``target`` is not None, and print a line for each FMU."""
    from cosim.conformance import report

    if target is not None:
        text = json.dumps(report.data(found), indent=2) + "\n"
        if target == "-":
            click.echo(text, nl=False)
            return
        try:
            Path(target).write_text(text, encoding="utf-8")
        except OSError as error:
            raise SetupError(f"--json {target}: expected a file to write to, got: {error.strerror}") from error
    for one in found:
        console.print(report.summary(one), soft_wrap=True)


def _rules() -> Table:
    """Make a table of all rules."""
    from cosim.conformance.suite import load_rules

    table = Table("rule", "severity", "runs the FMU", "what holds", box=SIMPLE)
    for rule in load_rules().values():
        table.add_row(rule.id, rule.severity, "yes" if rule.stage == "behaviour" else "", rule.title)
    return table
