"""One running FMU: fmpy's slave with its log, its buffers, and an end that comes whatever happens."""

from __future__ import annotations

import ctypes
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from fmpy.fmi1 import FMICallException, printLogMessage
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.logging import addLoggerProxy
from fmpy.model_description import ModelVariable

from cosim.errors import RunError, SetupError
from cosim.model import Model

_ACCESS = {"Real": "Real", "Integer": "Integer", "Enumeration": "Integer", "Boolean": "Boolean", "String": "String"}
_C_TYPES: dict[str, Any] = {"Real": ctypes.c_double, "Integer": ctypes.c_int, "Boolean": ctypes.c_int}

_WARNING, _FATAL = 1, 4
_STATUS = dict(enumerate(("ok", "warning", "discard", "error", "fatal", "pending")))

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


@dataclass(frozen=True)
class Port:
    """Some variables of one FMU type, moved between the FMU and a part of a table of values by one call.

    Attributes
    ----------
    access
        fmpy's getter or setter.
    references
        C array of value references.
    buffer
        C array the FMU reads or writes.
    table
        The values of all components' outputs.
    places
        Where in ``table`` each value belongs.
    """

    access: Callable[..., int]
    references: Any
    buffer: np.ndarray[Any, Any]
    pointer: Any
    table: np.ndarray[Any, Any]
    places: np.ndarray[Any, Any]


class Instance:
    """An instantiated FMU.

    Parameters
    ----------
    name
        The component's name in its system.
    model
        What to instantiate.
    folder
        Where the FMU was extracted.
    """

    def __init__(self, name: str, model: Model, folder: Path) -> None:
        self.name = name
        self.model = model
        self.journal: deque[tuple[int, str]] = deque(maxlen=1000)
        self._environment = next(_environments)
        _journals[self._environment] = self.journal
        self._callbacks = fmi2CallbackFunctions()
        self._callbacks.logger = _proxy.logger
        self._callbacks.allocateMemory = defaultCallbacks.allocateMemory
        self._callbacks.freeMemory = defaultCallbacks.freeMemory
        self._callbacks.componentEnvironment = self._environment
        self._inputs: list[Port] = []
        self._outputs: list[Port] = []
        self._initialised = False
        self._dead = False
        self.fmu: Any = None
        with self.calling("load"):
            self.fmu = FMU2Slave(
                guid=model.description.guid,
                modelIdentifier=model.description.coSimulation.modelIdentifier,
                unzipDirectory=str(folder),
                instanceName=name,
            )
        try:
            with self.calling("fmi2Instantiate"):
                self.fmu.instantiate(callbacks=self._callbacks, loggingOn=True)
        except RunError:
            self.fmu.freeLibrary()
            _journals.pop(self._environment)
            raise

    @contextmanager
    def calling(self, call: str) -> Iterator[None]:
        """Turn whatever goes wrong in a call before the first step into a :class:`RunError`."""
        try:
            yield
        except Exception as error:  # fmpy raises bare exceptions, too
            raise self.failure(error, call) from error

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

    @property
    def warnings(self) -> list[str]:
        """What the FMU warned of so far, each text once."""
        return list(dict.fromkeys(message for status, message in self.journal if status == _WARNING))

    # ---- wiring ------------------------------------------------------------------------------------------------------

    def wire(
        self,
        table: np.ndarray[Any, Any],
        outputs: Mapping[str, int],
        inputs: Mapping[str, int],
    ) -> None:
        """Say where in the table of values each output goes and each connected input comes from.

        Parameters
        ----------
        table
            Values of all components' outputs, float64.
        outputs, inputs
            Variable name to place in ``table``.
        """
        self._outputs = [self._port("Get", kind, table, places) for kind, places in self._by_kind(outputs)]
        self._inputs = [self._port("Set", kind, table, places) for kind, places in self._by_kind(inputs)]

    def _by_kind(self, places: Mapping[str, int]) -> Iterator[tuple[str, dict[int, int]]]:
        for kind in _C_TYPES:
            found = {
                self.model.variables[name].valueReference: place
                for name, place in places.items()
                if _ACCESS[self.model.variables[name].type] == kind
            }
            if found:
                yield kind, found

    def _port(self, direction: str, kind: str, table: np.ndarray[Any, Any], places: Mapping[int, int]) -> Port:
        buffer = np.zeros(len(places), dtype=np.dtype(_C_TYPES[kind]))
        return Port(
            access=getattr(self.fmu, f"fmi2{direction}{kind}"),
            references=(ctypes.c_uint * len(places))(*places),
            buffer=buffer,
            pointer=buffer.ctypes.data_as(ctypes.POINTER(_C_TYPES[kind])),
            table=table,
            places=np.array(list(places.values())),
        )

    def take_inputs(self) -> None:
        """Set all connected inputs from the table of values."""
        for port in self._inputs:
            port.buffer[:] = port.table[port.places]
            port.access(self.fmu.component, port.references, len(port.buffer), port.pointer)

    def give_outputs(self) -> None:
        """Get all outputs into the table of values."""
        for port in self._outputs:
            port.access(self.fmu.component, port.references, len(port.buffer), port.pointer)
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
        with self.calling("initialisation"):
            if self._initialised:
                self.fmu.reset()
            self._initialised = True
            self.fmu.setupExperiment(startTime=0.0, stopTime=stop_time)
            for name, value in values.items():
                self._set(self.model.variables[name], value)
            self.fmu.enterInitializationMode()

    def _set(self, variable: ModelVariable, value: float | str) -> None:
        kind = _ACCESS[variable.type]
        given = {"Real": float, "Integer": int, "Boolean": int, "String": str}[kind](value)  # type: ignore[operator]
        getattr(self.fmu, f"set{kind}")([variable.valueReference], [given])

    def finish_initialisation(self) -> None:
        """Leave the initialisation."""
        with self.calling("initialisation"):
            self.fmu.exitInitializationMode()

    def step(self, time: float, step_size: float) -> None:
        """Take inputs, step from ``time`` by ``step_size`` (both in s), give outputs."""
        self.take_inputs()
        self.fmu.fmi2DoStep(self.fmu.component, time, step_size, 1)
        self.give_outputs()

    def terminate(self) -> None:
        """End a run."""
        if self._initialised and not self._dead:
            with self.calling("fmi2Terminate"):
                self.fmu.terminate()

    def free(self) -> None:
        """Free the instance and unload its library; after a fatal error FMI forbids the first."""
        with suppress(Exception):
            if not self._dead:
                self.fmu.fmi2FreeInstance(self.fmu.component)
        with suppress(Exception):
            self.fmu.freeLibrary()
        _journals.pop(self._environment, None)


def extract(model: Model, folder: Path) -> None:
    """Extract an FMU into a folder.

    Raises
    ------
    SetupError
        If the archive is damaged or holds an illegal path.
    """
    try:
        fmpy.extract(str(model.path), str(folder))
    except Exception as error:  # zip errors, and fmpy's bare ones
        raise SetupError(f"{model.path}: expected an archive that can be extracted, got: {error}") from error
