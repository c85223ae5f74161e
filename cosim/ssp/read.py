"""Reading system structures and parameter files."""

from __future__ import annotations

from pathlib import Path

from cosim.engine.structure import ALGORITHMS, Structure
from cosim.errors import SetupError
from cosim.fmi.values import Value
from cosim.ssp import ssd, ssv
from cosim.ssp.bindings import Bindings
from cosim.ssp.connections import Connections
from cosim.ssp.nodes import Nodes
from cosim.ssp.package import Package, read_file
from cosim.ssp.quantities import Hop, Quantity, set_value


def load(path: str | Path, structure: Structure) -> None:
    """Read a system structure, nested ones flattened: component ``seat`` of system ``cabin`` becomes ``cabin/seat``.

    What SSP has no place for is read from annotations: the step size from those of the Open Simulation Platform, the
    exchange from our own; with it, components step in the order of their elements. Start values of connected inputs
    are passed over, as the initial exchange overrides them, and so are parameters that fit no variable (as the standard
    says); ``structure.ignored`` names them. Connections from a calculated parameter to a parameter of another
    component, signal dictionaries as ends of connections, nested ``.ssp`` files and sources elsewhere than in the
    package are refused.

    Parameters
    ----------
    path
        An ``.ssp`` file, or an ``.ssd`` file beside its resources.
    structure
        What is filled; empty at first.

    Raises
    ------
    SetupError
        With all problems found.
    """
    package = Package(path)
    description = ssd.read_description(package.description(), str(package.where))
    nodes = Nodes(package, description, structure)
    connections = Connections(nodes, description.system)
    connections.connect()
    bindings = Bindings(nodes, connections, description.system)
    nodes.attempt(_take_experiment, description, structure)
    if nodes.problems:
        raise SetupError(*nodes.problems)
    structure.name = description.name
    structure.parameters |= {str(port): value for port, value in bindings.values.items()}
    structure.ignored = tuple(bindings.notes)


def _take_experiment(description: ssd.Description, structure: Structure) -> None:
    """Take the times and the exchange; runs begin at 0, so an experiment that does not is left alone."""
    experiment = description.experiment
    if experiment is None:
        return
    if not experiment.start_time:
        structure.stop_time = experiment.stop_time
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
    """Read a ``.ssv`` file as parameters of a run.

    Parameters
    ----------
    path
        The file; its parameters are named ``component.variable``.
    structure
        Whose parameters they are: values with a unit are converted to that of the variable.

    Returns
    -------
    dict
        ``component.variable`` to value.

    Raises
    ------
    SetupError
        With all problems found; a name that fits no variable is one.
    """
    values = ssv.read_parameter_set(read_file(Path(path), "a parameter set (.ssv)"), str(path))
    found: dict[str, Value] = {}
    problems: list[str] = []
    for parameter in values.parameters:
        try:
            port = structure.parse(parameter.name)
            variable = structure.variable(port)
            model = structure.models[port.component]
            units = [*(definition.unit for definition in values.units), *model.defined_units]
            quantity = Quantity.of(parameter.given, units, parameter.name)
            unit = model.defined_unit(variable)
            found[parameter.name] = set_value(model, *port, quantity.passed(Hop(), unit, parameter.name))
        except SetupError as error:
            problems += [f"{path}: {problem}" for problem in error.problems]
    if problems:
        raise SetupError(*problems)
    return found
