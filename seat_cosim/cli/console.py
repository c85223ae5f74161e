"""Output of commands: tables go to standard output, warnings and progress to standard error."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from cosim.results.result import Result

_PLAIN = {"highlight": False, "markup": False, "emoji": False}
"""Texts are shown as they are: names of variables and messages of FMUs may have brackets and colons."""

console = Console(width=None if sys.stdout is not None and sys.stdout.isatty() else 120, **_PLAIN)  # type: ignore[arg-type]
"""Console of a command's output."""

stderr = Console(stderr=True, **_PLAIN)  # type: ignore[arg-type]
"""Console of warnings and progress."""


@contextmanager
def progress_shown(task: str) -> Iterator[Callable[[str], None]]:
    """Show on a terminal that a task is running.

    Parameters
    ----------
    task
        Name of the task.

    Yields
    ------
    Callable
        Function that shows a text behind the task's name.
    """
    columns = (SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn())
    with Progress(*columns, console=stderr, transient=True, disable=not stderr.is_terminal) as progress:
        number = progress.add_task(task, total=None)
        yield lambda text: progress.update(number, description=f"{task}: {text}")


def command_line() -> list[str]:
    """Return the words of the command line, with the command's name instead of its path."""
    return ["seat-cosim", *sys.argv[1:]]


def print_warnings(texts: Iterable[str]) -> None:
    """Print warnings, a line each."""
    for text in texts:
        stderr.print(f"warning: {text}", soft_wrap=True)


def print_notes(texts: Iterable[str]) -> None:
    """Print notes, a line each; they are no warnings of FMUs and block nothing."""
    for text in texts:
        stderr.print(f"note: {text}", markup=False, soft_wrap=True)


def print_outcome(result: Result) -> None:
    """Print a run's warnings.

    Parameters
    ----------
    result
        Result of the run.

    Raises
    ------
    CosimError
        The run's error, if it did not reach its stop time.
    """
    print_warnings(result.warnings)
    if result.error is not None:
        raise result.error
