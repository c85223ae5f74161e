"""One running FMU: fmpy's slave with its log, its buffers, and an end that comes whatever happens.

:class:`Instance` is the same for all versions of FMI; what differs stands in one small class for each version.
"""

from __future__ import annotations

import ctypes
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import chdir, contextmanager, suppress
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from fmpy.fmi1 import FMICallException, printLogMessage
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE, fmi2Terminated
from fmpy.fmi3 import FMU3Slave
from fmpy.logging import addLoggerProxy
from fmpy.model_description import ModelVariable

from cosim.archives import open_archive
from cosim.errors import RunError, SetupError
from cosim.model import KINDS, Model
from cosim.stdout import printed
from cosim.units import IDENTITY, Linear

_WARNING, _DISCARD, _ERROR, _FATAL = 1, 2, 3, 4
_STATUS = dict(enumerate(("ok", "warning", "discard", "error", "fatal", "pending")))


@dataclass(frozen=True)
class Port:
    """Some variables of one FMU type, moved between the FMU and a part of a table of values by one call.

    Attributes
    ----------
    access
        fmpy's getter or setter.
    arguments
        What it is called with: instance, value references, pointers to ``buffer``, sizes.
    buffer
        What the FMU reads or writes.
    table
        The values of all components' outputs.
    places
        Where in ``table`` each value belongs.
    factors, offsets
        What transforms values on their way from the table; both None where they stay as they are.
    """

    access: Callable[..., int]
    arguments: tuple[Any, ...]
    buffer: np.ndarray[Any, Any]
    table: np.ndarray[Any, Any]
    places: np.ndarray[Any, Any]
    factors: np.ndarray[Any, Any] | None = None
    offsets: np.ndarray[Any, Any] | None = None

    def call(self) -> None:
        """Move the values between the FMU and the buffer."""
        self.access(*self.arguments)


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

    ACCESS: ClassVar[Mapping[str, str]]
    """Type of a variable to the name of its access, where they differ."""

    def __init__(self, name: str, model: Model, folder: Path) -> None:
        self.name = name
        self.model = model
        self.journal: deque[tuple[int, str]] = deque(maxlen=1000)
        self._inputs: list[Port] = []
        self._outputs: list[Port] = []
        self._attributed: dict[str, str] = {}
        self._initialised = False
        self._running = False
        self._dead = False
        self._time = 0.0
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

    # ---- failures ----------------------------------------------------------------------------------------------------

    @contextmanager
    def calling(self, call: str, time: float = 0.0) -> Iterator[None]:
        """Turn whatever goes wrong in a call outside the steps into a :class:`RunError`; note what is said meanwhile.

        Parameters
        ----------
        call
            Its name, for messages.
        time
            When, in s.
        """
        try:
            yield
        except Exception as error:  # fmpy raises bare exceptions, too
            raise self.failure(error, call, time) from error
        finally:
            self.listen(call, time)

    def listen(self, call: str, time: float) -> None:
        """Attribute to a call at a time in s what was printed and warned of since the last time."""
        text, printing = printed(), f"printed to stdout in {call}"
        if text and printing not in self._attributed:  # once a run is enough
            message = f"{printing} at t = {time:g} s: {text}"
            self._attributed.update({printing: printing, message: message})
            self.journal.append((_WARNING, message))
        for message in self._warned() if self.journal else ():
            self._attributed.setdefault(message, f"{message} ({call}, t = {time:g} s)")

    def passed(self, status: int, call: str, time: float) -> None:
        """Take note of the status of a call that went well at a time in s, perhaps with a warning."""
        if status == _WARNING and call not in self._attributed:
            said = [message for message in self._warned() if message not in self._attributed]
            if not said:
                self.journal.append((_WARNING, f"{call} returned a warning"))
            self._attributed[call] = call
            self.listen(call, time)

    def failure(self, error: Exception, call: str, time: float = 0.0) -> RunError:
        """Describe a failed call: component, call, time in s, and what the FMU said about it."""
        if isinstance(error, RunError):
            return error
        status = ""
        said = [message for status_, message in self.journal if status_ > _WARNING]
        if isinstance(error, FMICallException):
            if error.status == _DISCARD and not said and self._ended():
                return self.asked_to_end(error.function, time)
            self._running = self._running and error.status < _ERROR  # after an error FMI allows reset and free only
            self._dead = self._dead or error.status == _FATAL
            call = error.function
            status = f" ({_STATUS.get(error.status, error.status)})"
        reason = " ".join((said[-1] if said else str(error)).split())
        return RunError(f"{self.name}: {call} failed at t = {time:g} s{status}: {reason}")

    def asked_to_end(self, call: str, reached: float) -> RunError:
        """Describe an FMU that asks in a call for the end of the run, having reached a time in s."""
        return RunError(f"{self.name}: {call} asked to end the run at t = {reached:g} s")

    def _ended(self) -> bool:
        """Whether the FMU discarded a step because it asks for the end of the run."""
        return False

    def _warned(self) -> list[str]:
        return [message for status, message in self.journal if status == _WARNING]

    @property
    def warnings(self) -> list[str]:
        """What the FMU warned of so far, each text once, with call and time where they are known."""
        return [self._attributed.get(message, message) for message in dict.fromkeys(self._warned())]

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
        given = {name: (place, IDENTITY) for name, place in outputs.items()}
        self._outputs = [self._port("Get", kind, table, names, given) for kind, names in self._by_kind(given)]
        self._inputs = [self._port("Set", kind, table, names, inputs) for kind, names in self._by_kind(inputs)]

    def _by_kind(self, names: Iterable[str]) -> Iterator[tuple[str, list[str]]]:
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
        table: np.ndarray[Any, Any],
        names: Sequence[str],
        places: Mapping[str, tuple[int, Linear]],
    ) -> Port:
        buffer = np.zeros(len(names), dtype=np.dtype(self.C_TYPES[kind]))
        references = (ctypes.c_uint * len(names))(*(self.model.variables[name].valueReference for name in names))
        pointer = buffer.ctypes.data_as(ctypes.POINTER(self.C_TYPES[kind]))
        transformations = [places[name][1] for name in names]
        identical = all(transformation == IDENTITY for transformation in transformations)
        return Port(
            access=getattr(self.fmu, f"{self.PREFIX}{direction}{kind}"),
            arguments=self._arguments(references, len(names), pointer),
            buffer=buffer,
            table=table,
            places=np.array([places[name][0] for name in names]),
            factors=None if identical else np.array([t.factor for t in transformations]),
            offsets=None if identical else np.array([t.offset for t in transformations]),
        )

    def _arguments(self, references: Any, count: int, pointer: Any) -> tuple[Any, ...]:
        """Order the arguments of a getter or setter."""
        return (self.fmu.component, references, count, pointer)

    def take_inputs(self) -> None:
        """Set all connected inputs from the table of values."""
        for port in self._inputs:
            values = port.table[port.places]
            port.buffer[:] = values if port.factors is None else port.factors * values + port.offsets
            port.call()

    def give_outputs(self) -> None:
        """Get all outputs into the table of values."""
        for port in self._outputs:
            port.call()
            port.table[port.places] = port.buffer

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
                self.journal.clear()  # what was said in an earlier run is that run's
                self._attributed.clear()
                self.fmu.reset()
            self._initialised = True
            self._begin(stop_time, values)

    def _set(self, values: Mapping[str, float | str]) -> None:
        for name, value in values.items():
            variable = self.model.variables[name]
            given = {"Real": float, "Boolean": bool, "String": str}.get(KINDS[variable.type], int)(value)
            getattr(self.fmu, f"set{self._access(variable)}")([variable.valueReference], [given])

    def finish_initialisation(self) -> None:
        """Leave the initialisation."""
        with self.calling("initialisation"):
            self.fmu.exitInitializationMode()
        self._running = True

    def step(self, time: float, step_size: float) -> None:
        """Take inputs, step from ``time`` by ``step_size`` (both in s), give outputs."""
        self.take_inputs()
        self.advance(time, step_size)
        self.give_outputs()

    def terminate(self, time: float = 0.0) -> None:
        """End a run at a time in s; nothing where FMI does not allow it."""
        self._time = time
        if self._running and not self._dead:
            self._running = False
            with self.calling("terminate", time):
                self.fmu.terminate()

    def free(self) -> None:
        """Free the instance and unload its library; after a fatal error FMI forbids the first."""
        with suppress(Exception):
            if self.fmu.component and not self._dead:
                getattr(self.fmu, f"{self.PREFIX}FreeInstance")(self.fmu.component)
        with suppress(Exception):
            self.listen("free", self._time)
        with suppress(Exception):
            self.fmu.freeLibrary()
        self._forget()


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
    SLAVE = FMU2Slave
    C_TYPES: ClassVar = {"Real": ctypes.c_double, "Integer": ctypes.c_int, "Boolean": ctypes.c_int}
    ACCESS: ClassVar = {"Enumeration": "Integer"}

    _environment: int | None = None

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
        self.fmu.setupExperiment(startTime=0.0, stopTime=stop_time)
        self._set(values)
        self.fmu.enterInitializationMode()

    def advance(self, time: float, step_size: float) -> None:  # noqa: D102
        status = self.fmu.fmi2DoStep(self.fmu.component, time, step_size, 1)
        if status:
            self.passed(status, "fmi2DoStep", time)

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
        self._flags = [ctypes.c_bool() for _ in ("event handling needed", "terminate", "early return")]
        self._reached = ctypes.c_double()
        self.fmu.instantiate(loggingOn=True, logMessage=self._log)

    def _log(self, environment: int | None, status: int, category: bytes, message: bytes) -> None:
        self.journal.append((status, message.decode(errors="replace")))

    def _begin(self, stop_time: float, values: Mapping[str, float | str]) -> None:
        self._set(values)
        self.fmu.enterInitializationMode(startTime=0.0, stopTime=stop_time)

    def advance(self, time: float, step_size: float) -> None:  # noqa: D102
        flags = [ctypes.byref(flag) for flag in self._flags]
        status = self.fmu.fmi3DoStep(self.fmu.component, time, step_size, True, *flags, ctypes.byref(self._reached))
        if self._flags[1].value:
            raise self.asked_to_end("fmi3DoStep", self._reached.value)
        if status:
            self.passed(status, "fmi3DoStep", time)

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
        If the archive is damaged or holds what it should not; then nothing is extracted.
    """
    try:
        with open_archive(model.path) as archive:
            archive.extractall(folder)
    except SetupError:
        raise
    except Exception as error:  # zip errors, unknown compression, a full disk
        raise SetupError(f"{model.path}: expected an archive that can be extracted, got: {error}") from error
