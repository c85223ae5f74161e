"""One running FMU: fmpy's slave with its log, its buffers, and an end that comes whatever happens.

:class:`Instance` is the same for all versions of FMI; what differs stands in one small class for each version.
"""

from __future__ import annotations

import ctypes
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, chdir, suppress
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any, ClassVar

import fmpy
import numpy as np
from fmpy.fmi1 import FMICallException, printLogMessage
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Slave
from fmpy.logging import addLoggerProxy
from fmpy.model_description import ModelVariable

from cosim.errors import RunError, SetupError
from cosim.model import Model
from cosim.units import IDENTITY, Linear

_WARNING, _FATAL = 1, 4
_STATUS = dict(enumerate(("ok", "warning", "discard", "error", "fatal", "pending")))


@dataclass(frozen=True)
class Access:
    """One call of an FMU's getter or setter: some variables of one type, moved between the FMU and a buffer.

    Attributes
    ----------
    name
        Of the function.
    function
        As fmpy loaded it.
    arguments
        What it is called with: instance, value references, pointer to ``buffer``, sizes.
    references
        Value references.
    buffer
        What the FMU reads or writes.
    """

    name: str
    function: Any
    arguments: tuple[Any, ...]
    references: Any
    buffer: np.ndarray[Any, Any]

    def call(self) -> None:
        """Move the values between the FMU and the buffer."""
        status = self.function(*self.arguments)
        if status > _WARNING:
            raise FMICallException(function=self.name, status=status)


@dataclass(frozen=True)
class Port:
    """Some variables of one type, moved between the FMU and a part of a table of values.

    Attributes
    ----------
    access
        How.
    places
        Where in the table each value belongs.
    factors, offsets
        What transforms values on their way from the table; both None where they stay as they are.
    discrete
        Whether the variables are discrete outputs.
    direct
        Whether the FMU writes into the table itself, of which ``buffer`` is a part.
    """

    access: Access
    places: np.ndarray[Any, Any]
    factors: np.ndarray[Any, Any] | None = None
    offsets: np.ndarray[Any, Any] | None = None
    discrete: bool = False
    direct: bool = False


@dataclass(frozen=True)
class Calls:
    """What a loop in C needs of an instance to call the FMU's own functions.

    Attributes
    ----------
    standard
        Major version of FMI.
    component
        The instance's pointer.
    step_name, step
        Name and function of the step.
    inputs, outputs
        What is set before it and got after it.
    """

    standard: int
    component: int
    step_name: str
    step: Any
    inputs: Sequence[Port]
    outputs: Sequence[Port]


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

    def __init__(self, name: str, model: Model, folder: Path) -> None:
        self.name = name
        self.model = model
        self.journal: deque[tuple[int, str]] = deque(maxlen=1000)
        self._table = np.zeros(0)
        self._inputs: list[Port] = []
        self._outputs: list[Port] = []
        self._parameters: dict[tuple[str, ...], list[tuple[Access, list[str]]]] = {}
        self._texts: list[str] = []
        self._initialised = False
        self._dead = False
        self.fmu: Any = None
        with self.calling("load"), chdir(Path.cwd()):  # fmpy does not come back from the folder of one that fails
            self.fmu = self.SLAVE(
                guid=model.description.guid,
                modelIdentifier=model.description.coSimulation.modelIdentifier,
                unzipDirectory=str(folder),
                instanceName=name,
            )
        self._functions = {name: getattr(self.fmu.dll, self.PREFIX + name) for name in self.FUNCTIONS}
        try:
            with self.calling("instantiate"):
                self._instantiate()
        except RunError:
            self.fmu.freeLibrary()
            self._forget()
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

    # ---- failures ----------------------------------------------------------------------------------------------------

    def calling(self, call: str) -> AbstractContextManager[None]:
        """Turn whatever goes wrong in a call before the first step into a :class:`RunError`."""
        return _Calling(self, call)

    def failure(self, error: Exception, call: str, time: float = 0.0) -> RunError:
        """Describe a failed call: component, call, time in s, and what the FMU said about it."""
        status = ""
        if isinstance(error, FMICallException):
            self._dead = self._dead or error.status == _FATAL
            call = error.function
            status = f" ({_STATUS.get(error.status, error.status)})"
        said = [message for status_, message in self.journal if status_ > _WARNING]
        reason = " ".join((said[-1] if said else str(error)).split())
        return RunError(f"{self.name}: {call} failed at t = {time:g} s{status}: {reason}")

    def asked_to_end(self, call: str, reached: float) -> RunError:
        """Describe an FMU that asks in a call for the end of the run, having reached a time in s."""
        return RunError(f"{self.name}: {call} asked to end the run at t = {reached:g} s")

    def returned_early(self, call: str, reached: float) -> RunError:
        """Describe an FMU that did not finish its step, though it was not allowed to return early."""
        return RunError(f"{self.name}: {call} returned early, at t = {reached:g} s")

    @property
    def warnings(self) -> list[str]:
        """What the FMU warned of so far, each text once."""
        return list(dict.fromkeys(message for status, message in self.journal if status == _WARNING))

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
            for kind, names in self._by_kind(name for name in given if self.is_discrete(name) is discrete)
        ]
        self._inputs = [self._port("Set", kind, names, inputs) for kind, names in self._by_kind(inputs)]

    def is_discrete(self, name: str) -> bool:
        """Whether a variable changes at instants only."""
        return bool(self.model.variables[name].variability != "continuous")

    def calls(self) -> Calls | None:
        """Return what a loop in C needs, or None of an FMU that cannot be called from there."""
        step = f"{self.PREFIX}DoStep"
        return Calls(self.STANDARD, self.fmu.component, step, self._functions["DoStep"], self._inputs, self._outputs)

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
    ) -> Port:
        transformations = [places[name][1] for name in names]
        identical = all(transformation == IDENTITY for transformation in transformations)
        found = np.array([places[name][0] for name in names], dtype=np.int64)
        begin, end = int(found[0]), int(found[0]) + len(found)
        direct = direction == "Get" and self.C_TYPES[kind] is ctypes.c_double and found.tolist() == [*range(begin, end)]
        return Port(
            access=self._accessor(direction, kind, names, self._table[begin:end] if direct else None),
            places=found,
            factors=None if identical else np.array([t.factor for t in transformations]),
            offsets=None if identical else np.array([t.offset for t in transformations]),
            discrete=discrete,
            direct=direct,
        )

    def _accessor(
        self, direction: str, kind: str, names: Sequence[str], buffer: np.ndarray[Any, Any] | None = None
    ) -> Access:
        if buffer is None:
            buffer = np.zeros(len(names), dtype=np.dtype(self.C_TYPES[kind]))
        references = (ctypes.c_uint * len(names))(*(self.model.variables[name].valueReference for name in names))
        pointer = buffer.ctypes.data_as(ctypes.POINTER(self.C_TYPES[kind]))
        function = f"{self.PREFIX}{direction}{kind}"
        arguments = self._arguments(references, len(names), pointer)
        return Access(function, getattr(self.fmu.dll, function), arguments, references, buffer)

    def _arguments(self, references: Any, count: int, pointer: Any) -> tuple[Any, ...]:
        """Order the arguments of a getter or setter."""
        return (self.fmu.component, references, count, pointer)

    def take_inputs(self) -> None:
        """Set all connected inputs from the table of values."""
        for port in self._inputs:
            values = self._table[port.places]
            port.access.buffer[:] = values if port.factors is None else port.factors * values + port.offsets
            port.access.call()

    def give_outputs(self, discrete: bool | None = None) -> None:
        """Get outputs into the table of values: all of them, or those that are discrete, or those that are not."""
        for port in self._outputs:
            if discrete is None or port.discrete is discrete:
                port.access.call()
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
        with self.calling("initialisation"):
            if self._initialised:
                self.journal.clear()  # what was said in an earlier run is that run's
                self._call("Reset")
            self._initialised = True
            self._begin(stop_time, values)

    def _call(self, function: str, *arguments: Any) -> None:
        """Call a function of the FMU that takes the instance first."""
        status = self._functions[function](self.fmu.component, *arguments)
        if status > _WARNING:
            raise FMICallException(function=self.PREFIX + function, status=status)

    def _set(self, values: Mapping[str, float | str]) -> None:
        names = tuple(values)
        if names not in self._parameters:  # the next run sets the same ones, as a rule
            self._parameters = {names: [(self._accessor("Set", *found), found[1]) for found in self._by_kind(names)]}
            self._texts = [name for name in names if self._access(self.model.variables[name]) not in self.C_TYPES]
        for access, found in self._parameters[names]:
            for i, name in enumerate(found):
                access.buffer[i] = values[name]
            access.call()
        for name in self._texts:
            variable = self.model.variables[name]
            getattr(self.fmu, f"set{variable.type}")([variable.valueReference], [values[name]])

    def finish_initialisation(self) -> None:
        """Leave the initialisation."""
        with self.calling("initialisation"):
            self._call("ExitInitializationMode")

    def step(self, time: float, step_size: float) -> None:
        """Take inputs, step from ``time`` by ``step_size`` (both in s), give outputs."""
        self.take_inputs()
        self.advance(time, step_size)
        self.give_outputs()

    def terminate(self) -> None:
        """End a run."""
        if self._initialised and not self._dead:
            with self.calling("terminate"):
                self._call("Terminate")

    def free(self) -> None:
        """Free the instance and unload its library; after a fatal error FMI forbids the first."""
        with suppress(Exception):
            if not self._dead:
                getattr(self.fmu, f"{self.PREFIX}FreeInstance")(self.fmu.component)
        with suppress(Exception):
            self.fmu.freeLibrary()
        self._forget()


class _Calling(AbstractContextManager[None]):
    """See :meth:`Instance.calling`; a class, as a run begins with many and a generator takes its time."""

    def __init__(self, instance: Instance, call: str) -> None:
        self._instance = instance
        self._call = call

    def __exit__(self, kind: object, error: BaseException | None, traceback: object) -> None:
        if isinstance(error, Exception):  # fmpy raises bare exceptions, too
            raise self._instance.failure(error, self._call) from error


# ---- FMI 2 -----------------------------------------------------------------------------------------------------------

_journals: dict[int, deque[tuple[int, str]]] = {}
_environments = count(1)


@fmi2CallbackLoggerTYPE  # type: ignore[untyped-decorator]
def _log(environment: int | None, name: bytes, status: int, category: bytes, message: bytes) -> None:
    """Write an FMU's message into its instance's journal; fmpy has one logger per process, so ours serves all."""
    if environment in _journals:
        _journals[environment].append((status, message.decode(errors="replace")))
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

    def _instantiate(self) -> None:
        self._environment = next(_environments)
        _journals[self._environment] = self.journal
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
        self._call("DoStep", time, step_size, 1)

    def _forget(self) -> None:
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
        self._event, self._terminate, self._early = ctypes.c_bool(), ctypes.c_bool(), ctypes.c_bool()
        self._reached = ctypes.c_double()
        self.fmu.instantiate(loggingOn=True, logMessage=self._log)

    def _log(self, environment: int | None, status: int, category: bytes, message: bytes) -> None:
        self.journal.append((status, message.decode(errors="replace")))

    def _begin(self, stop_time: float, values: Mapping[str, float | str]) -> None:
        self._set(values)
        self._call("EnterInitializationMode", False, 0.0, 0.0, True, stop_time)  # no tolerance; from 0 to the stop time

    def advance(self, time: float, step_size: float) -> None:  # noqa: D102
        for flag in (self._event, self._terminate, self._early):
            flag.value = False
        flags = (ctypes.byref(flag) for flag in (self._event, self._terminate, self._early, self._reached))
        self._call("DoStep", time, step_size, True, *flags)
        if self._terminate.value:
            raise self.asked_to_end("fmi3DoStep", self._reached.value)
        if self._early.value:
            raise self.returned_early("fmi3DoStep", self._reached.value)

    def _arguments(self, references: Any, count: int, pointer: Any) -> tuple[Any, ...]:
        return (*super()._arguments(references, count, pointer), count)


def instantiate(name: str, model: Model, folder: Path) -> Instance:
    """Load an FMU and make an instance of it; parameters as those of :class:`Instance`.

    Raises
    ------
    RunError
        If it cannot be loaded or refuses to be instantiated.
    """
    return {2: Instance2, 3: Instance3}[model.description.fmiMajorVersion](name, model, folder)


def extract(model: Model, folder: Path) -> None:
    """Extract an FMU into a folder.

    Raises
    ------
    SetupError
        If the archive is damaged or holds an illegal path.
    """
    try:
        fmpy.extract(model.open(), str(folder))
    except Exception as error:  # zip errors, and fmpy's bare ones
        raise SetupError(f"{model.where}: expected an archive that can be extracted, got: {error}") from error
