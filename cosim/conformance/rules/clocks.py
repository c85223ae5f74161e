"""Rules about clocks of FMI 3.0: their attributes, and the variables that they clock."""

from __future__ import annotations

from collections.abc import Iterator

from cosim.conformance.fmu_archive import FmuArchive
from cosim.conformance.model_description import RawDescription, RawVariable, is_true, parse_number
from cosim.conformance.rule import NotApplicableError, rule
from cosim.conformance.rules.description import require_description

PERIODIC = ("constant", "fixed", "tunable")
"""Interval variabilities of periodic clocks."""

APERIODIC = ("changing", "countdown", "triggered")
"""Interval variabilities of all other clocks."""

_OF_PERIODIC = ("intervalDecimal", "shiftDecimal", "resolution", "intervalCounter", "shiftCounter")
"""Attributes that periodic clocks only may have."""

_CAUSALITIES = ("input", "output", "local")


def _clocks(found: RawDescription) -> list[RawVariable]:
    clocks = [v for v in found.variables if v.type == "Clock"]
    if not clocks:
        raise NotApplicableError("the FMU has no clocks")
    return clocks


@rule(
    "clocks.attributes",
    "Clocks have an interval variability and the attributes that belong to it",
    clause="3.0 §2.4.4, §2.4.7.4",
    stage="description",
)
def attributes(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    for v in _clocks(found):
        yield from (f"{v}: {problem}" for problem in _clock_problems(found, v))


def _clock_problems(found: RawDescription, v: RawVariable) -> Iterator[str]:
    if v.causality not in _CAUSALITIES:
        yield f"expected a clock of causality {' or '.join(_CAUSALITIES)}, got {v.causality}"
    if v.variability not in ("discrete", "tunable"):
        yield f"expected variability discrete or tunable, got {v.variability}"
    interval = found.attribute(v, "intervalVariability")
    if interval in PERIODIC:
        yield from _interval_problems(found, v)
    elif interval in APERIODIC:
        if extra := [name for name in _OF_PERIODIC if found.attribute(v, name) is not None]:
            yield f"expected {', '.join(extra)} of periodic clocks only, got {interval}"
    elif interval is not None:  # the schema requires the attribute
        yield f"expected intervalVariability to be one of {', '.join((*PERIODIC, *APERIODIC))}, got {interval}"


def _interval_problems(found: RawDescription, v: RawVariable) -> Iterator[str]:
    """Yield what is wrong with the interval of a periodic clock."""
    texts = {name: found.attribute(v, name) for name in _OF_PERIODIC}
    if texts["intervalDecimal"] is None and texts["intervalCounter"] is None:
        yield "expected an intervalDecimal or an intervalCounter of a periodic clock, got neither"
    for name in ("intervalDecimal", "intervalCounter", "resolution"):
        if (value := parse_number(texts[name])) is not None and not value > 0.0:
            yield f"expected {name} above 0, got {texts[name]}"
    if (shift := parse_number(texts["shiftDecimal"])) is not None and not shift >= 0.0:
        yield f"expected shiftDecimal of at least 0, got {texts['shiftDecimal']}"
    for name in ("intervalCounter", "shiftCounter"):
        if texts[name] is not None and texts["resolution"] is None:
            yield f"expected a resolution with {name}, got none"
        if texts[name] is not None and not is_true(found.attribute(v, "supportsFraction")):
            yield f"expected supportsFraction with {name}, got none"


@rule(
    "clocks.references",
    "Clocked variables refer to clocks, and are discrete or tunable",
    clause="3.0 §2.4.7.4",
    stage="description",
)
def references(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    clocked = [v for v in found.variables if v.clocks is not None]
    if not clocked:
        raise NotApplicableError("no variable is clocked")
    for v in clocked:
        if v.variability not in ("discrete", "tunable"):
            yield f"{v}: expected a discrete or tunable variable with clocks, got {v.variability}"
        for reference in v.clocks or ():
            clock = found.variable(reference)
            if clock is None:
                yield f"{v}: expected clocks that exist, got value reference {reference}"
            elif clock.type != "Clock":
                yield f"{v}: expected clocks of type Clock, got {clock} of type {clock.type}"


@rule(
    "clocks.event-mode",
    "An FMU with clocks declares event mode, without which no clock can tick",
    stage="description",
    severity="warning",
)
def event_mode(fmu: FmuArchive) -> Iterator[str]:
    found = require_description(fmu)
    clocks = _clocks(found)
    if "CoSimulation" not in found.interfaces:
        raise NotApplicableError("the FMU is not for co-simulation")
    if not found.has_capability("hasEventMode"):
        yield f"CoSimulation: expected hasEventMode with clocks, got {clocks[0]} without it"
