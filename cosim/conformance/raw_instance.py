"""Call an FMU function by function: each call returns its status, and the rule judges it.

:class:`cosim.fmi.instance.Instance` runs FMUs and raises exceptions for errors. The rules also make calls that are
wrong on purpose, and must work with incomplete libraries. The prototypes of the functions come from fmpy.
"""

from __future__ import annotations

import ctypes
import inspect
import math
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

from cosim.conformance.model_description import RawDescription, RawVariable
from cosim.conformance.rule import NotApplicableError
from cosim.errors import CosimError
from cosim.fmi.variable_types import INTEGERS

OK, WARNING, DISCARD, ERROR, FATAL = range(5)
STATUS = ("ok", "warning", "discard", "error", "fatal", "pending")
"""Names of the status codes; FMI 2.0 and 3.0 number them alike."""

Values = tuple[Any, ...]
"""Values of a variable, one for each element of an array."""


class CallFailedError(CosimError):
    """A call that must succeed did not."""


class InstantiationError(CallFailedError):
    """The FMU returned no instance."""


def _c_type(annotation: Any) -> Any:
    """Return the C type of an argument from fmpy's annotation."""
    if isinstance(annotation, types.UnionType):
        annotation = typing.get_args(annotation)[0]
    return {bytes: ctypes.c_char_p, int: ctypes.c_int}.get(annotation, annotation)


class StepResult(NamedTuple):
    """Result of a step.

    Attributes
    ----------
    status
        Status of the call.
    terminate
        Whether the FMU requests the end of the simulation.
    early_return
        Whether the FMU returned before the end of the step.
    last_time
        The time that the FMU reports to have reached, in s; None in FMI 2.0.
    """

    status: int
    terminate: bool = False
    early_return: bool = False
    last_time: float | None = None


class RawLibrary(ABC):
    """The library of an FMU; :func:`load_library` creates one.

    Parameters
    ----------
    description
        The FMU's model description.
    folder
        Where the FMU was extracted.

    Attributes
    ----------
    messages
        Status and text of all messages of all instances.
    instances
        How many instances were requested so far.
    """

    PREFIX: ClassVar[str]
    """Prefix of the functions."""

    FMPY_CLASS: ClassVar[Any]
    """The class of fmpy whose methods have the prototypes."""

    TYPES: ClassVar[dict[str, tuple[str, Any]]]
    """Type of a variable to the name of its access functions and the C type of its values."""

    STATE_FUNCTIONS: ClassVar[tuple[str, str, str, str, str, str]]
    """Functions that get, set, free, size, serialize and deserialize the FMU state."""

    BYTE: ClassVar[Any]
    """C type of a byte of a serialized state."""

    def __init__(self, description: RawDescription, folder: Path) -> None:
        self.description = description
        self.folder = folder
        self.messages: list[tuple[int, str]] = []
        self.instances = 0
        self._last_call = 0  # number of messages before it
        self._functions: dict[str, Any] = {}
        path = library_path(description, folder)
        with chdir(path.parent):  # some libraries search the working folder for others that they need
            self._library = ctypes.CDLL(str(path))
        self._create_callbacks()

    @classmethod
    @cache
    def prototypes(cls) -> dict[str, tuple[list[Any], Any]]:
        """Return the co-simulation functions of the standard.

        Returns
        -------
        dict
            Name to the C types of the arguments and of the returned value.
        """
        found = {}
        for name, function in inspect.getmembers(cls.FMPY_CLASS, inspect.isfunction):
            if name.startswith(cls.PREFIX):
                signature = inspect.signature(function)
                arguments = [_c_type(p.annotation) for p in list(signature.parameters.values())[1:]]
                found[name] = arguments, _c_type(signature.return_annotation)
        return found

    @abstractmethod
    def _create_callbacks(self) -> None:
        """Create the callbacks that all instances share."""

    def function(self, name: str) -> Any:
        """Return a function of the library, to be called at once: the messages from now on are those of the call.

        Parameters
        ----------
        name
            The function's name without prefix.

        Returns
        -------
        ctypes function
            With its prototype set.

        Raises
        ------
        NotApplicableError
            If the library does not export the function, which the rule ``binary.symbols`` reports.
        """
        if name not in self._functions:
            full = self.PREFIX + name
            try:
                function = getattr(self._library, full)
            except AttributeError:
                raise NotApplicableError(f"the library has no {full}") from None
            function.argtypes, function.restype = self.prototypes()[full]
            self._functions[name] = function
        self._last_call = len(self.messages)
        return self._functions[name]

    @property
    def resources(self) -> Path:
        """The FMU's folder ``resources``."""
        return self.folder / "resources"

    def last_message(self) -> str:
        """Return what the FMU said of the last call, in parentheses, to be appended to a message; empty for nothing.

        It is the last error, where there was none the last warning or else the last message. Where the last call logged
        nothing, those of all calls count.
        """
        found = self.messages[self._last_call :] or self.messages
        for least in (DISCARD, WARNING, OK):
            for status, text in reversed(found):
                if status >= least:
                    return f" (FMU message: {text})"
        return ""

    @abstractmethod
    def instantiate(self, name: str, token: str) -> int | None:
        """Instantiate the FMU for co-simulation.

        Parameters
        ----------
        name
            Name of the instance.
        token
            GUID or instantiation token.

        Returns
        -------
        int or None
            The instance's pointer; None if the FMU returns a null pointer.
        """

    @abstractmethod
    def enter_initialization_mode(self, pointer: int, start_time: float, stop_time: float | None) -> tuple[str, int]:
        """Enter the initialization mode.

        Parameters
        ----------
        pointer
            The instance.
        start_time, stop_time
            Start and stop time of the experiment in s; no stop time is defined where it is None.

        Returns
        -------
        tuple
            Name and status of the last call.
        """

    @abstractmethod
    def do_step(self, pointer: int, time: float, step_size: float) -> StepResult:
        """Make a communication step.

        Parameters
        ----------
        pointer
            The instance.
        time
            The communication point at the beginning of the step, in s.
        step_size
            Size of the step, in s.

        Returns
        -------
        StepResult
            Of any status.
        """

    def count_arguments(self, count: int) -> tuple[int, ...]:
        """Return the arguments of access functions that follow the values.

        Parameters
        ----------
        count
            Number of the values.
        """
        return ()

    def value_count(self, variable: RawVariable) -> int:
        """Return how many values a variable has, by its declared dimensions.

        Parameters
        ----------
        variable
            A scalar or an array.

        Raises
        ------
        NotApplicableError
            If its dimensions make no sense.
        """
        shape = self.description.shape(variable)
        if shape is None:
            raise NotApplicableError(f"{variable} has invalid dimensions, see arrays.dimensions")
        return math.prod(shape)


class RawLibrary2(RawLibrary):
    """The library of an FMI 2.0 FMU."""

    PREFIX = "fmi2"
    FMPY_CLASS = FMU2Slave
    BYTE = ctypes.c_char
    TYPES: ClassVar = {
        "Real": ("Real", ctypes.c_double),
        "Integer": ("Integer", ctypes.c_int),
        "Enumeration": ("Integer", ctypes.c_int),
        "Boolean": ("Boolean", ctypes.c_int),
        "String": ("String", ctypes.c_char_p),
    }
    STATE_FUNCTIONS = (
        "GetFMUstate",
        "SetFMUstate",
        "FreeFMUstate",
        "SerializedFMUstateSize",
        "SerializeFMUstate",
        "DeSerializeFMUstate",
    )

    def _create_callbacks(self) -> None:
        @fmi2CallbackLoggerTYPE  # type: ignore[untyped-decorator]
        def log(environment: int | None, name: bytes, status: int, category: bytes, message: bytes) -> None:
            self.messages.append((status, (message or b"").decode(errors="replace")))

        self._callbacks = fmi2CallbackFunctions()
        self._callbacks.logger = log
        self._callbacks.allocateMemory = defaultCallbacks.allocateMemory
        self._callbacks.freeMemory = defaultCallbacks.freeMemory
        addLoggerProxy(ctypes.byref(self._callbacks))  # formats the variable arguments, which ctypes cannot
        self._log = log

    def instantiate(self, name: str, token: str) -> int | None:  # noqa: D102
        location = self.resources.resolve().as_uri().encode()
        arguments = (token.encode(), location, ctypes.byref(self._callbacks), 0, 1)
        pointer: int | None = self.function("Instantiate")(name.encode(), 1, *arguments)
        return pointer

    def enter_initialization_mode(  # noqa: D102
        self, pointer: int, start_time: float, stop_time: float | None
    ) -> tuple[str, int]:
        status = self.function("SetupExperiment")(pointer, 0, 0.0, start_time, stop_time is not None, stop_time or 0.0)
        if status > WARNING:
            return "fmi2SetupExperiment", status
        return "fmi2EnterInitializationMode", self.function("EnterInitializationMode")(pointer)

    def do_step(self, pointer: int, time: float, step_size: float) -> StepResult:  # noqa: D102
        status = self.function("DoStep")(pointer, time, step_size, 1)
        terminated = ctypes.c_int(0)
        if status == DISCARD:
            self.function("GetBooleanStatus")(pointer, fmi2Terminated, ctypes.byref(terminated))
        return StepResult(status, terminate=bool(terminated.value))


class RawLibrary3(RawLibrary):
    """The library of an FMI 3.0 FMU, used without event mode and early return."""

    PREFIX = "fmi3"
    FMPY_CLASS = FMU3Slave
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
    STATE_FUNCTIONS = (
        "GetFMUState",
        "SetFMUState",
        "FreeFMUState",
        "SerializedFMUStateSize",
        "SerializeFMUState",
        "DeserializeFMUState",
    )

    def _create_callbacks(self) -> None:
        def log(environment: int | None, status: int, category: bytes, message: bytes) -> None:
            self.messages.append((status, (message or b"").decode(errors="replace")))

        self._log = fmi3LogMessageCallback(log)
        self._update = fmi3IntermediateUpdateCallback()

    def instantiate(self, name: str, token: str) -> int | None:  # noqa: D102
        path = f"{self.resources.resolve()}/".encode()
        arguments = (token.encode(), path, False, True, False, False, None, 0, None, self._log, self._update)
        pointer: int | None = self.function("InstantiateCoSimulation")(name.encode(), *arguments)
        return pointer

    def enter_initialization_mode(  # noqa: D102
        self, pointer: int, start_time: float, stop_time: float | None
    ) -> tuple[str, int]:
        arguments = (False, 0.0, start_time, stop_time is not None, stop_time or 0.0)
        return "fmi3EnterInitializationMode", self.function("EnterInitializationMode")(pointer, *arguments)

    def do_step(self, pointer: int, time: float, step_size: float) -> StepResult:  # noqa: D102
        _event, terminate, early_return = flags = [ctypes.c_bool() for _ in range(3)]
        last_time = ctypes.c_double(time)
        results = (*map(ctypes.byref, flags), ctypes.byref(last_time))
        status = self.function("DoStep")(pointer, time, step_size, True, *results)
        return StepResult(status, terminate.value, early_return.value, last_time.value)

    def count_arguments(self, count: int) -> tuple[int, ...]:  # noqa: D102
        return (count,)


_LIBRARIES: dict[int, type[RawLibrary]] = {2: RawLibrary2, 3: RawLibrary3}
"""Major version of FMI to class."""


def library_path(description: RawDescription, folder: Path) -> Path:
    """Return the path of an FMU's library for this platform, whether it exists or not.

    Parameters
    ----------
    description
        The FMU's model description.
    folder
        Where the FMU was extracted.
    """
    platform_folder: str = platform if description.fmi_major == 2 else platform_tuple
    name: str = f"{description.model_identifier}{sharedLibraryExtension}"
    return folder / "binaries" / platform_folder / name


def library_class(description: RawDescription) -> type[RawLibrary]:
    """Return the class for an FMU's version of FMI.

    Parameters
    ----------
    description
        The FMU's model description.
    """
    return _LIBRARIES[description.fmi_major]


def load_library(description: RawDescription, folder: Path) -> RawLibrary:
    """Load an FMU's library.

    Parameters
    ----------
    description
        The FMU's model description.
    folder
        Where the FMU was extracted.

    Returns
    -------
    RawLibrary
        The library, of the class for its version of FMI.

    Raises
    ------
    OSError
        If the library cannot be loaded.
    """
    return library_class(description)(description, folder)


class RawInstance:
    """An instance of an FMU.

    Parameters
    ----------
    library
        The FMU's library.
    pointer
        The instance's pointer, from :meth:`RawLibrary.instantiate`.
    """

    def __init__(self, library: RawLibrary, pointer: int) -> None:
        self.library = library
        self.pointer = pointer

    def call(self, name: str, *arguments: Any) -> int:
        """Call a function whose first argument is the instance.

        Parameters
        ----------
        name
            The function's name without prefix.
        *arguments
            The arguments after the instance.

        Returns
        -------
        int
            The status.
        """
        status: int = self.library.function(name)(self.pointer, *arguments)
        return status

    def call_ok(self, name: str, *arguments: Any) -> None:
        """Call a function that must succeed.

        Parameters
        ----------
        name
            The function's name without prefix.
        *arguments
            The arguments after the instance.

        Raises
        ------
        CallFailedError
            If the status is worse than a warning.
        """
        self._require_ok(self.library.PREFIX + name, self.call(name, *arguments))

    def _require_ok(self, name: str, status: int, where: str = "") -> None:
        if status > WARNING:
            got = STATUS[status] if status < len(STATUS) else status
            raise CallFailedError(f"{name}{where}: expected ok, got {got}{self.library.last_message()}")

    # ---- lifecycle ---------------------------------------------------------------------------------------------------

    def enter_initialization_mode(self, start_time: float, stop_time: float | None = None) -> None:
        """Enter the initialization mode.

        Parameters
        ----------
        start_time, stop_time
            Start and stop time of the experiment in s; no stop time is defined where it is None.

        Raises
        ------
        CallFailedError
            If a call fails.
        """
        self._require_ok(*self.library.enter_initialization_mode(self.pointer, start_time, stop_time))

    def exit_initialization_mode(self) -> None:
        """Exit the initialization mode."""
        self.call_ok("ExitInitializationMode")

    def do_step(self, time: float, step_size: float) -> StepResult:
        """Make a communication step that must succeed or request the end of the simulation.

        Parameters
        ----------
        time
            The communication point at the beginning of the step, in s.
        step_size
            Size of the step, in s.

        Returns
        -------
        StepResult
            Its status is ok or a warning, unless the FMU requests the end.

        Raises
        ------
        CallFailedError
            If the step fails or returns early.
        """
        result = self.library.do_step(self.pointer, time, step_size)
        if not result.terminate:
            self._require_ok(f"{self.library.PREFIX}DoStep", result.status, f" at t = {time:g} s, step {step_size:g} s")
            if result.early_return:
                raise CallFailedError(f"fmi3DoStep at t = {time:g} s: expected the whole step, got an early return")
        return result

    def free(self) -> None:
        """Free the instance and its memory."""
        self.library.function("FreeInstance")(self.pointer)

    # ---- values ------------------------------------------------------------------------------------------------------

    def get_values(self, variables: Iterable[RawVariable]) -> dict[str, Values]:
        """Get the values of variables.

        Parameters
        ----------
        variables
            Variables whose types are in :attr:`RawLibrary.TYPES`.

        Returns
        -------
        dict
            Name to values; of binaries the bytes.

        Raises
        ------
        CallFailedError
            If a call fails.
        """
        found: dict[str, Values] = {}
        for type_name in self.library.TYPES:
            if chosen := [v for v in variables if v.type == type_name]:
                found |= self._get_type(type_name, chosen)
        return found

    def _get_type(self, type_name: str, variables: list[RawVariable]) -> dict[str, Values]:
        access, c_type = self.library.TYPES[type_name]
        counts = [self.library.value_count(v) for v in variables]
        total = sum(counts)
        references = (ctypes.c_uint * len(variables))(*(v.reference for v in variables))
        buffer = (c_type * total)()
        lengths = (ctypes.c_size_t * total)()
        more = (lengths, buffer, total) if type_name == "Binary" else (buffer, *self.library.count_arguments(total))
        where = f" of {variables[0].name}" if len(variables) == 1 else f" of {variables[0].name} and others"
        name = f"Get{access}"
        self._require_ok(self.library.PREFIX + name, self.call(name, references, len(variables), *more), where)
        if type_name == "Binary":
            values: list[Any] = [ctypes.string_at(buffer[i], lengths[i]) if buffer[i] else b"" for i in range(total)]
        else:
            values = list(buffer)
        return {v.name: tuple(values[end - n : end]) for v, n, end in _parts(variables, counts)}

    def set_values(self, variable: RawVariable, values: Values) -> int:
        """Set the values of a variable.

        Parameters
        ----------
        variable
            The variable.
        values
            One value for each element.

        Returns
        -------
        int
            The status.
        """
        access, c_type = self.library.TYPES[variable.type]
        references = (ctypes.c_uint * 1)(variable.reference)
        count = len(values)
        if variable.type == "Binary":
            contents = [(ctypes.c_uint8 * max(len(value), 1))(*value) for value in values]
            buffer = (c_type * count)(*(ctypes.cast(content, c_type) for content in contents))
            lengths = (ctypes.c_size_t * count)(*map(len, values))
            return self.call("SetBinary", references, 1, lengths, buffer, count)
        more = self.library.count_arguments(count)
        return self.call(f"Set{access}", references, 1, (c_type * count)(*values), *more)

    # ---- FMU state ---------------------------------------------------------------------------------------------------

    def get_state(self) -> ctypes.c_void_p:
        """Get the FMU state.

        Raises
        ------
        CallFailedError
            If the call fails or returns a null pointer.
        """
        state = ctypes.c_void_p()
        function = self.library.STATE_FUNCTIONS[0]
        self.call_ok(function, ctypes.byref(state))
        if not state.value:
            raise CallFailedError(f"{self.library.PREFIX}{function}: expected a state, got a null pointer")
        return state

    def set_state(self, state: ctypes.c_void_p) -> None:
        """Set the FMU state.

        Parameters
        ----------
        state
            A state from :meth:`get_state` or :meth:`deserialize_state`.
        """
        self.call_ok(self.library.STATE_FUNCTIONS[1], state)

    def free_state(self, state: ctypes.c_void_p) -> None:
        """Free an FMU state; by the standard, the pointer is null afterwards.

        Parameters
        ----------
        state
            A state, or a null pointer.
        """
        self.call_ok(self.library.STATE_FUNCTIONS[2], ctypes.byref(state))

    def serialize_state(self, state: ctypes.c_void_p) -> bytes:
        """Serialize an FMU state to bytes.

        Parameters
        ----------
        state
            A state of this instance.

        Returns
        -------
        bytes
            As many as the FMU reports as the size of the state.
        """
        size = ctypes.c_size_t()
        self.call_ok(self.library.STATE_FUNCTIONS[3], state, ctypes.byref(size))
        buffer = (self.library.BYTE * max(size.value, 1))()
        self.call_ok(self.library.STATE_FUNCTIONS[4], state, buffer, size.value)
        return bytes(bytearray(buffer)[: size.value])

    def deserialize_state(self, content: bytes) -> ctypes.c_void_p:
        """Deserialize an FMU state from bytes.

        Parameters
        ----------
        content
            Result of :meth:`serialize_state`, of any instance of the FMU.

        Returns
        -------
        ctypes.c_void_p
            The state; the caller frees it.
        """
        state = ctypes.c_void_p()
        buffer = (self.library.BYTE * max(len(content), 1)).from_buffer_copy(content or b"\0")
        self.call_ok(self.library.STATE_FUNCTIONS[5], buffer, len(content), ctypes.byref(state))
        return state


def _parts(variables: list[RawVariable], counts: list[int]) -> Iterable[tuple[RawVariable, int, int]]:
    """Yield each variable with the number of its values and the index after its last value."""
    end = 0
    for variable, count in zip(variables, counts, strict=True):
        end += count
        yield variable, count, end
