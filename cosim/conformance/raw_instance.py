"""Instances of an FMU, called function by function: what a rule asks comes back as a status, to be judged by the rule.

:class:`cosim.fmi.instance.Instance` is for those who want to run an FMU and hear of what goes wrong; here calls are
made that are wrong on purpose, and a library need not be complete. fmpy knows the functions' prototypes.
"""

from __future__ import annotations

import ctypes
import inspect
import types
import typing
from abc import ABC, abstractmethod
from collections.abc import Iterable
from contextlib import chdir
from functools import cache
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

from fmpy import platform, platform_tuple, sharedLibraryExtension
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE, fmi2Terminated
from fmpy.fmi3 import FMU3Slave, fmi3IntermediateUpdateCallback, fmi3LogMessageCallback
from fmpy.logging import addLoggerProxy

from cosim.conformance.model_description import INTEGERS, Description, Variable
from cosim.conformance.rule import NotApplicableError
from cosim.errors import CosimError

OK, WARNING, DISCARD, ERROR, FATAL = range(5)
STATUS = ("ok", "warning", "discard", "error", "fatal", "pending")

Values = tuple[Any, ...]


class RefusedError(CosimError):
    """A call that should have gone well did not."""


def _c_type(annotation: Any) -> Any:
    """Return the C type of an argument as fmpy annotates it."""
    if isinstance(annotation, types.UnionType):
        annotation = typing.get_args(annotation)[0]
    return {bytes: ctypes.c_char_p, int: ctypes.c_int}.get(annotation, annotation)


class Step(NamedTuple):
    """What a step came to.

    Attributes
    ----------
    status
        Of the call.
    ended
        Whether the FMU asks for the end of the run.
    early
        Whether it returned before the end of the step.
    reached
        The time it says it reached, in s; None where it does not say.
    """

    status: int
    ended: bool = False
    early: bool = False
    reached: float | None = None


class Library(ABC):
    """An FMU's library, loaded; made by :func:`load`.

    Parameters
    ----------
    description
        The FMU's.
    folder
        Where it was extracted.
    """

    PREFIX: ClassVar[str]
    SLAVE: ClassVar[Any]
    TYPES: ClassVar[dict[str, tuple[str, Any]]]
    """Type of a variable to the name of its access and the C type of its values."""

    STATE: ClassVar[tuple[str, str, str, str, str, str]]
    """Functions of the state: get, set, free, size, serialise, deserialise."""

    BYTE: ClassVar[Any]
    """C type of a byte of a serialised state."""

    def __init__(self, description: Description, folder: Path) -> None:
        self.description = description
        self.folder = folder
        self.said: list[str] = []
        self._functions: dict[str, Any] = {}
        path = library_path(description, folder)
        with chdir(path.parent):  # as some expect, to find what comes with them
            self._library = ctypes.CDLL(str(path))
        self._prepare()

    @classmethod
    @cache
    def prototypes(cls) -> dict[str, tuple[list[Any], Any]]:
        """Return all functions of the standard for co-simulation: types of arguments and of what is returned."""
        found = {}
        for name, function in inspect.getmembers(cls.SLAVE, inspect.isfunction):
            if name.startswith(cls.PREFIX):
                signature = inspect.signature(function)
                arguments = [_c_type(p.annotation) for p in list(signature.parameters.values())[1:]]
                found[name] = arguments, _c_type(signature.return_annotation)
        return found

    def _prepare(self) -> None:  # noqa: B027
        """Make what all instances share."""

    def function(self, name: str) -> Any:
        """Return a function by its name without the prefix.

        Raises
        ------
        NotApplicableError
            If the library does not have it, which one rule tells for all.
        """
        if name not in self._functions:
            full = self.PREFIX + name
            try:
                function = getattr(self._library, full)
            except AttributeError:
                raise NotApplicableError(f"the library has no {full}") from None
            function.argtypes, function.restype = self.prototypes()[full]
            self._functions[name] = function
        return self._functions[name]

    @property
    def resources(self) -> Path:
        """Where the FMU finds its files."""
        return self.folder / "resources"

    def complaint(self) -> str:
        """Return what the FMU said last; for the end of a message."""
        return f" (it says: {self.said[-1]})" if self.said else ""

    @abstractmethod
    def make(self, name: str, token: str) -> int | None:
        """Instantiate; returns the instance's pointer, None if the FMU refuses."""

    @abstractmethod
    def enter(self, instance: int, start: float, stop: float | None) -> tuple[str, int]:
        """Enter the initialisation of a run in s; returns name and status of the last call."""

    @abstractmethod
    def step(self, instance: int, time: float, size: float) -> Step:
        """Step from a time by a size in s."""

    def sizes(self, count: int) -> tuple[int, ...]:
        """Return what a getter or setter is told beside the references of some variables."""
        return ()

    def extent(self, variable: Variable) -> int:
        """Return how many values a variable has, as declared."""
        count = 1
        for start, reference in variable.dimensions:
            size = start or next(
                (v.start[0] for v in self.description.variables if v.start and str(v.reference) == reference), "0"
            )
            count *= int(size)
        return count


class Library2(Library):
    """The library of an FMI 2.0 FMU."""

    PREFIX = "fmi2"
    SLAVE = FMU2Slave
    BYTE = ctypes.c_char
    TYPES: ClassVar = {
        "Real": ("Real", ctypes.c_double),
        "Integer": ("Integer", ctypes.c_int),
        "Enumeration": ("Integer", ctypes.c_int),
        "Boolean": ("Boolean", ctypes.c_int),
        "String": ("String", ctypes.c_char_p),
    }
    STATE = (
        "GetFMUstate",
        "SetFMUstate",
        "FreeFMUstate",
        "SerializedFMUstateSize",
        "SerializeFMUstate",
        "DeSerializeFMUstate",
    )

    def _prepare(self) -> None:
        @fmi2CallbackLoggerTYPE  # type: ignore[untyped-decorator]
        def log(environment: int | None, name: bytes, status: int, category: bytes, message: bytes) -> None:
            self.said.append((message or b"").decode(errors="replace"))

        self._callbacks = fmi2CallbackFunctions()
        self._callbacks.logger = log
        self._callbacks.allocateMemory = defaultCallbacks.allocateMemory
        self._callbacks.freeMemory = defaultCallbacks.freeMemory
        addLoggerProxy(ctypes.byref(self._callbacks))  # formats the variable arguments, which ctypes cannot
        self._log = log

    def make(self, name: str, token: str) -> int | None:  # noqa: D102
        location = self.resources.resolve().as_uri().encode()
        arguments = (token.encode(), location, ctypes.byref(self._callbacks), 0, 1)
        found: int | None = self.function("Instantiate")(name.encode(), 1, *arguments)
        return found

    def enter(self, instance: int, start: float, stop: float | None) -> tuple[str, int]:  # noqa: D102
        status = self.function("SetupExperiment")(instance, 0, 0.0, start, stop is not None, stop or 0.0)
        if status > WARNING:
            return "fmi2SetupExperiment", status
        return "fmi2EnterInitializationMode", self.function("EnterInitializationMode")(instance)

    def step(self, instance: int, time: float, size: float) -> Step:  # noqa: D102
        status = self.function("DoStep")(instance, time, size, 1)
        ended = ctypes.c_int(0)
        if status == DISCARD:
            self.function("GetBooleanStatus")(instance, fmi2Terminated, ctypes.byref(ended))
        return Step(status, ended=bool(ended.value))


class Library3(Library):
    """The library of an FMI 3.0 FMU, used without event mode and early return."""

    PREFIX = "fmi3"
    SLAVE = FMU3Slave
    BYTE = ctypes.c_uint8
    TYPES: ClassVar = {
        "Float32": ("Float32", ctypes.c_float),
        "Float64": ("Float64", ctypes.c_double),
        **{name: (name, getattr(ctypes, f"c_{name.lower()}")) for name in INTEGERS if name != "Integer"},
        "Enumeration": ("Int64", ctypes.c_int64),
        "Boolean": ("Boolean", ctypes.c_bool),
        "String": ("String", ctypes.c_char_p),
        "Binary": ("Binary", ctypes.POINTER(ctypes.c_uint8)),
    }
    STATE = (
        "GetFMUState",
        "SetFMUState",
        "FreeFMUState",
        "SerializedFMUStateSize",
        "SerializeFMUState",
        "DeserializeFMUState",
    )

    def _prepare(self) -> None:
        def log(environment: int | None, status: int, category: bytes, message: bytes) -> None:
            self.said.append((message or b"").decode(errors="replace"))

        self._log = fmi3LogMessageCallback(log)
        self._update = fmi3IntermediateUpdateCallback()

    def make(self, name: str, token: str) -> int | None:  # noqa: D102
        path = f"{self.resources.resolve()}/".encode()
        arguments = (token.encode(), path, False, True, False, False, None, 0, None, self._log, self._update)
        found: int | None = self.function("InstantiateCoSimulation")(name.encode(), *arguments)
        return found

    def enter(self, instance: int, start: float, stop: float | None) -> tuple[str, int]:  # noqa: D102
        arguments = (False, 0.0, start, stop is not None, stop or 0.0)
        return "fmi3EnterInitializationMode", self.function("EnterInitializationMode")(instance, *arguments)

    def step(self, instance: int, time: float, size: float) -> Step:  # noqa: D102
        flags = [ctypes.c_bool() for _ in range(3)]
        reached = ctypes.c_double(time)
        answers = (*map(ctypes.byref, flags), ctypes.byref(reached))
        status = self.function("DoStep")(instance, time, size, True, *answers)
        return Step(status, ended=flags[1].value, early=flags[2].value, reached=reached.value)

    def sizes(self, count: int) -> tuple[int, ...]:  # noqa: D102
        return (count,)


def library_path(description: Description, folder: Path) -> Path:
    """Return where an FMU's library for this machine lies, if it has one."""
    where: str = platform if description.standard == 2 else platform_tuple
    name: str = f"{description.identifier}{sharedLibraryExtension}"
    return folder / "binaries" / where / name


def load(description: Description, folder: Path) -> Library:
    """Load an FMU's library; parameters as those of :class:`Library`, OSError if it cannot be loaded."""
    return {2: Library2, 3: Library3}[description.standard](description, folder)


class Slave:
    """An instance of an FMU.

    Parameters
    ----------
    library
        The FMU's library.
    pointer
        What instantiating it returned.
    """

    def __init__(self, library: Library, pointer: int) -> None:
        self.library = library
        self.pointer = pointer

    def call(self, name: str, *arguments: Any) -> int:
        """Call a function that takes the instance first, by its name without the prefix; returns its status."""
        status: int = self.library.function(name)(self.pointer, *arguments)
        return status

    def demand(self, name: str, *arguments: Any) -> None:
        """Call a function that has to go well.

        Raises
        ------
        RefusedError
            If it does not.
        """
        self._judge(self.library.PREFIX + name, self.call(name, *arguments))

    def _judge(self, name: str, status: int, where: str = "") -> None:
        if status > WARNING:
            got = STATUS[status] if status < len(STATUS) else status
            raise RefusedError(f"{name}{where}: expected ok, got {got}{self.library.complaint()}")

    # ---- life cycle --------------------------------------------------------------------------------------------------

    def enter(self, start: float, stop: float | None = None) -> None:
        """Enter the initialisation of a run from a time in s on."""
        self._judge(*self.library.enter(self.pointer, start, stop))

    def leave(self) -> None:
        """Leave the initialisation."""
        self.demand("ExitInitializationMode")

    def step(self, time: float, size: float) -> Step:
        """Step from a time by a size in s, which has to go well or to ask for the run's end."""
        found = self.library.step(self.pointer, time, size)
        if not found.ended:
            self._judge(f"{self.library.PREFIX}DoStep", found.status, f" at t = {time:g} s, step {size:g} s")
            if found.early:
                raise RefusedError(f"fmi3DoStep at t = {time:g} s: expected the whole step, got an early return")
        return found

    def free(self) -> None:
        """Free the instance."""
        self.library.function("FreeInstance")(self.pointer)

    # ---- values ------------------------------------------------------------------------------------------------------

    def get(self, variables: Iterable[Variable]) -> dict[str, Values]:
        """Get values by name; of arrays all elements, of binaries the bytes."""
        found: dict[str, Values] = {}
        for kind in self.library.TYPES:
            if chosen := [v for v in variables if v.type == kind]:
                found |= self._get(kind, chosen)
        return found

    def _get(self, kind: str, variables: list[Variable]) -> dict[str, Values]:
        access, c_type = self.library.TYPES[kind]
        extents = [self.library.extent(v) for v in variables]
        total = sum(extents)
        references = (ctypes.c_uint * len(variables))(*(v.reference for v in variables))
        buffer = (c_type * total)()
        lengths = (ctypes.c_size_t * total)()
        more = (lengths, buffer, total) if kind == "Binary" else (buffer, *self.library.sizes(total))
        where = f" of {variables[0].name}" if len(variables) == 1 else f" of {variables[0].name} and others"
        name = f"Get{access}"
        self._judge(self.library.PREFIX + name, self.call(name, references, len(variables), *more), where)
        if kind == "Binary":
            values: list[Any] = [ctypes.string_at(buffer[i], lengths[i]) if buffer[i] else b"" for i in range(total)]
        else:
            values = list(buffer)
        return {v.name: tuple(values[end - n : end]) for v, n, end in _parts(variables, extents)}

    def set(self, variable: Variable, values: Values) -> int:
        """Set a variable's values; returns the status."""
        access, c_type = self.library.TYPES[variable.type]
        references = (ctypes.c_uint * 1)(variable.reference)
        count = len(values)
        if variable.type == "Binary":
            contents = [(ctypes.c_uint8 * max(len(value), 1))(*value) for value in values]
            buffer = (c_type * count)(*(ctypes.cast(content, c_type) for content in contents))
            lengths = (ctypes.c_size_t * count)(*map(len, values))
            return self.call("SetBinary", references, 1, lengths, buffer, count)
        return self.call(f"Set{access}", references, 1, (c_type * count)(*values), *self.library.sizes(count))

    # ---- state -------------------------------------------------------------------------------------------------------

    def state(self) -> ctypes.c_void_p:
        """Get the FMU's state."""
        found = ctypes.c_void_p()
        self.demand(self.library.STATE[0], ctypes.byref(found))
        if not found.value:
            raise RefusedError(f"{self.library.PREFIX}{self.library.STATE[0]}: expected a state, got a null pointer")
        return found

    def restore(self, state: ctypes.c_void_p) -> None:
        """Set the FMU's state."""
        self.demand(self.library.STATE[1], state)

    def free_state(self, state: ctypes.c_void_p) -> None:
        """Free a state; the pointer is null afterwards."""
        self.demand(self.library.STATE[2], ctypes.byref(state))

    def serialise(self, state: ctypes.c_void_p) -> bytes:
        """Turn a state into bytes."""
        size = ctypes.c_size_t()
        self.demand(self.library.STATE[3], state, ctypes.byref(size))
        buffer = (self.library.BYTE * max(size.value, 1))()
        self.demand(self.library.STATE[4], state, buffer, size.value)
        return bytes(bytearray(buffer)[: size.value])

    def deserialise(self, content: bytes) -> ctypes.c_void_p:
        """Turn bytes into a state."""
        found = ctypes.c_void_p()
        buffer = (self.library.BYTE * max(len(content), 1)).from_buffer_copy(content or b"\0")
        self.demand(self.library.STATE[5], buffer, len(content), ctypes.byref(found))
        return found


def _parts(variables: list[Variable], extents: list[int]) -> Iterable[tuple[Variable, int, int]]:
    """Go through variables, how many values each has, and where they end."""
    end = 0
    for variable, extent in zip(variables, extents, strict=True):
        end += extent
        yield variable, extent, end
