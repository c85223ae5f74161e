"""Writing system structures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from importlib.metadata import version
from urllib.parse import quote

from fmpy.model_description import ModelVariable

from cosim.engine.structure import Connection, Structure, VariableRef
from cosim.fmi.description import ModelDescription, Value
from cosim.fmi.variable_types import KINDS
from cosim.ssp import ssd, ssv
from cosim.ssp.nodes import connector_kind
from cosim.ssp.package import DESCRIPTION
from cosim.ssp.xml import BOOLEAN, INTEGER, REAL, write_document
from cosim.units import IDENTITY, Unit, conversion


def package_contents(structure: Structure) -> dict[str, bytes]:
    """Write a system structure with all it needs.

    Parameters
    ----------
    structure
        What is described; its components stand in their order of exchange.

    Returns
    -------
    dict
        Name in the archive to content; the same structure gives the same bytes.
    """
    sources: dict[str, str] = {}
    resources: dict[str, bytes] = {}
    for name, model in structure.models.items():
        content = model.content()
        file = f"resources/{model.where.name}"
        if resources.get(file, content) != content:
            file = f"resources/{name.replace('/', '-')}.fmu"
        sources[name] = file
        resources[file] = content
    return {DESCRIPTION: write_document(_describe(structure, sources)), **resources}


def parameter_set(
    structure: Structure,
    name: str,
    parameters: Mapping[str, Value],
    description: str | None = None,
    sources: Mapping[str, str] | None = None,
) -> bytes:
    """Write parameters as a ``.ssv`` file that :func:`cosim.ssp.read_parameters` reads back.

    Parameters
    ----------
    structure
        Whose parameters they are; values are in the units of its variables, which stand in the file.
    name
        Of the set.
    parameters
        ``component.variable`` to value.
    description
        Of the set.
    sources
        ``component.variable`` to where the value comes from.

    Raises
    ------
    SetupError
        If there is no such variable, or a value does not fit it.
    """
    units: dict[str, Unit] = {}
    written = []
    for key, value in parameters.items():
        port = VariableRef.parse(key)
        variable, model = structure.variable(port), structure.models[port.component]
        given, unit = _given(model, port, value), model.defined_unit(variable)
        if given.kind == "Real" and unit is not None:
            given, units[unit.name] = replace(given, unit=unit.name), unit
        written.append(ssv.Parameter(name=key, description=(sources or {}).get(key), given=given))
    return write_document(
        ssv.ParameterSet(
            version=ssv.VERSION,
            name=name,
            description=description,
            parameters=tuple(written),
            units=tuple(ssv.UnitDefinition.of(units[name]) for name in sorted(units)),
        )
    )


def _describe(structure: Structure, sources: dict[str, str]) -> ssd.Description:
    units = _units(structure)
    components = [_component(structure, name, sources[name], units) for name in structure.order]
    connections = [_connection(structure, sink, feed) for sink, feed in structure.connections.items()]
    return ssd.Description(
        version=ssv.VERSION,
        name=structure.name,
        generation_tool=f"seat-cosim {version('seat-cosim')}",
        system=ssd.System(name=structure.name, elements=tuple(components), connections=tuple(connections)),
        units=tuple(ssv.UnitDefinition.of(units[name]) for name in sorted(units)),
        experiment=_experiment(structure),
    )


def _units(structure: Structure) -> dict[str, Unit]:
    """Collect the units of all connectors; of two by one name, the first."""
    units: dict[str, Unit] = {}
    for model in structure.models.values():
        for variable in _connected(model):
            unit = model.defined_unit(variable)
            if unit is not None:
                units.setdefault(unit.name, unit)
    return units


def _connected(model: ModelDescription) -> list[ModelVariable]:
    """List the variables that get a connector: all that can be connected."""
    return [v for v in model.variables.values() if v.causality in ("input", "output") and KINDS[v.type] in ssv.KINDS]


def _component(structure: Structure, name: str, source: str, units: Mapping[str, Unit]) -> ssd.Component:
    model = structure.models[name]
    step_size = structure.component_steps.get(name)
    hint = () if step_size is None else (ssd.StepSizeHint(value=step_size),)
    return ssd.Component(
        name=name,
        source=quote(source),
        connectors=tuple(
            ssd.Connector(name=v.name, kind=connector_kind(v), type=_type(model, v, units)) for v in _connected(model)
        ),
        bindings=_bindings(structure, name),
        annotations=tuple(ssd.Annotation(type=ssd.Annotation.OSP, content=content) for content in hint),
    )


def _type(model: ModelDescription, variable: ModelVariable, units: Mapping[str, Unit]) -> ssd.Type | None:
    """Describe a variable's type; enumerations and units of a name that is taken are left to the FMU."""
    kind = KINDS[variable.type]
    unit = model.defined_unit(variable)
    name = unit.name if unit is not None and unit in units.values() else None
    return None if kind == "Enumeration" else ssd.Type(kind=kind, unit=name)


def _bindings(structure: Structure, component: str) -> tuple[ssd.ParameterBinding, ...]:
    """Bind a component's parameters at the component itself, where all tools look."""
    model = structure.models[component]
    ports = {VariableRef.parse(name): value for name, value in structure.parameters.items()}
    given = tuple(
        ssv.Parameter(name=port.variable, given=_given(model, port, value))
        for port, value in ports.items()
        if port.component == component
    )
    values = ssv.ParameterSet(version=ssv.VERSION, name="parameters", parameters=given)
    return (ssd.ParameterBinding(values=values),) if given else ()


def _given(model: ModelDescription, port: VariableRef, value: Value) -> ssv.Given:
    """Write down a parameter's value."""
    variable = model.variable(*port)
    kind, checked = KINDS[variable.type], model.value(*port, value)
    if isinstance(checked, str):
        return ssv.Given(kind="String", text=checked)
    if kind == "Enumeration":
        items = {float(item.value): str(item.name) for item in variable.declaredType.items}
        return ssv.Given(kind=kind, text=items[checked])
    codecs = {"Real": REAL, "Integer": INTEGER, "Boolean": BOOLEAN}
    return ssv.Given(kind=kind, text=codecs[kind].write(int(checked) if kind == "Integer" else checked))


def _connection(structure: Structure, sink: VariableRef, feed: Connection) -> ssd.Connection:
    """Write down a connection, its conversion of units as a transformation: not all tools convert units."""
    source = feed.source
    units = [structure.models[port.component].defined_unit(structure.variable(port)) for port in (source, sink)]
    return ssd.Connection(
        start_element=source.component,
        start_connector=source.variable,
        end_element=sink.component,
        end_connector=sink.variable,
        suppress_unit_conversion=not feed.convert_units or conversion(*units) != IDENTITY,
        transformation=ssv.Transformation.of(feed.transformation),
    )


def _experiment(structure: Structure) -> ssd.DefaultExperiment:
    exchange = ssd.Annotation(type=ssd.Annotation.OWN, content=ssd.Exchange(algorithm=structure.algorithm))
    step = () if structure.step_size is None else (ssd.FixedStep(base_step_size=structure.step_size),)
    return ssd.DefaultExperiment(
        start_time=0.0,
        stop_time=structure.stop_time,
        annotations=(
            *(ssd.Annotation(type=ssd.Annotation.OSP, content=ssd.OspAlgorithm(fixed_step=fixed)) for fixed in step),
            exchange,
        ),
    )
