"""One instantiated FMU in this process: fmpy's slave with its messages, its buffers, and an orderly end.

:class:`Instance` is the same for all versions of FMI; what differs between them is in :mod:`cosim.fmi.versions`.
"""

from __future__ import annotations

import ctypes
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, chdir, suppress
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.model_description import ModelVariable

from cosim.errors import RunError
from cosim.fmi.access import AccessCall, NativeCalls, VariableAccess
from cosim.fmi.description import ModelDescription
from cosim.fmi.messages import WARNING, MessageLog
from cosim.fmi.output_capture import printed
from cosim.units import IDENTITY, Linear

_DISCARD, _ERROR, _FATAL = 2, 3, 4
_STATUS = dict(enumerate(("ok", "warning", "discard", "error", "fatal", "pending")))


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
        self._setters: dict[tuple[str, ...], list[tuple[AccessCall, list[str]]]] = {}
        self._texts: list[str] = []
        self._initialized = False  # so that it must be reset before another run
        self._running = False  # so that it must be terminated
        self._fatal = False
        self._reached = 0.0
        self.fmu = self.FMPY_CLASS.__new__(self.FMPY_CLASS)  # so that it can be freed also if its __init__ fails
        self.fmu.component = None
        try:
            with self.calling("load"), chdir(Path.cwd()):  # fmpy does not come back from the folder of one that fails
                self.fmu.__init__(
                    guid=model.description.guid,
                    modelIdentifier=model.description.coSimulation.modelIdentifier,
                    unzipDirectory=str(folder),
                    instanceName=name,
                )
                names = {name: self.PREFIX + name for name in self.FUNCTIONS}
                self._functions = {name: (full, getattr(self.fmu.dll, full)) for name, full in names.items()}
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
    def _set_up(self, stop_time: float, values: Mapping[str, float | str]) -> None:
        """Set values and enter the initialization of a run from 0 to ``stop_time``, in s."""

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
            if error.status == _DISCARD and not self.messages.last_error and self._requests_termination():
                return self.termination_requested(error.function, time)
            self._running = self._running and error.status < _ERROR  # after an error FMI allows reset and free only
            self._fatal = self._fatal or error.status == _FATAL
            call = error.function
            status = f" ({_STATUS.get(error.status, error.status)})"
        reason = " ".join((self.messages.last_error or str(error)).split())
        return RunError(f"{self.name}: {call} failed at t = {time:g} s{status}: {reason}")

    def termination_requested(self, call: str, reached: float) -> RunError:
        """Describe an FMU that requests the end of the run in a call, having reached a time in s."""
        return RunError(f"{self.name}: {call} asked to end the run at t = {reached:g} s")

    def returned_early(self, call: str, reached: float) -> RunError:
        """Describe an FMU that did not finish its step, though it was not allowed to return early."""
        return RunError(f"{self.name}: {call} returned early, at t = {reached:g} s")

    @property
    def warnings(self) -> list[str]:
        """Warnings of this run and what was printed, each text once, with call and time."""
        return self.messages.warnings

    # ---- variables ---------------------------------------------------------------------------------------------------

    def map_variables(
        self,
        values: np.ndarray[Any, Any],
        outputs: Mapping[str, int],
        inputs: Mapping[str, tuple[int, Linear]],
    ) -> None:
        """Map outputs and connected inputs to the table of values.

        Parameters
        ----------
        values
            Values of all components' outputs, float64.
        outputs
            Variable name to index in ``values``.
        inputs
            Variable name to index in ``values`` and what transforms the value found there.
        """
        self._values = values
        mapped = {name: (index, IDENTITY) for name, index in outputs.items()}
        self._outputs = [
            self._access("Get", kind, names, mapped, discrete)
            for discrete in (False, True)
            for kind, names in self._by_kind(name for name in mapped if self.model.is_discrete(name) is discrete)
        ]
        self._inputs = [self._access("Set", kind, names, inputs) for kind, names in self._by_kind(inputs)]

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

    def _access(
        self,
        direction: str,
        kind: str,
        names: Sequence[str],
        mapped: Mapping[str, tuple[int, Linear]],
        discrete: bool = False,
    ) -> VariableAccess:
        index = np.array([mapped[name][0] for name in names], dtype=np.int64)
        transformations = [mapped[name][1] for name in names]
        identical = all(transformation == IDENTITY for transformation in transformations)
        begin, end = int(index[0]), int(index[0]) + len(index)
        direct = direction == "Get" and self.C_TYPES[kind] is ctypes.c_double and index.tolist() == [*range(begin, end)]
        return VariableAccess(
            call=self._access_call(direction, kind, names, self._values[begin:end] if direct else None),
            index=index,
            factors=None if identical else np.array([t.factor for t in transformations]),
            offsets=None if identical else np.array([t.offset for t in transformations]),
            discrete=discrete,
            direct=direct,
        )

    def _access_call(
        self, direction: str, kind: str, names: Sequence[str], buffer: np.ndarray[Any, Any] | None = None
    ) -> AccessCall:
        if buffer is None:
            buffer = np.zeros(len(names), dtype=np.dtype(self.C_TYPES[kind]))
        references = (ctypes.c_uint * len(names))(*(self.model.variables[name].valueReference for name in names))
        pointer = buffer.ctypes.data_as(ctypes.POINTER(self.C_TYPES[kind]))
        function = f"{self.PREFIX}{direction}{kind}"
        arguments = self._arguments(references, len(names), pointer)
        return AccessCall(function, getattr(self.fmu.dll, function), arguments, references, buffer)

    def _arguments(self, references: Any, count: int, pointer: Any) -> tuple[Any, ...]:
        """Order the arguments of a getter or setter."""
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
            values = self._values[access.index]
            access.call.buffer[:] = values if access.factors is None else access.factors * values + access.offsets
            self._move(access.call)

    def get_outputs(self, time: float, discrete: bool | None = None) -> None:
        """Get outputs into the table of values.

        Parameters
        ----------
        time
            Simulated time, in s.
        discrete
            True for those that are discrete, False for those that are not, None for all.
        """
        self.messages.time = time
        for access in self._outputs:
            if discrete is None or access.discrete is discrete:
                self._move(access.call)
                if not access.direct:
                    self._values[access.index] = access.call.buffer

    # ---- life cycle --------------------------------------------------------------------------------------------------

    def enter_initialization(self, stop_time: float, values: Mapping[str, float | str]) -> None:
        """Enter the initialization of a run, after a reset where there was one before.

        Parameters
        ----------
        stop_time
            End of the run, in s.
        values
            Checked parameters and start values by variable name.

        Raises
        ------
        RunError
            If the FMU refuses a call, or a call before returned fatal.
        """
        if self._fatal:
            raise RunError(f"{self.name}: expected an FMU that can run again, got one that failed fatally")
        with self.calling("initialisation"):
            if self._initialized:
                self.messages.clear()
                self._call("Reset")
            self._initialized = True
            self._set_up(stop_time, values)

    def _call(self, function: str, *arguments: Any) -> None:
        """Call a function of the FMU whose first argument is the instance."""
        name, call = self._functions[function]
        self.messages.call = name
        if status := call(self.fmu.component, *arguments):
            self._check_status(status, name)

    def _set(self, values: Mapping[str, float | str]) -> None:
        """Set variables by name."""
        names = tuple(values)
        if names not in self._setters:  # the next run sets the same ones, as a rule
            self._setters = {names: [(self._access_call("Set", *found), found[1]) for found in self._by_kind(names)]}
            self._texts = [name for name in names if self._kind(self.model.variables[name]) not in self.C_TYPES]
        for access, found in self._setters[names]:
            for i, name in enumerate(found):
                access.buffer[i] = values[name]
            self._move(access)
        for name in self._texts:
            variable = self.model.variables[name]
            getattr(self.fmu, f"set{variable.type}")([variable.valueReference], [values[name]])

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
        """Set inputs, step from ``time`` by ``step_size`` (both in s), get outputs."""
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
