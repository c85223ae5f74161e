"""When values reach whom: the order in which components step, and the delay that each connection gets from it.

A component that steps earlier hands its newest output to those after it. For a *discrete* output, computed from the
samples of t_k and held, that is the value of t_k: no delay. For a *continuous* one it is the value of the step's end,
t_(k+1), while the taker still begins at t_k: one step ahead of its time. So a sampler goes before those it feeds, and
what is continuous after them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple


class Edge(NamedTuple):
    """A connection between components, as far as its timing goes."""

    source: str
    sink: str
    discrete: bool

    @property
    def first(self) -> str:
        """Who steps first if the value is to be that of t_k."""
        return self.source if self.discrete else self.sink

    @property
    def second(self) -> str:
        """Who steps second."""
        return self.sink if self.discrete else self.source


def propose(names: Sequence[str], edges: Iterable[Edge]) -> tuple[tuple[str, ...], list[Edge]]:
    """Find an order in which every connection hands over the value of t_k, as far as there is one.

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
        Where a loop had to be broken: connections that hand over a value of another time.
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
    place = {name: k for k, name in enumerate(order)}
    return tuple(order), [edge for edge in wanted if place[edge.first] > place[edge.second]]


def delay(edge: Edge, order: Sequence[str], together: bool) -> int:
    """Count the communication steps by which a value is late where it is taken; negative: ahead of its time.

    Parameters
    ----------
    edge
        The connection.
    order
        In which the components step.
    together
        Whether all components exchange values at once, before any steps.
    """
    source_first = not together and order.index(edge.source) < order.index(edge.sink)
    return (0 if source_first else 1) if edge.discrete else (-1 if source_first else 0)
