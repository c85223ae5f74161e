"""The functions of an FMU, called by hand as any host would call them, every call noted before it is made.

What is noted outlives the process: if a call crashes it, the file holds all calls since the instance was made, and a
call that hangs is ended by an alarm.
"""

from __future__ import annotations

import ctypes
import os
import signal
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

TIME_LIMIT = 60
"""How long the calls of one instance may take, in s: its steps of 10 s take 0.2 s each at most."""

OK, WARNING, DISCARD, ERROR, FATAL = range(5)


class Said(NamedTuple):
    """A message of an FMU."""

    status: int
    text: str


class Answer(NamedTuple):
    """What came of a call: status, result, messages."""

    status: int
    value: Any
    said: list[Said]

    @property
    def ok(self) -> bool:
        return self.status in (OK, WARNING)

    @property
    def text(self) -> str:
        return "; ".join(said.text for said in self.said)


@dataclass(frozen=True)
class Library:
    """What to load: a shared library with its standard, its token and its folder of resources."""

    path: Path
    version: int
    token: str
    resources: Path


@dataclass
class Host:
    """Calls the functions of one library, of either standard."""

    library: Library
    said: list[Said] = field(default_factory=list)
    states: dict[int, ctypes.c_void_p] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.version = self.library.version
        self.dll = ctypes.CDLL(str(self.library.path))
        self.prefix = f"fmi{self.version}"
        real, integer = ("Real", "Integer") if self.version == 2 else ("Float64", "Int64")
        truth: Any = ctypes.c_int if self.version == 2 else ctypes.c_bool
        whole: Any = ctypes.c_int32 if self.version == 2 else ctypes.c_int64
        self.types: dict[str, tuple[str, Any]] = {
            "Real": (real, ctypes.c_double),
            "Integer": (integer, whole),
            "Boolean": ("Boolean", truth),
            "String": ("String", ctypes.c_char_p),
        }
        text, pointer = ctypes.c_char_p, ctypes.c_void_p
        if self.version == 2:
            kind = ctypes.CFUNCTYPE(None, pointer, text, ctypes.c_int, text, text)
            self.logger: Any = kind(lambda _e, _n, status, _c, message: self._note(status, message))
            self.allocate = ctypes.CFUNCTYPE(pointer, ctypes.c_size_t, ctypes.c_size_t)(("calloc", ctypes.CDLL(None)))
            self.release = ctypes.CFUNCTYPE(None, pointer)(("free", ctypes.CDLL(None)))
            cast = [ctypes.cast(f, pointer) for f in (self.logger, self.allocate, self.release)]
            self.callbacks = (pointer * 5)(*(f.value for f in cast), None, None)
        else:
            self.logger = ctypes.CFUNCTYPE(None, pointer, ctypes.c_int, text, text)(
                lambda _e, status, _c, message: self._note(status, message)
            )
        self.component = ctypes.c_void_p()

    def _note(self, status: int, message: bytes | None) -> None:
        self.said.append(Said(status, (message or b"").decode(errors="replace")))

    def _call(self, name: str, *arguments: Any) -> int:
        return int(getattr(self.dll, self.prefix + name)(self.component, *arguments))

    def make(self, name: bytes, token: bytes | None) -> tuple[int, Any]:
        self.free()
        if self.version == 2:
            function = self.dll.fmi2Instantiate
            arguments = [name, 1, token, self.library.resources.as_uri().encode(), self.callbacks, 0, 1]
        else:
            function = self.dll.fmi3InstantiateCoSimulation
            no = ctypes.c_bool(False)
            path = (f"{self.library.resources}/").encode()
            arguments = [name, token, path, no, ctypes.c_bool(True), no, no, None, ctypes.c_size_t(0), None]
            arguments += [self.logger, None]
        function.restype = ctypes.c_void_p
        self.component = ctypes.c_void_p(function(*arguments))
        return (OK if self.component else ERROR), None

    def free(self) -> tuple[int, Any]:
        if self.component:
            for number in [*self.states]:
                self.free_state(number)
            getattr(self.dll, f"{self.prefix}FreeInstance")(self.component)
        self.component = ctypes.c_void_p()
        return OK, None

    def setup(self, start: float, stop: float | None = None) -> tuple[int, Any]:
        double = ctypes.c_double
        times = double(start), int(stop is not None), double(stop or 0.0)
        return self._call("SetupExperiment", 0, double(0.0), *times), None

    def enter(self, start: float, stop: float | None = None) -> tuple[int, Any]:
        no, double = ctypes.c_bool(False), ctypes.c_double
        times = double(start), ctypes.c_bool(stop is not None), double(stop or 0.0)
        arguments = [] if self.version == 2 else [no, double(0.0), *times]
        return self._call("EnterInitializationMode", *arguments), None

    def exit(self) -> tuple[int, Any]:
        return self._call("ExitInitializationMode"), None

    def terminate(self) -> tuple[int, Any]:
        return self._call("Terminate"), None

    def reset(self) -> tuple[int, Any]:
        return self._call("Reset"), None

    def step(self, time: float, step_size: float) -> tuple[int, Any]:
        double = ctypes.c_double
        if self.version == 2:
            return self._call("DoStep", double(time), double(step_size), 1), None
        flags, reached = [ctypes.c_bool() for _ in range(3)], double()
        results = [ctypes.byref(result) for result in (*flags, reached)]
        status = self._call("DoStep", double(time), double(step_size), ctypes.c_bool(True), *results)
        return status, any(flag.value for flag in flags)

    def _access(self, direction: str, kind: str, references: Sequence[int], values: Any) -> int:
        count = ctypes.c_size_t(len(references))
        counts = [count] if self.version == 3 else []
        array = (ctypes.c_uint32 * len(references))(*references)
        return self._call(f"{direction}{self.types[kind][0]}", array, count, values, *counts)

    def get(self, kind: str, references: Sequence[int]) -> tuple[int, Any]:
        values = (self.types[kind][1] * len(references))()
        status = self._access("Get", kind, references, values)
        return status, list(values)

    def set(self, kind: str, references: Sequence[int], given: Sequence[Any]) -> tuple[int, Any]:
        values = (self.types[kind][1] * len(references))(*given)
        return self._access("Set", kind, references, values), None

    # FMI 2 and 3 differ in the spelling of "state"

    def _state(self, name: str) -> str:
        return name if self.version == 2 else name.replace("FMUstate", "FMUState").replace("DeSer", "Deser")

    def get_state(self) -> tuple[int, Any]:
        state, number = ctypes.c_void_p(), 1 + max(self.states, default=0)
        status = self._call(self._state("GetFMUstate"), ctypes.byref(state))
        if state:
            self.states[number] = state
        return status, number

    def set_state(self, number: int) -> tuple[int, Any]:
        return self._call(self._state("SetFMUstate"), self.states[number]), None

    def free_state(self, number: int) -> tuple[int, Any]:
        state = self.states.pop(number)
        return self._call(self._state("FreeFMUstate"), ctypes.byref(state)), bool(state)

    def to_bytes(self, number: int) -> tuple[int, Any]:
        size = ctypes.c_size_t()
        name = "SerializedFMUstateSize" if self.version == 2 else "SerializedFMUStateSize"
        status = self._call(name, self.states[number], ctypes.byref(size))
        room = ctypes.create_string_buffer(size.value)
        name = self._state("SerializeFMUstate")
        return max(status, self._call(name, self.states[number], room, ctypes.c_size_t(size.value))), room.raw

    def from_bytes(self, data: bytes) -> tuple[int, Any]:
        state, number = ctypes.c_void_p(), 1 + max(self.states, default=0)
        room = ctypes.create_string_buffer(data, max(1, len(data)))
        name = "DeSerializeFMUstate" if self.version == 2 else "DeserializeFMUState"
        status = self._call(name, room, ctypes.c_size_t(len(data)), ctypes.byref(state))
        if state:
            self.states[number] = state
        return status, number if state else None

    def saved(self) -> tuple[int, Any]:
        """The instance's state as bytes."""
        status, number = self.get_state()
        if status != OK:
            return status, None
        found = self.to_bytes(number)
        self.free_state(number)
        return found

    def memory(self) -> tuple[int, Any]:
        """Bytes in use, as the C library counts them."""

        class Statistics(ctypes.Structure):
            _fields_ = [(f"f{i}", ctypes.c_size_t) for i in range(10)]

        count = ctypes.CDLL(None).mallinfo2
        count.restype = Statistics
        found = count()
        return OK, found.f7 + found.f4  # arena and mapped

    def repeat(self, times: int, calls: Sequence[tuple[Any, ...]]) -> tuple[int, Any]:
        """Make the same calls many times over, without any of them kept."""
        for _ in range(times):
            for name, *arguments in calls:
                getattr(self, name)(*arguments)
            self.said.clear()
        return OK, None


class Caller:
    """Calls the functions of a library: ``caller.step(0.0, 0.002)`` is :meth:`Host.step`, noted and answered.

    Parameters
    ----------
    library
        What to load into this process.
    notes
        The file that holds the calls since the last ``make``, while this process lives and after.
    """

    def __init__(self, library: Library, notes: Path) -> None:
        self._host = Host(library)
        self._notes = os.open(notes, os.O_CREAT | os.O_WRONLY | os.O_TRUNC)
        self._place = 0

    def __getattr__(self, name: str) -> Callable[..., Answer]:
        if name.startswith("_"):
            raise AttributeError(name)
        method = getattr(self._host, name)

        def call(*arguments: Any) -> Answer:
            self._note(name, arguments)
            signal.alarm(TIME_LIMIT)
            try:
                status, value = method(*arguments)
            finally:
                signal.alarm(0)
            said, self._host.said = self._host.said, []
            if status == FATAL:  # after which no call is allowed, and one may crash
                print(f"{name} was fatal: {said}", file=sys.stderr, flush=True)
                os._exit(FATAL)
            return Answer(status, value, said)

        return call

    def _note(self, name: str, arguments: tuple[Any, ...]) -> None:
        if name == "make":
            os.ftruncate(self._notes, 0)
            self._place = 0
        line = f"{name}{arguments}\n".encode(errors="replace")
        self._place += os.pwrite(self._notes, line, self._place)
