"""Rules about arrays of FMI 3.0: their sizes, their start values, and how they are read and written."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cosim.conformance.fmu_archive import FmuArchive
from cosim.conformance.harness import Harness, Row, bit_patterns, format_values, number, row_difference
from cosim.conformance.model_description import RawDescription, RawVariable
from cosim.conformance.raw_instance import WARNING, RawInstance, Values
from cosim.conformance.rule import NotApplicableError, rule
from cosim.conformance.rules.description import require_description
from cosim.conformance.rules.variables import RANGES
from cosim.fmi.variable_types import FLOATS, INTEGERS

_CLAUSE = "3.0 §2.4.7.2"

_SIZES = "UInt64"
"""Type of variables that are sizes of dimensions."""


def _arrays(found: RawDescription) -> list[RawVariable]:
    arrays = [v for v in found.variables if v.dimensions]
    if not arrays:
        raise NotApplicableError("no variable is an array")
    return arrays


@rule(
    "arrays.dimensions",
    "Dimensions have positive sizes: numbers, or structural parameters or constants of type UInt64",
    clause=_CLAUSE,
    stage="description",
)
def dimensions(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    for v in _arrays(found):
        if v.causality == "structuralParameter":
            yield f"{v}: expected a structural parameter without dimensions, got {len(v.dimensions)}"
        for position, (start, reference) in enumerate(v.dimensions, 1):
            if problem := _dimension_problem(found, start, reference):
                yield f"{v}, dimension {position}: {problem}"


def _dimension_problem(found: RawDescription, start: str, reference: str) -> str:
    """Return what is wrong with a dimension; empty for a valid one."""
    if bool(start) == bool(reference):
        return f"expected either start or valueReference, got {'both' if start else 'neither'}"
    if start:
        return "" if _is_positive(start) else f"expected a size of at least 1, got {start}"
    size = found.variable(int(reference)) if reference.strip().isdecimal() else None
    if size is None:
        return f"expected the value reference of a variable, got {reference}"
    if size.type != _SIZES:
        return f"expected a size of type {_SIZES}, got {size} of type {size.type}"
    if size.causality != "structuralParameter" and size.variability != "constant":
        return f"expected a structural parameter or a constant, got {size}, {size.variability} {size.causality}"
    if not size.start or not _is_positive(size.start[0]):
        return f"expected {size} to start at 1 at least, got {size.start[0] if size.start else 'no start value'}"
    return ""


def _is_positive(text: str) -> bool:
    return text.strip().isdecimal() and int(text) > 0


@rule(
    "arrays.start",
    "Arrays have one start value for all elements, or one for each",
    clause="3.0 §2.4.7.5",
    stage="description",
    needs=("arrays.dimensions",),
)
def start(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    for v in _arrays(found):
        shape = found.shape(v)
        if v.start is not None and shape is not None and len(v.start) not in (1, math.prod(shape)):
            expected = f"{math.prod(shape)} start values for {' x '.join(map(str, shape))} elements"
            yield f"{v}: expected {expected}, or one for all, got {len(v.start)}"


@rule(
    "arrays.access",
    "Arrays are read and written whole, alone and together with other variables",
    clause="3.0 §2.2.6.2",
    stage="behaviour",
    needs=("arrays.dimensions", "lifecycle.sequence"),
)
def access(harness: Harness) -> Iterator[str]:
    arrays = [v for v in harness.readable if v.dimensions]
    with harness.instance() as instance:
        instance.enter_initialization_mode(harness.experiment.start_time)
        together = instance.get_values(harness.readable)
        for v in arrays:
            alone = instance.get_values([v])
            if text := row_difference(alone, {v.name: together[v.name]}):
                yield f"read together with other variables: {text}"
        for v in arrays:
            if problem := _writing_problem(harness, instance, v):
                yield problem
        instance.exit_initialization_mode()
        instance.call_ok("Terminate")


def _writing_problem(harness: Harness, instance: RawInstance, v: RawVariable) -> str:
    """Write different values to the elements of an array; return what is wrong then.

    Values that the FMU rejects are no problem: not all are good for its model.
    """
    settable = [other for other in harness.readable if other.causality in ("parameter", "input")]
    before = instance.get_values(settable)
    if v not in settable or (values := _other_values(v, len(before[v.name]))) is None:
        return ""
    if instance.set_values(v, values) > WARNING:
        return ""
    after = instance.get_values(settable)
    instance.set_values(v, before[v.name])
    if bit_patterns(after[v.name]) != bit_patterns(values):
        return f"{v}: expected {format_values(values)} as written, got {format_values(after[v.name])}"
    text = row_difference(_without(v, before), _without(v, after))
    return f"after {v} was written: {text}" if text else ""


def _without(v: RawVariable, row: Row) -> Row:
    return {name: values for name, values in row.items() if name != v.name}


def _other_values(v: RawVariable, count: int) -> Values | None:
    """Return values that differ from each other, within the bounds of an array; None where there are none to try."""
    if v.type == "Boolean":
        return tuple(i % 2 == 0 for i in range(count))
    if v.type not in (*FLOATS, *INTEGERS):
        return None
    low, high = RANGES.get(v.type, (-math.inf, math.inf))
    low, high = max(low, _bound(v.minimum, low)), min(high, _bound(v.maximum, high))
    first = 0.0 if low <= 0.0 and high >= count else low if math.isfinite(low) else high - count
    step = min(1.0, (high - first) / count)
    if step <= 0.0 or (v.type in INTEGERS and step < 1.0):
        return None
    return tuple(number(v.type, first + step * i) for i in range(count))


def _bound(value: float | None, otherwise: float) -> float:
    return otherwise if value is None or math.isnan(value) else value
