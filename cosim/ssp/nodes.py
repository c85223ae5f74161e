"""The nodes of a system structure, nested as it may be: the connectors of its components and systems."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from fmpy.model_description import ModelVariable

from cosim.engine.structure import Structure
from cosim.errors import SetupError, did_you_mean
from cosim.fmi.description import ModelDescription
from cosim.fmi.variable_types import KINDS
from cosim.ssp import ssd
from cosim.ssp.package import Package
from cosim.ssp.quantities import defined
from cosim.units import Unit

Path = tuple[str, ...]
"""Names of the elements from the outermost system inwards; that system itself is empty."""

GIVES_INSIDE = {"input": True, "parameter": True, "output": False, "calculatedParameter": False}
"""Kind of a system's connector to whether it gives values to those inside; an element's connector is the opposite."""


class Node(NamedTuple):
    """A connector of a component or of a system."""

    path: Path
    connector: str

    def __str__(self) -> str:
        return ".".join((*self.path, self.connector))


def component_name(path: Path) -> str:
    """Name a component of a nested system in a flat one."""
    return "/".join(path)


def connector_kind(variable: ModelVariable) -> str:
    """Return the kind of connector that a variable has."""
    causality = str(variable.causality)
    return causality if causality in GIVES_INSIDE else "parameter"


class Nodes:
    """What stands where in a system structure; its components are added to a flat one.

    Parameters
    ----------
    package
        Where the files are.
    description
        What is read.
    structure
        What the components are added to.

    Attributes
    ----------
    connectors
        Path of a component or system to its connectors as described, by name.
    components
        Path to component, of those whose FMU can be used.
    failed, dictionaries
        Paths of components whose FMU cannot be used, and of signal dictionaries.
    problems
        All that is wrong, a line each.
    """

    def __init__(self, package: Package, description: ssd.Description, structure: Structure) -> None:
        self.package = package
        self.structure = structure
        self.connectors: dict[Path, dict[str, ssd.Connector]] = {}
        self.components: dict[Path, ssd.Component] = {}
        self.failed: set[Path] = set()
        self.dictionaries: set[Path] = set()
        self.problems: list[str] = []
        self._units = [definition.unit for definition in description.units]
        self._place(description.system, ())

    def attempt(self, do: Callable[..., None], *arguments: object) -> None:
        """Do something; what is wrong with it is collected."""
        try:
            do(*arguments)
        except SetupError as error:
            where = self.package.where
            self.problems += [p if p.startswith(f"{where.parent}/") else f"{where}: {p}" for p in error.problems]

    # ---- elements ----------------------------------------------------------------------------------------------------

    def _place(self, system: ssd.System, path: Path) -> None:
        """Enter a system's connectors and elements, those of nested systems too."""
        self.connectors[path] = {connector.name: connector for connector in system.connectors}
        for element in system.elements:
            inner = (*path, element.name)
            if isinstance(element, ssd.SignalDictionaryReference):
                self.dictionaries.add(inner)
            elif inner in self.connectors:
                problem = f"element {'.'.join(inner)}: expected a new name, got one that is there already"
                self.problems.append(f"{self.package.where}: {problem}")
            elif isinstance(element, ssd.System):
                self._place(element, inner)
            else:
                self.connectors[inner] = {connector.name: connector for connector in element.connectors}
                self.attempt(self._add, element, inner)
                if inner not in self.components:
                    del self.connectors[inner]
                    self.failed.add(inner)

    def _add(self, component: ssd.Component, path: Path) -> None:
        """Add a component and check its connectors."""
        name = component_name(path)
        if component.type != ssd.FMU:
            raise SetupError(f"component {name}: expected type {ssd.FMU}, got {component.type}")
        if component.implementation == "ModelExchange":
            raise SetupError(f"component {name}: expected a co-simulation, got {component.implementation}")
        self.structure.add(name, self.package.model(component.source))
        self.components[path] = component
        for connector in component.connectors:
            self.attempt(self._check, path, connector)
        for annotation in component.annotations:
            if isinstance(annotation.content, ssd.StepSizeHint):
                self.structure.component_steps[name] = annotation.content.value

    def model(self, path: Path) -> ModelDescription:
        """Return a component's FMU."""
        return self.structure.models[component_name(path)]

    def _check(self, path: Path, connector: ssd.Connector) -> None:
        """Compare a component's connector with the FMU's variable."""
        node = Node(path, connector.name)
        where = f"connector {node}"
        model = self.model(path)
        variable = model.variable(component_name(path), connector.name)
        problems = []
        if connector_kind(variable) != connector.kind:
            problems.append(f"{where}: expected kind {variable.causality}, as the FMU says, got {connector.kind}")
        kind = KINDS[variable.type]
        if connector.type is not None and connector.type.kind != kind:
            problems.append(f"{where}: expected type {kind}, as the FMU says, got {connector.type.kind}")
        own, stated = model.defined_unit(variable), self._stated_unit(node)
        if own is not None and stated is not None and own[1:] != stated[1:]:
            problems.append(
                f"{where}: expected unit {own.name}, as the FMU says, got {stated.name} of another definition"
            )
        if problems:
            raise SetupError(*problems)

    # ---- connectors --------------------------------------------------------------------------------------------------

    def _stated_unit(self, node: Node) -> Unit | None:
        """Return the unit that the description states for a connector."""
        connector = self.connectors[node.path].get(node.connector)
        if connector is None or connector.type is None:
            return None
        return defined(connector.type.unit, self.known_units(node.path), f"connector {node}")

    def known_units(self, path: Path) -> list[Unit]:
        """List units by what counts first: the description's, the component's own, all others."""
        models = list(self.structure.models.values())
        if path in self.components:
            models.insert(0, self.model(path))
        return [*self._units, *(unit for model in models for unit in model.defined_units)]

    def unit(self, node: Node) -> Unit | None:
        """Return a connector's unit: the FMU's, else what the description states, else None."""
        if node.path in self.components:
            model = self.model(node.path)
            own = model.defined_unit(model.variable(component_name(node.path), node.connector))
            if own is not None:
                return own
        return self._stated_unit(node)

    def kind(self, node: Node) -> str:
        """Return a connector's kind, which of a component's is the FMU's business."""
        if node.path in self.components:
            return connector_kind(self.model(node.path).variable(component_name(node.path), node.connector))
        connectors = self.connectors[node.path]
        if node.connector not in connectors:
            raise SetupError(
                f"{node}: expected a connector of the system, got none{did_you_mean(node.connector, connectors)}"
            )
        return connectors[node.connector].kind

    def is_parameter(self, node: Node) -> bool:
        """Whether a connector takes part before a run alone."""
        return self.kind(node) in ("parameter", "calculatedParameter")
