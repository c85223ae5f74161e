"""Model description of a component: fmpy's ``ModelDescription``, XML files, GUID."""

from __future__ import annotations

import io
import uuid
from collections.abc import Sequence
from hashlib import sha256
from importlib.metadata import version
from typing import Any

import fmpy.model_description as fmi
from lxml import etree

from cosim.fmi.repairs import SAMPLED
from fmus.component import Component, DefaultExperiment
from fmus.units import dimension
from fmus.variables import VariableDeclaration

LOG_CATEGORIES = {
    "logStatusWarning": "Warnings about legal values",
    "logStatusDiscard": "Reasons of refused steps",
    "logStatusError": "Reasons of refused values and calls",
    "logAll": "All messages",
}
"""Categories of log messages with their descriptions."""


def content_guid(*contents: bytes) -> str:
    """Derive a GUID from contents; equal contents give the same GUID.

    Parameters
    ----------
    contents
        All contents that determine the behaviour of the FMU.

    Returns
    -------
    str
        In braces.

    Examples
    --------
    >>> content_guid(b"description", b"binary")
    '{06291435-4e91-0885-0972-164bf156995b}'
    """
    digest = sha256()
    for content in contents:
        digest.update(sha256(content).digest())
    return "{" + str(uuid.UUID(bytes=digest.digest()[:16])) + "}"


_TYPES = {
    "2.0": {float: "Real", int: "Integer", bool: "Boolean", str: "String"},
    "3.0": {float: "Float64", int: "Int64", bool: "Boolean", str: "String"},
}
"""Names of the types in each version of FMI."""


def _fmi_type(variable: VariableDeclaration, fmi_version: str) -> str:
    return "Enumeration" if variable.items else _TYPES[fmi_version][variable.type]


def _literal(value: float | str | None, variable: VariableDeclaration) -> str | bool | None:
    if value is None or isinstance(value, bool | str):
        return value
    return str(int(value)) if issubclass(variable.type, int) else repr(float(value))


def _unit(name: str) -> fmi.Unit:
    base = dimension(name)
    return fmi.Unit(name=name, baseUnit=fmi.BaseUnit(kg=base.kg, m=base.m, s=base.s, rad=base.rad))


def _enumeration(variable: VariableDeclaration) -> fmi.SimpleType:
    items = [fmi.Item(name=name, value=str(number)) for name, number in variable.items.items()]
    return fmi.SimpleType(name=variable.type.__name__, type="Enumeration", items=items)


def _model_variable(
    variable: VariableDeclaration, reference: int, types: dict[str, fmi.SimpleType], fmi_version: str
) -> fmi.ModelVariable:
    return fmi.ModelVariable(
        name=variable.name,
        valueReference=reference,
        type=_fmi_type(variable, fmi_version),
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


def _build_configuration(component: Component, source_files: Sequence[str]) -> fmi.BuildConfiguration:
    sources = fmi.SourceFileSet(language="C99", sourceFiles=list(source_files))
    return fmi.BuildConfiguration(modelIdentifier=component.name, sourceFileSets=[sources])


def model_description(
    component: Component,
    experiment: DefaultExperiment,
    guid: str,
    *,
    needs_execution_tool: bool,
    fmi_version: str = "2.0",
    source_files: Sequence[str] = (),
) -> fmi.ModelDescription:
    """Return the model description of a component.

    Parameters
    ----------
    component
        Component to describe.
    experiment
        Default experiment.
    guid
        GUID or instantiation token, see :func:`content_guid`.
    needs_execution_tool
        Whether the FMU needs more than its own binary, as a Python FMU does.
    fmi_version
        ``"2.0"`` or ``"3.0"``.
    source_files
        Names of the files to compile in the FMU's folder of sources.

    Returns
    -------
    fmpy.model_description.ModelDescription
        For :func:`to_xml`.
    """
    variables = component.variables
    types = {variable.name: _enumeration(variable) for variable in variables if variable.items}
    described = {v.name: _model_variable(v, number, types, fmi_version) for number, v in enumerate(variables)}
    outputs = [v for v in variables if v.causality == "output"]
    return fmi.ModelDescription(
        fmiVersion=fmi_version,
        modelName=component.name,
        instantiationToken=guid,
        description=component.description,
        license="MIT",
        version=version("seat-cosim"),
        generationTool=f"seat-cosim {version('seat-cosim')}",
        variableNamingConvention="structured",
        logCategories=[fmi.Category(name=name, description=text) for name, text in LOG_CATEGORIES.items()],
        defaultExperiment=fmi.DefaultExperiment(
            startTime="0.0", stopTime=str(experiment.stop_time), stepSize=str(experiment.step_size)
        ),
        coSimulation=fmi.CoSimulation(
            modelIdentifier=component.name,
            needsExecutionTool=needs_execution_tool,
            canHandleVariableCommunicationStepSize=True,
            canGetAndSetFMUstate=True,
            canSerializeFMUstate=True,
            canNotUseMemoryManagementFunctions=True,
            fixedInternalStepSize=component.sample_time,
        ),
        buildConfigurations=[_build_configuration(component, source_files)] if source_files else [],
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
    """Convert a model description to a ``modelDescription.xml``.

    Parameters
    ----------
    description
        Description from :func:`model_description`.

    Returns
    -------
    bytes
        XML text.
    """
    stream = io.BytesIO()
    fmi.write_model_description(description, stream)  # type: ignore[arg-type]
    root = etree.fromstring(stream.getvalue())
    if description.fmiMajorVersion == 3:
        _complete_variables(root, description)
    else:
        _complete_source_files(root, description)
    if any(v.causality == "output" and v.variability == "discrete" for v in description.modelVariables):
        _declare_sampled(root, description.fmiMajorVersion)
    return _text(root)


def _text(root: Any) -> bytes:
    etree.indent(root)
    return bytes(etree.tostring(root, encoding="utf-8", xml_declaration=True, pretty_print=True))


def _declare_sampled(root: Any, fmi_version: int) -> None:
    """Declare that discrete outputs are values at the begin of a step, which FMI has no attribute for."""
    if fmi_version == 3:
        etree.SubElement(etree.SubElement(root, "Annotations"), "Annotation", type=SAMPLED)
    else:
        annotations = etree.Element("VendorAnnotations")
        etree.SubElement(annotations, "Tool", name=SAMPLED)
        root.find("ModelVariables").addprevious(annotations)


def _complete_variables(root: Any, description: fmi.ModelDescription) -> None:
    """Add what fmpy's writer omits in FMI 3: bounds and nominal values, start values of texts as elements."""
    for element, variable in zip(root.find("ModelVariables"), description.modelVariables, strict=True):
        for attribute in ("min", "max", "nominal"):
            if (value := getattr(variable, attribute)) is not None:
                element.set(attribute, value)
        if element.tag == "String":
            etree.SubElement(element, "Start", value=element.attrib.pop("start"))


def _complete_source_files(root: Any, description: fmi.ModelDescription) -> None:
    """Add what fmpy's writer omits in FMI 2: the files to compile."""
    for configuration in description.buildConfigurations:
        files = etree.SubElement(root.find("CoSimulation"), "SourceFiles")
        for name in configuration.sourceFileSets[0].sourceFiles:
            etree.SubElement(files, "File", name=name)


def build_description_xml(description: fmi.ModelDescription, platform_options: str) -> bytes:
    """Return the ``buildDescription.xml`` of FMI 3.

    Parameters
    ----------
    description
        Description with build configurations.
    platform_options
        Options for compilers that accept those of gcc.

    Returns
    -------
    bytes
        XML text.
    """
    root = etree.Element("fmiBuildDescription", fmiVersion=description.fmiVersion)
    for configuration in description.buildConfigurations:
        element = etree.SubElement(root, "BuildConfiguration", modelIdentifier=configuration.modelIdentifier)
        for files in configuration.sourceFileSets:
            sources = etree.SubElement(
                element, "SourceFileSet", language=files.language, compiler="gcc", compilerOptions=platform_options
            )
            for name in files.sourceFiles:
                etree.SubElement(sources, "SourceFile", name=name)
    return _text(root)


def terminals_xml(component: Component, fmi_version: str) -> bytes:
    """Return the ``terminalsAndIcons.xml`` of FMI 3, with the matching rule ``plug``: equal member names fit.

    Parameters
    ----------
    component
        Component with terminals.
    fmi_version
        Version in the file.

    Returns
    -------
    bytes
        XML text.
    """
    root = etree.Element("fmiTerminalsAndIcons", fmiVersion=fmi_version)
    terminals = etree.SubElement(root, "Terminals")
    for declared in component.terminals:
        terminal = etree.SubElement(
            terminals, "Terminal", name=declared.name, matchingRule="plug", description=declared.description
        )
        for member, variable in declared.members.items():
            etree.SubElement(
                terminal, "TerminalMemberVariable", variableName=variable, memberName=member, variableKind="signal"
            )
    return _text(root)
