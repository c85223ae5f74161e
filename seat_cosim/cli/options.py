"""What commands that run a system have in common: options, and how their words are read."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import reduce
from pathlib import Path
from typing import Any, TypeVar

import click

from cosim.engine.structure import Structure
from cosim.errors import SetupError
from cosim.fmi.archive import is_file
from cosim.fmi.isolated import TIME_LIMIT
from cosim.fmi.values import Value
from cosim.results.formats import FORMATS
from cosim.ssp import read_parameters
from plant_models.parameter_sets import NAMES, path

Command = TypeVar("Command", bound=Callable[..., Any])

_RUN_OPTIONS = (
    click.option(
        "--format", "formats", type=click.Choice(list(FORMATS)), multiple=True, help="Beside CSV; repeatable."
    ),
    click.option("--record-every", type=click.IntRange(min=1), default=1, metavar="N", help="Record every N-th step."),
    click.option("--real-time", is_flag=True, help="Begin no step before its time has come; count missed deadlines."),
    click.option(
        "--isolate", multiple=True, metavar="COMPONENT", help="Run its FMU in a process of its own; repeatable."
    ),
    click.option(
        "--time-limit",
        type=float,
        default=TIME_LIMIT,
        show_default=True,
        metavar="S",
        help="For each call of an isolated FMU.",
    ),
)

set_option = click.option(
    "--set", "settings", multiple=True, metavar="COMPONENT.VARIABLE=VALUE", help="Any parameter; wins."
)

parameters_option = click.option(
    "--parameters",
    "parameter_files",
    multiple=True,
    metavar="FILE.ssv|NAME",
    help=f"Parameters: a file, or a set that comes along ({', '.join(NAMES)}); repeatable, later wins.",
)


def run_options(command: Command) -> Command:
    """Give a command the options of how to run and what to leave on disk."""
    return reduce(lambda decorated, option: option(decorated), reversed(_RUN_OPTIONS), command)


def assignments(option: str, texts: Iterable[str], form: str) -> dict[str, str]:
    """Read words of the form ``NAME=VALUE``.

    Parameters
    ----------
    option
        Whose words, for the message.
    texts
        The words.
    form
        What they should look like, for the message.

    Raises
    ------
    SetupError
        If one has no equals sign, or nothing before it or after it.
    """
    found: dict[str, str] = {}
    for text in texts:
        name, _, value = (part.strip() for part in text.partition("="))
        if not (name and value):
            raise SetupError(f"{option} {text}: expected {form}")
        found[name] = value
    return found


def settings_of(texts: Iterable[str]) -> dict[str, str]:
    """Read the words of ``--set``."""
    return assignments("--set", texts, "COMPONENT.VARIABLE=VALUE")


def parameter_sets(words: Iterable[str], system: Structure) -> dict[str, Value]:
    """Read the words of ``--parameters``: files, or names of sets that come along.

    Raises
    ------
    SetupError
        With all problems of the first file that has any.
    """
    found: dict[str, Value] = {}
    for word in words:
        found |= read_parameters(path(word) if word in NAMES else word, system)
    return found


def seconds(option: str, texts: Iterable[str]) -> dict[str, float]:
    """Read words of the form ``COMPONENT=S``."""
    found = {}
    for name, value in assignments(option, texts, "COMPONENT=S").items():
        try:
            found[name] = float(value)
        except ValueError:
            raise SetupError(f"{option} {name}={value}: expected a number of seconds, got {value}") from None
    return found


def existing(path: Path, what: str) -> Path:
    """Return a path to a file that is there."""
    if not is_file(path):
        raise SetupError(f"{path}: expected {what}, got no such file")
    return path
