"""Connections of a system structure, from the outputs of components through nested systems to inputs.

Each node has at most one source. Following the sources from a component's input leads to an output of a component, to
which the input is then connected, or to a node without a source, which leaves the input unconnected.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from cosim.engine.network import VariableRef
from cosim.errors import SetupError, did_you_mean
from cosim.ssp import ssd
from cosim.ssp.nodes import IS_SOURCE_INSIDE, ElementPath, Node, Nodes, component_name
from cosim.ssp.quantities import Transfer
from cosim.units import IDENTITY, Linear


class NodeConnection(NamedTuple):
    """The connection to a node.

    Attributes
    ----------
    source
        The node at its beginning.
    transfer
        How values are transferred.
    """

    source: Node
    transfer: Transfer


class ConnectionGraph:
    """The connections between the nodes of a system structure.

    Parameters
    ----------
    nodes
        The nodes.
    system
        The outermost system.

    Attributes
    ----------
    connections
        Node to the connection to it.
    """

    def __init__(self, nodes: Nodes, system: ssd.System) -> None:
        self.connections: dict[Node, NodeConnection] = {}
        self._nodes = nodes
        self._add_system(system, ())

    def connect(self) -> None:
        """Connect the components of the flat structure."""
        for node in self.connections:
            if node.path in self._nodes.components and not self._nodes.is_parameter(node):
                with self._nodes.collected():
                    self._connect(node)

    def sinks_of(self, node: Node) -> Iterator[tuple[Node, Transfer]]:
        """Yield the nodes to which a node is connected.

        Parameters
        ----------
        node
            The source.

        Yields
        ------
        tuple
            A sink, and how values are transferred to it.
        """
        for sink, connection in self.connections.items():
            if connection.source == node:
                yield sink, connection.transfer

    def _add_system(self, system: ssd.System, path: ElementPath) -> None:
        """Add the connections of a system and of the systems inside it."""
        for connection in system.connections:
            with self._nodes.collected():
                self._add(connection, path)
        for element in system.elements:
            if isinstance(element, ssd.System):
                self._add_system(element, (*path, element.name))

    def _add(self, connection: ssd.Connection, path: ElementPath) -> None:
        """Add a connection of a system."""
        where = f"connection {'.'.join((*path, ''))}{connection}"
        ends = [
            self._end(path, element, name, where)
            for element, name in (
                (connection.start_element, connection.start_connector),
                (connection.end_element, connection.end_connector),
            )
        ]
        if any(node.path in self._nodes.failed for node in ends):
            return  # the problem of that component was reported already
        source, sink = self._directed(ends, path, where)
        if connection.transformation is not None and connection.transformation.linear is None:
            raise SetupError(f"{where}: expected a LinearTransformation, got a {connection.transformation.kind}")
        if sink in self.connections:
            other = self.connections[sink].source
            raise SetupError(f"{where}: expected a free {sink}, got one that {other} feeds")
        if sink in self._chain(source):
            raise SetupError(f"{where}: expected a path from a component, got a loop of systems' connectors")
        transfer = Transfer(connection.transformation, connection.suppress_unit_conversion)
        self.connections[sink] = NodeConnection(source, transfer)

    def _end(self, path: ElementPath, element: str | None, connector: str, where: str) -> Node:
        """Return the node at an end of a connection."""
        inner = path if element is None else (*path, element)
        if inner in self._nodes.dictionaries:
            raise SetupError(f"{where}: expected components and systems, got the signal dictionary {element}")
        if inner not in self._nodes.connectors and inner not in self._nodes.failed:
            names = [known[-1] for known in self._nodes.connectors if known[:-1] == path and known]
            raise SetupError(
                f"{where}: expected an element of the system, got {element}{did_you_mean(inner[-1], names)}"
            )
        return Node(inner, connector)

    def _directed(self, ends: list[Node], path: ElementPath, where: str) -> tuple[Node, Node]:
        """Return source and sink of a connection, by the kinds of its ends."""
        kinds = [self._nodes.kind(node) for node in ends]
        if "inout" in kinds:
            raise SetupError(f"{where}: expected an input and an output, got a connector of kind inout")
        is_source = [IS_SOURCE_INSIDE[kind] == (node.path == path) for node, kind in zip(ends, kinds, strict=True)]
        same_kind = self._nodes.is_parameter(ends[0]) == self._nodes.is_parameter(ends[1])
        if is_source[0] == is_source[1] or not same_kind:
            raise SetupError(f"{where}: expected a source and a sink, got {' and '.join(kinds)}")
        if {"calculatedParameter", "parameter"} == set(kinds):
            raise SetupError(
                f"{where}: expected an output and an input, got a calculated parameter and a parameter; "
                "values are exchanged between components during a run only"
            )
        return (ends[0], ends[1]) if is_source[0] else (ends[1], ends[0])

    def _chain(self, sink: Node) -> list[Node]:
        """Return a node, its source, the source of that, and so on."""
        chain = [sink]
        while chain[-1] in self.connections:
            chain.append(self.connections[chain[-1]].source)
        return chain

    def _connect(self, sink: Node) -> None:
        """Connect a component's input to the output at the beginning of its chain."""
        node, *others = reversed(self._chain(sink))
        if node.path not in self._nodes.components:
            return
        total, unit = IDENTITY, self._nodes.unit(node)
        for other in others:
            transfer = self.connections[other].transfer
            linear, unit = transfer.linear(unit, self._nodes.unit(other), f"connection {node} -> {sink}")
            total = linear.after(total)
        suppressed = any(self.connections[other].transfer.suppress_unit_conversion for other in others)
        self._nodes.structure.connect(*self._connect_arguments(node, sink, total, suppressed))

    def _connect_arguments(
        self, source: Node, sink: Node, total: Linear, suppressed: bool
    ) -> tuple[str, str, Linear, bool]:
        """Return the arguments of :meth:`Structure.connect`.

        A transformation that is only the conversion of units is not passed as an explicit one: a component that
        replaces this one may have other units.
        """
        refs = [VariableRef(component_name(end.path), end.connector) for end in (source, sink)]
        converted = self._nodes.structure.conversion(*refs).transformation
        if total == converted and not (suppressed and converted == IDENTITY):
            return str(refs[0]), str(refs[1]), IDENTITY, True
        return str(refs[0]), str(refs[1]), total, converted == IDENTITY and not suppressed
