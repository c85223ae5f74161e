"""Choices by which the seat suspension is varied, and the parameters that they stand for, in their order."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from cosim.engine.structure import Structure
from cosim.errors import SetupError, did_you_mean
from cosim.fmi.values import Value
from seat_cosim import scenarios

CONTROL = ("on", "off", "passive")
"""The controller on or off; passive: off, in the well-tuned passive seat."""

MODES = ("published", "robust")

ORDER = ("parameter_sets", "gains", "observer", "control", "driver_mass")
"""Names of the choices; parameters of later ones win. The mode comes last, as it depends on the seat's parameters."""

Read = Callable[[str, Any, Structure], Mapping[str, Value]]
"""Returns the parameters of a choice, see :func:`choice`."""


def choice(name: str, value: Any, system: Structure) -> dict[str, Value]:
    """Return the parameters of a choice.

    Parameters
    ----------
    name
        One of :data:`ORDER`.
    value
        Names or files of parameter sets, of which later ones win, a preset or file of gains, one of
        :data:`seat_cosim.scenarios.OBSERVERS`, one of :data:`CONTROL`, or the driver's mass in kg.
    system
        System whose parameters they are.

    Raises
    ------
    SetupError
        If there is no such set, gains, observer or control.
    """
    if name == "parameter_sets":
        return scenarios.read_parameter_sets(_names(value), system)
    if name == "gains":
        return scenarios.gains(value)
    if name == "observer":
        return scenarios.named_observer(_one_of(name, value, scenarios.OBSERVERS))
    if name == "driver_mass":
        return scenarios.driver_mass(value)
    found = scenarios.control(_one_of(name, value, CONTROL) == "on")
    return found | scenarios.read_parameter_sets(["passive"], system) if value == "passive" else found


def _names(value: str | Iterable[str]) -> list[str]:
    """Return the names of parameter sets; a text has commas between them."""
    return [name.strip() for name in value.split(",") if name.strip()] if isinstance(value, str) else list(value)


def _one_of(name: str, value: Any, known: Iterable[str]) -> str:
    """Check that a choice is one of those that there are."""
    if str(value) not in known:
        raise SetupError(f"{name}: expected one of {', '.join(known)}, got {value}{did_you_mean(str(value), known)}")
    return str(value)


def parameters(
    choices: Mapping[str, Any],
    given: Mapping[str, Value],
    system: Structure,
    before: Mapping[str, Value] | None = None,
    read: Read = choice,
) -> dict[str, Value]:
    """Return the parameters of all choices; later ones win: those of :data:`ORDER`, what is given, the mode.

    Parameters
    ----------
    choices
        Name of each choice to its value; None for none.
    given
        Single parameters, as ``component.variable``.
    system
        System whose parameters they are.
    before
        Parameters that hold where the choices say nothing; a mode may depend on them.
    read
        Returns the parameters of one choice.

    Returns
    -------
    dict
        ``component.variable`` to value, without those before.

    Raises
    ------
    SetupError
        If one of them is not known.
    """
    found: dict[str, Value] = {}
    for name in ORDER:
        if choices.get(name) is not None:
            found |= read(name, choices[name], system)
    found |= given
    if (mode := choices.get("mode")) is not None:
        found = scenarios.mode(_one_of("mode", mode, MODES), {**(before or {}), **found}) | found
    return found
