"""Inputs that nothing feeds: no silent zero passes for a signal.

Some components can do with one input of a group and derive the others. They say so by a *selector*, recognised by names
alone: an enumeration parameter ``G_signals`` whose first item stands for all inputs of the group, and each other item X
for the input ``G_X``, the most preferred first.
"""

from __future__ import annotations

from collections.abc import Container, Iterator
from dataclasses import dataclass, field

from cosim.fmi.description import KINDS, NUMERIC, ModelDescription

_SUFFIX = "_signals"


@dataclass(frozen=True)
class Selector:
    """A group of inputs with the parameter that tells which of them are alive.

    Attributes
    ----------
    parameter
        Name of the enumeration parameter.
    every
        Its item that stands for all inputs.
    inputs
        Item to the input it stands for.
    """

    parameter: str
    every: str
    inputs: dict[str, str]


def selectors(model: ModelDescription) -> Iterator[Selector]:
    """Find the selectors of an FMU."""
    for variable in model.variables.values():
        group = variable.name.removesuffix(_SUFFIX)
        if variable.type != "Enumeration" or variable.causality != "parameter" or group == variable.name:
            continue
        every, *items = [item.name for item in variable.declaredType.items]
        inputs = {item: f"{group}_{item}" for item in items}
        known = [name for name in inputs.values() if name in model.variables]
        if known and len(known) == len(inputs) and all(model.variables[n].causality == "input" for n in known):
            yield Selector(variable.name, every, inputs)


def derivable(name: str, model: ModelDescription, fed: Container[str]) -> set[str]:
    """Name the inputs that a component derives from another of their group; parameters as of :func:`settle`."""
    groups = [{f"{name}.{input_}" for input_ in selector.inputs.values()} for selector in selectors(model)]
    return {port for group in groups if any(port in fed for port in group) for port in group}


@dataclass
class UnconnectedInputs:
    """What becomes of the inputs of a component.

    Attributes
    ----------
    settings
        Parameters to set, by name.
    notes
        What a user should know.
    problems
        What forbids a run.
    """

    settings: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)


def settle(name: str, model: ModelDescription, fed: Container[str], given: Container[str]) -> UnconnectedInputs:
    """Decide what becomes of the inputs of a component.

    Parameters
    ----------
    name, model
        The component.
    fed
        Inputs that a connection feeds, as ``component.variable``.
    given
        Variables that a user or the system has set, likewise.
    """
    settled = UnconnectedInputs()
    grouped: set[str] = set()
    for selector in selectors(model):
        grouped |= set(selector.inputs.values())
        if f"{name}.{selector.parameter}" not in given:
            _select(name, selector, fed, given, settled)
    for variable in model.variables.values():
        port = f"{name}.{variable.name}"
        is_input = variable.causality == "input" and KINDS[variable.type] in NUMERIC
        if is_input and not (port in fed or port in given or variable.name in grouped):
            value = " ".join(filter(None, [str(variable.start), model.unit(variable)]))
            settled.notes.append(f"{port}: not connected and not set, keeps its start value {value}")
    return settled


def _select(
    name: str, selector: Selector, fed: Container[str], given: Container[str], settled: UnconnectedInputs
) -> None:
    """Choose the input of a group that is alive, where not all are."""
    ports = {item: f"{name}.{input_}" for item, input_ in selector.inputs.items()}
    alive = {item: port for item, port in ports.items() if port in fed or port in given}
    if len(alive) == len(ports):
        return
    if not alive:
        settled.problems.append(f"{name}: expected one of {', '.join(ports.values())} to be connected, got none")
        return
    chosen, *others = alive
    settled.settings[selector.parameter] = chosen
    ignored = f"; {' and '.join(alive[item] for item in others)} is ignored" if others else ""
    settled.notes.append(
        f"{name}.{selector.parameter}: set to {chosen}, as not all of its inputs are connected; "
        f"the others are derived from {alive[chosen]}{ignored}"
    )
