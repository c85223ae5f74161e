"""One running FMU: fmpy's slave with its log, its buffers, and an end that comes whatever happens.

:class:`Instance` is the same for all versions of FMI; what differs stands in one small class for each version.
"""

from __future__ import annotations

import ctypes
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, chdir, suppress
from itertools import count
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from fmpy.fmi1 import FMICallException, printLogMessage
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE, fmi2Terminated
from fmpy.fmi3 import FMU3Slave
from fmpy.logging import addLoggerProxy
from fmpy.model_description import ModelVariable

from cosim.errors import RunError, SetupError
from cosim.fmi.access import AccessCall, NativeCalls, VariableAccess
from cosim.fmi.archive import open_archive
from cosim.fmi.description import ModelDescription
from cosim.fmi.messages import WARNING, MessageLog
from cosim.fmi.output_capture import printed
from cosim.units import IDENTITY, Linear

_DISCARD, _ERROR, _FATAL = 2, 3, 4
_STATUS = dict(enumerate(("ok", "warning", "discard", "error", "fatal", "pending")))


class Instance(ABC):
    """An instantiated FMU; made by :func:`instantiate`.

    Parameters
    ----------
    name
        The component's name in its system.
    model
        What to instantiate.
    folder
        Where the FMU was extracted.
    """

    PREFIX: ClassVar[str]
    """What the names of the version's functions begin with."""

    SLAVE: ClassVar[Any]
    """fmpy's class."""

    C_TYPES: ClassVar[Mapping[str, Any]]
    """Name of an access (``Real`` of ``getReal``) to the C type of its values."""

    STANDARD: ClassVar[int]
    """Major version of FMI."""

    FUNCTIONS: ClassVar[Sequence[str]] = (
        "Reset",
        "EnterInitializationMode",
        "ExitInitializationMode",
        "DoStep",
        "Terminate",
    )
    """What is called without the detour through fmpy, which takes longer than a step of most FMUs."""

    ACCESS: ClassVar[Mapping[str, str]]
    """Type of a variable to the name of its access, where they differ."""

    def __init__(self, name: str, model: ModelDescription, folder: Path) -> None:
        self.name = name
        self.model = model
        self.messages = MessageLog()
        self._table = np.zeros(0)
        self._inputs: list[VariableAccess] = []
        self._outputs: list[VariableAccess] = []
        self._parameters: dict[tuple[str, ...], list[tuple[AccessCall, list[str]]]] = {}
        self._texts: list[str] = []
        self._initialised = False  # so that it must be reset before another run
        self._running = False  # so that it must be terminated
        self._dead = False
        self._reached = 0.0
        self.fmu = self.SLAVE.__new__(self.SLAVE)  # so that it is ours also if its making fails halfway
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
        """Make the instance, its messages going to the journal."""

    @abstractmethod
    def _begin(self, stop_time: float, values: Mapping[str, float | str]) -> None:
        """Set values and begin the initialisation of a run from 0 to ``stop_time``, in s."""

    @abstractmethod
    def advance(self, time: float, step_size: float) -> None:
        """Step from ``time`` by ``step_size``, both in s; nothing else."""

    def _forget(self) -> None:  # noqa: B027
        """Let go of what outlives the instance."""

    # ---- what is said, and failures ----------------------------------------------------------------------------------

    def calling(self, call: str, time: float = 0.0) -> AbstractContextManager[None]:
        """Turn whatever goes wrong in a call outside the steps into a :class:`RunError`; note what is said meanwhile.

        Parameters
        ----------
        call
            Its name, for messages.
        time
            When, in s.
        """
        return _Calling(self, call, time)

    def listen(self, call: str, time: float) -> bool:
        """Attribute what was printed since the last time to a call at a time in s; returns whether anything was."""
        text = printed()
        if text:
            self.messages.printed(call, time, text)
        return bool(text)

    def _judge(self, status: int, function: str) -> None:
        """Take note of a status that is not that of a call without any fault."""
        if status > WARNING:
            raise FMICallException(function=function, status=status)
        self.messages.warned(function, self.messages.time)

    def failure(self, error: Exception, call: str, time: float = 0.0) -> RunError:
        """Describe a failed call: component, call, time in s, and what the FMU said about it."""
        if isinstance(error, RunError):
            return error
        status = ""
        if isinstance(error, FMICallException):
            if error.status == _DISCARD and not self.messages.last_error and self._ended():
                return self.asked_to_end(error.function, time)
            self._running = self._running and error.status < _ERROR  # after an error FMI allows reset and free only
            self._dead = self._dead or error.status == _FATAL
            call = error.function
            status = f" ({_STATUS.get(error.status, error.status)})"
        reason = " ".join((self.messages.last_error or str(error)).split())
        return RunError(f"{self.name}: {call} failed at t = {time:g} s{status}: {reason}")

    def asked_to_end(self, call: str, reached: float) -> RunError:
        """Describe an FMU that asks in a call for the end of the run, having reached a time in s."""
        return RunError(f"{self.name}: {call} asked to end the run at t = {reached:g} s")

    def returned_early(self, call: str, reached: float) -> RunError:
        """Describe an FMU that did not finish its step, though it was not allowed to return early."""
        return RunError(f"{self.name}: {call} returned early, at t = {reached:g} s")

    def _ended(self) -> bool:
        """Whether the FMU discarded a step because it asks for the end of the run."""
        return False

    @property
    def warnings(self) -> list[str]:
        """What the FMU warned of or printed in this run, each text once, with call and time."""
        return self.messages.warnings

    # ---- wiring ------------------------------------------------------------------------------------------------------

    def wire(
        self,
        table: np.ndarray[Any, Any],
        outputs: Mapping[str, int],
        inputs: Mapping[str, tuple[int, Linear]],
    ) -> None:
        """Say where in the table of values each output goes and each connected input comes from.

        Parameters
        ----------
        table
            Values of all components' outputs, float64.
        outputs
            Variable name to place in ``table``.
        inputs
            Variable name to place in ``table`` and what transforms the value found there.
        """
        self._table = table
        given = {name: (place, IDENTITY) for name, place in outputs.items()}
        self._outputs = [
            self._port("Get", kind, names, given, discrete)
            for discrete in (False, True)
            for kind, names in self._by_kind(name for name in given if self.model.is_discrete(name) is discrete)
        ]
        self._inputs = [self._port("Set", kind, names, inputs) for kind, names in self._by_kind(inputs)]

    def calls(self) -> NativeCalls | None:
        """Return what a loop in C needs, or None of an FMU that cannot be called from there."""
        return NativeCalls(self.STANDARD, self.fmu.component, *self._functions["DoStep"], self._inputs, self._outputs)

    def _by_kind(self, names: Iterable[str]) -> Iterator[tuple[str, list[str]]]:
        names = list(names)
        for kind in self.C_TYPES:
            found = [name for name in names if self._access(self.model.variables[name]) == kind]
            if found:
                yield kind, found

    def _access(self, variable: ModelVariable) -> str:
        return self.ACCESS.get(variable.type, str(variable.type))

    def _port(
        self,
        direction: str,
        kind: str,
        names: Sequence[str],
        places: Mapping[str, tuple[int, Linear]],
        discrete: bool = False,
    ) -> VariableAccess:
        transformations = [places[name][1] for name in names]
        identical = all(transformation == IDENTITY for transformation in transformations)
        found = np.array([places[name][0] for name in names], dtype=np.int64)
        begin, end = int(found[0]), int(found[0]) + len(found)
        direct = direction == "Get" and self.C_TYPES[kind] is ctypes.c_double and found.tolist() == [*range(begin, end)]
        return VariableAccess(
            access=self._accessor(direction, kind, names, self._table[begin:end] if direct else None),
            places=found,
            factors=None if identical else np.array([t.factor for t in transformations]),
            offsets=None if identical else np.array([t.offset for t in transformations]),
            discrete=discrete,
            direct=direct,
        )

    def _accessor(
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
            self._judge(status, access.name)

    def set_inputs(self, time: float) -> None:
        """Set all connected inputs from the table of values, at a time in s."""
        self.messages.time = time
        for port in self._inputs:
            values = self._table[port.places]
            port.access.buffer[:] = values if port.factors is None else port.factors * values + port.offsets
            self._move(port.access)

    def get_outputs(self, time: float, discrete: bool | None = None) -> None:
        """Get outputs into the table of values, at a time in s: all, those that are discrete, or those that are not."""
        self.messages.time = time
        for port in self._outputs:
            if discrete is None or port.discrete is discrete:
                self._move(port.access)
                if not port.direct:
                    self._table[port.places] = port.access.buffer

    # ---- life cycle --------------------------------------------------------------------------------------------------

    def start(self, stop_time: float, values: Mapping[str, float | str]) -> None:
        """Enter the initialisation of a run, after a reset where there was one before.

        Parameters
        ----------
        stop_time
            End of the run, in s.
        values
            Checked parameters and start values by variable name.
        """
        if self._dead:
            raise RunError(f"{self.name}: expected an FMU that can run again, got one that failed fatally")
        with self.calling("initialisation"):
            if self._initialised:
                self.messages.clear()  # what was said in an earlier run is that run's
                self._call("Reset")
            self._initialised = True
            self._begin(stop_time, values)

    def _call(self, function: str, *arguments: Any) -> None:
        """Call a function of the FMU that takes the instance first."""
        name, call = self._functions[function]
        self.messages.call = name
        if status := call(self.fmu.component, *arguments):
            self._judge(status, name)

    def _set(self, values: Mapping[str, float | str]) -> None:
        names = tuple(values)
        if names not in self._parameters:  # the next run sets the same ones, as a rule
            self._parameters = {names: [(self._accessor("Set", *found), found[1]) for found in self._by_kind(names)]}
            self._texts = [name for name in names if self._access(self.model.variables[name]) not in self.C_TYPES]
        for access, found in self._parameters[names]:
            for i, name in enumerate(found):
                access.buffer[i] = values[name]
            self._move(access)
        for name in self._texts:
            variable = self.model.variables[name]
            getattr(self.fmu, f"set{variable.type}")([variable.valueReference], [values[name]])

    def finish_initialisation(self) -> None:
        """Leave the initialisation."""
        with self.calling("initialisation"):
            self._call("ExitInitializationMode")
        self._running = True

    def step(self, time: float, step_size: float) -> None:
        """Take inputs, step from ``time`` by ``step_size`` (both in s), give outputs."""
        self.set_inputs(time)
        self.advance(time, step_size)
        self.get_outputs(time)

    def terminate(self, time: float = 0.0) -> None:
        """End a run at a time in s; nothing where FMI does not allow it."""
        self._reached = time
        if self._running and not self._dead:
            self._running = False
            with self.calling("terminate", time):
                self._call("Terminate")

    def free(self) -> None:
        """Free the instance and unload its library; after a fatal error FMI forbids the first."""
        with suppress(Exception):
            if self.fmu.component and not self._dead:
                getattr(self.fmu, f"{self.PREFIX}FreeInstance")(self.fmu.component)
        with suppress(Exception):
            self.listen("free", self._reached)
        with suppress(Exception):
            self.fmu.freeLibrary()
        self._forget()


class _Calling(AbstractContextManager[None]):
    """See :meth:`Instance.calling`; a class, as a run begins with many and a generator takes its time."""

    def __init__(self, instance: Instance, call: str, time: float) -> None:
        self._instance = instance
        self._call = call
        self._time = time

    def __enter__(self) -> None:
        self._instance.messages.call, self._instance.messages.time = self._call, self._time

    def __exit__(self, kind: object, error: BaseException | None, traceback: object) -> None:
        self._instance.listen(self._call, self._time)
        if isinstance(error, Exception):  # fmpy raises bare exceptions, too
            raise self._instance.failure(error, self._call, self._time) from error


# ---- FMI 2 -----------------------------------------------------------------------------------------------------------

_journals: dict[int, MessageLog] = {}
_environments = count(1)


@fmi2CallbackLoggerTYPE  # type: ignore[untyped-decorator]
def _log(environment: int | None, name: bytes, status: int, category: bytes, message: bytes) -> None:
    """Write an FMU's message into its instance's journal; fmpy has one logger per process, so ours serves all."""
    if environment in _journals:
        _journals[environment].add(status, message.decode(errors="replace"))
    else:
        printLogMessage(environment, name, status, category, message)


_proxy = fmi2CallbackFunctions()
_proxy.logger = _log
addLoggerProxy(ctypes.byref(_proxy))  # formats the variable arguments, which ctypes cannot


class Instance2(Instance):
    """An instance of an FMI 2.0 FMU."""

    PREFIX = "fmi2"
    STANDARD = 2
    FUNCTIONS = ("SetupExperiment", *Instance.FUNCTIONS)
    SLAVE = FMU2Slave
    C_TYPES: ClassVar = {"Real": ctypes.c_double, "Integer": ctypes.c_int, "Boolean": ctypes.c_int}
    ACCESS: ClassVar = {"Enumeration": "Integer"}

    _environment: int | None = None

    def _instantiate(self) -> None:
        self._environment = next(_environments)
        _journals[self._environment] = self.messages
        self._callbacks = fmi2CallbackFunctions()
        self._callbacks.logger = _proxy.logger
        self._callbacks.allocateMemory = defaultCallbacks.allocateMemory
        self._callbacks.freeMemory = defaultCallbacks.freeMemory
        self._callbacks.componentEnvironment = self._environment
        self.fmu.instantiate(callbacks=self._callbacks, loggingOn=True)

    def _begin(self, stop_time: float, values: Mapping[str, float | str]) -> None:
        self._call("SetupExperiment", 0, 0.0, 0.0, 1, stop_time)  # no tolerance; from 0 to the stop time
        self._set(values)
        self._call("EnterInitializationMode")

    def advance(self, time: float, step_size: float) -> None:  # noqa: D102
        self.messages.time = time
        self._call("DoStep", time, step_size, 1)

    def _ended(self) -> bool:
        with suppress(FMICallException):
            return bool(self.fmu.getBooleanStatus(fmi2Terminated))
        return False

    def _forget(self) -> None:
        if self._environment is not None:
            _journals.pop(self._environment, None)


# ---- FMI 3 -----------------------------------------------------------------------------------------------------------


class Instance3(Instance):
    """An instance of an FMI 3.0 FMU, without event mode and early return."""

    PREFIX = "fmi3"
    STANDARD = 3
    SLAVE = FMU3Slave
    C_TYPES: ClassVar = {
        "Float32": ctypes.c_float,
        "Float64": ctypes.c_double,
        **{
            f"{sign}Int{bits}": getattr(ctypes, f"c_{sign.lower()}int{bits}")
            for sign in ("", "U")
            for bits in (8, 16, 32, 64)
        },
        "Boolean": ctypes.c_bool,
    }
    ACCESS: ClassVar = {"Enumeration": "Int64"}

    def _instantiate(self) -> None:
        self._event, self._ending, self._early = ctypes.c_bool(), ctypes.c_bool(), ctypes.c_bool()
        self._last_time = ctypes.c_double()
        self.fmu.instantiate(loggingOn=True, logMessage=self._log)

    def _log(self, environment: int | None, status: int, category: bytes, message: bytes) -> None:
        self.messages.add(status, message.decode(errors="replace"))

    def _begin(self, stop_time: float, values: Mapping[str, float | str]) -> None:
        self._set(values)
        self._call("EnterInitializationMode", False, 0.0, 0.0, True, stop_time)  # no tolerance; from 0 to the stop time

    def advance(self, time: float, step_size: float) -> None:  # noqa: D102
        self.messages.time = time
        for flag in (self._event, self._ending, self._early):
            flag.value = False
        answers = (ctypes.byref(answer) for answer in (self._event, self._ending, self._early, self._last_time))
        self._call("DoStep", time, step_size, True, *answers)
        if self._ending.value:
            raise self.asked_to_end("fmi3DoStep", self._last_time.value)
        if self._early.value:
            raise self.returned_early("fmi3DoStep", self._last_time.value)

    def _arguments(self, references: Any, count: int, pointer: Any) -> tuple[Any, ...]:
        return (*super()._arguments(references, count, pointer), count)


def instantiate(name: str, model: ModelDescription, folder: Path) -> Instance:
    """Load an FMU and make an instance of it; parameters as those of :class:`Instance`.

    Raises
    ------
    RunError
        If it cannot be loaded or refuses to be instantiated.
    """
    return {2: Instance2, 3: Instance3}[model.description.fmiMajorVersion](name, model, folder)


def extract(model: ModelDescription, folder: Path) -> None:
    """Extract an FMU into a folder.

    Raises
    ------
    SetupError
        If the archive is damaged or holds what it should not; then nothing is extracted.
    """
    try:
        with open_archive(model.open(), model.where) as archive:
            archive.extractall(folder)
    except SetupError:
        raise
    except Exception as error:  # zip errors, unknown compression, a full disk
        raise SetupError(f"{model.where}: expected an archive that can be extracted, got: {error}") from error
