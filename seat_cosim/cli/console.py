"""Where commands print: tables to standard output, progress to a terminal's standard error."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from cosim.results.result import Result

console = Console(highlight=False, width=None if sys.stdout.isatty() else 120)
"""For what a command has to say."""

stderr = Console(stderr=True, highlight=False)
"""For warnings and progress."""


@contextmanager
def progress_shown(what: str) -> Iterator[Callable[[str], None]]:
    """Show on a terminal that something goes on; yields a function that changes the words."""
    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    with Progress(*columns, console=stderr, transient=True, disable=not stderr.is_terminal) as progress:
        task = progress.add_task(what, total=None)
        yield lambda text: progress.update(task, description=f"{what}: {text}")


def command_line() -> list[str]:
    """Return what was typed, word by word, by the command's name rather than its path."""
    return ["seat-cosim", *sys.argv[1:]]


def conclude(result: Result) -> None:
    """Print a run's warnings; an incomplete one ends the command with its error."""
    for text in result.warnings:
        stderr.print(f"warning: {text}", markup=False, soft_wrap=True)
    if result.error is not None:
        raise result.error
