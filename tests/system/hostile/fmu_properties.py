"""Properties of an FMU that hold for any calls and values; hypothesis and the longer run try to break them."""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Callable, Sequence
from typing import Any

from hypothesis import strategies as st
from hypothesis.stateful import Bundle, RuleBasedStateMachine, initialize, invariant, rule

from tests.system.hostile.caller import DISCARD, ERROR, FATAL, OK, Answer, Caller
from tests.system.hostile.extracted_fmus import ExtractedFmu, Settable, Twin

_MAGNITUDES = (0.0, 5e-324, 2.2250738585072014e-308, 1e-100, 1e-30, 1e-12, 1e-9, 1e-6, 1e-3, 1.0, 60.0, 1e3, 1e6, 1e9)
_MAGNITUDES += (1e12, 1e30, 1e100, 1e160, 1.7976931348623157e308, math.inf, math.nan)

SPECIAL = tuple(sign * number for number in _MAGNITUDES for sign in (1.0, -1.0))
"""Numbers that have broken programs before."""

WHOLE = (*(sign * number for number in (0, 1, 2, 3, 5, 6, 9, 10, 2**15, 2**31 - 1) for sign in (1, -1)), -(2**31))

TEXTS = (
    b"",
    b"x",
    b"/",
    b".",
    b"..",
    b"/dev/null",
    b"no such file.csv",
    b"%s%n%s%n",
    b"\xc3\xa4\xf0\x9f\x92\xba",
    b"a\nb",
)
TEXTS += (b"x" * 1023, b"x" * 1024, b"y" * 100_000)
NO_TEXT = b"\xff\xfe\x80"
"""No UTF-8. pythonfmu's binary crashes at it, before it asks Python: Python instances are spared."""

STEP_SIZES = (1e-6, 1e-5, 1.1e-4, 0.001, 0.002, 0.0021, 0.01, 0.5, 10.0)
BAD_STEP_SIZES = (0.0, -0.0, -1e-9, -0.002, -1e300, math.nan, math.inf, -math.inf, 1.1e3, 1e300)
BAD_TIMES = (math.nan, math.inf, -math.inf, 1e300, -1e300, 1e10)


def special_values(variable: Settable, native: bool = True) -> list[Any]:
    """All that a variable is tried with, its own bounds and what lies just beyond them included."""
    if variable.kind == "String":
        return [variable.start.encode(), *TEXTS, *([NO_TEXT] if native else [])]
    if variable.kind == "Boolean":
        return [False, True]
    near = [bound for bound in (variable.minimum, variable.maximum, variable.start) if math.isfinite(bound)]
    if variable.kind == "Integer":
        return [*{*(int(bound) + shift for bound in near for shift in (-1, 0, 1) if abs(bound) < 2**31 - 1), *WHOLE}]
    beside = [math.nextafter(bound, to) for bound in near for to in (-math.inf, math.inf)]
    return [*near, *beside, *SPECIAL]


def values(variable: Settable, native: bool = True) -> st.SearchStrategy[Any]:
    """Draw values for a variable: the special ones, near its start, within its bounds, any."""
    choices = [st.sampled_from(special_values(variable, native))]
    if variable.kind == "Real":
        low, high = (bound if math.isfinite(bound) else None for bound in (variable.minimum, variable.maximum))
        choices.append(st.floats(low, high))
        choices.append(st.floats(0.5, 2.0).map(lambda share: share * (variable.start or 0.05)))
    return st.one_of(choices)


class Checked:
    """An instance beside its twin: every call is checked against what the contract says of it.

    Raises
    ------
    AssertionError
        From any call that does not come out as it should.
    """

    def __init__(self, caller: Caller, fmu: ExtractedFmu) -> None:
        self.caller = caller
        self.fmu = fmu
        self.twin = Twin(fmu)
        self.stained = False  # a Python instance that refused a value discards its next step
        answer = caller.make(b"it", fmu.library.token.encode())
        assert answer.status == OK, answer

    def free(self) -> None:
        self.caller.free()

    def saved(self) -> bytes:
        answer = self.caller.saved()
        assert answer.status == OK, answer
        return bytes(answer.value)

    def refused(self, call: Callable[[], Answer], *words: str) -> None:
        """Check that a call is an error that says these words, and that it has left no trace."""
        before = self.saved()
        answer = call()
        assert all(word in answer.text for word in words), (words, answer, self.twin)
        assert answer.text, (answer, self.twin)
        if self.fmu.is_native:
            assert answer.status == ERROR, (answer, self.twin)
            assert self.saved() == before, (answer, self.twin)
        else:  # what a Python instance cannot say itself, as pythonfmu knows no such status there, its next step says
            assert answer.status != FATAL, (answer, self.twin)
            self.stained = True

    # ---- values ------------------------------------------------------------------------------------------------------

    def read(self, variable: Settable) -> Any:
        answer = self.caller.get(variable.kind, [variable.reference])
        assert answer.ok, answer
        return answer.value[0]

    def expect_values(self) -> None:
        """Check that all parameters and inputs are those of the twin, and every output is a finite number."""
        for kind in ("Real", "Integer", "Boolean", "String"):
            wanted = [v for v in self.fmu.settable if v.kind == kind]
            answer = self.caller.get(kind, [v.reference for v in wanted])
            assert answer.ok, answer
            for variable, got in zip(wanted, answer.value, strict=True):
                assert _same(got, self.twin.values[variable.name]), (variable, got, self.twin.values[variable.name])
        for kind, references in self.fmu.outputs.items():
            answer = self.caller.get(kind, references)
            assert answer.ok, answer
            assert all(math.isfinite(number) for number in answer.value), (answer, self.twin)

    def set(self, variable: Settable, value: Any) -> bool:
        """Set a value; returns whether it was taken."""

        def call() -> Answer:
            return self.caller.set(variable.kind, [variable.reference], [value])

        finite = self.fmu.is_native or variable.kind != "Real" or math.isfinite(value)  # see the contract
        if self.twin.may_set(variable) and variable.is_legal(value) and finite:
            answer = call()
            assert answer.status == OK, answer
            self.twin.values[variable.name] = value
            return True
        self.refused(call, "" if self.twin.phase == "terminated" else variable.name)
        assert _same(self.read(variable), self.twin.values[variable.name])
        return False

    # ---- life cycle --------------------------------------------------------------------------------------------------

    def setup(self, start: float) -> None:
        """Tell the start time, in FMI 2."""
        if self.twin.phase == "instantiated" and abs(start) <= 1e9:
            assert self.caller.setup(start).status == OK
            self.twin.time = start
        else:
            self.refused(lambda: self.caller.setup(start))

    def enter(self, start: float = 0.0) -> bool:
        three = self.fmu.library.version == 3
        if self.twin.phase == "instantiated" and not (three and not abs(start) <= 1e9):
            assert self.caller.enter(start).status == OK
            self.twin.phase, self.twin.time = "initialising", start if three else self.twin.time
            return True
        self.refused(lambda: self.caller.enter(start))
        return False

    def exit(self) -> bool:
        bad = self.twin.bad_inputs()
        if self.twin.phase != "initialising" or bad:
            self.refused(self.caller.exit, *[*bad][:1])
            return False
        before = self.saved() if self.fmu.is_native else b""
        answer = self.caller.exit()
        failed = not answer.ok or any(said.status >= DISCARD for said in answer.said)
        assert not (failed and self.twin.tame), (answer, self.twin)
        assert answer.status != FATAL, answer
        if not failed:
            self.twin.phase = "stepping"
        elif self.fmu.is_native:
            assert answer.text, answer
            assert self.saved() == before
        else:
            self.stained = True
        return not failed

    def step(self, time: float, step_size: float) -> bool:
        stained = self.stained
        if not self.twin.may_step(time, step_size) or stained:
            words = self.twin.what_spoils_a_step() if self.twin.is_next(time, step_size) and not stained else ()
            self.refused(lambda: self.caller.step(time, step_size), *words)
            self.stained = stained and self.twin.phase != "stepping"
            return False
        before = self.saved()
        answer = self.caller.step(time, step_size)
        assert answer.ok or not self.twin.tame, (answer, self.twin)
        assert not answer.value, answer  # no events, no early return, no end
        if answer.ok:
            self.twin.time = time + step_size
        else:
            assert answer.status != FATAL, answer
            assert answer.text, answer
            assert self.saved() == before
        return answer.ok

    def terminate(self) -> None:
        if self.twin.phase == "stepping":
            assert self.caller.terminate().status == OK
            self.twin.phase = "terminated"
        else:
            self.refused(self.caller.terminate)

    def reset(self) -> None:
        assert self.caller.reset().status == OK
        self.twin, self.stained = Twin(self.fmu), False

    def begin(self) -> bool:
        """Go from an instance that was just made to its first step."""
        return self.enter() and self.exit()


def _same(got: Any, expected: Any) -> bool:
    if isinstance(expected, str):
        expected = expected.encode()
    if isinstance(expected, float):
        return struct.pack("d", got) == struct.pack("d", expected) or (math.isnan(got) and math.isnan(expected))
    return bool(got == expected)


def run_a_little(checked: Checked) -> None:
    """Step at sizes from 1 us up, and again where a step was."""
    for step_size in (0.002, 1e-6, 0.1 if checked.fmu.is_native else 0.0033):
        checked.step(checked.twin.time, step_size)
        checked.expect_values()
    if checked.twin.time > 0.0:
        checked.step(0.0, 0.002)


# ---- every value ---------------------------------------------------------------------------------------------------


def every_value_is_taken_or_refused(caller: Caller, fmu: ExtractedFmu) -> int:
    """Try every special value of every parameter and input, before and while stepping; returns how many there were."""
    cases = 0
    checked = Checked(caller, fmu)
    for variable in fmu.settable:
        for value in special_values(variable, fmu.is_native):
            cases += 1
            checked.set(variable, value)
            if checked.begin():
                run_a_little(checked)
            checked.reset()
            if variable.tunable:
                checked.begin()
                checked.set(variable, value)
                run_a_little(checked)
                checked.reset()
    checked.free()
    return cases


# ---- any order of calls ----------------------------------------------------------------------------------------------


def life_cycle(caller: Caller, fmu: ExtractedFmu, recordings: Sequence[bytes] = ()) -> type[RuleBasedStateMachine]:
    """Make the machine that calls an FMU's functions in any order, legal or not, with any values.

    Parameters
    ----------
    recordings
        Names of files that the shaker can play.
    """
    native = fmu.is_native
    step_sizes = STEP_SIZES if native else STEP_SIZES[:6]

    class LifeCycle(RuleBasedStateMachine):
        """One instance, checked call by call; saved states with the twins they were taken from."""

        states: Bundle[tuple[int, Twin, bool]] = Bundle("states")

        @initialize()
        def make(self) -> None:
            self.checked = Checked(caller, fmu)

        def teardown(self) -> None:
            self.checked.free()

        @rule(data=st.data(), variable=st.sampled_from(fmu.settable))
        def set(self, data: st.DataObject, variable: Settable) -> None:
            choices = values(variable, native)
            if variable.kind == "String" and recordings:
                choices = st.one_of(st.sampled_from(recordings), choices)
            self.checked.set(variable, data.draw(choices, label=variable.name))

        @rule(start=st.sampled_from((0.0, 0.0, 0.1, -5.0, 1e6, 1e9, -1e9, 1.1e9, math.nan, math.inf)))
        def setup(self, start: float) -> None:
            if fmu.library.version == 2:
                self.checked.setup(start)

        @rule()
        def enter(self) -> None:
            self.checked.enter()

        @rule()
        def exit(self) -> None:
            self.checked.exit()

        @rule()
        def begin(self) -> None:
            if self.checked.twin.phase == "instantiated":
                self.checked.begin()

        @rule(step_size=st.sampled_from(step_sizes))
        def step(self, step_size: float) -> None:
            self.checked.step(self.checked.twin.time, step_size)

        @rule(step_size=st.sampled_from(BAD_STEP_SIZES))
        def step_by_nonsense(self, step_size: float) -> None:
            self.checked.step(self.checked.twin.time, step_size)

        @rule(time=st.one_of(st.sampled_from(BAD_TIMES), st.sampled_from((0.0, 0.002, -0.002))))
        def step_from_elsewhere(self, time: float) -> None:
            self.checked.step(time, 0.002)

        @rule(target=states)
        def get_state(self) -> tuple[int, Twin, bool]:
            answer = caller.get_state()
            assert answer.status == OK, answer
            return answer.value, self.checked.twin.copy(), self.checked.stained

        @rule(state=states)
        def set_state(self, state: tuple[int, Twin, bool]) -> None:
            number, twin, stained = state
            answer = caller.set_state(number)
            assert answer.status == OK, answer
            self.checked.twin, self.checked.stained = twin.copy(), stained

        @rule(target=states, state=states)
        def there_and_back(self, state: tuple[int, Twin, bool]) -> tuple[int, Twin, bool]:
            number, twin, stained = state
            data = caller.to_bytes(number).value
            answer = caller.from_bytes(data)
            assert answer.status == OK, answer
            assert caller.to_bytes(answer.value).value == data
            return answer.value, twin, stained

        @rule()
        def terminate(self) -> None:
            self.checked.terminate()

        @rule()
        def reset(self) -> None:
            self.checked.reset()

        @invariant()
        def agrees(self) -> None:
            self.checked.expect_values()

    LifeCycle.__qualname__ = f"LifeCycle of {fmu}"
    return LifeCycle


# ---- states from bytes -----------------------------------------------------------------------------------------------


def saved_states(checked: Checked) -> list[bytes]:
    """Take states of an instance in every phase, and reset it."""
    found = [checked.saved()]
    checked.enter()
    found.append(checked.saved())
    checked.exit()
    for _ in range(4):
        for variable in checked.fmu.inputs:
            checked.set(variable, 0.01 * len(found))
        checked.step(checked.twin.time, 0.0021)
    found.append(checked.saved())
    checked.terminate()
    found.append(checked.saved())
    checked.reset()
    return found


def a_state_is_refused_or_harmless(checked: Checked, data: bytes) -> bool:
    """Offer bytes as a state: an error that says so, or an instance that goes on; returns whether they were taken."""
    caller, fmu = checked.caller, checked.fmu
    answer = caller.from_bytes(data)
    if not answer.ok:
        assert answer.text, answer
        assert answer.status == ERROR, answer
        assert answer.value is None, answer
        return False
    before = checked.saved()
    taken = caller.set_state(answer.value)
    assert taken.status != FATAL, taken
    caller.free_state(answer.value)
    if any(said.status >= DISCARD for said in taken.said) or not taken.ok:
        assert taken.text, taken
        assert not fmu.is_native or checked.saved() == before, taken
    for _ in range(3):
        found = caller.get("Real", [0, *fmu.outputs.get("Real", [])])
        assert found.ok, found
        assert all(map(math.isfinite, found.value)), found
        for variable in fmu.inputs:
            caller.set("Real", [variable.reference], [0.01])
        stepped = caller.step(found.value[0], 0.002)
        assert stepped.status != FATAL, stepped
        assert stepped.ok or stepped.text, stepped
    return True


def checksummed(data: bytes) -> bytes:
    """Give a native state that was changed the checksum that belongs to it: FNV-1a over what follows the checksum."""
    total = 14695981039346656037
    for byte in data[64:]:
        total = (total ^ byte) * 1099511628211 % 2**64
    return data[:56] + struct.pack("<Q", total) + data[64:]


@st.composite
def spoiled_states(draw: st.DrawFn, saved: Sequence[bytes], strangers: Sequence[bytes], native: bool) -> bytes:
    """Draw states that were damaged, by chance or on purpose, or were none from the begin."""
    how = draw(st.sampled_from(("numbers", "numbers", "numbers", "bits", "cut", "longer", "stranger", "noise")))
    data = bytearray(draw(st.sampled_from(saved)))
    if how == "stranger":
        return draw(st.sampled_from(strangers))
    if how == "noise":
        return draw(st.binary(max_size=2 * len(data)))
    if how == "cut":
        return bytes(data[: draw(st.integers(0, len(data) - 1))])
    if how == "longer":
        return bytes(data) + draw(st.binary(min_size=1, max_size=100))
    if how == "numbers" and not native:
        return _with_other_numbers(draw, bytes(data))
    for _ in range(draw(st.integers(1, 6))):
        if how == "bits":
            place = draw(st.integers(0, len(data) - 1))
            data[place] ^= 1 << draw(st.integers(0, 7))
        else:
            place = 64 + 8 * draw(st.integers(0, (len(data) - 64) // 8 - 1))
            data[place : place + 8] = struct.pack("<d", draw(_NUMBERS))
    fix = native and len(data) >= 64 and (how == "numbers" or draw(st.booleans()))
    return checksummed(bytes(data)) if fix else bytes(data)


_NUMBERS = st.one_of(st.sampled_from(SPECIAL), st.sampled_from((2.0, 3.0, 4.0, 255.0, 256.0, 257.0, 0.5)), st.floats())


def _with_other_numbers(draw: st.DrawFn, data: bytes) -> bytes:
    """Put something else into places of a Python state, which is JSON."""
    state = json.loads(data)
    strange = st.one_of(_NUMBERS, st.none(), st.booleans(), st.text(max_size=5), st.just([]), st.just({}))
    for _ in range(draw(st.integers(1, 4))):
        key = draw(st.sampled_from(sorted(state)))
        if isinstance(state[key], list) and state[key] and draw(st.integers(0, 9)):
            state[key][draw(st.integers(0, len(state[key]) - 1))] = draw(strange)
        elif draw(st.booleans()):
            state[key] = draw(strange)
        elif draw(st.integers(0, 3)) == 0:
            del state[key]
        if not state:
            break
    return json.dumps(state).encode()
