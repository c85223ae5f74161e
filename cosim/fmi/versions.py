"""Instances of FMI 2.0 and FMI 3.0 FMUs."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from contextlib import suppress
from itertools import count
from pathlib import Path
from typing import Any, ClassVar

from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE, fmi2Terminated
from fmpy.fmi3 import FMU3Slave
from fmpy.logging import addLoggerProxy

from cosim.fmi.description import ModelDescription
from cosim.fmi.instance import Experiment, Instance
from cosim.fmi.messages import MessageLog
from cosim.fmi.values import Checked

# ---- FMI 2 -----------------------------------------------------------------------------------------------------------

_logs: dict[int, tuple[str, MessageLog]] = {}
"""Component environment, which each message carries, to the name and the log of its instance."""

_environments = count(1)


@fmi2CallbackLoggerTYPE  # type: ignore[untyped-decorator]
def _log(environment: int | None, name: bytes | None, status: int, category: bytes, message: bytes | None) -> None:
    """Add a message to its instance's log; fmpy has one logger for the process, so this one serves all instances.

    A message of an unknown environment goes to the instance of its name, or to the newest one.
    """
    if environment not in _logs:
        named = [each for each, (instance, _) in list(_logs.items()) if instance.encode() == name]
        environment = next(reversed(named or [*_logs]), None)
    if environment in _logs:
        _logs[environment][1].add(status, _text(message))


def _text(message: bytes | None) -> str:
    return "(no text)" if message is None else message.decode(errors="replace")


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
        _logs[self._environment] = self.name, self.messages
        self._callbacks = fmi2CallbackFunctions()
        self._callbacks.logger = _proxy.logger
        self._callbacks.allocateMemory = defaultCallbacks.allocateMemory
        self._callbacks.freeMemory = defaultCallbacks.freeMemory
        self._callbacks.componentEnvironment = self._environment
        self.fmu.instantiate(callbacks=self._callbacks, loggingOn=True)

    def _set_up(self, experiment: Experiment, values: Mapping[str, Checked]) -> None:
        tolerance = experiment.tolerance
        self._call(
            "SetupExperiment", tolerance is not None, tolerance or 0.0, experiment.start_time, 1, experiment.stop_time
        )
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
    _configured = False

    def _instantiate(self) -> None:
        self._event, self._terminate, self._early = ctypes.c_bool(), ctypes.c_bool(), ctypes.c_bool()
        self._last_time = ctypes.c_double()
        self.fmu.instantiate(loggingOn=True, logMessage=self._log)

    def _log(self, environment: int | None, status: int, category: bytes, message: bytes | None) -> None:
        self.messages.add(status, _text(message))

    def _set_up(self, experiment: Experiment, values: Mapping[str, Checked]) -> None:
        self._configure(values)
        self._set({name: value for name, value in values.items() if name not in self.model.structural})
        tolerance = experiment.tolerance
        times = experiment.start_time, True, experiment.stop_time
        self._call("EnterInitializationMode", tolerance is not None, tolerance or 0.0, *times)

    def _configure(self, values: Mapping[str, Checked]) -> None:
        """Set structural parameters in configuration mode, where any differs from what it was, and all of them then."""
        given = {name: values[name] for name in self.model.structural if name in values}
        if not given and not self._configured:
            return
        self._load_functions(("EnterConfigurationMode", "ExitConfigurationMode"))
        self._call("EnterConfigurationMode")
        self._set({**self.model.structural, **given})
        self._call("ExitConfigurationMode")
        self._configured = True

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

    def _arguments(self, references: Any, count: int, pointer: Any, value_count: int) -> tuple[Any, ...]:
        return (*super()._arguments(references, count, pointer, value_count), value_count)


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
