"""Rules about the FMU state: after it is set or deserialized, the run continues with the same values to the bit."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator

from cosim.conformance.harness import Harness, first_difference, row_difference
from cosim.conformance.rule import rule

_CLAUSE = "2.0 §2.1.8; 3.0 §2.2.6.4"
_STATE, _SERIALIZE = "canGetAndSetFMUState", "canSerializeFMUState"


@rule(
    "state.continues",
    "After a state is set, the run continues with the same values as the first time, to the bit",
    clause=_CLAUSE,
    stage="behaviour",
    needs=("steps.deterministic",),
)
def continues(harness: Harness) -> Iterator[str]:
    harness.require_capability(_STATE)
    middle = harness.middle_step
    with harness.initialized() as instance:
        if len(before := harness.run(instance, last=middle)) < middle:
            return
        state = instance.get_state()
        first = harness.run(instance, middle)
        instance.set_state(state)
        restored = instance.get_values(harness.observed)
        again = harness.run(instance, middle)
        instance.free_state(state)
    text = row_difference(before[-1], restored) or first_difference(first, again, harness.experiment, middle)
    if text:
        yield f"after setting the state: {text}"


@rule(
    "state.serialises",
    "A new instance continues the run from a serialized state",
    clause=_CLAUSE,
    stage="behaviour",
    needs=("state.continues",),
)
def serializes(harness: Harness) -> Iterator[str]:
    harness.require_capability(_STATE)
    harness.require_capability(_SERIALIZE)
    middle = harness.middle_step
    with harness.initialized() as instance:
        if len(harness.run(instance, last=middle)) < middle:
            return
        state = instance.get_state()
        content = instance.serialize_state(state)
        instance.free_state(state)
        expected = harness.run(instance, middle)
    with harness.initialized() as fresh:
        state = fresh.deserialize_state(content)
        fresh.set_state(state)
        fresh.free_state(state)
        got = harness.run(fresh, middle)
    if text := first_difference(expected, got, harness.experiment, middle):
        yield f"in a new instance: {text}"


@rule(
    "state.free",
    "Freeing a state sets its pointer to null, and a null pointer is ignored",
    clause=_CLAUSE,
    stage="behaviour",
    needs=("lifecycle.sequence",),
)
def free(harness: Harness) -> Iterator[str]:
    harness.require_capability(_STATE)
    name = f"{harness.library.PREFIX}{harness.library.STATE_FUNCTIONS[2]}"
    with harness.initialized() as instance:
        state = instance.get_state()
        instance.free_state(state)
        if state.value:
            yield f"{name}: expected the pointer to be null afterwards, it is not"
        instance.free_state(ctypes.c_void_p())
