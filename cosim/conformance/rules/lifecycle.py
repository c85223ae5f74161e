"""Rules about an instance's life: from the first call to the last, in order and out of order, alone and with others."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator

from cosim.conformance.harness import Bench, bits, changed, difference, parsed, show
from cosim.conformance.raw_instance import OK, STATUS, WARNING, RefusedError, Slave
from cosim.conformance.rule import NotApplicableError, rule
from cosim.conformance.rules.binary import LOADED

RUNS = ("steps.inputs",)
"""What rules need that run the FMU with moving inputs."""


@rule(
    "lifecycle.instantiate",
    "The description's GUID or token is the library's: an instance can be made with it",
    clause="2.0 §2.1.5; 3.0 §2.3.1",
    stage="behaviour",
    needs=LOADED,
)
def instantiate(bench: Bench) -> None:
    if any(v.type == "Clock" for v in bench.description.variables):
        raise NotApplicableError("the FMU has clocks, for which it needs a master with event mode")
    try:
        with bench.instance():
            pass
    except RefusedError as error:
        if bench.description.can("needsExecutionTool"):
            raise RefusedError(f"{error}; the FMU needs another tool, which may be missing here") from None
        raise


@rule(
    "lifecycle.token",
    "Another GUID or token is refused: library and description belong together",
    clause="2.0 §2.1.5; 3.0 §2.3.1",
    stage="behaviour",
    severity="warning",
    needs=("lifecycle.instantiate",),
)
def token(bench: Bench) -> Iterator[str]:
    wrong = f"{bench.description.token}0"
    if bench.library.make("it", wrong):
        yield f"expected no instance with {wrong} instead of {bench.description.token}, got one"


@rule(
    "lifecycle.sequence",
    "The plain sequence works: instantiate, initialise, step, terminate, free",
    clause="2.0 §4.2.4; 3.0 §4.2.1",
    stage="behaviour",
    needs=("lifecycle.instantiate",),
)
def sequence(bench: Bench) -> None:
    with bench.started() as slave:
        slave.get(bench.observed)
        for k in range(bench.experiment.steps):
            step = slave.step(bench.experiment.time(k), bench.experiment.size)
            slave.get(bench.observed)
            if step.ended:
                break


@rule(
    "lifecycle.free-null",
    "Freeing a null pointer is ignored",
    clause="2.0 §2.1.5; 3.0 §2.3.1",
    stage="behaviour",
    needs=("lifecycle.instantiate",),
)
def free_null(bench: Bench) -> None:
    bench.library.function("FreeInstance")(None)


@rule(
    "lifecycle.start-values",
    "Before it steps, the FMU returns the start values of the description",
    clause="2.0 §2.1.6, §2.2.7; 3.0 §2.3.2, §2.4.7.4",
    stage="behaviour",
    needs=("lifecycle.sequence",),
)
def start_values(bench: Bench) -> Iterator[str]:
    variables = [v for v in bench.description.variables if v.initial == "exact" and v.type in bench.library.TYPES]
    variables = [v for v in variables if v.start is not None]
    with bench.instance() as slave:
        slave.enter(bench.experiment.start)
        found = slave.get(variables)
        slave.leave()
        slave.demand("Terminate")
    for v in variables:
        expected = tuple(map(_plain, parsed(v)))
        expected = expected * len(found[v.name]) if len(expected) == 1 else expected  # one for all elements
        got = tuple(map(_plain, found[v.name]))
        if bits(expected) != bits(got):
            yield f"{v}: expected start value {show(expected)}, got {show(got)}"


def _plain(value: object) -> object:
    """Return a value as what it compares by: truths as numbers, no text as an empty one, 0 without a sign."""
    if isinstance(value, float):
        return value + 0.0
    return int(value) if isinstance(value, bool) else b"" if value is None else value


@rule(
    "lifecycle.terminated",
    "After the end values can still be read, and are those of the last step",
    clause="2.0 §4.2.4; 3.0 §2.3.7",
    stage="behaviour",
    needs=RUNS,
)
def terminated(bench: Bench) -> Iterator[str]:
    with bench.instance() as slave:
        bench.start(slave)
        rows = bench.run(slave, last=min(2, bench.experiment.steps))
        slave.demand("Terminate")
        if text := changed(rows[-1], slave.get(bench.observed)):
            yield f"after Terminate: {text}"


@rule(
    "lifecycle.reset",
    "After a reset the FMU is as if it were new",
    clause="2.0 §2.1.6; 3.0 §2.3.1",
    stage="behaviour",
    needs=("steps.deterministic",),
)
def reset(bench: Bench) -> Iterator[str]:
    with bench.instance() as slave:
        bench.start(slave)
        fresh = bench.run(slave)
        slave.demand("Terminate")
        slave.demand("Reset")
        bench.start(slave)
        again = bench.run(slave)
        slave.demand("Terminate")
    if text := difference(fresh, again, bench.experiment):
        yield f"after Reset: {text}"


@rule(
    "lifecycle.instances",
    "Two instances in one process do not know of each other",
    clause="2.0 §2.1.5; 3.0 §2.3.1",
    stage="behaviour",
    needs=("steps.deterministic",),
)
def instances(bench: Bench) -> Iterator[str]:
    bench.several()
    with bench.started() as alone:
        expected = bench.run(alone)
    with bench.started("one") as one, bench.started("other") as other:
        got = []
        for k in range(bench.experiment.steps):
            got += bench.run(one, k, k + 1)
            if k % 2 == 0:  # the other goes its own way
                other.step(bench.experiment.time(k // 2), bench.experiment.size)
            if len(got) == len(expected):
                break
    if text := difference(expected, got, bench.experiment):
        yield f"beside another instance: {text}"


@rule(
    "lifecycle.logging",
    "Logging can be switched, for all and for the declared categories",
    clause="2.0 §2.1.5; 3.0 §2.3.1",
    stage="behaviour",
    needs=("lifecycle.sequence",),
)
def logging(bench: Bench) -> None:
    categories = [name.encode() for name in bench.description.categories]
    with bench.started() as slave:
        slave.demand("SetDebugLogging", False, 0, None)
        slave.demand("SetDebugLogging", True, 0, None)
        if categories:
            slave.demand("SetDebugLogging", True, len(categories), (ctypes.c_char_p * len(categories))(*categories))


# ---- out of order ----------------------------------------------------------------------------------------------------


def _step_before_initialisation(bench: Bench, slave: Slave) -> int:
    return slave.library.step(slave.pointer, bench.experiment.start, bench.experiment.size).status


def _step_in_initialisation(bench: Bench, slave: Slave) -> int:
    slave.enter(bench.experiment.start)
    return slave.library.step(slave.pointer, bench.experiment.start, bench.experiment.size).status


def _leave_without_entering(bench: Bench, slave: Slave) -> int:
    return slave.call("ExitInitializationMode")


def _enter_twice(bench: Bench, slave: Slave) -> int:
    slave.enter(bench.experiment.start)
    return slave.library.enter(slave.pointer, bench.experiment.start, None)[1]


def _step_after_the_end(bench: Bench, slave: Slave) -> int:
    bench.start(slave)
    slave.demand("Terminate")
    return slave.library.step(slave.pointer, bench.experiment.start, bench.experiment.size).status


OUT_OF_ORDER: dict[str, Callable[[Bench, Slave], int]] = {
    "a step before the initialisation": _step_before_initialisation,
    "a step in the initialisation": _step_in_initialisation,
    "the end of an initialisation that was not begun": _leave_without_entering,
    "the begin of an initialisation that was begun already": _enter_twice,
    "a step after the end": _step_after_the_end,
}
"""Calls that the state machine does not allow."""


@rule(
    "lifecycle.call-order",
    "Calls out of order return an error and do not crash",
    clause="2.0 §4.2.4; 3.0 §4.2.1",
    stage="behaviour",
    severity="warning",
    needs=("lifecycle.sequence",),
)
def call_order(bench: Bench) -> Iterator[str]:
    for what, call in OUT_OF_ORDER.items():
        slave = bench.make()
        status = call(bench, slave)
        if status <= WARNING:
            yield f"{what}: expected an error, got {STATUS[status]}"
        elif status < len(STATUS) - 2:  # not fatal
            slave.free()


@rule(
    "lifecycle.fixed",
    "Fixed parameters cannot be changed after the initialisation",
    clause="2.0 §4.2.4; 3.0 §2.3.4",
    stage="behaviour",
    severity="warning",
    needs=("lifecycle.sequence",),
)
def fixed(bench: Bench) -> Iterator[str]:
    parameters = [v for v in bench.description.variables if (v.causality, v.variability) == ("parameter", "fixed")]
    parameters = [v for v in parameters if v.type in bench.library.TYPES]
    if not parameters:
        raise NotApplicableError("the FMU has no fixed parameters")
    accepted = []
    for v in parameters[:_TRIED]:
        slave = bench.make()
        bench.start(slave)
        values = slave.get([v])[v.name]
        if slave.set(v, values) == OK:
            accepted.append(v)
        slave.free()
    if accepted:
        names = ", ".join(map(str, accepted[:5])) + (" and more" if len(accepted) > 5 else "")
        yield f"in step mode: expected fixed parameters to be refused, it took {names}"


_TRIED = 5
"""How many fixed parameters are tried, an instance each."""
