"""Dependencies of outputs on inputs, as the descriptions of FMUs declare them, and loops among them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from graphlib import CycleError, TopologicalSorter
from typing import Literal, NamedTuple

from fmpy.model_description import ModelVariable

from cosim.fmi.description import ModelDescription
from cosim.fmi.elements import owner


class Node(NamedTuple):
    """A connected input or an output of a component, by the name of its owner where it is an alias.

    Attributes
    ----------
    component, variable
        Their names.
    is_input
        Which of the two it is.
    """

    component: str
    variable: str
    is_input: bool

    def __str__(self) -> str:
        return f"{self.component}.{self.variable}"


Graph = dict[Node, set[Node]]
"""Each node with those that it depends on."""

Stage = Literal["initialization", "step"]
"""Stage of a run: an output may depend on other inputs in initialization mode than in a step."""


def dependency_graph(
    models: Mapping[str, ModelDescription], connections: Mapping[Node, set[Node]], stage: Stage
) -> Graph:
    """Make the graph of all outputs and connected inputs.

    Parameters
    ----------
    models
        Component to its FMU.
    connections
        Connected input to the outputs that feed its elements.
    stage
        For which the dependencies are declared.
    """
    graph: Graph = {sink: set(sources) for sink, sources in connections.items()}
    inputs: dict[str, set[str]] = {name: set() for name in models}
    for sink in connections:
        inputs[sink.component].add(sink.variable)
    for name, model in models.items():
        declared = declared_dependencies(model, stage)
        for output in model.outputs:
            known = declared.get(owner(output))
            chosen = inputs[name] if known is None else inputs[name] & known
            depends = not _is_independent(model, output, stage)
            graph[Node(name, owner(output), False)] = {Node(name, each, True) for each in chosen} if depends else set()
    return graph


def _is_independent(model: ModelDescription, output: ModelVariable, stage: Stage) -> bool:
    """Whether an output depends on no input: it is known exactly, or is a sample that is held over the step."""
    return output.initial == "exact" if stage == "initialization" else model.is_sampled(output.name)


def declared_dependencies(model: ModelDescription, stage: Stage) -> dict[str, set[str] | None]:
    """Return outputs with the variables that they depend on.

    Parameters
    ----------
    model
        The FMU.
    stage
        For which: as ``InitialUnknowns`` or ``Outputs`` of the model structure.

    Returns
    -------
    dict
        A variable that is missing, or whose value is None, depends on all inputs.
    """
    unknowns = model.description.initialUnknowns if stage == "initialization" else model.description.outputs
    return {
        owner(unknown.variable): None if unknown.dependencies is None else {owner(v) for v in unknown.dependencies}
        for unknown in unknowns
        if unknown.variable is not None
    }


def order_by_dependencies(graph: Graph) -> tuple[list[list[Node]], list[Node]]:
    """Order nodes so that each comes after those that it depends on.

    Returns
    -------
    waves : list of list of Node
        Nodes of a wave depend on those of earlier waves only.
    rest : list of Node
        Nodes in loops, and those that depend on them.
    """
    sorter = TopologicalSorter(graph)
    with suppress(CycleError):  # nodes outside of loops are ordered nevertheless
        sorter.prepare()
    waves: list[list[Node]] = []
    while ready := sorter.get_ready():
        waves.append(list(ready))
        sorter.done(*ready)
    ordered = {node for wave in waves for node in wave}
    return waves, [node for node in graph if node not in ordered]


def loops(graph: Graph) -> Iterator[list[Node]]:
    """Find loops that have no node in common, each in the direction of the values, its first node at both ends."""
    graph = dict(graph)
    while True:
        try:
            TopologicalSorter(graph).prepare()
        except CycleError as error:
            loop: list[Node] = error.args[1]
            yield loop
            graph = {node: needed - set(loop) for node, needed in graph.items() if node not in loop}
        else:
            return
