"""Rules about a run: steps, time, bounds, and which values may change."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cosim.conformance.harness import Harness, bit_patterns, first_difference, format_values
from cosim.conformance.model_description import RawVariable, parse_number
from cosim.conformance.raw_instance import STATUS, WARNING
from cosim.conformance.rule import NotApplicableError, rule
from cosim.conformance.rules.lifecycle import NEEDS_RUN
from cosim.fmi.variable_types import FLOATS, INTEGERS

_STEP = "2.0 §4.2.2; 3.0 §4.2.1"

RELATIVE_SIZES = (1.0, 0.5, 0.25, 2.0, 0.3)
"""Sizes of the steps that the rule ``steps.variable`` makes, relative to the default one."""

_TRIED = 20
"""How many variables are set to values outside their bounds."""


@rule(
    "steps.inputs",
    "Inputs can vary from step to step",
    clause="2.0 §4.2.1; 3.0 §4.2.1",
    stage="behaviour",
    needs=("lifecycle.sequence",),
)
def inputs(harness: Harness) -> None:
    with harness.initialized() as instance:
        harness.run(instance)


@rule(
    "steps.deterministic",
    "Two runs with the same inputs give the same values to the bit",
    stage="behaviour",
    severity="warning",
    needs=NEEDS_RUN,
)
def deterministic(harness: Harness) -> Iterator[str]:
    with harness.initialized() as instance:
        first = harness.run(instance)
    with harness.initialized() as instance:
        second = harness.run(instance)
    if text := first_difference(first, second, harness.experiment):
        yield f"in a second run: {text}"


@rule(
    "steps.time",
    "A step reaches the requested time",
    clause=_STEP,
    stage="behaviour",
    needs=NEEDS_RUN,
)
def time(harness: Harness) -> Iterator[str]:
    clocks = [v for v in harness.description.variables if v.causality == "independent" and v.type in FLOATS]
    internal = parse_number(harness.description.co_simulation.get("fixedInternalStepSize")) or 0.0
    if not clocks and harness.description.fmi_major == 2:
        raise NotApplicableError("the FMU has no independent variable, and FMI 2.0 reports the time in no other way")
    experiment = harness.experiment
    tolerance = 1e-6 * experiment.step_size + internal
    with harness.initialized() as instance:
        for k in range(experiment.steps):
            result = harness.do_step(instance, k)
            expected = experiment.time(k + 1)
            reported = [(f"{v}", instance.get_values([v])[v.name][0]) for v in clocks]
            reported += [] if result.last_time is None else [("lastSuccessfulTime", result.last_time)]
            if result.terminate:
                break
            if wrong := [(name, t) for name, t in reported if not abs(t - expected) <= tolerance]:
                name, got = wrong[0]
                where = f"after the step from {experiment.time(k):g} s"
                yield f"{where}: expected {name} to be {expected:g} s, got {got:g} s"
                break


@rule(
    "steps.variable",
    "Steps of several sizes work where the description declares that",
    clause="2.0 §4.2.2, §4.3.1; 3.0 §4.2.1, §4.3.1",
    stage="behaviour",
    needs=NEEDS_RUN,
)
def variable(harness: Harness) -> None:
    harness.require_capability("canHandleVariableCommunicationStepSize")
    internal = parse_number(harness.description.co_simulation.get("fixedInternalStepSize"))
    now = harness.experiment.start_time
    stop = parse_number(harness.description.default_experiment.get("stopTime")) or math.inf
    with harness.initialized() as instance:
        for relative_size in RELATIVE_SIZES:
            size = relative_size * harness.experiment.step_size
            size = size if internal is None else max(1, round(size / internal)) * internal
            if now + size > stop * (1 + 1e-9) or instance.do_step(now, size).terminate:
                break
            now += size


@rule(
    "steps.backward",
    "A step of negative size is rejected",
    clause=_STEP,
    stage="behaviour",
    severity="warning",
    needs=("lifecycle.sequence",),
)
def backward(harness: Harness) -> Iterator[str]:
    instance = harness.instantiate()
    harness.initialize(instance)
    experiment = harness.experiment
    if instance.do_step(experiment.start_time, experiment.step_size).terminate:
        raise NotApplicableError("the FMU ends the run after one step")
    status = instance.library.do_step(instance.pointer, experiment.time(1), -experiment.step_size).status
    if status <= WARNING:
        yield f"step of {-experiment.step_size:g} s: expected an error, got {STATUS[status]}"


@rule(
    "steps.stop-time",
    "A step past the defined stop time returns an error",
    clause="2.0 §2.1.6; 3.0 §2.3.2",
    stage="behaviour",
    needs=NEEDS_RUN,
)
def stop_time(harness: Harness) -> Iterator[str]:
    instance = harness.instantiate()
    experiment = harness.experiment
    steps = min(3, experiment.steps)
    stop = experiment.time(steps)
    harness.initialize(instance, stop)
    for k in range(steps):
        if instance.do_step(experiment.time(k), experiment.step_size).terminate:
            raise NotApplicableError("the FMU ends the run before that")
    result = instance.library.do_step(instance.pointer, stop, experiment.step_size)
    if result.status <= WARNING and not result.terminate:
        yield f"step from the stop time {stop:g} s on: expected an error, got {STATUS[result.status]}"


@rule(
    "steps.bounds",
    "Values stay within min and max",
    clause="2.0 §2.2.7; 3.0 §2.4.7.4",
    stage="behaviour",
    needs=NEEDS_RUN,
)
def bounds(harness: Harness) -> Iterator[str]:
    bounded = {v.name: v for v in harness.observed if v.minimum is not None or v.maximum is not None}
    if not bounded:
        raise NotApplicableError("no variable has bounds")
    with harness.initialized() as instance:
        for k, row in enumerate(harness.run(instance), 1):
            for v in list(bounded.values()):
                low, high = _range(v)
                if not all(low <= value <= high or math.isnan(value) for value in row[v.name]):
                    where = f"at t = {harness.experiment.time(k):g} s"
                    yield f"{v} {where}: expected values in [{low:g}, {high:g}], got {format_values(row[v.name])}"
                    del bounded[v.name]


def _range(v: RawVariable) -> tuple[float, float]:
    low = -math.inf if v.minimum is None or math.isnan(v.minimum) else v.minimum
    high = math.inf if v.maximum is None or math.isnan(v.maximum) else v.maximum
    return low, high


@rule("steps.finite", "Outputs are finite numbers", stage="behaviour", severity="warning", needs=NEEDS_RUN)
def finite(harness: Harness) -> Iterator[str]:
    outputs = [v for v in harness.observed if v.causality == "output" and v.type in FLOATS]
    if not outputs:
        raise NotApplicableError("the FMU has no real outputs")
    with harness.initialized() as instance:
        rows = harness.run(instance)
    for v in outputs:
        for k, row in enumerate(rows, 1):
            if not all(map(math.isfinite, row[v.name])):
                where = f"at t = {harness.experiment.time(k):g} s"
                yield f"{v} {where}: expected finite numbers, got {format_values(row[v.name])}"
                break


@rule(
    "steps.constant",
    "Constants and fixed parameters do not change during the run, tunable ones only when they are set",
    clause="2.0 §2.2.7; 3.0 §2.4.7.4",
    stage="behaviour",
    needs=NEEDS_RUN,
)
def constant(harness: Harness) -> Iterator[str]:
    constants = [v for v in harness.observed if v.variability in ("constant", "fixed", "tunable")]
    if not constants:
        raise NotApplicableError("the FMU has neither parameters nor constants")
    with harness.initialized() as instance:
        before = instance.get_values(constants)
        rows = harness.run(instance)
    for v in constants:
        for k, row in enumerate(rows, 1):
            if bit_patterns(before[v.name]) != bit_patterns(row[v.name]):
                where = f"at t = {harness.experiment.time(k):g} s"
                expected, got = format_values(before[v.name]), format_values(row[v.name])
                yield f"{v} {where}: expected {expected} as before, got {got}"
                break


@rule(
    "steps.limits",
    "A value outside min and max is rejected, accepted unchanged, or ignored",
    stage="behaviour",
    severity="warning",
    needs=("lifecycle.sequence",),
)
def limits(harness: Harness) -> Iterator[str]:
    settable = [v for v in harness.observed if v.causality in ("parameter", "input") and not v.dimensions]
    tried = [(v, value) for v in settable if (value := _outside(v)) is not None][:_TRIED]
    if not tried:
        raise NotApplicableError("neither parameters nor inputs have bounds")
    for v, value in tried:
        instance = harness.instantiate()
        instance.enter_initialization_mode(harness.experiment.start_time)
        old = instance.get_values([v])[v.name]
        if instance.set_values(v, (value,)) <= WARNING:
            new = instance.get_values([v])[v.name]
            if new not in (old, (value,)):
                yield f"{v}: expected {value:g} to be rejected or accepted unchanged, got {format_values(new)} instead"
        instance.free()


def _outside(v: RawVariable) -> float | int | None:
    """Return a value outside a variable's bounds that its type can represent; None if there is none."""
    if v.type not in (*FLOATS, *INTEGERS, "Enumeration"):
        return None
    low, high = _range(v)
    value = high + 1.0 + abs(high) if math.isfinite(high) else low - 1.0 - abs(low)
    if not math.isfinite(value) or v.type == "Float32":
        return None
    if v.type in FLOATS:
        return value
    return int(value) if v.type in ("Integer", "Enumeration", "Int32", "Int64") and abs(value) < 2**31 else None
