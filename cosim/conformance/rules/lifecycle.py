"""Rules about the lifecycle of instances: calls in the allowed order and in others, one instance and several."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator

from cosim.conformance.harness import (
    Harness,
    bit_patterns,
    first_difference,
    format_values,
    row_difference,
)
from cosim.conformance.raw_instance import OK, STATUS, WARNING, CallFailedError, RawInstance
from cosim.conformance.rule import Advice, NotApplicableError, rule
from cosim.conformance.rules.binary import NEEDS_LIBRARY

NEEDS_RUN = ("steps.inputs",)
"""Needs of the rules that run the FMU with varying inputs."""


@rule(
    "lifecycle.instantiate",
    "The library accepts the description's GUID or token: it returns an instance",
    clause="2.0 §2.1.5; 3.0 §2.3.1",
    stage="behaviour",
    needs=NEEDS_LIBRARY,
)
def instantiate(harness: Harness) -> None:
    if any(v.type == "Clock" for v in harness.description.variables):
        raise NotApplicableError("the FMU has clocks, for which it needs a master with event mode")
    try:
        with harness.instance():
            pass
    except CallFailedError as error:
        if harness.description.has_capability("needsExecutionTool"):
            raise CallFailedError(f"{error}; the FMU needs another tool, which may be missing here") from None
        raise


@rule(
    "lifecycle.token",
    "Another GUID or token is rejected",
    clause="2.0 §2.1.5; 3.0 §2.3.1",
    stage="behaviour",
    severity="warning",
    needs=("lifecycle.instantiate",),
)
def token(harness: Harness) -> Iterator[str]:
    wrong = f"{harness.description.token}0"
    if harness.library.instantiate("instance", wrong):
        yield f"expected no instance with {wrong} instead of {harness.description.token}, got one"


@rule(
    "lifecycle.sequence",
    "The standard sequence works: instantiate, initialize, step, terminate, free",
    clause="2.0 §4.2.4; 3.0 §4.2.1",
    stage="behaviour",
    needs=("lifecycle.instantiate",),
)
def sequence(harness: Harness) -> None:
    with harness.initialized() as instance:
        instance.get_values(harness.observed)
        for k in range(harness.experiment.steps):
            result = instance.do_step(harness.experiment.time(k), harness.experiment.step_size)
            instance.get_values(harness.observed)
            if result.terminate:
                break


@rule(
    "lifecycle.free-null",
    "Freeing a null pointer is ignored",
    clause="2.0 §2.1.5; 3.0 §2.3.1",
    stage="behaviour",
    needs=("lifecycle.instantiate",),
)
def free_null(harness: Harness) -> None:
    harness.library.function("FreeInstance")(None)


@rule(
    "lifecycle.start-values",
    "In the initialization mode, the FMU returns the start values of the description",
    clause="2.0 §2.1.6, §2.2.7; 3.0 §2.3.2, §2.4.7.4",
    stage="behaviour",
    needs=("lifecycle.sequence",),
)
def start_values(harness: Harness) -> Iterator[str]:
    variables = [v for v in harness.readable if v.initial == "exact" and v.start is not None]
    with harness.instance() as instance:
        instance.enter_initialization_mode(harness.experiment.start_time)
        found = instance.get_values(variables)
        instance.exit_initialization_mode()
        instance.call_ok("Terminate")
    for v in variables:
        expected = tuple(map(_comparable, harness.start_values(v)))
        got = tuple(map(_comparable, found[v.name]))
        if bit_patterns(expected) != bit_patterns(got):
            yield f"{v}: expected start value {format_values(expected)}, got {format_values(got)}"


def _comparable(value: object) -> object:
    """Convert a value for comparison: Booleans to integers, a null string to an empty one, -0 to 0."""
    if isinstance(value, float):
        return value + 0.0
    return int(value) if isinstance(value, bool) else b"" if value is None else value


@rule(
    "lifecycle.terminated",
    "After Terminate, the values can still be read and are those of the last step",
    clause="2.0 §4.2.4; 3.0 §2.3.7",
    stage="behaviour",
    needs=NEEDS_RUN,
)
def terminated(harness: Harness) -> Iterator[str]:
    with harness.instance() as instance:
        harness.initialize(instance)
        rows = harness.run(instance, last=min(2, harness.experiment.steps))
        instance.call_ok("Terminate")
        if text := row_difference(rows[-1], instance.get_values(harness.observed)):
            yield f"after Terminate: {text}"


@rule(
    "lifecycle.reset",
    "After Reset, a run gives the same values as that of a new instance",
    clause="2.0 §2.1.6; 3.0 §2.3.1",
    stage="behaviour",
    needs=("steps.deterministic",),
)
def reset(harness: Harness) -> Iterator[str]:
    with harness.instance() as instance:
        harness.initialize(instance)
        first = harness.run(instance)
        instance.call_ok("Terminate")
        instance.call_ok("Reset")
        harness.initialize(instance)
        second = harness.run(instance)
        instance.call_ok("Terminate")
    if text := first_difference(first, second, harness.experiment):
        yield f"after Reset: {text}"


@rule(
    "lifecycle.instances",
    "Two instances in one process do not influence each other",
    clause="2.0 §2.1.5; 3.0 §2.3.1",
    stage="behaviour",
    needs=("steps.deterministic",),
)
def instances(harness: Harness) -> Iterator[str]:
    if harness.instantiates_once:
        raise NotApplicableError("the FMU can be instantiated only once per process")
    with harness.initialized() as single:
        expected = harness.run(single)
    with harness.initialized("one") as one, harness.initialized("other") as other:
        got = []
        for k in range(harness.experiment.steps):
            got += harness.run(one, k, k + 1)
            if k % 2 == 0:  # half as many steps, so that the two are at different times
                other.do_step(harness.experiment.time(k // 2), harness.experiment.step_size)
            if len(got) == len(expected):
                break
    if text := first_difference(expected, got, harness.experiment):
        yield f"beside another instance: {text}"


@rule(
    "lifecycle.once",
    "An FMU that can be instantiated only once per process refuses a second instance and goes on with the first",
    clause="2.0 §4.3.1; 3.0 §4.3.1",
    stage="behaviour",
    needs=("steps.deterministic",),
)
def once(harness: Harness) -> Iterator[str]:
    if not harness.instantiates_once:
        raise NotApplicableError("the FMU can be instantiated several times per process")
    with harness.initialized() as single:
        expected = harness.run(single)
    with harness.initialized("one") as one:
        got = harness.run(one, last=1)
        if harness.library.instantiate("other", harness.description.token):
            yield Advice("expected no second instance, as canBeInstantiatedOnlyOncePerProcess is declared, got one")
        if len(got) < len(expected):
            got += harness.run(one, 1)
    if text := first_difference(expected, got, harness.experiment):
        yield f"after a second instance was requested: {text}"


@rule(
    "lifecycle.logging",
    "Logging can be switched, for all and for the declared categories",
    clause="2.0 §2.1.5; 3.0 §2.3.1",
    stage="behaviour",
    needs=("lifecycle.sequence",),
)
def logging(harness: Harness) -> None:
    categories = [name.encode() for name in harness.description.categories]
    with harness.initialized() as instance:
        instance.call_ok("SetDebugLogging", False, 0, None)
        instance.call_ok("SetDebugLogging", True, 0, None)
        if categories:
            names = (ctypes.c_char_p * len(categories))(*categories)
            instance.call_ok("SetDebugLogging", True, len(categories), names)


# ---- calls out of order ----------------------------------------------------------------------------------------------


def _first_step(harness: Harness, instance: RawInstance) -> int:
    """Make a step from the start time without judging its status, which is returned."""
    experiment = harness.experiment
    return instance.library.do_step(instance.pointer, experiment.start_time, experiment.step_size).status


def _step_in_initialization_mode(harness: Harness, instance: RawInstance) -> int:
    instance.enter_initialization_mode(harness.experiment.start_time)
    return _first_step(harness, instance)


def _exit_without_entering(harness: Harness, instance: RawInstance) -> int:
    return instance.call("ExitInitializationMode")


def _enter_twice(harness: Harness, instance: RawInstance) -> int:
    instance.enter_initialization_mode(harness.experiment.start_time)
    return instance.library.enter_initialization_mode(instance.pointer, harness.experiment.start_time, None)[1]


def _step_after_terminate(harness: Harness, instance: RawInstance) -> int:
    harness.initialize(instance)
    instance.call_ok("Terminate")
    return _first_step(harness, instance)


OUT_OF_ORDER: dict[str, Callable[[Harness, RawInstance], int]] = {
    "a step before the initialization": _first_step,
    "a step in the initialization mode": _step_in_initialization_mode,
    "exiting the initialization mode without entering it": _exit_without_entering,
    "entering the initialization mode twice": _enter_twice,
    "a step after Terminate": _step_after_terminate,
}
"""Calls that the state machine does not allow: name to function that makes them and returns the last status."""


@rule(
    "lifecycle.call-order",
    "Calls out of order return an error and do not crash",
    clause="2.0 §4.2.4; 3.0 §4.2.1",
    stage="behaviour",
    severity="warning",
    needs=("lifecycle.sequence",),
)
def call_order(harness: Harness) -> Iterator[str]:
    for what, call in OUT_OF_ORDER.items():
        instance = harness.instantiate()
        status = call(harness, instance)
        if status <= WARNING:
            yield f"{what}: expected an error, got {STATUS[status]}"
        elif status < len(STATUS) - 2:  # not fatal
            instance.free()
            continue
        if harness.instantiates_once:
            break  # an instance that cannot be freed is left


@rule(
    "lifecycle.fixed",
    "Fixed parameters cannot be changed after the initialization",
    clause="2.0 §4.2.4; 3.0 §2.3.4",
    stage="behaviour",
    severity="warning",
    needs=("lifecycle.sequence",),
)
def fixed(harness: Harness) -> Iterator[str]:
    parameters = [v for v in harness.readable if (v.causality, v.variability) == ("parameter", "fixed")]
    if not parameters:
        raise NotApplicableError("the FMU has no fixed parameters")
    accepted = []
    for v in parameters[:_TRIED]:
        instance = harness.instantiate()
        harness.initialize(instance)
        values = instance.get_values([v])[v.name]
        if instance.set_values(v, values) == OK:
            accepted.append(v)
        instance.free()
    if accepted:
        names = ", ".join(map(str, accepted[:5])) + (" and more" if len(accepted) > 5 else "")
        yield f"in step mode: expected fixed parameters to be rejected, the FMU accepted {names}"


_TRIED = 5
"""How many fixed parameters are tried, each with a new instance."""
