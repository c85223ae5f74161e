"""Connections of a system structure, through its nested systems from output to input.

What feeds a node is one hop away; going back hop by hop from a component's input leads to an output, whose connection
that is, or to nothing, which leaves the input free.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from cosim.engine.network import VariableRef
from cosim.errors import SetupError, did_you_mean
from cosim.ssp import ssd
from cosim.ssp.nodes import GIVES_INSIDE, Node, Nodes, Path, component_name
from cosim.ssp.quantities import Hop
from cosim.units import IDENTITY, Linear


class Connection(NamedTuple):
    """What feeds a node, and how its values get there."""

    source: Node
    hop: Hop


class Connections:
    """Who feeds whom.

    Parameters
    ----------
    nodes
        What there is.
    system
        The outermost system.

    Attributes
    ----------
    feeds
        Node to what feeds it.
    """

    def __init__(self, nodes: Nodes, system: ssd.System) -> None:
        self.feeds: dict[Node, Connection] = {}
        self._nodes = nodes
        self._wire(system, ())

    def connect(self) -> None:
        """Connect the components of the flat structure."""
        for node in self.feeds:
            if node.path in self._nodes.components and not self._nodes.is_parameter(node):
                self._nodes.attempt(self._connect, node)

    def fed_by(self, node: Node) -> Iterator[tuple[Node, Hop]]:
        """Yield what a node feeds, and how."""
        for sink, feed in self.feeds.items():
            if feed.source == node:
                yield sink, feed.hop

    def _wire(self, system: ssd.System, path: Path) -> None:
        """Enter a system's connections, those of nested systems too."""
        for connection in system.connections:
            self._nodes.attempt(self._enter, connection, path)
        for element in system.elements:
            if isinstance(element, ssd.System):
                self._wire(element, (*path, element.name))

    def _enter(self, connection: ssd.Connection, path: Path) -> None:
        """Enter a connection by the node it feeds."""
        where = f"connection {'.'.join((*path, ''))}{connection}"
        ends = [
            self._end(path, element, name, where)
            for element, name in (
                (connection.start_element, connection.start_connector),
                (connection.end_element, connection.end_connector),
            )
        ]
        if any(node.path in self._nodes.failed for node in ends):
            return  # what is wrong with that component has been said
        kinds = [self._nodes.kind(node) for node in ends]
        if "inout" in kinds:
            raise SetupError(f"{where}: expected an input and an output, got a connector of kind inout")
        giving = [GIVES_INSIDE[kind] == (node.path == path) for node, kind in zip(ends, kinds, strict=True)]
        if giving[0] == giving[1] or self._nodes.is_parameter(ends[0]) != self._nodes.is_parameter(ends[1]):
            raise SetupError(f"{where}: expected one end that gives and one that takes, got {' and '.join(kinds)}")
        if {"calculatedParameter", "parameter"} == set(kinds):
            raise SetupError(
                f"{where}: expected an output and an input, got a calculated parameter and a parameter; "
                "values pass between components in a run only"
            )
        if connection.transformation is not None and connection.transformation.linear is None:
            raise SetupError(f"{where}: expected a LinearTransformation, got a {connection.transformation.kind}")
        source, sink = ends if giving[0] else reversed(ends)
        if sink in self.feeds:
            raise SetupError(f"{where}: expected a free {sink}, got one that {self.feeds[sink].source} feeds")
        if sink in self._way(source):
            raise SetupError(f"{where}: expected a way from a component, got a loop of systems' connectors")
        self.feeds[sink] = Connection(source, Hop(connection.transformation, connection.suppress_unit_conversion))

    def _end(self, path: Path, element: str | None, connector: str, where: str) -> Node:
        inner = path if element is None else (*path, element)
        if inner in self._nodes.dictionaries:
            raise SetupError(f"{where}: expected components and systems, got the signal dictionary {element}")
        if inner not in self._nodes.connectors and inner not in self._nodes.failed:
            names = [known[-1] for known in self._nodes.connectors if known[:-1] == path and known]
            raise SetupError(
                f"{where}: expected an element of the system, got {element}{did_you_mean(inner[-1], names)}"
            )
        return Node(inner, connector)

    def _way(self, sink: Node) -> list[Node]:
        """List a node, what feeds it, what feeds that, and so on."""
        way = [sink]
        while way[-1] in self.feeds:
            way.append(self.feeds[way[-1]].source)
        return way

    def _connect(self, sink: Node) -> None:
        """Connect a component's input to the output that feeds it, through as many systems as there are between."""
        node, *ends = reversed(self._way(sink))
        if node.path not in self._nodes.components:
            return
        total, unit = IDENTITY, self._nodes.unit(node)
        for end in ends:
            linear, unit = self.feeds[end].hop.linear(unit, self._nodes.unit(end), f"connection {node} -> {sink}")
            total = linear.after(total)
        suppressed = any(self.feeds[end].hop.suppress_unit_conversion for end in ends)
        self._nodes.structure.connect(*self._as_asked(node, sink, total, suppressed))

    def _as_asked(self, source: Node, sink: Node, total: Linear, suppressed: bool) -> tuple[str, str, Linear, bool]:
        """Tell a mere conversion of units from what was asked for: another FMU may come that has other units."""
        ports = [VariableRef(component_name(end.path), end.connector) for end in (source, sink)]
        converted = self._nodes.structure.conversion(*ports).transformation
        if total == converted and not (suppressed and converted == IDENTITY):
            return str(ports[0]), str(ports[1]), IDENTITY, True
        return str(ports[0]), str(ports[1]), total, converted == IDENTITY and not suppressed
