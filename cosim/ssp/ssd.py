"""Elements of SSP 1.0 for system structures (``.ssd`` files).

The classes mirror the elements of the standard and have their names. Geometry, icons, unknown annotations and the
contents of signal dictionaries are ignored on reading; they do not influence results.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cosim.ssp.ssv import (
    KINDS,
    PARAMETER_MAPPING,
    PARAMETER_SET,
    TRANSFORMATIONS,
    Enumeration,
    ParameterMapping,
    ParameterSet,
    Transformation,
    UnitDefinition,
)
from cosim.ssp.xml import BOOLEAN, REAL, attribute, child, children, read_document, tag

FMU = "application/x-fmu-sharedlibrary"
"""MIME type of FMUs."""


# ---- annotations -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class FixedStep:
    """The Open Simulation Platform's fixed step algorithm, with its step size in s."""

    base_step_size: float = attribute("baseStepSize", REAL)


@dataclass(frozen=True, kw_only=True)
class OspAlgorithm:
    """The Open Simulation Platform's choice of an algorithm."""

    fixed_step: FixedStep | None = child({"osp:FixedStepAlgorithm": FixedStep})


@dataclass(frozen=True, kw_only=True)
class StepSizeHint:
    """The Open Simulation Platform's step size of one component, in s."""

    value: float = attribute("value", REAL)


@dataclass(frozen=True, kw_only=True)
class Exchange:
    """The package's algorithm of exchange; a sequential exchange has the order of the elements."""

    algorithm: str = attribute("algorithm")


@dataclass(frozen=True, kw_only=True)
class Annotation:
    """An annotation; the content is None for unknown types.

    The step size is written to the annotation of the Open Simulation Platform only, where its tools read it.
    """

    type: str = attribute("type")
    content: OspAlgorithm | StepSizeHint | Exchange | None = child(
        {"osp:Algorithm": OspAlgorithm, "osp:StepSizeHint": StepSizeHint, "exchange:Exchange": Exchange}
    )

    OSP = "com.opensimulationplatform"
    OWN = "io.github.seat-cosim.exchange"


_ANNOTATIONS = {"ssc:Annotation": Annotation}


# ---- bindings of parameters ------------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class MappingReference:
    """A mapping of parameters in a file, or inline."""

    type: str = attribute("type", default=PARAMETER_MAPPING)
    source: str | None = attribute("source", default=None)
    source_base: str = attribute("sourceBase", default="SSD")
    mapping: ParameterMapping | None = child({"ssm:ParameterMapping": ParameterMapping})


@dataclass(frozen=True, kw_only=True)
class ParameterBinding:
    """A set of parameters in a file, or inline, bound to an element with a prefix and a mapping."""

    type: str = attribute("type", default=PARAMETER_SET)
    source: str | None = attribute("source", default=None)
    source_base: str = attribute("sourceBase", default="SSD")
    prefix: str = attribute("prefix", default="")
    values: ParameterSet | None = child({"ssv:ParameterSet": ParameterSet}, container="ssd:ParameterValues")
    mapping: MappingReference | None = child({"ssd:ParameterMapping": MappingReference})


_BINDINGS = {"ssd:ParameterBinding": ParameterBinding}


# ---- structure -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Type:
    """The type of a connector, with its unit or the name of its enumeration."""

    kind: str = tag()
    unit: str | None = attribute("unit", default=None)
    enumeration: str | None = attribute("name", default=None)


@dataclass(frozen=True, kw_only=True)
class Connector:
    """A connector of a component or of a system."""

    name: str = attribute("name")
    kind: str = attribute("kind")
    type: Type | None = child({f"ssc:{kind}": Type for kind in KINDS})


@dataclass(frozen=True, kw_only=True)
class Connection:
    """A connection of two connectors, in either direction; an element of None is the system itself."""

    start_element: str | None = attribute("startElement", default=None)
    start_connector: str = attribute("startConnector")
    end_element: str | None = attribute("endElement", default=None)
    end_connector: str = attribute("endConnector")
    suppress_unit_conversion: bool = attribute("suppressUnitConversion", BOOLEAN, False)
    transformation: Transformation | None = child(TRANSFORMATIONS)

    def __str__(self) -> str:
        ends = ((self.start_element, self.start_connector), (self.end_element, self.end_connector))
        return " -> ".join(".".join(filter(None, end)) for end in ends)


@dataclass(frozen=True, kw_only=True)
class Component:
    """A component of a system: an FMU with its connectors and parameters.

    The type is written although it is the default: OMSimulator 3.0 skips components without it.
    """

    name: str = attribute("name")
    type: str = attribute("type", default=FMU, always=True)
    source: str = attribute("source")
    implementation: str = attribute("implementation", default="any")
    connectors: tuple[Connector, ...] = children({"ssd:Connector": Connector}, container="ssd:Connectors")
    bindings: tuple[ParameterBinding, ...] = children(_BINDINGS, container="ssd:ParameterBindings")
    annotations: tuple[Annotation, ...] = children(_ANNOTATIONS, container="ssd:Annotations")


@dataclass(frozen=True, kw_only=True)
class SignalDictionaryReference:
    """A reference to a signal dictionary, whose content is not read."""

    name: str = attribute("name")
    dictionary: str = attribute("dictionary")


_ELEMENTS: dict[str, type] = {}


@dataclass(frozen=True, kw_only=True)
class System:
    """A system of elements and their connections; an element itself."""

    name: str = attribute("name")
    connectors: tuple[Connector, ...] = children({"ssd:Connector": Connector}, container="ssd:Connectors")
    bindings: tuple[ParameterBinding, ...] = children(_BINDINGS, container="ssd:ParameterBindings")
    elements: tuple[Component | System | SignalDictionaryReference, ...] = children(_ELEMENTS, container="ssd:Elements")
    connections: tuple[Connection, ...] = children({"ssd:Connection": Connection}, container="ssd:Connections")


_ELEMENTS |= {
    "ssd:Component": Component,
    "ssd:System": System,
    "ssd:SignalDictionaryReference": SignalDictionaryReference,
}


@dataclass(frozen=True, kw_only=True)
class DefaultExperiment:
    """The default experiment: start and stop time in s, and annotations for the step size and the exchange."""

    start_time: float | None = attribute("startTime", REAL, None)
    stop_time: float | None = attribute("stopTime", REAL, None)
    annotations: tuple[Annotation, ...] = children(_ANNOTATIONS, container="ssd:Annotations")


@dataclass(frozen=True, kw_only=True)
class SystemStructureDescription:
    """The description of a system, the root of an ``.ssd`` file."""

    ROOT: ClassVar[str] = "ssd:SystemStructureDescription"

    version: str = attribute("version")
    name: str = attribute("name")
    generation_tool: str | None = attribute("generationTool", default=None)
    system: System = child({"ssd:System": System})
    enumerations: tuple[Enumeration, ...] = children({"ssc:Enumeration": Enumeration}, container="ssd:Enumerations")
    units: tuple[UnitDefinition, ...] = children({"ssc:Unit": UnitDefinition}, container="ssd:Units")
    experiment: DefaultExperiment | None = child({"ssd:DefaultExperiment": DefaultExperiment})


def read_description(data: bytes, where: str) -> SystemStructureDescription:
    """Read the description of a system from an ``.ssd`` file.

    Parameters
    ----------
    data
        The bytes of the file.
    where
        Name of the file in messages.

    Returns
    -------
    SystemStructureDescription
        The content of the file.

    Raises
    ------
    SetupError
        If the file is of another kind or version, or violates the schema.
    """
    return read_document(SystemStructureDescription, data, where)
