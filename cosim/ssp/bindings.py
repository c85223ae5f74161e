"""Parameters that a system structure binds to its elements.

Of several bindings for one parameter, the last one at an element wins, and those of an outer system win over those of
the elements inside it.
"""

from __future__ import annotations

from cosim.engine.network import VariableRef
from cosim.errors import SetupError, prefixed
from cosim.fmi.values import Value
from cosim.ssp import ssd, ssv
from cosim.ssp.connections import ConnectionGraph
from cosim.ssp.nodes import ElementPath, Node, Nodes, component_name
from cosim.ssp.quantities import Quantity, Transfer, check_value
from cosim.units import Unit

_SETTABLE = ("input", "parameter")
"""Kinds of a system's connectors to which values can be bound."""


class Bindings:
    """Values that are bound to parameters and unconnected inputs of components.

    Parameters
    ----------
    nodes
        The nodes.
    graph
        Their connections, including those of parameters.
    system
        The outermost system.

    Attributes
    ----------
    values
        Variable to its value.
    ignored
        What was ignored, one line each.
    """

    def __init__(self, nodes: Nodes, graph: ConnectionGraph, system: ssd.System) -> None:
        self.values: dict[VariableRef, Value] = {}
        self.ignored: list[str] = []
        self._nodes = nodes
        self._graph = graph
        self._bind(system, ())

    def _bind(self, element: ssd.System | ssd.Component, path: ElementPath) -> None:
        """Apply the bindings inside an element, then its own, which win."""
        if isinstance(element, ssd.System):
            for inner in element.elements:
                if not isinstance(inner, ssd.SignalDictionaryReference):
                    self._bind(inner, (*path, inner.name))
        elif path not in self._nodes.components:
            return
        for binding in element.bindings:
            with self._nodes.collected():
                self._apply(binding, element, path)

    def _apply(self, binding: ssd.ParameterBinding, element: ssd.System | ssd.Component, path: ElementPath) -> None:
        """Apply one binding of an element."""
        values, where = self._values_of(binding, element)
        mapping = self._mapping_of(binding, element)
        units = [*(definition.unit for definition in values.units), *self._nodes.known_units(path)]
        for parameter in values.parameters:
            name = binding.prefix + parameter.name
            entries = [entry for entry in mapping.entries if entry.source == name] if mapping else []
            entries = entries or [ssv.MappingEntry(source=name, target=name)]
            for entry in entries:
                with self._nodes.collected():
                    self._set(parameter, units, entry, path, where)

    def _set(
        self, parameter: ssv.Parameter, units: list[Unit], entry: ssv.MappingEntry, path: ElementPath, where: str
    ) -> None:
        """Set the target of a mapping entry to the value of a parameter."""
        label = f"{where}: parameter {parameter.name}"
        target = self._find(path, entry.target)
        if target is None:
            place = ".".join(path) or "the system"
            self.ignored.append(f"{label}: ignored, as there is no {entry.target} in {place}")
            return
        if target.path not in self._nodes.components and (kind := self._nodes.kind(target)) not in _SETTABLE:
            raise SetupError(f"{label}: expected a parameter or an input, got the system's {kind} {target}")
        quantity = Quantity.of(parameter.typed_value, units, label)
        transfer = Transfer(entry.transformation, entry.suppress_unit_conversion)
        self._assign(target, quantity.transferred(transfer, self._nodes.unit(target), label), label)

    def _find(self, path: ElementPath, name: str) -> Node | None:
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

    def _assign(self, node: Node, quantity: Quantity, where: str) -> None:
        """Assign a value to a node and all its sinks; connected inputs of components are not changed."""
        if node.path not in self._nodes.components:
            for sink, transfer in self._graph.sinks_of(node):
                self._assign(sink, quantity.transferred(transfer, self._nodes.unit(sink), where), where)
            return
        ref = VariableRef(component_name(node.path), node.connector)
        if ref not in self._nodes.structure.connections:
            with prefixed(where):
                self.values[ref] = check_value(self._nodes.model(node.path), *ref, quantity)

    def _values_of(
        self, binding: ssd.ParameterBinding, element: ssd.System | ssd.Component
    ) -> tuple[ssv.ParameterSet, str]:
        """Read the parameters of a binding; return them and the name of their file in messages."""
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
        """Read the mapping of a binding; None where it has none."""
        reference = binding.mapping
        if reference is None:
            return None
        if reference.type != ssv.PARAMETER_MAPPING:
            raise SetupError(f"mapping of {element.name}: expected type {ssv.PARAMETER_MAPPING}, got {reference.type}")
        if reference.source is None:
            return reference.mapping
        return ssv.read_parameter_mapping(*self._resource(reference.source, reference.source_base, element))

    def _resource(self, uri: str, base: str, element: ssd.System | ssd.Component) -> tuple[bytes, str]:
        """Read a resource of the package or of the component's FMU; return it and its name in messages."""
        if base == "SSD":
            return self._nodes.package.read(uri), str(self._nodes.package.locate(uri))
        if isinstance(element, ssd.System):
            raise SetupError(f"parameters of {element.name}: expected sourceBase SSD for a system, got {base}")
        return self._nodes.package.read_in(element.source, uri)
