"""Random calls of the whole API of a native FMU: a refused call leaves no trace, a copy behaves like its original.

The original is driven at random. From time to time a second instance is made from its bytes, which has another history
of its own; from then on both get the same calls, and have to give the same answers and the same bytes.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import Any

from tests.system.hostile.caller import ERROR, OK, WARNING, Host
from tests.system.hostile.extracted_fmus import ExtractedFmu
from tests.system.hostile.fmu_properties import BAD_STEP_SIZES, BAD_TIMES, STEP_SIZES, special_values

Call = tuple[Any, ...]
"""Name of a method of :class:`tests.system.hostile.caller.Host` and its arguments."""

STOP_TIMES = (None, None, 0.004, 0.1, 1.0, 1e6, -1.0)
STARTS = (0.0, 0.0, 0.0, 0.5, -3.0, 1e8)


class ApiDriver:
    """Drives an instance, and a copy of it, at random.

    Parameters
    ----------
    fmu
        The FMU, native.
    seed
        Of the random calls.
    """

    def __init__(self, fmu: ExtractedFmu, seed: int) -> None:
        self._fmu = fmu
        self._random = random.Random(seed)
        self._original, self._copy = Host(fmu.library), Host(fmu.library)
        self._history: list[Call] = []
        self._time = 0.0
        self._has_copy = False
        self.refused = self.copies = self.calls = 0
        self._make(self._original)

    def close(self) -> None:
        """Free the instances."""
        self._original.free()
        self._copy.free()

    def run(self, calls: int) -> None:
        """Make random calls.

        Raises
        ------
        AssertionError
            If a call leaves a trace that it must not leave, or copy and original differ; with the history.
        """
        for _ in range(calls):
            if self._random.random() < 0.05:
                self._make_copy()
            self._make_call(self._draw())

    def _make(self, host: Host) -> None:
        status, _ = host.make(b"it", self._fmu.library.token.encode())
        assert status == OK

    def _make_copy(self) -> None:
        """Give a second instance, of another history, the bytes of the first."""
        self._make(self._copy)
        stop = self._random.choice(STOP_TIMES)
        for call in self._random.choice([[], [("setup", 0.0, stop), ("enter", 0.0, stop), ("exit",)]]):
            if call[0] != "setup" or self._copy.version == 2:
                getattr(self._copy, call[0])(*call[1:])
        data = _bytes(self._original)
        status, number = self._copy.from_bytes(data)
        assert status == OK, self._described(f"bytes of a state refused: {self._copy.said}")
        status, _ = self._copy.set_state(number)
        assert status == OK, self._described(f"state refused: {self._copy.said}")
        assert _bytes(self._copy) == data, self._described(_difference(data, _bytes(self._copy)))
        self._has_copy = True
        self.copies += 1

    def _make_call(self, call: Call) -> None:
        """Make a call of original and copy and compare the outcomes."""
        name, *arguments = call
        self._history.append(call)
        self.calls += 1
        before = _bytes(self._original)
        status, value = getattr(self._original, name)(*arguments)
        after = _bytes(self._original)
        if status not in (OK, WARNING):
            self.refused += 1
            assert status == ERROR, self._described(f"status {status}")
            assert after == before, self._described(f"refused, but {_difference(before, after)}")
        elif name == "step":
            self._time = arguments[0] + arguments[1]
        if self._has_copy:
            found = getattr(self._copy, name)(*arguments)
            assert (found[0], repr(found[1])) == (status, repr(value)), self._described(
                f"original {status, value}, copy {found}: {[said.text for said in self._copy.said[-2:]]}"
            )
            assert _bytes(self._copy) == after, self._described(f"copy: {_difference(after, _bytes(self._copy))}")
        self._original.said.clear()
        self._copy.said.clear()

    def _draw(self) -> Call:
        kinds: list[tuple[Callable[[], Call], int]] = [
            (self._step, 40),
            (self._set, 25),
            (self._get, 10),
            (self._life, 12),
        ]
        (chosen,) = self._random.choices([kind for kind, _ in kinds], [weight for _, weight in kinds])
        return chosen()

    def _step(self) -> Call:
        time, size = self._time, self._random.choice(STEP_SIZES[:7])
        if self._random.random() < 0.1:
            time = self._random.choice(BAD_TIMES)
        if self._random.random() < 0.1:
            size = self._random.choice((*BAD_STEP_SIZES, *STEP_SIZES))
        return "step", time, size

    def _set(self) -> Call:
        variable = self._random.choice(self._fmu.settable if self._random.random() < 0.4 else self._fmu.inputs or [0])
        variable = variable or self._random.choice(self._fmu.settable)
        near = variable.kind == "Real" and self._random.random() < 0.5
        value = self._random.uniform(0.5, 2.0) * (variable.start or 0.05) if near else None
        value = self._random.choice(special_values(variable)) if value is None else value
        return "set", variable.kind, [variable.reference], [value]

    def _get(self) -> Call:
        kind, references = self._random.choice(list(self._fmu.outputs.items()))
        return "get", kind, references

    def _life(self) -> Call:
        start, stop = self._random.choice(STARTS), self._random.choice(STOP_TIMES)
        name = self._random.choice(["setup", "enter", "enter", "exit", "exit", "exit", "terminate", "reset"])
        if name in ("setup", "enter"):
            name = name if self._fmu.library.version == 2 else "enter"
            self._time = start
            return name, start, stop
        return (name,)

    def _described(self, what: str) -> str:
        return f"{self._fmu}: {what} after {self._history[-12:]}"


def _bytes(host: Host) -> bytes:
    status, data = host.saved()
    assert status == OK
    return bytes(data)


def _difference(one: bytes, other: bytes) -> str:
    """Name the cells of eight bytes that differ."""
    cells = [i for i in range(0, len(one), 8) if one[i : i + 8] != other[i : i + 8]]
    return f"cells {cells[:8]} of {len(one)} bytes differ"
