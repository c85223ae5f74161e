"""Parameters of a system structure: who binds which value to what, and whose word counts.

Of bindings at one element the later wins, and what is bound further out wins over what is bound further in.
"""

from __future__ import annotations

from cosim.engine.network import VariableRef
from cosim.errors import SetupError
from cosim.fmi.values import Value
from cosim.ssp import ssd, ssv
from cosim.ssp.connections import Connections
from cosim.ssp.nodes import Node, Nodes, Path, component_name
from cosim.ssp.quantities import Hop, Quantity, set_value
from cosim.units import Unit

_SETTABLE = ("input", "parameter")
"""Kinds of a system's connectors that take values from outside."""


class Bindings:
    """Values of the components' parameters and free inputs.

    Parameters
    ----------
    nodes
        What there is.
    connections
        Which ways values go, those of parameters too.
    system
        The outermost system.

    Attributes
    ----------
    values
        Variable to its value.
    notes
        What was passed over, a line each.
    """

    def __init__(self, nodes: Nodes, connections: Connections, system: ssd.System) -> None:
        self.values: dict[VariableRef, Value] = {}
        self.notes: list[str] = []
        self._nodes = nodes
        self._connections = connections
        self._bind(system, ())

    def _bind(self, element: ssd.System | ssd.Component, path: Path) -> None:
        """Take the parameters bound to an element: what is bound further out comes later and wins, as in a sequence."""
        if isinstance(element, ssd.System):
            for inner in element.elements:
                if not isinstance(inner, ssd.SignalDictionaryReference):
                    self._bind(inner, (*path, inner.name))
        elif path not in self._nodes.components:
            return
        for binding in element.bindings:
            self._nodes.attempt(self._take, binding, element, path)

    def _take(self, binding: ssd.ParameterBinding, element: ssd.System | ssd.Component, path: Path) -> None:
        """Take a set of parameters."""
        values, where = self._values_of(binding, element)
        mapping = self._mapping_of(binding, element)
        units = [*(definition.unit for definition in values.units), *self._nodes.known_units(path)]
        for parameter in values.parameters:
            name = binding.prefix + parameter.name
            entries = [entry for entry in mapping.entries if entry.source == name] if mapping else []
            entries = entries or [ssv.MappingEntry(source=name, target=name)]
            for entry in entries:
                self._nodes.attempt(self._set, parameter, units, entry, path, where)

    def _set(
        self, parameter: ssv.Parameter, units: list[Unit], entry: ssv.MappingEntry, path: Path, where: str
    ) -> None:
        label = f"{where}: parameter {parameter.name}"
        target = self._find(path, entry.target)
        if target is None:
            self.notes.append(
                f"{label}: passed over, as there is no {entry.target} in {'.'.join(path) or 'the system'}"
            )
            return
        if target.path not in self._nodes.components and (kind := self._nodes.kind(target)) not in _SETTABLE:
            raise SetupError(f"{label}: expected a parameter or an input, got the system's {kind} {target}")
        quantity = Quantity.of(parameter.given, units, label)
        hop = Hop(entry.transformation, entry.suppress_unit_conversion)
        self._give(target, quantity.passed(hop, self._nodes.unit(target), label), label)

    def _find(self, path: Path, name: str) -> Node | None:
        """Find the node of a hierarchical name in an element."""
        if path in self._nodes.components:
            return Node(path, name) if name in self._nodes.model(path).variables else None
        if name in self._nodes.connectors[path]:
            return Node(path, name)
        for inner in self._nodes.connectors:
            if inner[:-1] == path and inner and name.startswith(f"{inner[-1]}."):
                found = self._find(inner, name.removeprefix(f"{inner[-1]}."))
                if found is not None:
                    return found
        return None

    def _give(self, node: Node, quantity: Quantity, where: str) -> None:
        """Give a value to a node and all that it feeds; a start value of a connected input changes nothing."""
        if node.path not in self._nodes.components:
            for sink, hop in self._connections.fed_by(node):
                self._give(sink, quantity.passed(hop, self._nodes.unit(sink), where), where)
            return
        port = VariableRef(component_name(node.path), node.connector)
        if port not in self._nodes.structure.connections:
            try:
                self.values[port] = set_value(self._nodes.model(node.path), *port, quantity)
            except SetupError as error:
                raise SetupError(*(f"{where}: {problem}" for problem in error.problems)) from None

    def _values_of(
        self, binding: ssd.ParameterBinding, element: ssd.System | ssd.Component
    ) -> tuple[ssv.ParameterSet, str]:
        """Read a binding's parameters, and say where they stand."""
        if binding.type != ssv.PARAMETER_SET:
            raise SetupError(f"parameters of {element.name}: expected type {ssv.PARAMETER_SET}, got {binding.type}")
        if binding.source is None:
            if binding.values is None:
                raise SetupError(f"parameters of {element.name}: expected a source or values, got neither")
            return binding.values, str(self._nodes.package.where)
        data, where = self._resource(binding.source, binding.source_base, element)
        return ssv.read_parameter_set(data, where), where

    def _mapping_of(
        self, binding: ssd.ParameterBinding, element: ssd.System | ssd.Component
    ) -> ssv.ParameterMapping | None:
        """Read a binding's mapping."""
        reference = binding.mapping
        if reference is None:
            return None
        if reference.type != ssv.PARAMETER_MAPPING:
            raise SetupError(f"mapping of {element.name}: expected type {ssv.PARAMETER_MAPPING}, got {reference.type}")
        if reference.source is None:
            return reference.mapping
        return ssv.read_parameter_mapping(*self._resource(reference.source, reference.source_base, element))

    def _resource(self, uri: str, base: str, element: ssd.System | ssd.Component) -> tuple[bytes, str]:
        """Read a resource beside the description or in the component's FMU, and say where that is."""
        if base == "SSD":
            return self._nodes.package.read(uri), str(self._nodes.package.locate(uri))
        if isinstance(element, ssd.System):
            raise SetupError(f"parameters of {element.name}: expected sourceBase SSD for a system, got {base}")
        return self._nodes.package.read_in(element.source, uri)
