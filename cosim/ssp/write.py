"""Write system structures and parameter files."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from importlib.metadata import version
from itertools import chain, count
from urllib.parse import quote

from fmpy.model_description import ModelVariable

from cosim.engine.network import Connection, VariableRef
from cosim.engine.structure import Structure
from cosim.fmi.description import ModelDescription
from cosim.fmi.values import Value
from cosim.fmi.variable_types import KINDS
from cosim.ssp import ssd, ssv
from cosim.ssp.nodes import connector_kind
from cosim.ssp.package import DESCRIPTION
from cosim.ssp.xml import BOOLEAN, INTEGER, REAL, write_document
from cosim.units import IDENTITY, Unit

_FOREIGN = re.compile(r"[^\w.-]|^\.+")
"""Characters that do not belong into the name of a file."""


def package_contents(structure: Structure) -> dict[str, bytes]:
    """Return the contents of an ``.ssp`` file for a system: the description and the FMUs.

    Parameters
    ----------
    structure
        The system; its components are written in the order in which they step.

    Returns
    -------
    dict
        Name in the archive to content; the same structure gives the same bytes.
    """
    sources: dict[str, str] = {}
    resources: dict[str, bytes] = {}
    for name, model in structure.models.items():
        content = model.content()
        own = _FOREIGN.sub("-", name)
        names = chain((model.where.name, f"{own}.fmu"), (f"{own}-{number}.fmu" for number in count(2)))
        files = (f"resources/{each}" for each in names)
        file = next(file for file in files if resources.get(file, content) == content)
        sources[name] = file
        resources[file] = content
    return {DESCRIPTION: write_document(_description(structure, sources)), **resources}


def parameter_set(
    structure: Structure,
    name: str,
    parameters: Mapping[str, Value],
    description: str | None = None,
    sources: Mapping[str, str] | None = None,
) -> bytes:
    """Return the content of an ``.ssv`` file that :func:`cosim.ssp.read_parameters` reads.

    Parameters
    ----------
    structure
        The system.
    name
        Name of the set.
    parameters
        ``component.variable`` to value, in the unit of the variable, which is written to the file.
    description
        Description of the set.
    sources
        ``component.variable`` to the source of its value, which becomes the parameter's description.

    Returns
    -------
    bytes
        The same arguments give the same bytes.

    Raises
    ------
    SetupError
        If a variable does not exist, or a value is of a wrong type or out of range.
    """
    units: dict[str, Unit] = {}
    written = []
    sizes = structure.sizes(parameters)
    for key, value in parameters.items():
        ref = structure.parse(key)
        unit = structure.models[ref.component].defined_unit(structure.variable(ref))
        for variable, typed_value in _typed_values(structure, ref, value, sizes).items():
            if typed_value.kind == "Real" and unit is not None:
                typed_value, units[unit.name] = replace(typed_value, unit=unit.name), unit
            element, source = str(ref._replace(variable=variable)), (sources or {}).get(key)
            written.append(ssv.Parameter(name=element, description=source, typed_value=typed_value))
    return write_document(
        ssv.ParameterSet(
            version=ssv.VERSION,
            name=name,
            description=description,
            parameters=tuple(written),
            units=tuple(ssv.UnitDefinition.of(units[name]) for name in sorted(units)),
        )
    )


def _description(structure: Structure, sources: dict[str, str]) -> ssd.SystemStructureDescription:
    units = _units(structure)
    components = [_component(structure, name, sources[name], units) for name in structure.order]
    connections = [_connection(structure, sink, connection) for sink, connection in structure.connections.items()]
    return ssd.SystemStructureDescription(
        version=ssv.VERSION,
        name=structure.name,
        generation_tool=f"seat-cosim {version('seat-cosim')}",
        system=ssd.System(name=structure.name, elements=tuple(components), connections=tuple(connections)),
        units=tuple(ssv.UnitDefinition.of(units[name]) for name in sorted(units)),
        experiment=_experiment(structure),
    )


def _units(structure: Structure) -> dict[str, Unit]:
    """Return the units of all connectors by name; of two with one name, the first."""
    units: dict[str, Unit] = {}
    for model in structure.models.values():
        for variable in _connectable(model):
            unit = model.defined_unit(variable)
            if unit is not None:
                units.setdefault(unit.name, unit)
    return units


def _connectable(model: ModelDescription) -> list[ModelVariable]:
    """Return the variables that get a connector: all inputs and outputs of types that SSP has, but for enumerations.

    An enumeration's connector would have no type, as its items are not described; libcosim refuses such a file.
    """
    kinds = set(ssv.KINDS) - {"Enumeration"}
    return [v for v in model.variables.values() if v.causality in ("input", "output") and KINDS[v.type] in kinds]


def _connectors(structure: Structure, component: str) -> dict[str, ModelVariable]:
    """Return the connectors of a component with their variables: its own, and elements of arrays that are connected."""
    found = {v.name: v for v in _connectable(structure.models[component])}
    for sink, connection in structure.connections.items():
        for ref in (sink, connection.source):
            if ref.component == component:
                found.setdefault(ref.variable, structure.variable(ref))
    return found


def _component(structure: Structure, name: str, source: str, units: Mapping[str, Unit]) -> ssd.Component:
    model = structure.models[name]
    step_size = structure.component_steps.get(name)
    hint = () if step_size is None else (ssd.StepSizeHint(value=step_size),)
    return ssd.Component(
        name=name,
        source=quote(source),
        connectors=tuple(
            ssd.Connector(name=connector, kind=connector_kind(variable), type=_type(model, variable, units))
            for connector, variable in _connectors(structure, name).items()
        ),
        bindings=_bindings(structure, name),
        annotations=tuple(ssd.Annotation(type=ssd.Annotation.OSP, content=content) for content in hint),
    )


def _type(model: ModelDescription, variable: ModelVariable, units: Mapping[str, Unit]) -> ssd.Type | None:
    """Return the type of a variable's connector.

    Enumerations are not described, and no unit whose name belongs to another unit: the FMU describes them.
    """
    kind = KINDS[variable.type]
    unit = model.defined_unit(variable)
    name = unit.name if unit is not None and unit in units.values() else None
    return None if kind == "Enumeration" else ssd.Type(kind=kind, unit=name)


def _bindings(structure: Structure, component: str) -> tuple[ssd.ParameterBinding, ...]:
    """Return the binding of a component's parameters at the component itself, which all tools read."""
    refs = {structure.parse(name): value for name, value in structure.parameters.items()}
    parameters = tuple(
        ssv.Parameter(name=name, typed_value=typed_value)
        for ref, value in refs.items()
        if ref.component == component
        for name, typed_value in _typed_values(structure, ref, value).items()
    )
    values = ssv.ParameterSet(version=ssv.VERSION, name="parameters", parameters=parameters)
    return (ssd.ParameterBinding(values=values),) if parameters else ()


def _typed_values(
    structure: Structure, ref: VariableRef, value: Value, sizes: Mapping[str, Mapping[int, int]] | None = None
) -> dict[str, ssv.TypedValue]:
    """Check a parameter's value and return its element by the variable's name, those of an array by their names."""
    model, elements = structure.models[ref.component], structure.elements(ref, sizes)
    variable = model.variables[elements.variable]
    checked = model.value(ref.component, elements, value)
    if not isinstance(checked, tuple):
        return {ref.variable: _typed_value(variable, checked)}
    return {name: _typed_value(variable, each) for name, each in zip(elements.names, checked, strict=True)}


def _typed_value(variable: ModelVariable, checked: float | str) -> ssv.TypedValue:
    kind = KINDS[variable.type]
    if isinstance(checked, str):
        return ssv.TypedValue(kind="String", text=checked)
    if kind == "Enumeration":
        items = {float(item.value): str(item.name) for item in variable.declaredType.items}
        return ssv.TypedValue(kind=kind, text=items[checked])
    codecs = {"Real": REAL, "Integer": INTEGER, "Boolean": BOOLEAN}
    return ssv.TypedValue(kind=kind, text=codecs[kind].write(int(checked) if kind == "Integer" else checked))


def _connection(structure: Structure, sink: VariableRef, connection: Connection) -> ssd.Connection:
    """Return the element of a connection.

    The conversion of units is written as a transformation, because some tools do not convert units.
    """
    source = connection.source
    units = structure.conversion(source, sink)
    return ssd.Connection(
        start_element=source.component,
        start_connector=source.variable,
        end_element=sink.component,
        end_connector=sink.variable,
        suppress_unit_conversion=not connection.convert_units or units.transformation != IDENTITY,
        transformation=ssv.Transformation.of(connection.transformation),
    )


def _experiment(structure: Structure) -> ssd.DefaultExperiment:
    exchange = ssd.Annotation(type=ssd.Annotation.OWN, content=ssd.Exchange(algorithm=structure.algorithm))
    step = () if structure.step_size is None else (ssd.FixedStep(base_step_size=structure.step_size),)
    start = structure.start_time
    if start is None and not structure.agreed_start_time:
        start = 0.0  # that of a run; some tools expect one
    return ssd.DefaultExperiment(
        start_time=start,
        stop_time=structure.stop_time,
        annotations=(
            *(ssd.Annotation(type=ssd.Annotation.OSP, content=ssd.OspAlgorithm(fixed_step=fixed)) for fixed in step),
            exchange,
        ),
    )
