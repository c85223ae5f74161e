"""Inputs without a connection: each is derived, keeps its start value with a note, or is an error.

Some components need one input of a group only and derive the others. Such a component has a *selector*, recognised by
names alone: an enumeration parameter ``G_signals`` whose first item stands for all inputs of the group, and each other
item X for the input ``G_X``, in order of preference.

Other components have inputs for something that they also model themselves: an enumeration parameter ``G.model`` with
the item ``external``, and inputs ``G_...`` that are used with this item only. Without a connection there is nothing to
say of them as long as this parameter has another item.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from fmpy.model_description import ModelVariable

from cosim.errors import listed
from cosim.fmi.description import ModelDescription
from cosim.fmi.elements import owner
from cosim.fmi.values import Value

_SUFFIX = "_signals"
_MODEL, _EXTERNAL = ".model", "external"


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


def inputs_of_externals(model: ModelDescription, given: Container[str], values: Mapping[str, Value]) -> set[str]:
    """Find the inputs for what an FMU models itself unless a parameter says otherwise.

    Parameters
    ----------
    model
        The FMU.
    given
        Names of the parameters that are set.
    values
        Their values, where these are known.

    Returns
    -------
    set of str
        Names of the inputs that are not used, as far as is known.
    """
    groups = set()
    for variable in model.variables.values():
        group = variable.name.removesuffix(_MODEL)
        if variable.type != "Enumeration" or variable.causality != "parameter" or group == variable.name:
            continue
        external = [item.value for item in variable.declaredType.items if item.name == _EXTERNAL]
        chosen = values.get(variable.name, _EXTERNAL if variable.name in given else variable.start)
        if external and str(chosen) not in (str(external[0]), str(float(external[0])), _EXTERNAL):
            groups.add(f"{group}_")
    inputs = (variable.name for variable in model.variables.values() if variable.causality == "input")
    return {name for name in inputs if name.startswith(tuple(groups))}


def derived_inputs(model: ModelDescription, connected: Container[str]) -> set[str]:
    """Find the inputs that an FMU derives from another of their group.

    Parameters
    ----------
    model
        The FMU.
    connected
        Names of the connected inputs.

    Returns
    -------
    set of str
        Names, those that are connected included.
    """
    groups = [set(selector.inputs.values()) for selector in selectors(model)]
    return {name for group in groups if any(name in connected for name in group) for name in group}


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
    name: str,
    model: ModelDescription,
    connected: Mapping[str, set[int]],
    given: Mapping[str, set[int]],
    sizes: Mapping[int, int] = MappingProxyType({}),
    values: Mapping[str, Value] = MappingProxyType({}),
) -> UnconnectedInputs:
    """Resolve the unconnected inputs of a component.

    Parameters
    ----------
    name, model
        The component.
    connected
        Names of the connected inputs, each with the places of its connected elements.
    given
        Names of the variables that the user or the system has set, likewise.
    sizes
        Values of the structural parameters, see :meth:`ModelDescription.sizes`.
    values
        Values that are set, by name, where they are known.
    """
    resolved = UnconnectedInputs()
    grouped = inputs_of_externals(model, given, values)
    for selector in selectors(model):
        grouped |= set(selector.inputs.values())
        if selector.parameter not in given:
            _select(name, selector, connected, given, resolved)
    for variable in model.variables.values():
        known = owner(variable) in connected or owner(variable) in given or variable.name in grouped
        if variable.causality == "input" and variable.alias is None and not known:
            resolved.notes.append(f"{name}.{variable.name}: not connected and not set, {_start(model, variable)}")
    for input_, places in connected.items():
        known_places = places | given.get(input_, set())
        elements = model.elements(name, input_, sizes)
        missing = [n for place, n in zip(elements.places, elements.names, strict=True) if place not in known_places]
        if missing:
            names = listed([f"{name}.{element}" for element in missing])
            resolved.notes.append(f"{names}: not connected and not set, unlike other elements of the array")
    return resolved


def _start(model: ModelDescription, variable: ModelVariable) -> str:
    """Say which value an input keeps."""
    if variable.start is None:
        return "and has no start value in its description"
    return f"keeps its start value {' '.join(filter(None, [str(variable.start), model.unit(variable)]))}"


def _select(
    name: str, selector: Selector, connected: Container[str], given: Container[str], resolved: UnconnectedInputs
) -> None:
    """Select the input of a group that is used, where not all are connected or set."""
    available = {item: input_ for item, input_ in selector.inputs.items() if input_ in connected or input_ in given}
    if len(available) == len(selector.inputs):
        return
    if not available:
        inputs = [f"{name}.{input_}" for input_ in selector.inputs.values()]
        resolved.problems.append(
            f"{name}: expected one of {', '.join(inputs)} to be connected, got none; "
            f"for example: --connect COMPONENT.OUTPUT={inputs[0]}"
        )
        return
    chosen, *others = available
    resolved.parameters[selector.parameter] = chosen
    ignored = f"; {' and '.join(f'{name}.{available[item]}' for item in others)} is ignored" if others else ""
    resolved.notes.append(
        f"{name}.{selector.parameter}: set to {chosen}, as not all of its inputs are connected; "
        f"the others are derived from {name}.{available[chosen]}{ignored}"
    )
