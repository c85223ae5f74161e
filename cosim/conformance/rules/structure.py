"""Rules about the model structure: outputs, derivatives and initial unknowns, and what they depend on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from cosim.conformance.fmu_archive import Subject
from cosim.conformance.model_description import FLOATS, Description, Unknown, Variable
from cosim.conformance.rule import NotApplicableError, rule
from cosim.conformance.rules.description import described

_CLAUSE = "2.0 §2.2.8; 3.0 §2.4.8"

KINDS = ("dependent", "constant", "fixed", "tunable", "discrete")
_LATER = ("fixed", "tunable", "discrete")
"""Kinds that make no sense during initialisation."""


def _entries(fmu: Subject, name: str) -> list[Unknown]:
    return [unknown for unknown in described(fmu).unknowns if unknown.list == name]


def _targets(fmu: Subject, name: str) -> set[int]:
    """Return the indices of the variables in a list."""
    found = (described(fmu).target(unknown.target) for unknown in _entries(fmu, name))
    return {variable.index for variable in found if variable is not None}


def _names(variables: list[Variable]) -> str:
    shown = ", ".join(map(str, variables[:5]))
    return shown + (f" and {len(variables) - 5} more" if len(variables) > 5 else "")


@rule("structure.references", "Entries name variables that are there, each once", clause=_CLAUSE, stage="description")
def references(fmu: Subject) -> Iterator[str]:
    found = described(fmu)
    what = "an index" if found.standard == 2 else "a value reference"
    times = Counter((unknown.list, unknown.target) for unknown in found.unknowns)
    for unknown in found.unknowns:
        where = f"{unknown.list} (line {unknown.line})"
        if found.target(unknown.target) is None:
            yield f"{where}: expected {what} of a variable, got {unknown.target}"
        for dependency in unknown.dependencies or ():
            if found.target(dependency) is None:
                yield f"{where}: expected dependencies on variables that are there, got {dependency}"
        if times.pop((unknown.list, unknown.target), 1) > 1:
            yield f"{where}: expected one entry of {found.target(unknown.target)}, got several"


@rule("structure.outputs", "Outputs are listed, and nothing else as output", clause=_CLAUSE, stage="description")
def outputs(fmu: Subject) -> Iterator[str]:
    found = described(fmu)
    listed = _targets(fmu, "Output")
    if missing := [v for v in found.variables if v.causality == "output" and v.index not in listed]:
        yield f"Outputs: expected every output, {_names(missing)} missing"
    for v in found.variables:
        if v.causality != "output" and v.index in listed:
            yield f"Outputs: expected outputs alone, got {v}, a {v.causality}"


@rule(
    "structure.initial-unknowns",
    "Initial unknowns are the calculated outputs, calculated parameters, states and derivatives",
    clause=_CLAUSE,
    stage="description",
)
def initial_unknowns(fmu: Subject) -> Iterator[str]:
    found = described(fmu)
    listed = _targets(fmu, "InitialUnknown")
    needed = {v.index for v in _initial_unknowns(found, _targets(fmu, "Derivative"))}
    if missing := [v for v in found.variables if v.index in needed - listed]:
        yield f"InitialUnknowns: expected what is calculated in the initialisation, {_names(missing)} missing"
    if extra := [v for v in found.variables if v.index in listed - needed]:
        yield f"InitialUnknowns: expected what is calculated in the initialisation alone, got {_names(extra)}"


def _initial_unknowns(found: Description, derivatives: set[int]) -> Iterator[Variable]:
    for v in found.variables:
        calculated = v.initial in ("calculated", "approx")
        if (v.causality == "output" and calculated and not v.clocks) or v.causality == "calculatedParameter":
            yield v
        if v.index in derivatives:
            state = found.target(v.derivative)
            yield from (x for x in (v, state) if x is not None and x.initial in ("calculated", "approx"))


@rule(
    "structure.derivatives",
    "Listed derivatives are declared as such",
    clause=_CLAUSE,
    stage="description",
)
def derivatives(fmu: Subject) -> Iterator[str]:
    found = described(fmu)
    listed = _targets(fmu, "Derivative")
    if not listed:
        raise NotApplicableError("no derivatives are listed")
    for v in found.variables:
        if v.index in listed and v.derivative is None:
            yield f"Derivatives: expected {v} to have the attribute derivative, got none"


@rule(
    "structure.dependencies",
    "Dependencies name what may be known, and their kinds fit",
    clause="2.0 §2.2.8; 3.0 §2.2.10, §2.4.8",
    stage="description",
)
def dependencies(fmu: Subject) -> Iterator[str]:
    found = described(fmu)
    if all(unknown.dependencies is None and unknown.kinds is None for unknown in found.unknowns):
        raise NotApplicableError("no dependencies are declared")
    states = {v.derivative for v in found.variables if v.derivative is not None}
    for unknown in found.unknowns:
        where = f"{unknown.list} {found.target(unknown.target) or unknown.target}"
        yield from (f"{where}: {problem}" for problem in _kind_problems(found, unknown))
        for number in unknown.dependencies or ():
            known = found.target(number)
            if known is not None and not _may_be_known(unknown, known, number in states):
                yield f"{where}: expected dependencies on what is known then, got {known}, {_described(known)}"


def _described(v: Variable) -> str:
    return f"{v.variability} {v.causality}, initial {v.initial or 'not given'}"


def _may_be_known(unknown: Unknown, known: Variable, state: bool) -> bool:
    """Whether an unknown can depend on a variable, rather than on what that is computed from."""
    if known.causality in ("input", "independent", "structuralParameter") or state or known.type == "Clock":
        return True
    if unknown.list == "InitialUnknown":
        return known.initial in ("exact", "approx") and known.variability != "constant"
    return known.variability == "tunable" or (
        known.causality in ("local", "output") and known.variability == "discrete"
    )


def _kind_problems(found: Description, unknown: Unknown) -> Iterator[str]:
    if unknown.kinds is None:
        return
    if unknown.dependencies is None:
        yield "expected dependencies with dependenciesKind, got none"
        return
    if len(unknown.kinds) != len(unknown.dependencies):
        yield f"expected {len(unknown.dependencies)} kinds for as many dependencies, got {len(unknown.kinds)}"
    target = found.target(unknown.target)
    for kind in dict.fromkeys(unknown.kinds):
        if kind not in KINDS:
            yield f"expected one of {', '.join(KINDS)}, got {kind}"
        elif kind != "dependent" and target is not None and target.type not in FLOATS:
            yield f"expected kind dependent of a {target.type}, got {kind}"
        elif kind in _LATER and unknown.list == "InitialUnknown":
            yield f"expected dependent or constant in the initialisation, got {kind}"


@rule(
    "structure.dependencies-told",
    "Outputs say which inputs they depend on; those that do not look like algebraic loops",
    stage="description",
    severity="warning",
)
def dependencies_told(fmu: Subject) -> Iterator[str]:
    found = described(fmu)
    if not any(v.causality == "input" for v in found.variables) or not _entries(fmu, "Output"):
        raise NotApplicableError("the FMU has no inputs, or no outputs")
    silent = [found.target(unknown.target) for unknown in _entries(fmu, "Output") if unknown.dependencies is None]
    if missing := [v for v in silent if v is not None]:
        yield f"Outputs: expected dependencies, {_names(missing)} without"
