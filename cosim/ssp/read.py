"""Read system structures and parameter files."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from cosim.engine.compatibility import QuantityUnit
from cosim.engine.structure import ALGORITHMS, Structure
from cosim.errors import Problems, SetupError, prefixed
from cosim.fmi.values import Value
from cosim.ssp import ssd, ssv
from cosim.ssp.bindings import Bindings
from cosim.ssp.connections import ConnectionGraph
from cosim.ssp.nodes import Nodes
from cosim.ssp.package import Package, read_file
from cosim.ssp.quantities import Quantity, Transfer, check_value


def load(path: str | Path, structure: Structure) -> None:
    """Read a system structure into a flat one.

    Nested systems are flattened: component ``seat`` of system ``cabin`` becomes ``cabin/seat``. The step size is read
    from the annotation of the Open Simulation Platform, the algorithm of exchange from this package's own; with the
    latter, components step in the order of their elements. Start values of connected inputs have no effect, because the
    initial exchange overrides them. Parameters for variables that do not exist are ignored, as the standard says, and
    listed in ``structure.ignored``.

    Connections from a calculated parameter to a parameter of another component, signal dictionaries as ends of
    connections, nested ``.ssp`` files and sources outside the package are not supported.

    Parameters
    ----------
    path
        An ``.ssp`` file, or an ``.ssd`` file beside its resources.
    structure
        An empty structure, which is filled.

    Raises
    ------
    SetupError
        With all problems found.
    """
    package = Package(path)
    description = ssd.read_description(package.description(), str(package.where))
    nodes = Nodes(package, description, structure)
    graph = ConnectionGraph(nodes, description.system)
    bindings = Bindings(nodes, graph, description.system)
    bindings.set_sizes()
    graph.connect()
    bindings.set_parameters()
    with nodes.collected():
        _apply_experiment(description, structure)
    nodes.problems.raise_any()
    structure.name = description.name
    structure.ignored = (*bindings.ignored, *nodes.notes)


def _apply_experiment(description: ssd.SystemStructureDescription, structure: Structure) -> None:
    """Set start and stop time, step size, algorithm and order."""
    experiment = description.experiment
    if experiment is None:
        return
    structure.start_time, structure.stop_time = experiment.start_time, experiment.stop_time
    for annotation in experiment.annotations:
        content = annotation.content
        if isinstance(content, ssd.OspAlgorithm) and content.fixed_step is not None:
            structure.step_size = content.fixed_step.base_step_size
        elif isinstance(content, ssd.Exchange):
            algorithms = [known for known in ALGORITHMS if known == content.algorithm]
            if not algorithms:
                raise SetupError(f"exchange: expected one of {', '.join(ALGORITHMS)}, got {content.algorithm}")
            structure.algorithm = algorithms[0]
            structure.order = tuple(structure.models)


def read_parameters(path: str | Path, structure: Structure) -> dict[str, Value]:
    """Read parameters of a run from an ``.ssv`` file.

    Parameters
    ----------
    path
        The file; its parameters are named ``component.variable``.
    structure
        The system; values with a unit are converted to the unit of its variable.

    Returns
    -------
    dict
        ``component.variable`` to value.

    Raises
    ------
    SetupError
        With all problems found, including names of variables that do not exist.
    """
    values = ssv.read_parameter_set(read_file(Path(path), "a parameter set (.ssv)"), str(path))
    found: dict[str, Value] = {}
    problems = Problems()
    for parameter in sorted(values.parameters, key=lambda parameter: not _is_structural(parameter.name, structure)):
        with problems.collected(), prefixed(str(path)):
            ref = structure.parse(parameter.name)
            elements = structure.elements(ref, structure.sizes(found))
            model = structure.models[ref.component]
            units = [*(definition.unit for definition in values.units), *model.defined_units]
            quantity = Quantity.of(parameter.typed_value, units, parameter.name)
            unit = QuantityUnit.of(model, model.variables[elements.variable])
            quantity = replace(quantity, unit=quantity.unit._replace(relative=unit.relative))
            quantity = quantity.transferred(Transfer(), unit, parameter.name)
            found[parameter.name] = check_value(model, elements, ref.component, quantity)
    problems.raise_any()
    return found


def _is_structural(name: str, structure: Structure) -> bool:
    """Whether a parameter gives arrays their sizes; false for a name that does not exist."""
    with suppress(SetupError):
        ref = structure.parse(name)
        return ref.component in structure.models and ref.variable in structure.models[ref.component].structural
    return False
