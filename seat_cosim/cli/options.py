"""Options of commands that run any system, and functions that read their arguments."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Mapping
from functools import reduce
from typing import Any, TypeVar

import click

from cosim.engine.names import split_assignment
from cosim.engine.structure import Structure
from cosim.errors import SetupError
from cosim.fmi.isolated import TIME_LIMIT
from cosim.results.formats import FORMATS
from plant_models.parameter_sets import NAMES
from seat_cosim.cli.effect import is_given

Command = TypeVar("Command", bound=Callable[..., Any])
T = TypeVar("T")

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

replace_option = click.option(
    "--replace", multiple=True, metavar="COMPONENT=FILE.fmu", help="Put another FMU in a component's place."
)

set_option = click.option(
    "--set", "settings", multiple=True, metavar="COMPONENT.VARIABLE=VALUE", help="Any parameter; wins."
)

parameters_option = click.option(
    "--parameters",
    "parameter_files",
    multiple=True,
    metavar="FILE.ssv|NAME",
    help=f"Parameters: a file, or a set of this project ({', '.join(NAMES)}); repeatable, later wins.",
)


def run_options(command: Command) -> Command:
    """Give a command the options of a run that are fields of :class:`cosim.engine.run_options.RunOptions`."""
    return reduce(lambda decorated, option: option(decorated), reversed(_RUN_OPTIONS), command)


def check_run_options(how: Mapping[str, Any]) -> None:
    """Check that every option of :func:`run_options` has an effect.

    Parameters
    ----------
    how
        The options, by the names of their arguments.

    Raises
    ------
    SetupError
        If a time limit is given without a component that it holds for.
    """
    if not how["isolate"] and is_given("time_limit"):
        raise SetupError(f"--time-limit {how['time_limit']:g}: expected with --isolate COMPONENT, got without")


def assignments(
    option: str, texts: Iterable[str], form: str, is_name: Callable[[str], bool] = lambda name: False
) -> dict[str, str]:
    """Read arguments of the form ``NAME=VALUE``; a name in double quotes may have any characters.

    Parameters
    ----------
    option
        The option, for the message.
    texts
        Its arguments.
    form
        Their form, for the message.
    is_name
        Whether there is something of a name, which may have equals signs.

    Returns
    -------
    dict
        Name to value.

    Raises
    ------
    SetupError
        If one has no equals sign, or nothing before it or after it.

    Examples
    --------
    >>> assignments("--set", ["seat.driver_mass=70"], "COMPONENT.VARIABLE=VALUE")
    {'seat.driver_mass': '70'}
    """
    found: dict[str, str] = {}
    for text in texts:
        name, value = split_assignment(text, is_name)
        if not (name and value):
            raise SetupError(f"{option} {text}: expected {form}")
        found[name] = value
    return found


def settings(texts: Iterable[str], system: Structure) -> dict[str, str]:
    """Read arguments of ``--set``.

    Parameters
    ----------
    texts
        The arguments.
    system
        System whose parameters they set.

    Returns
    -------
    dict
        ``component.variable`` to value.
    """
    return assignments("--set", texts, "COMPONENT.VARIABLE=VALUE, for example seat.driver_mass=80", system.has)


def replacements(texts: Iterable[str]) -> dict[str, str]:
    """Read arguments of ``--replace``; returns component to file."""
    return assignments("--replace", texts, "COMPONENT=FILE.fmu")


def names(text: str) -> list[str]:
    """Read an argument that lists names with commas between; a name in double quotes may have commas.

    Examples
    --------
    >>> names('shaker, "seat, left"')
    ['shaker', 'seat, left']
    """
    (row,) = csv.reader([text], skipinitialspace=True)
    return [name.strip() for name in row]


def seconds(option: str, texts: Iterable[str]) -> dict[str, float]:
    """Read arguments of the form ``COMPONENT=S``.

    Parameters
    ----------
    option
        The option, for the message.
    texts
        Its arguments.

    Returns
    -------
    dict
        Component to seconds.

    Raises
    ------
    SetupError
        If one has another form.
    """
    found = {}
    for name, value in assignments(option, texts, "COMPONENT=S").items():
        try:
            found[name] = float(value)
        except ValueError:
            raise SetupError(f"{option} {name}={value}: expected a number of seconds, got {value}") from None
    return found


def listed(option: str, text: str, kind: Callable[[str], T], what: str) -> tuple[T, ...]:
    """Read an argument that lists values with commas between.

    Parameters
    ----------
    option
        The option, for the message.
    text
        Its argument.
    kind
        Converts one value; raises :class:`ValueError` if that is not possible.
    what
        What the values are, for the message.

    Raises
    ------
    SetupError
        If a value cannot be converted.

    Examples
    --------
    >>> listed("--masses", "55,100", float, "numbers")
    (55.0, 100.0)
    """
    try:
        return tuple(kind(word.strip()) for word in text.split(",") if word.strip())
    except ValueError:
        raise SetupError(f"{option} {text}: expected {what} with commas between") from None
