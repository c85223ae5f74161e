"""Rules about the model structure: outputs, derivatives and initial unknowns, and their dependencies."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from cosim.conformance.fmu_archive import FmuArchive
from cosim.conformance.model_description import RawDescription, RawVariable, Unknown
from cosim.conformance.rule import NotApplicableError, rule
from cosim.conformance.rules.description import require_description
from cosim.errors import listed
from cosim.fmi.variable_types import FLOATS

_CLAUSE = "2.0 §2.2.8; 3.0 §2.4.8"

KINDS = ("dependent", "constant", "fixed", "tunable", "discrete")
"""Kinds of dependencies."""

_AFTER_INITIALIZATION = ("fixed", "tunable", "discrete")
"""Kinds of dependencies that are not allowed for initial unknowns."""


def _entries(fmu: FmuArchive, name: str) -> list[Unknown]:
    return [unknown for unknown in require_description(fmu).unknowns if unknown.list == name]


def _indices(fmu: FmuArchive, name: str) -> set[int]:
    """Return the indices of the variables in a list of the model structure."""
    found = (require_description(fmu).variable(unknown.reference) for unknown in _entries(fmu, name))
    return {variable.index for variable in found if variable is not None}


def _names(variables: list[RawVariable]) -> str:
    return listed(list(map(str, variables)), most=5)


@rule("structure.references", "Entries refer to existing variables, each once", clause=_CLAUSE, stage="description")
def references(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    what = "an index" if found.fmi_major == 2 else "a value reference"
    times = Counter((unknown.list, unknown.reference) for unknown in found.unknowns)
    for unknown in found.unknowns:
        where = f"{unknown.list} (line {unknown.line})"
        if found.variable(unknown.reference) is None:
            yield f"{where}: expected {what} of a variable, got {unknown.reference}"
        for dependency in unknown.dependencies or ():
            if found.variable(dependency) is None:
                yield f"{where}: expected dependencies on existing variables, got {dependency}"
        if times.pop((unknown.list, unknown.reference), 1) > 1:
            yield f"{where}: expected one entry of {found.variable(unknown.reference)}, got several"


@rule(
    "structure.outputs",
    "All outputs are listed as outputs, and no other variables",
    clause=_CLAUSE,
    stage="description",
)
def outputs(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    listed = _indices(fmu, "Output")
    if missing := [v for v in found.variables if v.causality == "output" and v.index not in listed]:
        yield f"Outputs: expected every output, {_names(missing)} missing"
    for v in found.variables:
        if v.causality != "output" and v.index in listed:
            yield f"Outputs: expected outputs only, got {v}, a {v.causality}"


@rule(
    "structure.initial-unknowns",
    "Initial unknowns are the calculated outputs, calculated parameters, states and derivatives",
    clause=_CLAUSE,
    stage="description",
)
def initial_unknowns(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    listed = _indices(fmu, "InitialUnknown")
    needed = {v.index for v in _initial_unknowns(found, _indices(fmu, "Derivative"))}
    if missing := [v for v in found.variables if v.index in needed - listed]:
        yield f"InitialUnknowns: expected what is calculated in the initialization, {_names(missing)} missing"
    if extra := [v for v in found.variables if v.index in listed - needed]:
        yield f"InitialUnknowns: expected only what is calculated in the initialization, got {_names(extra)}"


def _initial_unknowns(found: RawDescription, derivatives: set[int]) -> Iterator[RawVariable]:
    for v in found.variables:
        calculated = v.initial in ("calculated", "approx")
        if (v.causality == "output" and calculated and not v.clocks) or v.causality == "calculatedParameter":
            yield v
        if v.index in derivatives:
            state = found.variable(v.derivative)
            yield from (x for x in (v, state) if x is not None and x.initial in ("calculated", "approx"))


@rule(
    "structure.derivatives",
    "Listed derivatives have the attribute derivative",
    clause=_CLAUSE,
    stage="description",
)
def derivatives(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    listed = _indices(fmu, "Derivative")
    if not listed:
        raise NotApplicableError("no derivatives are listed")
    for v in found.variables:
        if v.index in listed and v.derivative is None:
            yield f"Derivatives: expected {v} to have the attribute derivative, got none"


@rule(
    "structure.dependencies",
    "Dependencies refer to variables that may be known, and have legal kinds",
    clause="2.0 §2.2.8; 3.0 §2.2.10, §2.4.8",
    stage="description",
)
def dependencies(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    if all(unknown.dependencies is None and unknown.kinds is None for unknown in found.unknowns):
        raise NotApplicableError("no dependencies are declared")
    states = {v.derivative for v in found.variables if v.derivative is not None}
    for unknown in found.unknowns:
        where = f"{unknown.list} {found.variable(unknown.reference) or unknown.reference}"
        yield from (f"{where}: {problem}" for problem in _kind_problems(found, unknown))
        for reference in unknown.dependencies or ():
            known = found.variable(reference)
            if known is not None and not _may_be_known(found.fmi_major, unknown, known, reference in states):
                attributes = f"{known.variability} {known.causality}, initial {known.initial or 'not declared'}"
                yield f"{where}: expected dependencies on known variables, got {known}, {attributes}"


def _may_be_known(fmi_major: int, unknown: Unknown, known: RawVariable, is_state: bool) -> bool:
    """Return whether an unknown may depend on a variable directly; in FMI 3.0 on any parameter."""
    if fmi_major == 3 and known.causality == "parameter":
        return True
    if known.causality in ("input", "independent", "structuralParameter") or is_state or known.type == "Clock":
        return True
    if unknown.list == "InitialUnknown":
        return known.initial in ("exact", "approx") and known.variability != "constant"
    return known.variability == "tunable" or (
        known.causality in ("local", "output") and known.variability == "discrete"
    )


def _kind_problems(found: RawDescription, unknown: Unknown) -> Iterator[str]:
    if unknown.kinds is None:
        return
    if unknown.dependencies is None:
        yield "expected dependencies with dependenciesKind, got none"
        return
    if len(unknown.kinds) != len(unknown.dependencies):
        yield f"expected {len(unknown.dependencies)} kinds for as many dependencies, got {len(unknown.kinds)}"
    target = found.variable(unknown.reference)
    for kind in dict.fromkeys(unknown.kinds):
        if kind not in KINDS:
            yield f"expected one of {', '.join(KINDS)}, got {kind}"
        elif kind != "dependent" and target is not None and target.type not in FLOATS:
            yield f"expected kind dependent of a {target.type}, got {kind}"
        elif kind in _AFTER_INITIALIZATION and unknown.list == "InitialUnknown":
            yield f"expected dependent or constant in the initialization, got {kind}"


@rule(
    "structure.dependencies-told",
    "Outputs declare their dependencies; without them, importers must assume algebraic loops",
    stage="description",
    severity="warning",
)
def dependencies_declared(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    if not any(v.causality == "input" for v in found.variables) or not _entries(fmu, "Output"):
        raise NotApplicableError("the FMU has no inputs, or no outputs")
    undeclared = [unknown for unknown in _entries(fmu, "Output") if unknown.dependencies is None]
    if missing := [v for unknown in undeclared if (v := found.variable(unknown.reference)) is not None]:
        yield f"Outputs: expected dependencies, {_names(missing)} without"
