"""The description of a system as SSP 1.0 has it: what stands in an ``.ssd`` file, as dataclasses that mirror it.

Geometry, icons, annotations of others and the contents of signal dictionaries are passed over on reading; they change
no result.
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


# ---- annotations -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class FixedStep:
    """The Open Simulation Platform's fixed step algorithm; the step in s."""

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
    """How components exchange values; of a sequential exchange, the order is that of the elements."""

    algorithm: str = attribute("algorithm")


@dataclass(frozen=True, kw_only=True)
class Annotation:
    """What the standard has no place for; None for content of others.

    The step size stands where the Open Simulation Platform's tools look for it, and there alone.
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
    """A mapping in a file, or inline."""

    type: str = attribute("type", default=PARAMETER_MAPPING)
    source: str | None = attribute("source", default=None)
    source_base: str = attribute("sourceBase", default="SSD")
    mapping: ParameterMapping | None = child({"ssm:ParameterMapping": ParameterMapping})


@dataclass(frozen=True, kw_only=True)
class ParameterBinding:
    """Parameters in a file, or inline, and which names they go to."""

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
    """A connector's type, with its unit or the name of its enumeration."""

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
    """Two connectors; an element of None is the system itself. Which of them gives follows from their kinds."""

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
    """An FMU in its place."""

    name: str = attribute("name")
    type: str = attribute("type", default=FMU)
    source: str = attribute("source")
    implementation: str = attribute("implementation", default="any")
    connectors: tuple[Connector, ...] = children({"ssd:Connector": Connector}, container="ssd:Connectors")
    bindings: tuple[ParameterBinding, ...] = children(_BINDINGS, container="ssd:ParameterBindings")
    annotations: tuple[Annotation, ...] = children(_ANNOTATIONS, container="ssd:Annotations")


@dataclass(frozen=True, kw_only=True)
class SignalDictionaryReference:
    """A signal dictionary in its place; nothing here looks into one."""

    name: str = attribute("name")
    dictionary: str = attribute("dictionary")


_ELEMENTS: dict[str, type] = {}


@dataclass(frozen=True, kw_only=True)
class System:
    """Elements and their connections; itself an element."""

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
    """When to start and to stop, in s, and what the annotations say of the way there."""

    start_time: float | None = attribute("startTime", REAL, None)
    stop_time: float | None = attribute("stopTime", REAL, None)
    annotations: tuple[Annotation, ...] = children(_ANNOTATIONS, container="ssd:Annotations")


@dataclass(frozen=True, kw_only=True)
class Description:
    """What stands in an ``.ssd`` file."""

    ROOT: ClassVar[str] = "ssd:SystemStructureDescription"

    version: str = attribute("version")
    name: str = attribute("name")
    generation_tool: str | None = attribute("generationTool", default=None)
    system: System = child({"ssd:System": System})
    enumerations: tuple[Enumeration, ...] = children({"ssc:Enumeration": Enumeration}, container="ssd:Enumerations")
    units: tuple[UnitDefinition, ...] = children({"ssc:Unit": UnitDefinition}, container="ssd:Units")
    experiment: DefaultExperiment | None = child({"ssd:DefaultExperiment": DefaultExperiment})


def read_description(data: bytes, where: str) -> Description:
    """Read an ``.ssd`` file.

    Parameters
    ----------
    data
        Its bytes.
    where
        What to call it in messages.

    Raises
    ------
    SetupError
        If it is none, of another version, or against the schema.
    """
    return read_document(Description, data, where)
