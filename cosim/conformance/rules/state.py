"""Rules about the FMU's state: got, set, turned into bytes and back, it continues the run to the bit."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator

from cosim.conformance.harness import Bench, changed, difference
from cosim.conformance.rule import rule

_CLAUSE = "2.0 §2.1.8; 3.0 §2.2.6.4"
_STATE, _BYTES = "canGetAndSetFMUState", "canSerializeFMUState"


@rule(
    "state.continues",
    "A state that is set continues the run bit by bit as the first time",
    clause=_CLAUSE,
    stage="behaviour",
    needs=("steps.deterministic",),
)
def continues(bench: Bench) -> Iterator[str]:
    bench.can(_STATE)
    middle = bench.middle
    with bench.started() as slave:
        if len(before := bench.run(slave, last=middle)) < middle:
            return
        state = slave.state()
        first = bench.run(slave, middle)
        slave.restore(state)
        restored = slave.get(bench.observed)
        again = bench.run(slave, middle)
        slave.free_state(state)
    if text := changed(before[-1], restored) or difference(first, again, bench.experiment, middle):
        yield f"after setting the state: {text}"


@rule(
    "state.serialises",
    "Bytes of a state continue the run in a fresh instance",
    clause=_CLAUSE,
    stage="behaviour",
    needs=("state.continues",),
)
def serialises(bench: Bench) -> Iterator[str]:
    bench.can(_STATE)
    bench.can(_BYTES)
    middle = bench.middle
    with bench.started() as slave:
        if len(bench.run(slave, last=middle)) < middle:
            return
        state = slave.state()
        content = slave.serialise(state)
        slave.free_state(state)
        expected = bench.run(slave, middle)
    with bench.started() as fresh:
        state = fresh.deserialise(content)
        fresh.restore(state)
        fresh.free_state(state)
        got = bench.run(fresh, middle)
    if text := difference(expected, got, bench.experiment, middle):
        yield f"in a fresh instance: {text}"


@rule(
    "state.free",
    "Freeing a state sets its pointer to null, and a null pointer is ignored",
    clause=_CLAUSE,
    stage="behaviour",
    needs=("lifecycle.sequence",),
)
def free(bench: Bench) -> Iterator[str]:
    bench.can(_STATE)
    name = f"{bench.library.PREFIX}{bench.library.STATE[2]}"
    with bench.started() as slave:
        state = slave.state()
        slave.free_state(state)
        if state.value:
            yield f"{name}: expected the pointer to be null afterwards, it is not"
        slave.free_state(ctypes.c_void_p())
