"""One instantiated FMU in this process: fmpy's slave with its messages, its buffers, and an orderly end.

:class:`Instance` is the same for all versions of FMI; what differs between them is in :mod:`cosim.fmi.versions`.
"""

from __future__ import annotations

import ctypes
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, suppress
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.model_description import ModelVariable

from cosim.errors import RunError
from cosim.fmi.access import AccessCall, NativeCalls, VariableAccess, VariableMapping
from cosim.fmi.description import ModelDescription
from cosim.fmi.library import load_library
from cosim.fmi.messages import WARNING, MessageLog
from cosim.fmi.output_capture import printed
from cosim.fmi.values import EVERYTHING, Checked, may_be_inexact
from cosim.units import IDENTITY

_DISCARD, _ERROR, _FATAL, _PENDING = 2, 3, 4, 5
_MOST_SETTERS = 16  # runs that set the same variables use the same calls
_STATUS = dict(enumerate(("ok", "warning", "discard", "error", "fatal", "pending")))


class Experiment(NamedTuple):
    """Times and tolerance of a run, as an FMU gets them.

    Attributes
    ----------
    start_time, stop_time
        In s.
    tolerance
        Relative tolerance; None where there is none.
    """

    start_time: float
    stop_time: float
    tolerance: float | None = None


class Instance(ABC):
    """An instantiated FMU; made by :func:`cosim.fmi.versions.instantiate`.

    Parameters
    ----------
    name
        The component's name in its system.
    model
        What to instantiate.
    folder
        Where the FMU was extracted.

    Attributes
    ----------
    messages
        Messages of the FMU.
    fmu
        fmpy's slave.

    Raises
    ------
    RunError
        If the FMU cannot be loaded or refuses to be instantiated.
    """

    FMI_VERSION: ClassVar[int]
    """Major version of FMI."""

    PREFIX: ClassVar[str]
    """Prefix of the version's function names."""

    FMPY_CLASS: ClassVar[Any]
    """fmpy's class."""

    C_TYPES: ClassVar[Mapping[str, Any]]
    """Name of an access (``Real`` of ``getReal``) to the C type of its values."""

    ACCESS: ClassVar[Mapping[str, str]]
    """Type of a variable to the name of its access, where they differ."""

    FUNCTIONS: ClassVar[Sequence[str]] = (
        "Reset",
        "EnterInitializationMode",
        "ExitInitializationMode",
        "DoStep",
        "Terminate",
    )
    """Functions that are called directly: by way of fmpy a call takes longer than a step of most FMUs."""

    def __init__(self, name: str, model: ModelDescription, folder: Path) -> None:
        self.name = name
        self.model = model
        self.messages = MessageLog()
        self._values = np.zeros(0)
        self._inputs: list[VariableAccess] = []
        self._outputs: list[VariableAccess] = []
        self._mapping = VariableMapping()
        self._partial: dict[Any, tuple[list[VariableAccess], list[VariableAccess]]] = {}
        self._setters: dict[Any, list[tuple[AccessCall, list[str]]]] = {}
        self._functions: dict[str, tuple[str, Any]] = {}
        self._initialized = False  # so that it must be reset before another run
        self._running = False  # so that it must be terminated
        self._fatal = False
        self._reached = 0.0
        self.fmu = self.FMPY_CLASS.__new__(self.FMPY_CLASS)  # so that it can be freed also if it cannot be loaded
        self.fmu.component = None
        try:
            with self.calling("load"):
                identifier = str(model.description.coSimulation.modelIdentifier)
                load_library(self.fmu, self.FMI_VERSION, str(model.description.guid), identifier, folder, name)
                self._load_functions(self.FUNCTIONS)
            with self.calling("instantiate"):
                self._instantiate()
        except BaseException:
            self.free()
            raise

    # ---- what differs between versions -------------------------------------------------------------------------------

    @abstractmethod
    def _instantiate(self) -> None:
        """Instantiate, with messages going to the log."""

    @abstractmethod
    def _set_up(self, experiment: Experiment, values: Mapping[str, Checked]) -> None:
        """Set values and enter the initialization of a run."""

    @abstractmethod
    def do_step(self, time: float, step_size: float) -> None:
        """Step.

        Parameters
        ----------
        time, step_size
            Begin and length of the step, in s.
        """

    def _release(self) -> None:  # noqa: B027
        """Release what outlives the instance."""

    def _requests_termination(self) -> bool:
        """Whether the FMU discarded a step because it requests the end of the run."""
        return False

    def _load_functions(self, functions: Iterable[str]) -> None:
        """Look up functions of the FMU that are called directly, by their names without prefix."""
        names = {name: self.PREFIX + name for name in functions}
        self._functions |= {name: (full, getattr(self.fmu.dll, full)) for name, full in names.items()}

    # ---- messages and failures ---------------------------------------------------------------------------------------

    def calling(self, call: str, time: float = 0.0) -> AbstractContextManager[None]:
        """Attribute messages to a call outside the steps, and turn its exceptions into a :class:`RunError`.

        Parameters
        ----------
        call
            Its name, for messages.
        time
            Simulated time, in s.
        """
        return _Calling(self, call, time)

    def collect_stdout(self, call: str, time: float) -> bool:
        """Attribute what was printed since the last time to a call.

        Parameters
        ----------
        call
            Name of the function.
        time
            Simulated time, in s.

        Returns
        -------
        bool
            Whether anything was printed.
        """
        text = printed()
        if text:
            self.messages.printed(call, time, text)
        return bool(text)

    def _check_status(self, status: int, function: str) -> None:
        """Raise for a status worse than a warning, note a warning."""
        if status > WARNING:
            raise FMICallException(function=function, status=status)
        self.messages.warned(function, self.messages.time)

    def failure(self, error: Exception, call: str, time: float = 0.0) -> RunError:
        """Describe a failed call.

        Parameters
        ----------
        error
            The exception.
        call
            Name of the function, where the exception does not name it.
        time
            Simulated time, in s.

        Returns
        -------
        RunError
            With component, call, time and the FMU's message.
        """
        if isinstance(error, RunError):
            return error
        status = ""
        if isinstance(error, FMICallException):
            if error.status == _PENDING:
                return RunError(
                    f"{self.name}: {error.function} returned pending at t = {time:g} s: expected a call that is "
                    "complete when it returns, as asynchronous FMUs are not supported"
                )
            if error.status == _DISCARD and not self.messages.last_error and self._requests_termination():
                return self.termination_requested(error.function, time)
            self._running = self._running and error.status < _ERROR  # after an error FMI allows reset and free only
            self._fatal = self._fatal or error.status == _FATAL
            call = error.function
            status = f" ({_STATUS.get(error.status, error.status)})"
        reason = " ".join((self.messages.last_error or str(error)).split())
        return RunError(f"{self.name}: {call} failed at t = {time:g} s{status}: {reason}")

    def termination_requested(self, call: str, reached: float) -> RunError:
        """Describe an FMU that requests the end of the run in a call, having reached a time in s.

        Parameters
        ----------
        call
            Name of the function that was called.
        reached
            Time that the FMU reached, in s.

        Returns
        -------
        RunError
            The error; it is not raised here.
        """
        return RunError(f"{self.name}: {call} asked to end the run at t = {reached:g} s")

    def returned_early(self, call: str, reached: float) -> RunError:
        """Describe an FMU that did not finish its step, though it was not allowed to return early.

        Parameters
        ----------
        call
            Name of the function that was called.
        reached
            Time that the FMU reached, in s.

        Returns
        -------
        RunError
            The error; it is not raised here.
        """
        return RunError(f"{self.name}: {call} returned early, at t = {reached:g} s")

    @property
    def warnings(self) -> list[str]:
        """Warnings of this run and what was printed, each text once, with call and time."""
        return self.messages.warnings

    # ---- variables ---------------------------------------------------------------------------------------------------

    def map_variables(self, values: np.ndarray[Any, Any], mapping: VariableMapping) -> None:
        """Map outputs and connected inputs to the table of values.

        Parameters
        ----------
        values
            The table, float64.
        mapping
            Where the variables are in it.
        """
        self._values, self._mapping = values, mapping
        self._partial.clear()
        self._outputs = [
            self._get_access(kind, names, sampled)
            for sampled in (False, True)
            for kind, names in self._by_kind(n for n in mapping.outputs if self.model.is_sampled(n) is sampled)
        ]
        self._inputs = [self._set_access(kind, names) for kind, names in self._by_kind(mapping.inputs)]

    def native_calls(self) -> NativeCalls | None:
        """Return what the loop in C needs, or None where it cannot call the FMU."""
        return NativeCalls(
            self.FMI_VERSION, self.fmu.component, *self._functions["DoStep"], self._inputs, self._outputs
        )

    def _by_kind(self, names: Iterable[str]) -> Iterator[tuple[str, list[str]]]:
        """Group variables by the name of their access."""
        names = list(names)
        for kind in self.C_TYPES:
            found = [name for name in names if self._kind(self.model.variables[name]) == kind]
            if found:
                yield kind, found

    def _kind(self, variable: ModelVariable) -> str:
        return self.ACCESS.get(variable.type, str(variable.type))

    def _get_access(self, kind: str, names: Sequence[str], sampled: bool = False) -> VariableAccess:
        entries = [entry for name in names for entry in self._mapping.outputs[name]]
        index = np.array([entry.index for entry in entries], dtype=np.int64)
        begin, end = int(index[0]) if len(index) else 0, int(index[0]) + len(index) if len(index) else 0
        direct = self.C_TYPES[kind] is ctypes.c_double and index.tolist() == [*range(begin, end)]
        inexact = any(may_be_inexact(self.model.variables[name]) for name in names)
        return VariableAccess(
            call=self._access_call("Get", kind, names, len(index), self._values[begin:end] if direct else None),
            names=[f"{self.name}.{entry.name}" for entry in entries],
            index=index,
            connected=np.array([entry.connected for entry in entries]) if inexact else None,
            sampled=sampled,
            direct=direct,
        )

    def _set_access(self, kind: str, names: Sequence[str]) -> VariableAccess:
        entries = [entry for name in names for entry in self._mapping.inputs[name]]
        transformations = [entry.transformation for entry in entries]
        identical = all(transformation == IDENTITY for transformation in transformations)
        ranges = [entry.range for entry in entries]
        low, high = np.array([r or EVERYTHING for r in ranges]).reshape(-1, 2).T.copy() if any(ranges) else (None, None)
        return VariableAccess(
            call=self._access_call("Set", kind, names, len(entries)),
            names=[f"{self.name}.{entry.name}" for entry in entries],
            index=np.array([entry.index for entry in entries], dtype=np.int64),
            factors=None if identical else np.array([t.factor for t in transformations]),
            offsets=None if identical else np.array([t.offset for t in transformations]),
            low=low,
            high=high,
        )

    def _access_call(
        self, direction: str, kind: str, names: Sequence[str], count: int, buffer: np.ndarray[Any, Any] | None = None
    ) -> AccessCall:
        if buffer is None:
            buffer = np.zeros(count, dtype=np.dtype(self.C_TYPES[kind]))
        references = (ctypes.c_uint * len(names))(*(self.model.variables[name].valueReference for name in names))
        pointer = buffer.ctypes.data_as(ctypes.POINTER(self.C_TYPES[kind]))
        function = f"{self.PREFIX}{direction}{kind}"
        arguments = self._arguments(references, len(names), pointer, count)
        return AccessCall(function, getattr(self.fmu.dll, function), arguments, references, buffer)

    def _arguments(self, references: Any, count: int, pointer: Any, value_count: int) -> tuple[Any, ...]:
        """Order the arguments of a getter or setter of ``count`` variables with ``value_count`` elements."""
        return (self.fmu.component, references, count, pointer)

    def _move(self, access: AccessCall) -> None:
        """Move values between the FMU and a buffer."""
        self.messages.call = access.name
        if status := access.function(*access.arguments):
            self._check_status(status, access.name)

    def set_inputs(self, time: float) -> None:
        """Set all connected inputs from the table of values, at a time in s."""
        self.messages.time = time
        for access in self._inputs:
            self._set_from_table(access)

    def _set_from_table(self, access: VariableAccess) -> None:
        if (outside := access.fill_buffer(self._values)) is not None:
            raise self.unfit(access, outside, self.messages.time)
        self._move(access.call)

    def get_outputs(self, time: float, sampled: bool | None = None) -> None:
        """Get outputs into the table of values.

        Parameters
        ----------
        time
            Simulated time, in s.
        sampled
            True for those at the begin of a step, False for the others, None for all.
        """
        self.messages.time = time
        for access in self._outputs:
            if sampled is None or access.sampled is sampled:
                self._get_into_table(access)

    def _get_into_table(self, access: VariableAccess) -> None:
        self._move(access.call)
        for element in access.empty_buffer(self._values):
            self.inexact(access, element, self.messages.time)

    def exchange(self, time: float, inputs: Sequence[str], outputs: Sequence[str]) -> None:
        """Set some connected inputs from the table of values, then get some outputs into it.

        Parameters
        ----------
        time
            Simulated time, in s.
        inputs, outputs
            Names of variables.
        """
        self.messages.time = time
        key = tuple(inputs), tuple(outputs)
        if key not in self._partial:  # the next run exchanges the same ones
            self._partial[key] = (
                [self._set_access(kind, names) for kind, names in self._by_kind(inputs)],
                [self._get_access(kind, names) for kind, names in self._by_kind(outputs)],
            )
        for access in self._partial[key][0]:
            self._set_from_table(access)
        for access in self._partial[key][1]:
            self._get_into_table(access)

    def unfit(self, access: VariableAccess, element: int, time: float) -> RunError:
        """Describe a value for an element of an access that does not fit its type, at a time in s.

        Parameters
        ----------
        access
            The access whose value it is.
        element
            Number of the element in the access.
        time
            Simulated time in s.

        Returns
        -------
        RunError
            The error; it is not raised here.
        """
        return RunError(f"{access.problem(element, self._values)} at t = {time:g} s")

    def inexact(self, access: VariableAccess, element: int, time: float) -> None:
        """Refuse a value that is not exact in the table where it is connected, note it where it is recorded only.

        Parameters
        ----------
        access
            The access whose value it is.
        element
            Number of the element in the access.
        time
            Simulated time in s.

        Raises
        ------
        RunError
            If a connection takes it.
        """
        assert access.connected is not None
        if access.connected[element]:
            raise self.unfit(access, element, time)
        name = access.names[element].removeprefix(f"{self.name}.")
        self.messages.rounded(access.call.name, time, f"{name}: values above 2^53 are rounded in the results")

    # ---- life cycle --------------------------------------------------------------------------------------------------

    def enter_initialization(self, experiment: Experiment, values: Mapping[str, Checked]) -> None:
        """Enter the initialization of a run, after a reset where there was one before.

        Parameters
        ----------
        experiment
            Times and tolerance of the run.
        values
            Checked parameters and start values by variable name.

        Raises
        ------
        RunError
            If the FMU refuses a call, or a call before returned fatal.
        """
        if self._fatal:
            raise RunError(f"{self.name}: expected an FMU that can run again, got one that failed fatally")
        with self.calling("initialisation", experiment.start_time):
            if self._initialized:
                self.messages.clear()
                self._call("Reset")
            self._initialized = True
            self._set_up(experiment, values)

    def _call(self, function: str, *arguments: Any) -> None:
        """Call a function of the FMU whose first argument is the instance."""
        name, call = self._functions[function]
        self.messages.call = name
        if status := call(self.fmu.component, *arguments):
            self._check_status(status, name)

    def _set(self, values: Mapping[str, Checked]) -> None:
        """Set variables by name."""
        key = tuple((name, len(value) if isinstance(value, tuple) else 1) for name, value in values.items())
        if key not in self._setters:
            self._setters[key] = self._setter_calls(dict(key))
        for access, names in self._setters[key]:
            elements = [values[name] for name in names]
            access.buffer[:] = np.hstack(elements) if any(isinstance(e, tuple) for e in elements) else elements
            self._move(access)
        for name, value in values.items():
            if isinstance(value, str):
                variable = self.model.variables[name]
                getattr(self.fmu, f"set{variable.type}")([variable.valueReference], [value])

    def _setter_calls(self, sizes: Mapping[str, int]) -> list[tuple[AccessCall, list[str]]]:
        """Make the calls that set some variables of given sizes."""
        if len(self._setters) >= _MOST_SETTERS:
            self._setters.clear()
        return [
            (self._access_call("Set", kind, names, sum(sizes[name] for name in names)), names)
            for kind, names in self._by_kind(sizes)
        ]

    def exit_initialization(self) -> None:
        """Exit the initialization.

        Raises
        ------
        RunError
            If the FMU refuses.
        """
        with self.calling("initialisation"):
            self._call("ExitInitializationMode")
        self._running = True

    def step(self, time: float, step_size: float) -> None:
        """Set inputs, step from ``time`` by ``step_size`` (both in s), get outputs.

        Parameters
        ----------
        time
            Begin of the step in s.
        step_size
            Its size in s.
        """
        self.set_inputs(time)
        self.do_step(time, step_size)
        self.get_outputs(time)

    def terminate(self, time: float = 0.0) -> None:
        """Terminate a run at a time in s, where FMI allows the call."""
        self._reached = time
        if self._running and not self._fatal:
            self._running = False
            with self.calling("terminate", time):
                self._call("Terminate")

    def free(self) -> None:
        """Free the instance and unload its library; after a fatal error FMI forbids the first."""
        with suppress(Exception):
            if self.fmu.component and not self._fatal:
                getattr(self.fmu, f"{self.PREFIX}FreeInstance")(self.fmu.component)
        with suppress(Exception):
            self.collect_stdout("free", self._reached)
        with suppress(Exception):
            self.fmu.freeLibrary()
        self._release()


class _Calling(AbstractContextManager[None]):
    """See :meth:`Instance.calling`; a class, as each run enters several and a generator is slower."""

    def __init__(self, instance: Instance, call: str, time: float) -> None:
        self._instance = instance
        self._call = call
        self._time = time

    def __enter__(self) -> None:
        self._instance.messages.call, self._instance.messages.time = self._call, self._time

    def __exit__(self, kind: object, error: BaseException | None, traceback: object) -> None:
        self._instance.collect_stdout(self._call, self._time)
        if isinstance(error, Exception):  # fmpy raises bare exceptions, too
            raise self._instance.failure(error, self._call, self._time) from error
