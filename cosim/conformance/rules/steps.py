"""Rules about the run: steps, time, bounds, and what may change when."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cosim.conformance.harness import Bench, bits, difference, show
from cosim.conformance.model_description import FLOATS, INTEGERS, Variable, number
from cosim.conformance.raw_instance import STATUS, WARNING
from cosim.conformance.rule import NotApplicableError, rule
from cosim.conformance.rules.lifecycle import RUNS

_STEP = "2.0 §4.2.2; 3.0 §4.2.1"

PARTS = (1.0, 0.5, 0.25, 2.0, 0.3)
"""Sizes of steps that are tried, relative to the default one."""

_TRIED = 20
"""How many variables are tried with values outside their bounds."""


@rule(
    "steps.inputs",
    "Inputs can move from step to step",
    clause="2.0 §4.2.1; 3.0 §4.2.1",
    stage="behaviour",
    needs=("lifecycle.sequence",),
)
def inputs(bench: Bench) -> None:
    with bench.started() as slave:
        bench.run(slave)


@rule(
    "steps.deterministic",
    "Two runs with the same inputs give the same bits",
    stage="behaviour",
    severity="warning",
    needs=RUNS,
)
def deterministic(bench: Bench) -> Iterator[str]:
    with bench.started() as slave:
        first = bench.run(slave)
    with bench.started() as slave:
        second = bench.run(slave)
    if text := difference(first, second, bench.experiment):
        yield f"in a second run: {text}"


@rule(
    "steps.time",
    "A step reaches the time it was asked for",
    clause=_STEP,
    stage="behaviour",
    needs=RUNS,
)
def time(bench: Bench) -> Iterator[str]:
    clocks = [v for v in bench.description.variables if v.causality == "independent" and v.type in FLOATS]
    internal = number(bench.description.co_simulation.get("fixedInternalStepSize")) or 0.0
    if not clocks and bench.description.standard == 2:
        raise NotApplicableError("the FMU has no independent variable, and FMI 2.0 no other way to tell the time")
    with bench.started() as slave:
        for k in range(bench.experiment.steps):
            step = bench.advance(slave, k)
            expected = bench.experiment.time(k + 1)
            told = [(f"{v}", slave.get([v])[v.name][0]) for v in clocks]
            told += [] if step.reached is None else [("lastSuccessfulTime", step.reached)]
            if step.ended:
                break
            wrong = [(name, t) for name, t in told if not abs(t - expected) <= 1e-6 * bench.experiment.size + internal]
            if wrong:
                yield f"after the step from {bench.experiment.time(k):g} s: expected {wrong[0][0]} to be " + (
                    f"{expected:g} s, got {wrong[0][1]:g} s"
                )
                break


@rule(
    "steps.variable",
    "Steps of several sizes work where that is declared",
    clause="2.0 §4.2.2, §4.3.1; 3.0 §4.2.1, §4.3.1",
    stage="behaviour",
    needs=RUNS,
)
def variable(bench: Bench) -> None:
    bench.can("canHandleVariableCommunicationStepSize")
    internal = number(bench.description.co_simulation.get("fixedInternalStepSize"))
    at = bench.experiment.start
    last = number(bench.description.experiment.get("stopTime")) or math.inf
    with bench.started() as slave:
        for part in PARTS:
            size = part * bench.experiment.size
            size = size if internal is None else max(1, round(size / internal)) * internal
            if at + size > last * (1 + 1e-9) or slave.step(at, size).ended:
                break
            at += size


@rule(
    "steps.backward",
    "A step of negative size is refused",
    clause=_STEP,
    stage="behaviour",
    severity="warning",
    needs=("lifecycle.sequence",),
)
def backward(bench: Bench) -> Iterator[str]:
    slave = bench.make()
    bench.start(slave)
    if slave.step(bench.experiment.start, bench.experiment.size).ended:
        raise NotApplicableError("the FMU ends the run after one step")
    status = slave.library.step(slave.pointer, bench.experiment.time(1), -bench.experiment.size).status
    if status <= WARNING:
        yield f"step of {-bench.experiment.size:g} s: expected an error, got {STATUS[status]}"


@rule(
    "steps.stop-time",
    "A step past the stop time that was announced returns an error",
    clause="2.0 §2.1.6; 3.0 §2.3.2",
    stage="behaviour",
    needs=RUNS,
)
def stop_time(bench: Bench) -> Iterator[str]:
    slave = bench.make()
    steps = min(3, bench.experiment.steps)
    stop = bench.experiment.time(steps)
    bench.start(slave, stop)
    for k in range(steps):
        if slave.step(bench.experiment.time(k), bench.experiment.size).ended:
            raise NotApplicableError("the FMU ends the run before that")
    found = slave.library.step(slave.pointer, stop, bench.experiment.size)
    if found.status <= WARNING and not found.ended:
        yield f"step from the stop time {stop:g} s on: expected an error, got {STATUS[found.status]}"


@rule(
    "steps.bounds",
    "Values stay within min and max",
    clause="2.0 §2.2.7; 3.0 §2.4.7.4",
    stage="behaviour",
    needs=RUNS,
)
def bounds(bench: Bench) -> Iterator[str]:
    bounded = {v.name: v for v in bench.observed if v.minimum is not None or v.maximum is not None}
    if not bounded:
        raise NotApplicableError("no variable has bounds")
    with bench.started() as slave:
        for k, row in enumerate(bench.run(slave), 1):
            for v in list(bounded.values()):
                low, high = _range(v)
                if not all(low <= value <= high or math.isnan(value) for value in row[v.name]):
                    where = f"at t = {bench.experiment.time(k):g} s"
                    yield f"{v} {where}: expected values in [{low:g}, {high:g}], got {show(row[v.name])}"
                    del bounded[v.name]


def _range(v: Variable) -> tuple[float, float]:
    low = -math.inf if v.minimum is None or math.isnan(v.minimum) else v.minimum
    high = math.inf if v.maximum is None or math.isnan(v.maximum) else v.maximum
    return low, high


@rule("steps.finite", "Outputs are finite numbers", stage="behaviour", severity="warning", needs=RUNS)
def finite(bench: Bench) -> Iterator[str]:
    outputs = [v for v in bench.observed if v.causality == "output" and v.type in FLOATS]
    if not outputs:
        raise NotApplicableError("the FMU has no real outputs")
    with bench.started() as slave:
        rows = bench.run(slave)
    for v in outputs:
        for k, row in enumerate(rows, 1):
            if not all(map(math.isfinite, row[v.name])):
                yield f"{v} at t = {bench.experiment.time(k):g} s: expected finite numbers, got {show(row[v.name])}"
                break


@rule(
    "steps.constant",
    "Constants and fixed parameters do not change during the run, tunable ones only when they are set",
    clause="2.0 §2.2.7; 3.0 §2.4.7.4",
    stage="behaviour",
    needs=RUNS,
)
def constant(bench: Bench) -> Iterator[str]:
    steady = [v for v in bench.observed if v.variability in ("constant", "fixed", "tunable")]
    if not steady:
        raise NotApplicableError("the FMU has neither parameters nor constants")
    with bench.started() as slave:
        before = slave.get(steady)
        rows = bench.run(slave)
    for v in steady:
        for k, row in enumerate(rows, 1):
            if bits(before[v.name]) != bits(row[v.name]):
                where = f"at t = {bench.experiment.time(k):g} s"
                yield f"{v} {where}: expected {show(before[v.name])} as before, got {show(row[v.name])}"
                break


@rule(
    "steps.limits",
    "A value outside min and max is refused or taken as it is, or the old one stays",
    stage="behaviour",
    severity="warning",
    needs=("lifecycle.sequence",),
)
def limits(bench: Bench) -> Iterator[str]:
    settable = [v for v in bench.observed if v.causality in ("parameter", "input") and not v.dimensions]
    tried = [(v, value) for v in settable if (value := _outside(v)) is not None][:_TRIED]
    if not tried:
        raise NotApplicableError("neither parameters nor inputs have bounds")
    for v, value in tried:
        slave = bench.make()
        slave.enter(bench.experiment.start)
        old = slave.get([v])[v.name]
        if slave.set(v, (value,)) <= WARNING:
            new = slave.get([v])[v.name]
            if new not in (old, (value,)):
                yield f"{v}: expected {value:g} to be refused or taken as it is, got {show(new)} instead"
        slave.free()


def _outside(v: Variable) -> float | int | None:
    """Return a value beyond a variable's bounds that its type can hold; None if there is none."""
    if v.type not in (*FLOATS, *INTEGERS, "Enumeration"):
        return None
    low, high = _range(v)
    value = high + 1.0 + abs(high) if math.isfinite(high) else low - 1.0 - abs(low)
    if not math.isfinite(value) or v.type == "Float32":
        return None
    if v.type in FLOATS:
        return value
    return int(value) if v.type in ("Integer", "Enumeration", "Int32", "Int64") and abs(value) < 2**31 else None
