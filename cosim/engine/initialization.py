"""Initialization of connected values: in the order of the declared dependencies, and on until nothing changes.

An input keeps its start value until the outputs that feed it are known. What is in a loop is iterated to a fixed point,
or solved for by Newton's method where the iteration does not converge.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from cosim.engine.dependencies import Graph, Node, loops, order_by_dependencies
from cosim.errors import RunError, listed
from cosim.fmi.access import VariableMapping
from cosim.fmi.isolated import AnyInstance
from cosim.fmi.variable_types import KINDS

MOST_ROUNDS = 100
"""Rounds after which an iteration that still changes counts as one that does not converge."""

SETTLED = 1e-12
"""Largest change of a value, relative to its magnitude or 1, that counts as none where it does not get smaller."""

SOLVED = 1e-9
"""Largest residual of a loop that is solved for, relative to the value or 1."""


class Exchange(NamedTuple):
    """Inputs of a component that are set together, and then outputs that are got.

    Attributes
    ----------
    component
        Its name.
    inputs, outputs
        Names of variables.
    """

    component: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


def plan_exchanges(graph: Graph) -> tuple[list[Exchange], list[Node]]:
    """Plan the exchange of initial values along the dependencies.

    Parameters
    ----------
    graph
        For the initialization, see :func:`cosim.engine.dependencies.dependency_graph`.

    Returns
    -------
    exchanges : list of Exchange
        Inputs are set when all that feeds them is known, outputs are got when all that they depend on is set; outputs
        in loops come last, with inputs at their start values.
    in_loops : list of Node
        What is in loops or depends on them.
    """
    waves, in_loops = order_by_dependencies(graph)
    exchanges: list[Exchange] = []
    inputs: dict[str, list[str]] = {}
    for wave in [*waves, [node for node in in_loops if not node.is_input]]:
        outputs: dict[str, list[str]] = {}
        for node in wave:
            if not node.is_input:
                outputs.setdefault(node.component, []).append(node.variable)
        exchanges += [Exchange(name, tuple(inputs.pop(name, ())), tuple(names)) for name, names in outputs.items()]
        for node in wave:
            if node.is_input:
                inputs.setdefault(node.component, []).append(node.variable)
    return exchanges, in_loops


class Initialization:
    """Exchanges initial values between instances in initialization mode.

    Parameters
    ----------
    instances
        By component, in the order in which they step.
    mappings
        Component to where its variables are in the table.
    values
        The table.
    names
        Names of the outputs in the table.
    graph
        Dependencies in initialization mode.
    """

    def __init__(
        self,
        instances: Mapping[str, AnyInstance],
        mappings: Mapping[str, VariableMapping],
        values: np.ndarray[Any, Any],
        names: Sequence[str],
        graph: Graph,
    ) -> None:
        self._instances, self._values, self._names, self._graph = instances, values, names, graph
        self._exchanges, in_loops = plan_exchanges(graph)
        self._connected = self._sources(mappings, [node for node in graph if node.is_input])
        self._unknown = self._sources(mappings, [node for node in in_loops if self._is_real_input(node)])

    def _is_real_input(self, node: Node) -> bool:
        variable = self._instances[node.component].model.variables[node.variable]
        return node.is_input and KINDS[variable.type] == "Real"

    def _sources(self, mappings: Mapping[str, VariableMapping], inputs: Iterable[Node]) -> np.ndarray[Any, Any]:
        """Return the places in the table of the outputs that feed some inputs."""
        entries = [entry for node in inputs for entry in mappings[node.component].inputs[node.variable]]
        return np.array(sorted({entry.index for entry in entries if entry.index < len(self._names)}), dtype=int)

    def run(self, time: float) -> None:
        """Exchange values until nothing changes.

        Parameters
        ----------
        time
            Start time of the run, in s.

        Raises
        ------
        RunError
            If an FMU refuses a call, or a loop does not settle.
        """
        for component, inputs, outputs in self._exchanges:
            instance = self._instances[component]
            with instance.calling("initial exchange", time):
                instance.exchange(time, inputs, outputs)
        first = self._values.copy()
        before, last = self._iterate(time)
        if len(before) and not self._solve(first, time):
            raise RunError(self._unsettled(before, last))

    def _iterate(self, time: float) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
        """Iterate until nothing changes; returns the last two tables of an iteration that does not converge."""
        longest = len(self._instances)  # chain of dependencies
        changes: list[float] = []
        while True:
            before = self._values.copy()
            self._round(time)
            changes.append(self._change(before))
            contracting = len(changes) <= 2 * longest or changes[-1] < changes[-1 - longest]
            is_last = not contracting or len(changes) >= max(MOST_ROUNDS, 2 * longest)
            if changes[-1] == 0.0 or (is_last and changes[-1] <= SETTLED):
                return np.zeros(0), np.zeros(0)
            if is_last:
                return before, self._values.copy()

    def _change(self, before: np.ndarray[Any, Any]) -> float:
        """Return the largest change of a connected value, relative to its magnitude or 1."""
        old, new = before[self._connected], self._values[self._connected]
        with np.errstate(invalid="ignore", over="ignore"):
            changes = np.abs(new - old) / np.maximum(1.0, np.abs(old))
        same = (old == new) | (np.isnan(old) & np.isnan(new))
        return float(np.max(np.where(same, 0.0, np.where(np.isfinite(changes), changes, np.inf)), initial=0.0))

    def _round(self, time: float) -> None:
        """Set all inputs and get all outputs of each component in turn."""
        for instance in self._instances.values():
            with instance.calling("initial exchange", time):
                instance.set_inputs(time)
                instance.get_outputs(time)

    def _solve(self, first: np.ndarray[Any, Any], time: float) -> bool:
        """Solve for the values in loops by a variant of Newton's method, from those of the first exchange."""
        if not len(self._unknown):
            return False
        from scipy.optimize import root  # loaded here: few systems need it, and it takes longer than most runs

        def residual(unknown: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
            self._values[self._unknown] = unknown
            for instance in self._instances.values():
                with instance.calling("initial exchange", time):
                    instance.set_inputs(time)
            for instance in self._instances.values():
                with instance.calling("initial exchange", time):
                    instance.get_outputs(time)
            found = self._values[self._unknown] - unknown
            return found if np.isfinite(found).all() else np.full_like(found, np.finfo(float).max ** 0.5)

        self._values[:] = first
        solution = root(residual, first[self._unknown], method="hybr", tol=SETTLED).x
        found = residual(solution)  # values of variables that are not unknown follow from the round before
        for _ in self._instances:
            found = residual(solution)
        return bool(np.all(np.abs(found) <= SOLVED * np.maximum(1.0, np.abs(solution))))

    def _unsettled(self, before: np.ndarray[Any, Any], last: np.ndarray[Any, Any]) -> str:
        """Name the loop that does not settle, with the last two values of its outputs."""
        changing = [i for i in self._connected.tolist() if before[i] != last[i]]
        values = listed([f"{self._names[i]} = {before[i]:.9g} and then {last[i]:.9g}" for i in changing])
        loop = next(loops(self._graph), [])
        where = f"the loop {' -> '.join(map(str, loop))}" if loop else "FMUs that declare no loop"
        return f"initial exchange: expected {where} to settle, got {values}"
