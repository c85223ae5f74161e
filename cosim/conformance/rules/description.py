"""Rules about the description as a document: its schema, what the FMU is, what it claims to be able to do."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import fmpy
from lxml import etree

from cosim.conformance.fmu_archive import Subject
from cosim.conformance.model_description import Description, number
from cosim.conformance.rule import Advice, NotApplicableError, rule
from cosim.fmi.repairs import DESCRIPTION

_SHOWN = 5
"""How many violations of the schema are told."""


def described(fmu: Subject) -> Description:
    """Return an FMU's description.

    Raises
    ------
    NotApplicableError
        If there is none that can be read.
    """
    if fmu.description is None:
        raise NotApplicableError("the description cannot be read")
    return fmu.description


@cache
def _schema(standard: int) -> Any:
    folder = Path(fmpy.__file__).parent / "schema" / f"fmi{standard}"
    return etree.XMLSchema(file=str(folder / f"fmi{standard}ModelDescription.xsd"))


@rule(
    "description.readable",
    f"{DESCRIPTION} is well-formed XML in UTF-8",
    clause="2.0 §2.2; 3.0 §2.4",
    stage="description",
)
def readable(fmu: Subject) -> Iterator[str]:
    if fmu.text is None:
        raise NotApplicableError("there is no description")
    if fmu.problem:
        yield fmu.problem
        return
    if fmu.tree.getroottree().docinfo.encoding not in ("UTF-8", "utf-8", None):
        yield f"{DESCRIPTION}: expected encoding UTF-8, got {fmu.tree.getroottree().docinfo.encoding}"
    if fmu.tree.getroottree().docinfo.doctype:
        yield Advice(f"{DESCRIPTION}: expected no DOCTYPE, got one, which careful importers refuse")


@rule(
    "description.version",
    "The FMU is one of FMI 2.0 or 3.0",
    clause="2.0 §2.2.1; 3.0 §2.4.1",
    stage="description",
)
def version(fmu: Subject) -> Iterator[str]:
    if fmu.tree is None:
        raise NotApplicableError("the description cannot be read")
    if fmu.tree.tag != "fmiModelDescription":
        yield f"{DESCRIPTION}: expected the element fmiModelDescription, got {fmu.tree.tag}"
    elif fmu.description is None:
        yield f"fmiVersion: expected 2.0 or 3.0, got {fmu.tree.get('fmiVersion')}"


@rule("description.schema", "The description fits the schema", clause="2.0 §2.2; 3.0 §2.4", stage="description")
def schema(fmu: Subject) -> Iterator[str]:
    checker = _schema(described(fmu).standard)
    checker.validate(fmu.tree)
    for entry in list(checker.error_log)[:_SHOWN]:
        yield f"line {entry.line}: {entry.message}"
    if len(checker.error_log) > _SHOWN:
        yield f"{len(checker.error_log) - _SHOWN} more violations of the schema"


@rule(
    "description.interface",
    "The FMU is for co-simulation",
    clause="2.0 §4.3.1; 3.0 §4.3.1",
    stage="description",
)
def interface(fmu: Subject) -> Iterator[str]:
    found = described(fmu)
    if "CoSimulation" not in found.interfaces:
        yield f"expected an element CoSimulation, got {', '.join(found.interfaces) or 'no interface'}"


@rule(
    "description.identifier",
    "The model identifier is a name in C",
    clause="2.0 §2.2.1, §4.3.1; 3.0 §2.4.1",
    stage="description",
)
def identifier(fmu: Subject) -> Iterator[str]:
    for name, attributes in described(fmu).interfaces.items():
        found = attributes.get("modelIdentifier", "")
        if found and not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", found):
            yield f"{name}: expected a modelIdentifier of letters, digits and _, got {found!r}"


@rule(
    "description.token",
    "The GUID or instantiation token tells FMUs apart",
    clause="2.0 §2.2.1; 3.0 §2.4.1",
    stage="description",
    severity="warning",
)
def token(fmu: Subject) -> Iterator[str]:
    found = described(fmu)
    name = "guid" if found.standard == 2 else "instantiationToken"
    if name not in found.attributes:
        raise NotApplicableError(f"there is no {name}, as the rule on the schema tells")
    if not found.token.strip():
        yield f"{name}: expected a text of its own, got an empty one"
    elif found.token != found.token.strip():
        yield f"{name}: expected no space around it, got {found.token!r}"


@rule(
    "description.capabilities",
    "Capabilities that rest on others come with them",
    clause="2.0 §4.3.1; 3.0 §4.3.1",
    stage="description",
)
def capabilities(fmu: Subject) -> Iterator[str]:
    found = described(fmu)
    pairs = [("canSerializeFMUState", "canGetAndSetFMUState")]
    if found.standard == 3:
        pairs.append(("canReturnEarlyAfterIntermediateUpdate", "providesIntermediateUpdate"))
    for capability, base in pairs:
        if found.can(capability) and not found.can(base):
            yield f"CoSimulation: expected {base} with {capability}, got {capability} alone"
    if found.standard == 3:
        step = number(found.co_simulation.get("fixedInternalStepSize"))
        if step is not None and not (math.isfinite(step) and step > 0.0):
            yield f"CoSimulation: expected a fixedInternalStepSize above 0, got {step:g}"


@rule(
    "description.experiment",
    "The default experiment can be run",
    clause="2.0 §2.2.5; 3.0 §2.4.6",
    stage="description",
)
def experiment(fmu: Subject) -> Iterator[str]:
    found = described(fmu).experiment
    if not found:
        raise NotApplicableError("there is no default experiment")
    values = {name: number(text) for name, text in found.items()}
    for name, value in values.items():
        if name in ("startTime", "stopTime", "stepSize", "tolerance") and not math.isfinite(value or 0.0):
            yield f"DefaultExperiment: expected a finite {name}, got {found[name]}"
    start, stop = values.get("startTime") or 0.0, values.get("stopTime")
    step, tolerance = values.get("stepSize"), values.get("tolerance")
    if stop is not None and stop <= start:
        yield f"DefaultExperiment: expected a stopTime after {start:g}, got {stop:g}"
    if step is not None and step <= 0.0:
        yield f"DefaultExperiment: expected a stepSize above 0, got {step:g}"
    if tolerance is not None and tolerance <= 0.0:
        yield f"DefaultExperiment: expected a tolerance above 0, got {tolerance:g}"
    if step is not None and stop is not None and 0.0 < stop - start < step:
        yield Advice(f"DefaultExperiment: expected a stepSize of at most {stop - start:g}, got {step:g}")


@rule(
    "description.step",
    "An FMU of one communication step says which",
    stage="description",
    severity="warning",
)
def step(fmu: Subject) -> Iterator[str]:
    found = described(fmu)
    if "CoSimulation" not in found.interfaces or found.can("canHandleVariableCommunicationStepSize"):
        raise NotApplicableError("the FMU takes steps of any size")
    if "stepSize" not in found.experiment and "fixedInternalStepSize" not in found.co_simulation:
        yield (
            "canHandleVariableCommunicationStepSize is false: expected a stepSize in the DefaultExperiment, "
            "got nothing that tells which steps it takes"
        )
