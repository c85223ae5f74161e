"""Rules about variables: names, types, legal combinations of attributes, values and units."""

from __future__ import annotations

import math
import re
from collections import Counter, defaultdict
from collections.abc import Iterator

from cosim.conformance.fmu_archive import Subject
from cosim.conformance.model_description import FLOATS, INTEGERS, Variable, number
from cosim.conformance.rule import NotApplicableError, rule
from cosim.conformance.rules.description import described

_VARIABLES = "2.0 §2.2.7; 3.0 §2.4.7"

LEGAL = {
    ("structuralParameter", "fixed"): ("exact",),
    ("structuralParameter", "tunable"): ("exact",),
    ("parameter", "fixed"): ("exact",),
    ("parameter", "tunable"): ("exact",),
    ("calculatedParameter", "fixed"): ("calculated", "approx"),
    ("calculatedParameter", "tunable"): ("calculated", "approx"),
    ("input", "discrete"): ("exact",),
    ("input", "continuous"): ("exact",),
    ("output", "constant"): ("exact",),
    ("output", "discrete"): ("calculated", "exact", "approx"),
    ("output", "continuous"): ("calculated", "exact", "approx"),
    ("local", "constant"): ("exact",),
    ("local", "fixed"): ("calculated", "approx"),
    ("local", "tunable"): ("calculated", "approx"),
    ("local", "discrete"): ("calculated", "exact", "approx"),
    ("local", "continuous"): ("calculated", "exact", "approx"),
    ("independent", "continuous"): (None,),
}
"""Causality and variability to what ``initial`` may be."""

RANGES = {
    "Integer": (-(2.0**31), 2.0**31 - 1),
    **{f"Int{bits}": (-(2.0 ** (bits - 1)), 2.0 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)},
    **{f"UInt{bits}": (0.0, 2.0**bits - 1) for bits in (8, 16, 32, 64)},
}
"""What fits into an integer type."""

_QUOTED = r"'(?:[^'\\]|\\.)+'"
_PART = rf"(?:[A-Za-z_]\w*|{_QUOTED})(?:\[\d+(?:,\s?\d+)*\])?"
_IDENTIFIER = rf"{_PART}(?:\.{_PART})*"
_STRUCTURED = re.compile(rf"{_IDENTIFIER}|der\({_IDENTIFIER}(?:,\s?\d+)?\)", re.ASCII)


@rule("variables.names-unique", "Each name comes once", clause=_VARIABLES, stage="description")
def names_unique(fmu: Subject) -> Iterator[str]:
    lines = defaultdict(list)
    for variable in described(fmu).variables:
        for name in (variable.name, *variable.aliases):
            lines[name].append(variable.line)
    for name, found in lines.items():
        if len(found) > 1:
            yield f"{name}: expected one variable of this name, got those of lines {', '.join(map(str, found))}"


@rule(
    "variables.names-legal",
    "Names follow the naming convention",
    clause="2.0 §2.2.9; 3.0 §2.4.7.5",
    stage="description",
)
def names_legal(fmu: Subject) -> Iterator[str]:
    found = described(fmu)
    structured = found.attributes.get("variableNamingConvention", "flat") == "structured"
    for variable in found.variables:
        for name in (variable.name, *variable.aliases):
            if not name or re.search(r"[\r\n\t]", name):
                yield f"{name!r} (line {variable.line}): expected a name without line breaks and tabs"
            elif structured and not _STRUCTURED.fullmatch(name):
                yield f"{variable}: expected a structured name like a.b[1], 'any text' or der(x), got {name}"


@rule(
    "variables.references",
    "Value references name one value",
    clause="2.0 §2.2.7; 3.0 §2.4.7.4",
    stage="description",
)
def references(fmu: Subject) -> Iterator[str]:
    found = described(fmu)
    sets = defaultdict(list)
    for variable in found.variables:
        base = "Integer" if found.standard == 2 and variable.type == "Enumeration" else variable.type
        sets[variable.reference, base if found.standard == 2 else ""].append(variable)
    for (reference, _), variables in sets.items():
        if found.standard == 3 and len(variables) > 1:
            names = ", ".join(map(str, variables))
            yield f"value reference {reference}: expected one variable, got {names}"
        settable = [v for v in variables if v.causality in ("input", "parameter")]
        if found.standard == 2 and len(settable) > 1:
            names = ", ".join(map(str, settable))
            yield f"value reference {reference}: expected at most one of the aliases to be settable, got {names}"


@rule(
    "variables.combinations",
    "Causality, variability and initial go together",
    clause="2.0 §2.2.7; 3.0 §2.4.7.4",
    stage="description",
)
def combinations(fmu: Subject) -> Iterator[str]:
    standard = described(fmu).standard
    for v in described(fmu).variables:
        legal = LEGAL.get((v.causality, v.variability))
        origin = "" if "variability" in v.given else " by default"
        if v.type == "Clock":
            continue
        if v.type not in FLOATS and v.variability == "continuous" and legal is not None:
            yield f"{v}: expected another variability of a {v.type}, got continuous{origin}"
        elif legal is None:
            yield f"{v}: expected a variability that fits {v.causality}, got {v.variability}{origin}"
        elif standard == 2 and v.causality == "input" and "initial" in v.given:
            yield f"{v}: expected no initial of an input in FMI 2.0, got {v.initial}"
        elif v.initial not in legal:
            expected = " or ".join(str(initial or "no initial") for initial in legal)
            yield f"{v}: expected {expected} for {v.causality} and {v.variability}, got initial {v.initial}"


@rule(
    "variables.start",
    "There is a start value where one is needed, and none where one is forbidden",
    clause="2.0 §2.2.7; 3.0 §2.4.7.4",
    stage="description",
)
def start(fmu: Subject) -> Iterator[str]:
    for v in described(fmu).variables:
        if v.type == "Clock":
            continue
        if v.initial in ("exact", "approx") and v.start is None:
            yield f"{v}: expected a start value of {_article(v.causality)} with initial {v.initial}, got none"
        elif v.start is not None and (v.initial == "calculated" or v.causality == "independent"):
            why = "causality independent" if v.causality == "independent" else "initial calculated"
            yield f"{v}: expected no start value with {why}, got {v.start[0]}"


def _article(word: str) -> str:
    return f"{'an' if word[:1] in 'aeiou' else 'a'} {word}"


@rule(
    "variables.bounds",
    "Start values are of their type and within min and max",
    clause="2.0 §2.2.7; 3.0 §2.4.7.4",
    stage="description",
)
def bounds(fmu: Subject) -> Iterator[str]:
    types = {t.name: t for t in described(fmu).types}
    for v in described(fmu).variables:
        low, high = v.minimum, v.maximum
        if low is not None and high is not None and not low <= high:
            yield f"{v}: expected min of at most max, got {low:g} and {high:g}"
            continue
        for text in v.start or ():
            declared = types.get(v.declared or "")
            if problem := _unfit(v, text, declared.items if declared else ()):
                yield f"{v}: expected a start value {problem}, got {text}"
                break
    yield from _nominals(fmu)


def _nominals(fmu: Subject) -> Iterator[str]:
    for v in described(fmu).variables:
        if v.nominal is not None and not (math.isfinite(v.nominal) and v.nominal != 0.0):
            yield f"{v}: expected a nominal value other than 0, got {v.nominal:g}"


def _unfit(v: Variable, text: str, items: tuple[float, ...]) -> str:
    """Say what a start value should be like; nothing of one that is."""
    if v.type == "Boolean":
        return "" if text in ("true", "false", "0", "1") else "true or false"
    if v.type == "Binary":
        return "" if re.fullmatch(r"([0-9A-Fa-f]{2}|\s)*", text) else "of hexadecimal digits"
    if v.type not in (*FLOATS, *INTEGERS, "Enumeration"):
        return ""
    value = number(text)
    assert value is not None
    if v.type not in FLOATS and not value.is_integer():
        return "that is a whole number"
    if math.isnan(value):
        return "that is a number"
    if v.type == "Enumeration" and items and value not in items:
        return f"among the items {', '.join(f'{item:g}' for item in items)}"
    low, high = RANGES.get(v.type, (-math.inf, math.inf))
    low = low if v.minimum is None or math.isnan(v.minimum) else max(low, v.minimum)
    high = high if v.maximum is None or math.isnan(v.maximum) else min(high, v.maximum)
    return "" if low <= value <= high else f"in [{low:g}, {high:g}]"


@rule(
    "variables.types",
    "Declared types exist, have the variable's base type, and enumerations have one",
    clause="2.0 §2.2.3; 3.0 §2.4.4",
    stage="description",
)
def types(fmu: Subject) -> Iterator[str]:
    found = described(fmu)
    declared = {t.name: t for t in found.types}
    for name, times in Counter(t.name for t in found.types).items():
        if times > 1:
            yield f"type {name}: expected one declaration, got {times}"
    for v in found.variables:
        if v.declared is None and v.type == "Enumeration":
            yield f"{v}: expected a declared type of an enumeration, got none"
        elif v.declared is not None and v.declared not in declared:
            yield f"{v}: expected a type of TypeDefinitions, got {v.declared}, which is not there"
        elif v.declared is not None and declared[v.declared].type != v.type:
            yield f"{v}: expected a declared type of base {v.type}, got {v.declared} of {declared[v.declared].type}"
    for t in found.types:
        if len(set(t.items)) < len(t.items):
            yield f"type {t.name}: expected items of different values, got {', '.join(f'{i:g}' for i in t.items)}"


@rule("variables.units", "Units and display units are declared", clause="2.0 §2.2.2; 3.0 §2.4.3", stage="description")
def units(fmu: Subject) -> Iterator[str]:
    found = described(fmu)
    declared = {unit.name: unit for unit in found.units}
    for name, times in Counter(unit.name for unit in found.units).items():
        if times > 1:
            yield f"unit {name}: expected one declaration, got {times}"
    for t in found.types:
        if t.unit is not None and t.unit not in declared:
            yield f"type {t.name}: expected a unit of UnitDefinitions, got {t.unit}, which is not there"
    for v in found.variables:
        if v.given.get("unit") is not None and v.unit not in declared:
            yield f"{v}: expected a unit of UnitDefinitions, got {v.unit}, which is not there"
        elif v.display_unit is not None and v.unit is None:
            yield f"{v}: expected a unit with the display unit {v.display_unit}, got none"
        elif v.display_unit is not None and v.display_unit not in declared[v.unit or ""].display_units:
            yield f"{v}: expected a display unit of {v.unit}, got {v.display_unit}, which is not there"


@rule(
    "variables.units-defined",
    "Units are defined in base units, so that importers can convert",
    stage="description",
    severity="warning",
)
def units_defined(fmu: Subject) -> Iterator[str]:
    found = described(fmu)
    if not found.units:
        raise NotApplicableError("no units are declared")
    used = {v.unit for v in found.variables}
    for unit in found.units:
        if unit.name in used and not unit.defined:
            yield f"unit {unit.name}: expected a BaseUnit, got none"


@rule(
    "variables.independent",
    "There is one independent variable (FMI 2.0: at most one), a continuous real number",
    clause="2.0 §2.2.7; 3.0 §2.4.7.4",
    stage="description",
)
def independent(fmu: Subject) -> Iterator[str]:
    found = described(fmu)
    variables = [v for v in found.variables if v.causality == "independent"]
    if len(variables) > 1 or (found.standard == 3 and not variables):
        names = ", ".join(map(str, variables)) or "none"
        yield f"expected {'at most ' if found.standard == 2 else ''}one independent variable, got {names}"
    for v in variables:
        if v.type not in FLOATS:
            yield f"{v}: expected a real independent variable, got {_article(v.type)}"


@rule(
    "variables.derivatives",
    "Derivatives are real, continuous, and of a variable that is there",
    clause="2.0 §2.2.7; 3.0 §2.4.7.4",
    stage="description",
)
def derivatives(fmu: Subject) -> Iterator[str]:
    found = described(fmu)
    variables = [v for v in found.variables if v.derivative is not None]
    if not variables:
        raise NotApplicableError("no variable is declared as a derivative")
    for v in variables:
        state = found.target(v.derivative)
        if state is None:
            yield f"{v}: expected the derivative of a variable that is there, got that of {v.derivative}"
        elif state.index == v.index:
            yield f"{v}: expected the derivative of another variable, got its own"
        elif state.type not in FLOATS or state.variability != "continuous":
            yield f"{v}: expected the derivative of a continuous real number, got that of {state}"
