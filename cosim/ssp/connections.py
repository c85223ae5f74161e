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
from cosim.ssp.nodes import ElementPath, Node, Nodes, component_name
from cosim.ssp.quantities import Transfer
from cosim.units import IDENTITY, Linear

_ALLOWED = {
    ("system", "parameter"): {
        ("system", "calculatedParameter"),
        ("system", "output"),
        ("element", "parameter"),
        ("element", "input"),
    },
    ("system", "input"): {("system", "output"), ("element", "input")},
    ("element", "calculatedParameter"): {
        ("element", "parameter"),
        ("element", "input"),
        ("system", "calculatedParameter"),
        ("system", "output"),
    },
    ("element", "output"): {("element", "input"), ("system", "output")},
}
"""Owner and kind of a source to those of its sinks: the allowed connections of SSP 1.0, 5.3.2.1, without ``inout``.

The owner is the system around the connection or an element of it, which may be a system itself.
"""


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
            if node.path in self._nodes.components:
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
        start, end = (
            ("system" if node.path == path else "element", kind) for node, kind in zip(ends, kinds, strict=True)
        )
        if end in _ALLOWED.get(start, ()):
            return ends[0], ends[1]
        if start in _ALLOWED.get(end, ()):
            return ends[1], ends[0]
        raise SetupError(f"{where}: expected a source and a sink, got {' and '.join(kinds)}")

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
        where = f"connection {node} -> {sink}"
        if self._nodes.kind(sink) == "parameter":
            raise SetupError(
                f"{where}: expected an output and an input, got a calculated parameter and a parameter; "
                "values are exchanged between components during a run only"
            )
        total, unit, notes = IDENTITY, self._nodes.unit(node), []
        for other in others:
            end = self._nodes.unit(other)
            if other.path not in self._nodes.components:
                end = end._replace(relative=unit.relative)
            linear, unit, found = self.connections[other].transfer.linear(unit, end, where)
            total = linear.after(total)
            notes += found
        suppressed = any(self.connections[other].transfer.suppress_unit_conversion for other in others)
        arguments = self._connect_arguments(node, sink, total, suppressed)
        self._nodes.structure.connect(*arguments)
        known = self._nodes.structure.connections.values()
        self._nodes.notes += [note for note in notes if not any(note in connection.notes for connection in known)]

    def _connect_arguments(
        self, source: Node, sink: Node, total: Linear, suppressed: bool
    ) -> tuple[str, str, Linear, bool]:
        """Return the arguments of :meth:`Structure.connect`.

        A transformation that is only the conversion of units is not passed as an explicit one: a component that
        replaces this one may have other units.
        """
        refs = [VariableRef(component_name(end.path), end.connector) for end in (source, sink)]
        units = self._nodes.structure.conversion(*refs)
        converted, alike = units.transformation, not units.problems
        if total == converted and alike and not (suppressed and converted == IDENTITY):
            return str(refs[0]), str(refs[1]), IDENTITY, True
        return str(refs[0]), str(refs[1]), total, converted == IDENTITY and alike and not suppressed
