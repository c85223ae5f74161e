"""A component's variables as an FMI description: fmpy's ``ModelDescription``, its XML, its GUID."""

from __future__ import annotations

import io
import uuid
from hashlib import sha256
from importlib.metadata import version

import fmpy.model_description as fmi

from fmus.component import Component
from fmus.units import dimension
from fmus.variables import Variable

STOP_TIME = 3.0
"""Stop time of the default experiment, in s: the paper's bump with its decay."""

STEP_SIZE = 0.002
"""Communication step of the default experiment, in s: the controller's sample time."""

_LOG_CATEGORIES = {
    "logStatusWarning": "Legal, but worth a look",
    "logStatusDiscard": "Why a step was refused",
    "logStatusError": "Why a value was refused",
    "logAll": "All messages",
}


def content_guid(*contents: bytes) -> str:
    """Derive a GUID from contents, so that it changes with them and with nothing else.

    Parameters
    ----------
    contents
        Everything that makes the FMU behave as it does.
    """
    digest = sha256()
    for content in contents:
        digest.update(sha256(content).digest())
    return "{" + str(uuid.UUID(bytes=digest.digest()[:16])) + "}"


def _fmi_type(variable: Variable) -> str:
    if variable.items:
        return "Enumeration"
    return "Boolean" if variable.type is bool else "Real"


def _literal(value: float | None, variable: Variable) -> str | bool | None:
    if value is None or isinstance(value, bool):
        return value
    return str(int(value)) if variable.items else repr(float(value))


def _unit(name: str) -> fmi.Unit:
    base = dimension(name)
    return fmi.Unit(name=name, baseUnit=fmi.BaseUnit(kg=base.kg, m=base.m, s=base.s))


def _enumeration(variable: Variable) -> fmi.SimpleType:
    items = [fmi.Item(name=name, value=str(number)) for name, number in variable.items.items()]
    return fmi.SimpleType(name=variable.type.__name__, type="Enumeration", items=items)


def _model_variable(variable: Variable, reference: int, types: dict[str, fmi.SimpleType]) -> fmi.ModelVariable:
    return fmi.ModelVariable(
        name=variable.name,
        valueReference=reference,
        type=_fmi_type(variable),
        description=variable.description,
        causality=variable.causality,
        variability=variable.variability,
        initial=None if variable.causality == "input" else variable.initial,
        canHandleMultipleSetPerTimeInstant=False,  # an attribute of model exchange
        declaredType=types.get(variable.name),
        unit=variable.unit,
        start=_literal(variable.start, variable),
        min=_literal(variable.minimum, variable),
        max=_literal(variable.maximum, variable),
        nominal=_literal(variable.nominal, variable),
    )


def model_description(component: Component, guid: str, *, needs_execution_tool: bool) -> fmi.ModelDescription:
    """Describe a component in FMI 2.0 terms.

    Parameters
    ----------
    component
        What to describe.
    guid
        See :func:`content_guid`.
    needs_execution_tool
        Whether the FMU needs more than its own binary, as a Python FMU does.
    """
    variables = component.variables
    types = {variable.name: _enumeration(variable) for variable in variables if variable.items}
    described = {v.name: _model_variable(v, reference, types) for reference, v in enumerate(variables)}
    outputs = [v for v in variables if v.causality == "output"]
    return fmi.ModelDescription(
        fmiVersion="2.0",
        modelName=component.name,
        instantiationToken=guid,
        description=component.description,
        license="MIT",
        version=version("seat-cosim"),
        generationTool=f"seat-cosim {version('seat-cosim')}",
        variableNamingConvention="structured",
        logCategories=[fmi.Category(name=name, description=text) for name, text in _LOG_CATEGORIES.items()],
        defaultExperiment=fmi.DefaultExperiment(startTime="0.0", stopTime=str(STOP_TIME), stepSize=str(STEP_SIZE)),
        coSimulation=fmi.CoSimulation(
            modelIdentifier=component.name,
            needsExecutionTool=needs_execution_tool,
            canHandleVariableCommunicationStepSize=True,
            canGetAndSetFMUstate=True,
            canSerializeFMUstate=True,
            canNotUseMemoryManagementFunctions=True,
        ),
        unitDefinitions=[_unit(name) for name in sorted({v.unit for v in variables if v.unit})],
        typeDefinitions=list(types.values()),
        modelVariables=list(described.values()),
        outputs=[fmi.Unknown(variable=described[v.name], dependencies=[], dependenciesKind=[]) for v in outputs],
        initialUnknowns=[
            fmi.Unknown(
                variable=described[v.name],
                dependencies=[described[name] for name in v.dependencies],
                dependenciesKind=["dependent"] * len(v.dependencies),
            )
            for v in outputs
        ],
    )


def to_xml(description: fmi.ModelDescription) -> bytes:
    """Write a description as the text of a ``modelDescription.xml``."""
    stream = io.BytesIO()
    fmi.write_model_description(description, stream)  # type: ignore[arg-type]
    return stream.getvalue()
