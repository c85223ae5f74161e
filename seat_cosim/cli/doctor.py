"""``seat-cosim doctor``: what is installed, what is missing, and what that means."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict

import click
from rich.box import SIMPLE
from rich.table import Table

from seat_cosim.cli.console import console, stderr

_SIGNS = {True: "ok", False: "WRONG", None: "-"}


@click.command()
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of a table.")
@click.option("--clean", is_flag=True, help="Remove what killed runs of this user have left in the temporary folder.")
def doctor(as_json: bool, clean: bool) -> None:
    """Show what is installed and what is missing; a bug report should carry it.

    It lists versions, FMUs and their platforms, the stepping loop, the compiler and optional packages. The exit code
    is 1 if something is in the way of a run.

    \b
    Example:
      seat-cosim doctor
    """
    from cosim.fmi.temporary_folders import remove_leftovers
    from seat_cosim.doctor import facts

    if clean:
        for path in remove_leftovers():
            stderr.print(f"removed {path}", soft_wrap=True)
    found = facts()
    if as_json:
        click.echo(json.dumps([asdict(fact) for fact in found], indent=2))
    else:
        table = Table("", "what", "found", "", box=SIMPLE)
        group = ""
        for fact in found:
            table.add_row(fact.group if fact.group != group else "", fact.name, fact.found, _SIGNS[fact.is_fine])
            group = fact.group
        console.print(table, markup=False)
    if any(fact.is_fine is False for fact in found):
        sys.exit(1)
