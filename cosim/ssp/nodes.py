"""The nodes of a system structure with nested systems: the connectors of its components and systems."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

from fmpy.model_description import ModelVariable

from cosim.engine.compatibility import QuantityUnit
from cosim.engine.structure import Structure
from cosim.errors import Problems, SetupError, did_you_mean
from cosim.fmi.description import ModelDescription
from cosim.fmi.variable_types import KINDS
from cosim.ssp import ssd
from cosim.ssp.package import Package
from cosim.ssp.quantities import find_unit
from cosim.ssp.ssv import unit_problems
from cosim.units import Unit

ElementPath = tuple[str, ...]
"""Names of an element and the systems around it, outermost first; empty for the outermost system."""

KINDS_OF_CONNECTORS = ("input", "output", "parameter", "calculatedParameter")
"""Kinds of the connectors of components and systems; signal dictionaries may also have those of kind ``inout``."""


class Node(NamedTuple):
    """A connector of a component or of a system.

    Attributes
    ----------
    path
        The component or system.
    connector
        Name of the connector.
    """

    path: ElementPath
    connector: str

    def __str__(self) -> str:
        return ".".join((*self.path, self.connector))


def component_name(path: ElementPath) -> str:
    """Return the name of a component in the flat structure.

    Parameters
    ----------
    path
        The component.
    """
    return "/".join(path)


def connector_kind(variable: ModelVariable) -> str:
    """Return the kind of the connector of an FMU's variable.

    Parameters
    ----------
    variable
        A variable of any causality.

    Returns
    -------
    str
        ``input``, ``output``, ``calculatedParameter`` or ``parameter``.
    """
    causality = str(variable.causality)
    return causality if causality in KINDS_OF_CONNECTORS else "parameter"


class Nodes:
    """All nodes of a system structure; adds its components to a flat structure.

    Parameters
    ----------
    package
        The files.
    description
        The description.
    structure
        The flat structure.

    Attributes
    ----------
    connectors
        Path of a component or system to its declared connectors by name.
    components
        Path to component, for components with a usable FMU.
    failed
        Paths of the components without a usable FMU.
    dictionaries
        Paths of the signal dictionaries.
    problems
        All problems found.
    notes
        What a user should know, one line each.
    """

    def __init__(self, package: Package, description: ssd.SystemStructureDescription, structure: Structure) -> None:
        self.package = package
        self.structure = structure
        self.connectors: dict[ElementPath, dict[str, ssd.Connector]] = {}
        self.components: dict[ElementPath, ssd.Component] = {}
        self.failed: set[ElementPath] = set()
        self.dictionaries: set[ElementPath] = set()
        self.problems = Problems()
        self.notes: list[str] = []
        self._units = [definition.unit for definition in description.units]
        for problem in unit_problems(description.units):
            self._report(problem)
        self._add_system(description.system, ())

    @contextmanager
    def collected(self) -> Iterator[None]:
        """Collect the problems of a :class:`SetupError` that is raised inside, with the name of the description."""
        with self.problems.collected(self._located):
            yield

    def _located(self, problem: str) -> str:
        where = self.package.where
        return problem if problem.startswith(f"{where.parent}/") else f"{where}: {problem}"

    # ---- elements ----------------------------------------------------------------------------------------------------

    def _add_system(self, system: ssd.System, path: ElementPath) -> None:
        """Add the connectors and elements of a system and of the systems inside it."""
        self.connectors[path] = self._by_name(system.connectors, path)
        seen: set[str] = set()
        for element in system.elements:
            inner = (*path, element.name)
            if element.name in seen:
                self._report(f"element {'.'.join(inner)}: expected a new name, got one that is there already")
                continue
            seen.add(element.name)
            if isinstance(element, ssd.SignalDictionaryReference):
                self.dictionaries.add(inner)
            elif isinstance(element, ssd.System):
                self._add_system(element, inner)
            else:
                self.connectors[inner] = self._by_name(element.connectors, inner)
                with self.collected():
                    self._add_component(element, inner)
                if inner not in self.components:
                    del self.connectors[inner]
                    self.failed.add(inner)

    def _by_name(self, connectors: tuple[ssd.Connector, ...], path: ElementPath) -> dict[str, ssd.Connector]:
        """Return the connectors of an element by name; reports those with the name of another."""
        found: dict[str, ssd.Connector] = {}
        for connector in connectors:
            if connector.name in found:
                where = f"connector {Node(path, connector.name)}"
                self._report(f"{where}: expected a new name, got one that is there already")
            found.setdefault(connector.name, connector)
        return found

    def _report(self, problem: str) -> None:
        with self.collected():
            raise SetupError(problem)

    def _add_component(self, component: ssd.Component, path: ElementPath) -> None:
        """Add a component and check its connectors."""
        name = component_name(path)
        if component.type != ssd.FMU:
            raise SetupError(f"component {name}: expected type {ssd.FMU}, got {component.type}")
        if component.implementation == "ModelExchange":
            raise SetupError(f"component {name}: expected a co-simulation, got {component.implementation}")
        self.structure.add(name, self.package.model(component.source))
        self.components[path] = component
        for connector in component.connectors:
            with self.collected():
                self._check_connector(path, connector)
        for annotation in component.annotations:
            if isinstance(annotation.content, ssd.StepSizeHint):
                self.structure.component_steps[name] = annotation.content.value

    def model(self, path: ElementPath) -> ModelDescription:
        """Return the FMU of a component.

        Parameters
        ----------
        path
            The component.
        """
        return self.structure.models[component_name(path)]

    def variable(self, node: Node) -> ModelVariable:
        """Return the variable of a component's connector; an element of an array has that of the array.

        Parameters
        ----------
        node
            The connector; its sizes are not looked at.

        Raises
        ------
        SetupError
            If there is no such variable.
        """
        return self.model(node.path).variable_of(component_name(node.path), node.connector)

    def _check_connector(self, path: ElementPath, connector: ssd.Connector) -> None:
        """Compare a connector of a component with the FMU's variable."""
        node = Node(path, connector.name)
        where = f"connector {node}"
        variable = self.variable(node)
        problems = []
        if connector_kind(variable) != connector.kind:
            problems.append(f"{where}: expected the FMU's kind {variable.causality}, got {connector.kind}")
        kind = KINDS[variable.type]
        if connector.type is not None and connector.type.kind != kind:
            problems.append(f"{where}: expected the FMU's type {kind}, got {connector.type.kind}")
        own, declared = QuantityUnit.of(self.model(path), variable), self._declared_unit(node)
        if own.name and declared.name and (own.name != declared.name or None not in (own[1], declared[1])):
            if own.known is None or declared.known is None:
                self.notes.append(f"{where}: its unit {declared.name} is ignored, the FMU's is {own.name}")
            elif not own.known.is_close(declared.known):
                problems.append(
                    f"{where}: expected the FMU's unit {own.name}, got {declared.name} of another definition"
                )
        if problems:
            raise SetupError(*problems)

    # ---- connectors --------------------------------------------------------------------------------------------------

    def _declared_unit(self, node: Node) -> QuantityUnit:
        """Return the unit that the description declares for a connector."""
        connector = self.connectors[node.path].get(node.connector)
        if connector is None or connector.type is None:
            return QuantityUnit()
        return find_unit(connector.type.unit, self.known_units(node.path))

    def known_units(self, path: ElementPath) -> list[Unit]:
        """Return all known units by priority: those of the description, of the component, of all other components.

        Parameters
        ----------
        path
            A component or system.
        """
        models = list(self.structure.models.values())
        if path in self.components:
            models.insert(0, self.model(path))
        return [*self._units, *(unit for model in models for unit in model.defined_units)]

    def unit(self, node: Node) -> QuantityUnit:
        """Return the unit of a connector: the FMU's, else the declared one.

        Parameters
        ----------
        node
            The connector.
        """
        declared = self._declared_unit(node)
        if node.path not in self.components:
            return declared
        own = QuantityUnit.of(self.model(node.path), self.variable(node))
        if own.definition is None and own.name in (None, declared.name):
            return declared._replace(relative=own.relative)
        return own

    def kind(self, node: Node) -> str:
        """Return the kind of a connector; for a component, the FMU determines it.

        Parameters
        ----------
        node
            The connector.

        Raises
        ------
        SetupError
            If there is no such variable or connector.
        """
        if node.path in self.components:
            return connector_kind(self.variable(node))
        connectors = self.connectors[node.path]
        if node.connector not in connectors:
            raise SetupError(
                f"{node}: expected a connector of the system, got none{did_you_mean(node.connector, connectors)}"
            )
        return connectors[node.connector].kind
