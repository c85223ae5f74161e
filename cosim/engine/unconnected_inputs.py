"""Inputs without a connection: each is derived, keeps its start value with a note, or is an error.

Some components need one input of a group only and derive the others. Such a component has a *selector*, recognised by
names alone: an enumeration parameter ``G_signals`` whose first item stands for all inputs of the group, and each other
item X for the input ``G_X``, in order of preference.
"""

from __future__ import annotations

from collections.abc import Container, Iterator
from dataclasses import dataclass, field

from cosim.fmi.description import ModelDescription
from cosim.fmi.variable_types import KINDS, NUMERIC

_SUFFIX = "_signals"


@dataclass(frozen=True)
class Selector:
    """A group of inputs with the parameter that selects which of them are used.

    Attributes
    ----------
    parameter
        Name of the enumeration parameter.
    all_item
        Its item that stands for all inputs.
    inputs
        Item to the input it stands for.
    """

    parameter: str
    all_item: str
    inputs: dict[str, str]


def selectors(model: ModelDescription) -> Iterator[Selector]:
    """Find the selectors of an FMU."""
    for variable in model.variables.values():
        group = variable.name.removesuffix(_SUFFIX)
        if variable.type != "Enumeration" or variable.causality != "parameter" or group == variable.name:
            continue
        all_item, *items = [item.name for item in variable.declaredType.items]
        inputs = {item: f"{group}_{item}" for item in items}
        known = [name for name in inputs.values() if name in model.variables]
        if known and len(known) == len(inputs) and all(model.variables[n].causality == "input" for n in known):
            yield Selector(variable.name, all_item, inputs)


def derived_inputs(name: str, model: ModelDescription, connected: Container[str]) -> set[str]:
    """Find the inputs that a component derives from another of their group.

    Parameters
    ----------
    name, model
        The component.
    connected
        Connected inputs, as ``component.variable``.

    Returns
    -------
    set of str
        As ``component.variable``, those that are connected included.
    """
    groups = [{f"{name}.{input_}" for input_ in selector.inputs.values()} for selector in selectors(model)]
    return {ref for group in groups if any(ref in connected for ref in group) for ref in group}


@dataclass
class UnconnectedInputs:
    """How the unconnected inputs of a component are resolved.

    Attributes
    ----------
    parameters
        Parameters of the component to set, by name.
    notes
        What the user should know.
    problems
        What forbids a run.
    """

    parameters: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)


def resolve_unconnected(
    name: str, model: ModelDescription, connected: Container[str], given: Container[str]
) -> UnconnectedInputs:
    """Resolve the unconnected inputs of a component.

    Parameters
    ----------
    name, model
        The component.
    connected
        Connected inputs, as ``component.variable``.
    given
        Variables that the user or the system has set, likewise.
    """
    resolved = UnconnectedInputs()
    grouped: set[str] = set()
    for selector in selectors(model):
        grouped |= set(selector.inputs.values())
        if f"{name}.{selector.parameter}" not in given:
            _select(name, selector, connected, given, resolved)
    for variable in model.variables.values():
        ref = f"{name}.{variable.name}"
        is_input = variable.causality == "input" and KINDS[variable.type] in NUMERIC
        if is_input and not (ref in connected or ref in given or variable.name in grouped):
            value = " ".join(filter(None, [str(variable.start), model.unit(variable)]))
            resolved.notes.append(f"{ref}: not connected and not set, keeps its start value {value}")
    return resolved


def _select(
    name: str, selector: Selector, connected: Container[str], given: Container[str], resolved: UnconnectedInputs
) -> None:
    """Select the input of a group that is used, where not all are connected or set."""
    refs = {item: f"{name}.{input_}" for item, input_ in selector.inputs.items()}
    available = {item: ref for item, ref in refs.items() if ref in connected or ref in given}
    if len(available) == len(refs):
        return
    if not available:
        resolved.problems.append(
            f"{name}: expected one of {', '.join(refs.values())} to be connected, got none; "
            f"for example: --connect COMPONENT.OUTPUT={next(iter(refs.values()))}"
        )
        return
    chosen, *others = available
    resolved.parameters[selector.parameter] = chosen
    ignored = f"; {' and '.join(available[item] for item in others)} is ignored" if others else ""
    resolved.notes.append(
        f"{name}.{selector.parameter}: set to {chosen}, as not all of its inputs are connected; "
        f"the others are derived from {available[chosen]}{ignored}"
    )
