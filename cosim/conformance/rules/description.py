"""Rules about the model description as a document: its schema, interfaces, capabilities and default experiment."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import fmpy
from lxml import etree

from cosim.conformance.fmu_archive import FmuArchive
from cosim.conformance.model_description import RawDescription, parse_number
from cosim.conformance.rule import Advice, NotApplicableError, rule
from cosim.fmi.repairs import DESCRIPTION

_REPORTED = 5
"""How many violations of the schema are reported."""


def require_description(fmu: FmuArchive) -> RawDescription:
    """Return an FMU's model description.

    Parameters
    ----------
    fmu
        The FMU.

    Raises
    ------
    NotApplicableError
        If the description cannot be read.
    """
    if fmu.description is None:
        raise NotApplicableError("the description cannot be read")
    return fmu.description


@cache
def _schema(fmi_major: int) -> Any:
    folder = Path(fmpy.__file__).parent / "schema" / f"fmi{fmi_major}"
    return etree.XMLSchema(file=str(folder / f"fmi{fmi_major}ModelDescription.xsd"))


@rule(
    "description.readable",
    f"{DESCRIPTION} is well-formed XML in UTF-8",
    clause="2.0 §2.2; 3.0 §2.4",
    stage="description",
)
def readable(fmu: FmuArchive) -> Iterator[str]:
    if fmu.description_bytes is None:
        raise NotApplicableError("there is no description")
    if fmu.description_problem:
        yield fmu.description_problem
        return
    document = fmu.description_root.getroottree().docinfo
    if document.encoding not in ("UTF-8", "utf-8", None):
        yield f"{DESCRIPTION}: expected encoding UTF-8, got {document.encoding}"
    if document.doctype:
        yield Advice(f"{DESCRIPTION}: expected no DOCTYPE, got one, which careful importers reject")


@rule(
    "description.version",
    "The FMU is one of FMI 2.0 or 3.0",
    clause="2.0 §2.2.1; 3.0 §2.4.1",
    stage="description",
)
def version(fmu: FmuArchive) -> Iterator[str]:
    root = fmu.description_root
    if root is None:
        raise NotApplicableError("the description cannot be read")
    if root.tag != "fmiModelDescription":
        yield f"{DESCRIPTION}: expected the element fmiModelDescription, got {root.tag}"
    elif fmu.description is None:
        yield f"fmiVersion: expected 2.0 or 3.0, got {root.get('fmiVersion')}"


@rule(
    "description.schema",
    "The description is valid against the schema",
    clause="2.0 §2.2; 3.0 §2.4",
    stage="description",
)
def schema(fmu: FmuArchive) -> Iterator[str]:
    checker = _schema(require_description(fmu).fmi_major)
    checker.validate(fmu.description_root)
    for entry in list(checker.error_log)[:_REPORTED]:
        yield f"line {entry.line}: {entry.message}"
    if len(checker.error_log) > _REPORTED:
        yield f"{len(checker.error_log) - _REPORTED} more violations of the schema"


@rule(
    "description.interface",
    "The FMU is for co-simulation",
    clause="2.0 §4.3.1; 3.0 §4.3.1",
    stage="description",
)
def interface(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    if "CoSimulation" not in found.interfaces:
        yield f"expected an element CoSimulation, got {', '.join(found.interfaces) or 'no interface'}"


@rule(
    "description.identifier",
    "The model identifier is a C identifier",
    clause="2.0 §2.2.1, §4.3.1; 3.0 §2.4.1",
    stage="description",
)
def identifier(fmu: FmuArchive) -> Iterator[str]:
    for name, attributes in require_description(fmu).interfaces.items():
        found = attributes.get("modelIdentifier", "")
        if found and not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", found):
            yield f"{name}: expected a modelIdentifier of letters, digits and _, got {found!r}"


@rule(
    "description.token",
    "The GUID or instantiation token identifies the FMU",
    clause="2.0 §2.2.1; 3.0 §2.4.1",
    stage="description",
    severity="warning",
)
def token(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    name = "guid" if found.fmi_major == 2 else "instantiationToken"
    if name not in found.attributes:
        raise NotApplicableError(f"there is no {name}, see description.schema")
    if not found.token.strip():
        yield f"{name}: expected a unique text, got an empty one"
    elif found.token != found.token.strip():
        yield f"{name}: expected no space around it, got {found.token!r}"


@rule(
    "description.date",
    "The date of generation is in UTC, in the form YYYY-MM-DDThh:mm:ssZ",
    clause="2.0 §2.2.1; 3.0 §2.4.1",
    stage="description",
    severity="warning",
)
def date(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu).attributes.get("generationDateAndTime")
    if found is None:
        raise NotApplicableError("there is no generationDateAndTime")
    if re.fullmatch(r"-?\d{4,}-\d\d-\d\dT.*", found) and not re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", found):
        yield f"generationDateAndTime: expected a time like 2026-01-31T12:00:00Z, got {found}"  # others: see the schema


@rule(
    "description.capabilities",
    "Capabilities that require others are declared with them",
    clause="2.0 §4.3.1; 3.0 §4.3.1",
    stage="description",
)
def capabilities(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    pairs = [("canSerializeFMUState", "canGetAndSetFMUState")]
    if found.fmi_major == 3:
        pairs.append(("canReturnEarlyAfterIntermediateUpdate", "providesIntermediateUpdate"))
    for capability, base in pairs:
        if found.has_capability(capability) and not found.has_capability(base):
            yield f"CoSimulation: expected {base} with {capability}, got {capability} only"
    if found.fmi_major == 3:
        step_size = parse_number(found.co_simulation.get("fixedInternalStepSize"))
        if step_size is not None and not (math.isfinite(step_size) and step_size > 0.0):
            yield f"CoSimulation: expected a fixedInternalStepSize above 0, got {step_size:g}"


@rule(
    "description.experiment",
    "The default experiment can be run",
    clause="2.0 §2.2.5; 3.0 §2.4.6",
    stage="description",
)
def experiment(fmu: FmuArchive) -> Iterator[str]:
    declared = require_description(fmu).default_experiment
    if not declared:
        raise NotApplicableError("there is no default experiment")
    values = {name: parse_number(text) for name, text in declared.items()}
    for name, value in values.items():
        if name in ("startTime", "stopTime", "stepSize", "tolerance") and not math.isfinite(value or 0.0):
            yield f"DefaultExperiment: expected a finite {name}, got {declared[name]}"
    start, stop = values.get("startTime") or 0.0, values.get("stopTime")
    step_size, tolerance = values.get("stepSize"), values.get("tolerance")
    if stop is not None and stop <= start:
        yield f"DefaultExperiment: expected a stopTime after {start:g}, got {stop:g}"
    if step_size is not None and step_size <= 0.0:
        yield f"DefaultExperiment: expected a stepSize above 0, got {step_size:g}"
    if tolerance is not None and tolerance <= 0.0:
        yield f"DefaultExperiment: expected a tolerance above 0, got {tolerance:g}"
    if step_size is not None and stop is not None and 0.0 < stop - start < step_size:
        yield Advice(f"DefaultExperiment: expected a stepSize of at most {stop - start:g}, got {step_size:g}")


@rule(
    "description.step",
    "An FMU that requires a certain communication step size declares it",
    stage="description",
    severity="warning",
)
def step(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    if "CoSimulation" not in found.interfaces or found.has_capability("canHandleVariableCommunicationStepSize"):
        raise NotApplicableError("the FMU accepts steps of any size")
    if "stepSize" not in found.default_experiment and "fixedInternalStepSize" not in found.co_simulation:
        yield (
            "canHandleVariableCommunicationStepSize is false: expected a stepSize in the DefaultExperiment, "
            "got no step size"
        )
