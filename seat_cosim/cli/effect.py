"""Options that have no effect beside others: each is an error that names both."""

from __future__ import annotations

from collections.abc import Iterable

import click
from click.core import ParameterSource

from cosim.errors import SetupError


def is_given(name: str) -> bool:
    """Return whether the user gave an option of the running command, by the name of its argument."""
    context = click.get_current_context()
    return context.get_parameter_source(name) not in (None, ParameterSource.DEFAULT, ParameterSource.DEFAULT_MAP)


def spelling(name: str) -> str:
    """Return an option or argument of the running command as the user spells it, by the name of its argument."""
    context = click.get_current_context()
    found = next(each for each in context.command.params if each.name == name)
    return found.opts[0] if isinstance(found, click.Option) else found.make_metavar(context).strip("[].")


def refuse_without_effect(names: Iterable[str], beside: str, why: str) -> None:
    """Raise an error for options that have no effect.

    Parameters
    ----------
    names
        Names of the arguments of options that have none.
    beside
        What takes their effect, as the user spelled it.
    why
        Why they have none, and what helps.

    Raises
    ------
    SetupError
        With one problem for each of them that the user gave.
    """
    given = [spelling(name) for name in names if is_given(name)]
    if given:
        raise SetupError(*(f"{option} with {beside}: expected one of them, got both; {why}" for option in given))
