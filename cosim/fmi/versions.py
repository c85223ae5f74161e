"""Instances of FMI 2.0 and FMI 3.0 FMUs."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from contextlib import suppress
from itertools import count
from pathlib import Path
from typing import Any, ClassVar

from fmpy.fmi1 import FMICallException, printLogMessage
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE, fmi2Terminated
from fmpy.fmi3 import FMU3Slave
from fmpy.logging import addLoggerProxy

from cosim.fmi.description import ModelDescription
from cosim.fmi.instance import Instance
from cosim.fmi.messages import MessageLog

# ---- FMI 2 -----------------------------------------------------------------------------------------------------------

_logs: dict[int, MessageLog] = {}
"""Component environment, which each message carries, to the log of its instance."""

_environments = count(1)


@fmi2CallbackLoggerTYPE  # type: ignore[untyped-decorator]
def _log(environment: int | None, name: bytes, status: int, category: bytes, message: bytes) -> None:
    """Add a message to its instance's log; fmpy has one logger for the process, so this one serves all instances."""
    if environment in _logs:
        _logs[environment].add(status, message.decode(errors="replace"))
    else:
        printLogMessage(environment, name, status, category, message)


_proxy = fmi2CallbackFunctions()
_proxy.logger = _log
addLoggerProxy(ctypes.byref(_proxy))  # formats the variable arguments, which ctypes cannot


class Instance2(Instance):
    """An instance of an FMI 2.0 FMU."""

    FMI_VERSION = 2
    PREFIX = "fmi2"
    FMPY_CLASS = FMU2Slave
    FUNCTIONS = ("SetupExperiment", *Instance.FUNCTIONS)
    C_TYPES: ClassVar = {"Real": ctypes.c_double, "Integer": ctypes.c_int, "Boolean": ctypes.c_int}
    ACCESS: ClassVar = {"Enumeration": "Integer"}

    _environment: int | None = None

    def _instantiate(self) -> None:
        self._environment = next(_environments)
        _logs[self._environment] = self.messages
        self._callbacks = fmi2CallbackFunctions()
        self._callbacks.logger = _proxy.logger
        self._callbacks.allocateMemory = defaultCallbacks.allocateMemory
        self._callbacks.freeMemory = defaultCallbacks.freeMemory
        self._callbacks.componentEnvironment = self._environment
        self.fmu.instantiate(callbacks=self._callbacks, loggingOn=True)

    def _set_up(self, stop_time: float, values: Mapping[str, float | str]) -> None:
        self._call("SetupExperiment", 0, 0.0, 0.0, 1, stop_time)  # no tolerance; from 0 to the stop time
        self._set(values)
        self._call("EnterInitializationMode")

    def do_step(self, time: float, step_size: float) -> None:  # noqa: D102
        self.messages.time = time
        self._call("DoStep", time, step_size, 1)

    def _requests_termination(self) -> bool:
        with suppress(FMICallException):
            return bool(self.fmu.getBooleanStatus(fmi2Terminated))
        return False

    def _release(self) -> None:
        if self._environment is not None:
            _logs.pop(self._environment, None)


# ---- FMI 3 -----------------------------------------------------------------------------------------------------------


class Instance3(Instance):
    """An instance of an FMI 3.0 FMU, without event mode and early return."""

    FMI_VERSION = 3
    PREFIX = "fmi3"
    FMPY_CLASS = FMU3Slave
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
        self._last_time = ctypes.c_double()
        self.fmu.instantiate(loggingOn=True, logMessage=self._log)

    def _log(self, environment: int | None, status: int, category: bytes, message: bytes) -> None:
        self.messages.add(status, message.decode(errors="replace"))

    def _set_up(self, stop_time: float, values: Mapping[str, float | str]) -> None:
        self._set(values)
        self._call("EnterInitializationMode", False, 0.0, 0.0, True, stop_time)  # no tolerance; from 0 to the stop time

    def do_step(self, time: float, step_size: float) -> None:  # noqa: D102
        self.messages.time = time
        for flag in (self._event, self._terminate, self._early):
            flag.value = False
        results = (ctypes.byref(result) for result in (self._event, self._terminate, self._early, self._last_time))
        self._call("DoStep", time, step_size, True, *results)
        if self._terminate.value:
            raise self.termination_requested("fmi3DoStep", self._last_time.value)
        if self._early.value:
            raise self.returned_early("fmi3DoStep", self._last_time.value)

    def _arguments(self, references: Any, count: int, pointer: Any) -> tuple[Any, ...]:
        return (*super()._arguments(references, count, pointer), count)


_CLASSES: dict[int, type[Instance]] = {cls.FMI_VERSION: cls for cls in (Instance2, Instance3)}


def instantiate(name: str, model: ModelDescription, folder: Path) -> Instance:
    """Load an FMU and instantiate it.

    Parameters
    ----------
    name
        The component's name in its system.
    model
        What to instantiate.
    folder
        Where the FMU was extracted.

    Returns
    -------
    Instance
        Of the class for its version of FMI.

    Raises
    ------
    RunError
        If it cannot be loaded or refuses to be instantiated.
    """
    return _CLASSES[model.description.fmiMajorVersion](name, model, folder)
