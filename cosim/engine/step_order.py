"""Order in which components step, and the delay that each connection gets from it.

A component that steps earlier passes its newest output to those after it. By FMI that is the value of the step's end,
t_(k+1), while the receiver still begins at t_k: one step early. Only of an output that is *sampled*, computed from the
inputs of t_k and held, it is the value of t_k: no delay. So a sampler steps before the components it feeds, and all
others step after those they feed.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple


class Edge(NamedTuple):
    """Timing of a connection between components.

    Attributes
    ----------
    source, sink
        Components.
    sampled
        Whether the source's output is a value at the begin of a step.
    """

    source: str
    sink: str
    sampled: bool

    @property
    def first(self) -> str:
        """Which component must step first if the value is to be that of t_k."""
        return self.source if self.sampled else self.sink

    @property
    def second(self) -> str:
        """Which component must step second."""
        return self.sink if self.sampled else self.source


def propose(names: Sequence[str], edges: Iterable[Edge]) -> tuple[tuple[str, ...], list[Edge]]:
    """Propose an order in which every connection passes the value of t_k, as far as there is one.

    Parameters
    ----------
    names
        The components; where the connections leave a choice, this is the order.
    edges
        The connections between them.

    Returns
    -------
    order : tuple of str
        All names.
    broken : list of Edge
        Where a loop had to be broken: connections that pass the value of another time.
    """
    wanted = [edge for edge in edges if edge.source != edge.sink]
    order: list[str] = []
    while len(order) < len(names):
        waiting = {
            name: [e for e in wanted if e.second == name and e.first not in order]
            for name in names
            if name not in order
        }
        order.append(min(waiting, key=lambda name: len(waiting[name])))
    rank = {name: k for k, name in enumerate(order)}
    return tuple(order), [edge for edge in wanted if rank[edge.first] > rank[edge.second]]


def delay(edge: Edge, order: Sequence[str], jacobi: bool) -> int:
    """Return the delay of a connection in communication steps; negative: the value is early.

    Parameters
    ----------
    edge
        The connection.
    order
        In which the components step.
    jacobi
        Whether all components exchange values at once, before any steps.
    """
    source_first = not jacobi and order.index(edge.source) < order.index(edge.sink)
    return (0 if source_first else 1) if edge.sampled else (-1 if source_first else 0)
