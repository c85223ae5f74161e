"""Rules about variables: names, types, legal combinations of attributes, values and units."""

from __future__ import annotations

import math
import re
from collections import Counter, defaultdict
from collections.abc import Iterator

from cosim.conformance.fmu_archive import FmuArchive
from cosim.conformance.model_description import RawDescription, RawVariable, is_true, parse_number
from cosim.conformance.rule import NotApplicableError, rule
from cosim.conformance.rules.description import require_description
from cosim.fmi.variable_types import FLOATS, INTEGERS

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
"""Causality and variability to the legal values of ``initial``."""

RANGES = {
    "Integer": (-(2.0**31), 2.0**31 - 1),
    **{f"Int{bits}": (-(2.0 ** (bits - 1)), 2.0 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)},
    **{f"UInt{bits}": (0.0, 2.0**bits - 1) for bits in (8, 16, 32, 64)},
}
"""Integer type to its smallest and largest value."""

_QUOTED = r"'(?:[^'\\]|\\.)+'"
_PART = rf"(?:[A-Za-z_]\w*|{_QUOTED})(?:\[\d+(?:,\s?\d+)*\])?"
_IDENTIFIER = rf"{_PART}(?:\.{_PART})*"
_STRUCTURED = re.compile(rf"{_IDENTIFIER}|der\({_IDENTIFIER}(?:,\s?\d+)?\)", re.ASCII)


@rule("variables.names-unique", "Names are unique", clause=_VARIABLES, stage="description")
def names_unique(fmu: FmuArchive) -> Iterator[str]:
    lines = defaultdict(list)
    for variable in require_description(fmu).variables:
        for name in variable.names:
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
def names_legal(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    structured = found.attributes.get("variableNamingConvention", "flat") == "structured"
    for variable in found.variables:
        for name in variable.names:
            if not name or re.search(r"[\r\n\t]", name):
                yield f"{name!r} (line {variable.line}): expected a name without line breaks and tabs"
            elif structured and not _STRUCTURED.fullmatch(name):
                yield f"{variable}: expected a structured name like a.b[1], 'any text' or der(x), got {name}"


@rule(
    "variables.references",
    "Each value reference refers to one value",
    clause="2.0 §2.2.7; 3.0 §2.4.7.4",
    stage="description",
)
def references(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    if found.fmi_major == 3:
        times = Counter(v.reference for v in found.variables)
        for reference in (reference for reference, count in times.items() if count > 1):
            names = ", ".join(str(v) for v in found.variables if v.reference == reference)
            yield f"value reference {reference}: expected one variable, got {names}"
        return
    for variables in _alias_sets(found):
        settable = list(filter(_is_settable, variables))
        if len(settable) > 1:
            names = ", ".join(map(str, settable))
            expected = "expected at most one of the aliases to be settable"
            yield f"value reference {variables[0].reference}: {expected}, got {names}"


@rule(
    "variables.aliases",
    "Aliases of one value agree in unit, constancy and start value; their display units exist",
    clause="2.0 §2.2.7; 3.0 §2.4.7.3",
    stage="description",
)
def aliases(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    if found.fmi_major == 3:
        if not any(v.aliases for v in found.variables):
            raise NotApplicableError("no variable has an alias")
        yield from _alias_unit_problems(found)
        return
    sets = [variables for variables in _alias_sets(found) if len(variables) > 1]
    if not sets:
        raise NotApplicableError("no variables share a value reference")
    for variables in sets:
        yield from (f"value reference {variables[0].reference}: {text}" for text in _alias_set_problems(variables))


def _alias_unit_problems(found: RawDescription) -> Iterator[str]:
    """Yield the aliases of FMI 3.0 whose display unit does not exist."""
    units = {unit.name: unit.display_units for unit in found.units}
    for v in found.variables:
        for alias in v.aliases:
            if alias.display_unit is not None and alias.display_unit not in units.get(v.unit or "", ()):
                expected = f"a display unit of {v.unit}" if v.unit else "no display unit of a variable without a unit"
                yield f"{v}, alias {alias.name}: expected {expected}, got {alias.display_unit}"


def _alias_sets(found: RawDescription) -> list[list[RawVariable]]:
    """Return the variables of FMI 2.0 by their value: those of one reference and one type of access function."""
    sets = defaultdict(list)
    for v in found.variables:
        sets[v.reference, "Integer" if v.type == "Enumeration" else v.type].append(v)
    return list(sets.values())


def _is_settable(v: RawVariable) -> bool:
    return v.causality in ("input", "parameter")


def _alias_set_problems(variables: list[RawVariable]) -> Iterator[str]:
    units = {v.unit for v in variables}
    if len(units) > 1:
        yield f"expected one unit of all aliases, got {_each(variables, [v.unit or 'none' for v in variables])}"
    constant = [v for v in variables if v.variability == "constant"]
    if constant and len(constant) < len(variables):
        yield f"expected all aliases to be constant or none, got {_each(variables, [v.variability for v in variables])}"
    started = [v for v in variables if v.start is not None]
    if len(constant) == len(variables):
        if len({v.start for v in started}) > 1:
            starts = [" ".join(v.start or ()) for v in started]
            yield f"expected one start value of constants, got {_each(started, starts)}"
    elif len(started) > 1 and sum(map(_is_settable, variables)) < 2:  # else see variables.references
        yield f"expected a start value of one alias at most, got those of {', '.join(map(str, started))}"


def _each(variables: list[RawVariable], values: list[str]) -> str:
    return ", ".join(f"{v}: {value}" for v, value in zip(variables, values, strict=True))


@rule(
    "variables.combinations",
    "Causality, variability and initial are a legal combination",
    clause="2.0 §2.2.7; 3.0 §2.4.7.4",
    stage="description",
)
def combinations(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    for v in found.variables:
        legal = LEGAL.get((v.causality, v.variability))
        origin = "" if "variability" in v.attributes else " by default"
        if v.type == "Clock":
            continue
        if v.type not in FLOATS and v.variability == "continuous" and legal is not None:
            yield f"{v}: expected another variability of a {v.type}, got continuous{origin}"
        elif legal is None:
            yield f"{v}: expected a variability that fits {v.causality}, got {v.variability}{origin}"
        elif found.fmi_major == 2 and v.causality == "input" and "initial" in v.attributes:
            yield f"{v}: expected no initial of an input in FMI 2.0, got {v.initial}"
        elif v.initial not in legal:
            expected = " or ".join(str(initial or "no initial") for initial in legal)
            yield f"{v}: expected {expected} for {v.causality} and {v.variability}, got initial {v.initial}"


@rule(
    "variables.start",
    "There is a start value where one is required, and none where one is forbidden",
    clause="2.0 §2.2.7; 3.0 §2.4.7.4",
    stage="description",
)
def start(fmu: FmuArchive) -> Iterator[str]:
    for v in require_description(fmu).variables:
        if v.type == "Clock":
            continue
        if v.initial in ("exact", "approx") and v.start is None:
            yield f"{v}: expected a start value of {_with_article(v.causality)} with initial {v.initial}, got none"
        elif v.start is not None and (v.initial == "calculated" or v.causality == "independent"):
            why = "causality independent" if v.causality == "independent" else "initial calculated"
            yield f"{v}: expected no start value with {why}, got {v.start[0]}"


def _with_article(word: str) -> str:
    return f"{'an' if word[:1] in 'aeiou' else 'a'} {word}"


@rule(
    "variables.bounds",
    "Start values are of their type and within min and max",
    clause="2.0 §2.2.7; 3.0 §2.4.7.4",
    stage="description",
)
def bounds(fmu: FmuArchive) -> Iterator[str]:
    types = {t.name: t for t in require_description(fmu).types}
    for v in require_description(fmu).variables:
        low, high = v.minimum, v.maximum
        if low is not None and high is not None and not low <= high:
            yield f"{v}: expected min of at most max, got {low:g} and {high:g}"
            continue
        for text in v.start or ():
            declared = types.get(v.declared_type or "")
            if expected := _expected_start(v, text, declared.items if declared else ()):
                yield f"{v}: expected a start value {expected}, got {text}"
                break
    yield from _nominal_problems(fmu)


def _nominal_problems(fmu: FmuArchive) -> Iterator[str]:
    for v in require_description(fmu).variables:
        if v.nominal is not None and not (math.isfinite(v.nominal) and v.nominal != 0.0):
            yield f"{v}: expected a nominal value other than 0, got {v.nominal:g}"


def _expected_start(v: RawVariable, text: str, items: tuple[float, ...]) -> str:
    """Return what is expected of an invalid start value; empty for a valid one."""
    if v.type == "Boolean":
        return "" if text in ("true", "false", "0", "1") else "true or false"
    if v.type == "Binary":
        return "" if re.fullmatch(r"([0-9A-Fa-f]{2}|\s)*", text) else "of hexadecimal digits"
    if v.type not in (*FLOATS, *INTEGERS, "Enumeration"):
        return ""
    value = parse_number(text)
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
def types(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    declared = {t.name: t for t in found.types}
    for name, times in Counter(t.name for t in found.types).items():
        if times > 1:
            yield f"type {name}: expected one declaration, got {times}"
    for v in found.variables:
        if v.declared_type is None:
            if v.type == "Enumeration":
                yield f"{v}: expected a declared type of an enumeration, got none"
        elif v.declared_type not in declared:
            yield f"{v}: expected a type of TypeDefinitions, got {v.declared_type}, which does not exist"
        elif (base := declared[v.declared_type].type) != v.type:
            yield f"{v}: expected a declared type of base {v.type}, got {v.declared_type} of {base}"
    for t in found.types:
        if len(set(t.items)) < len(t.items):
            yield f"type {t.name}: expected items of different values, got {', '.join(f'{i:g}' for i in t.items)}"


@rule("variables.units", "Units and display units are declared", clause="2.0 §2.2.2; 3.0 §2.4.3", stage="description")
def units(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    declared = {unit.name: unit for unit in found.units}
    for name, times in Counter(unit.name for unit in found.units).items():
        if times > 1:
            yield f"unit {name}: expected one declaration, got {times}"
    for t in found.types:
        if t.unit is not None and t.unit not in declared:
            yield f"type {t.name}: expected a unit of UnitDefinitions, got {t.unit}, which does not exist"
    for v in found.variables:
        if v.attributes.get("unit") is not None and v.unit not in declared:
            yield f"{v}: expected a unit of UnitDefinitions, got {v.unit}, which does not exist"
        elif v.display_unit is not None and v.unit is None:
            yield f"{v}: expected a unit with the display unit {v.display_unit}, got none"
        elif v.display_unit is not None and v.unit in declared and v.display_unit not in declared[v.unit].display_units:
            yield f"{v}: expected a display unit of {v.unit}, got {v.display_unit}, which does not exist"


@rule(
    "variables.relative-quantities",
    "A relative quantity has a unit, and its variable and declared type agree on it",
    stage="description",
    severity="warning",
)
def relative_quantities(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    what = "relativeQuantity"
    relative = [v for v in found.variables if v.type in FLOATS and found.attribute(v, what) is not None]
    if not relative:
        raise NotApplicableError("no variable is declared as a relative quantity or not")
    declared = {t.name: t.attributes.get(what) for t in found.types}
    for v in relative:
        own, of_type = v.attributes.get(what), declared.get(v.declared_type or "")
        if own is not None and of_type is not None and is_true(own) != is_true(of_type):
            yield f"{v}: expected {what} {of_type} of its type {v.declared_type}, got {own}"
        if is_true(found.attribute(v, what)) and v.unit is None:
            yield f"{v}: expected a unit with {what}, got none"


@rule(
    "variables.units-defined",
    "Units are defined in base units, so that importers can convert",
    stage="description",
    severity="warning",
)
def units_defined(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    if not found.units:
        raise NotApplicableError("no units are declared")
    used = {v.unit for v in found.variables}
    for unit in found.units:
        if unit.name in used and not unit.has_base_unit:
            yield f"unit {unit.name}: expected a BaseUnit, got none"


@rule(
    "variables.independent",
    "There is one independent variable (FMI 2.0: at most one), a continuous real number",
    clause="2.0 §2.2.7; 3.0 §2.4.7.4",
    stage="description",
)
def independent(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    variables = [v for v in found.variables if v.causality == "independent"]
    if len(variables) > 1 or (found.fmi_major == 3 and not variables):
        names = ", ".join(map(str, variables)) or "none"
        yield f"expected {'at most ' if found.fmi_major == 2 else ''}one independent variable, got {names}"
    for v in variables:
        if v.type not in FLOATS:
            yield f"{v}: expected a real independent variable, got {_with_article(v.type)}"


@rule(
    "variables.derivatives",
    "Derivatives are real, continuous, and of an existing variable",
    clause="2.0 §2.2.7; 3.0 §2.4.7.4",
    stage="description",
)
def derivatives(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    variables = [v for v in found.variables if v.derivative is not None]
    if not variables:
        raise NotApplicableError("no variable is declared as a derivative")
    for v in variables:
        state = found.variable(v.derivative)
        if state is None:
            yield f"{v}: expected the derivative of an existing variable, got that of {v.derivative}"
        elif state.index == v.index:
            yield f"{v}: expected the derivative of another variable, got its own"
        elif state.type not in FLOATS or state.variability != "continuous":
            yield f"{v}: expected the derivative of a continuous real number, got that of {state}"
