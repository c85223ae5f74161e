"""Parameters that a system structure binds to its elements.

Of several bindings for one parameter, the last one at an element wins, and those of an outer system win over those of
the elements inside it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from cosim.engine.network import VariableRef
from cosim.errors import SetupError, listed, prefixed
from cosim.fmi.elements import array_name
from cosim.ssp import ssd, ssv
from cosim.ssp.connections import ConnectionGraph
from cosim.ssp.nodes import ElementPath, Node, Nodes, component_name
from cosim.ssp.quantities import Quantity, Transfer, check_value
from cosim.units import Unit

_SETTABLE = ("input", "parameter")
"""Kinds of a system's connectors to which values can be bound."""


class _Given(NamedTuple):
    """A value for a variable, the name of its parameter in messages, and whether it gives arrays their sizes."""

    quantity: Quantity
    where: str
    is_structural: bool


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
    ignored
        What was ignored, one line each.
    """

    def __init__(self, nodes: Nodes, graph: ConnectionGraph, system: ssd.System) -> None:
        self.ignored: list[str] = []
        self._given: dict[VariableRef, _Given] = {}
        self._nodes = nodes
        self._graph = graph
        self._bind(system, ())

    def set_sizes(self) -> None:
        """Give the flat structure the structural parameters: connections of elements depend on the sizes of arrays."""
        self._set_parameters(structural=True)

    def set_parameters(self) -> None:
        """Give the flat structure all other values but those of connected inputs."""
        self._set_parameters(structural=False)

    def _set_parameters(self, structural: bool) -> None:
        structure = self._nodes.structure
        sizes = structure.sizes({})
        for ref, given in self._given.items():
            if given.is_structural == structural:
                with self._nodes.collected(), prefixed(given.where):
                    elements = structure.elements(ref, sizes)
                    if structure.feeding(ref, sizes) is None:
                        value = check_value(structure.models[ref.component], elements, ref.component, given.quantity)
                        structure.parameters[str(ref)] = value

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
        if mapping is not None:
            self._check_mapping(mapping, [binding.prefix + parameter.name for parameter in values.parameters], where)
        units = [*(definition.unit for definition in values.units), *self._nodes.known_units(path)]
        for parameter in values.parameters:
            name = binding.prefix + parameter.name
            entries = [ssv.MappingEntry(source=name, target=name)]
            if mapping is not None:
                entries = [entry for entry in mapping.entries if entry.source == name]
            for entry in entries:
                with self._nodes.collected():
                    self._set(parameter, units, entry, path, where)

    def _check_mapping(self, mapping: ssv.ParameterMapping, names: list[str], where: str) -> None:
        """Check that a mapping has one entry for each target; note what is not applied."""
        sources = [entry.source for entry in mapping.entries]
        targets = Counter(entry.target for entry in mapping.entries)
        if problems := [
            f"{where}: mapping to {target}: expected one entry, got {count}"
            for target, count in targets.items()
            if count > 1
        ]:
            raise SetupError(*problems)
        if unmapped := [name for name in names if name not in sources]:
            self.ignored.append(f"{where}: parameters without an entry in the mapping are ignored: {listed(unmapped)}")
        if missing := [source for source in dict.fromkeys(sources) if source not in names]:
            self.ignored.append(f"{where}: entries of the mapping without a parameter are ignored: {listed(missing)}")

    def _set(
        self, parameter: ssv.Parameter, units: list[Unit], entry: ssv.MappingEntry, path: ElementPath, where: str
    ) -> None:
        """Set all targets of a mapping entry to the value of a parameter."""
        label = f"{where}: parameter {parameter.name}"
        targets = list(self._find(path, entry.target))
        if not targets:
            place = ".".join(path) or "the system"
            self.ignored.append(f"{label}: ignored, as there is no {entry.target} in {place}")
            return
        settable = [node for node in targets if self._is_settable(node)]
        if not settable:
            kind = self._nodes.kind(targets[0])
            raise SetupError(f"{label}: expected a parameter or an input, got the system's {kind} {targets[0]}")
        quantity = Quantity.of(parameter.typed_value, units, label)
        transfer = Transfer(entry.transformation, entry.suppress_unit_conversion)
        reached = [self._assign(quantity, [(transfer, node)], label) for node in settable]
        if not any(reached):
            self.ignored.append(f"{label}: ignored, as {targets[0]} is connected to no component")

    def _is_settable(self, node: Node) -> bool:
        return node.path in self._nodes.components or self._nodes.kind(node) in _SETTABLE

    def _find(self, path: ElementPath, name: str) -> Iterator[Node]:
        """Yield the nodes of a hierarchical name in an element; names need not be unique, a value applies to all."""
        if path in self._nodes.components:
            model = self._nodes.model(path)
            array = model.variables.get(array_name(name))
            if name in model.variables or (array is not None and array.dimensions):
                yield Node(path, name)
            return
        if name in self._nodes.connectors.get(path, ()):
            yield Node(path, name)
        for inner in self._nodes.connectors:
            if inner and inner[:-1] == path and name.startswith(f"{inner[-1]}."):
                yield from self._find(inner, name.removeprefix(f"{inner[-1]}."))

    def _assign(self, quantity: Quantity, way: list[tuple[Transfer, Node]], where: str) -> bool:
        """Assign a value to all components' variables to which the connections from the end of a way lead.

        Whether the value is a difference, which offsets of units do not change, is said by the variable only. Returns
        whether there is such a variable.
        """
        node = way[-1][1]
        if node.path not in self._nodes.components:
            found = False
            for sink, transfer in self._graph.sinks_of(node):
                with self._nodes.collected():
                    found |= self._assign(quantity, [*way, (transfer, sink)], where)
            return found
        relative = self._nodes.unit(node).relative
        quantity = replace(quantity, unit=quantity.unit._replace(relative=relative))
        for transfer, end in way:
            quantity = quantity.transferred(transfer, self._nodes.unit(end)._replace(relative=relative), where)
        ref = VariableRef(component_name(node.path), node.connector)
        self._given.pop(ref, None)  # the last one counts, also among elements and aliases of one variable
        causality = self._nodes.variable(node).causality
        self._given[ref] = _Given(quantity, where, causality == "structuralParameter")
        return True

    def _values_of(
        self, binding: ssd.ParameterBinding, element: ssd.System | ssd.Component
    ) -> tuple[ssv.ParameterSet, str]:
        """Read the parameters of a binding; return them and the name of their file in messages."""
        if binding.type != ssv.PARAMETER_SET:
            raise SetupError(f"parameters of {element.name}: expected type {ssv.PARAMETER_SET}, got {binding.type}")
        if binding.source is None:
            if binding.values is None:
                raise SetupError(f"parameters of {element.name}: expected a source or values, got neither")
            ssv.check_names(binding.values, f"parameters of {element.name}")
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
