"""The loop in C: loads ``native_stepper.c`` as it was compiled, and lays a schedule out as its structures."""

from __future__ import annotations

import ctypes
import hashlib
from collections.abc import Sequence
from enum import IntEnum
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from fmpy import platform_tuple, sharedLibraryExtension
from fmpy.fmi1 import FMICallException

from cosim.engine.python_stepper import check_finite
from cosim.engine.recorder import Recorder
from cosim.engine.schedule import Schedule
from cosim.errors import RunError
from cosim.fmi.access import NativeCalls, VariableAccess
from cosim.fmi.instance import Instance

BUILT = Path(__file__).with_name("built")
"""Where the compiled loop lies, each platform's in the subfolder of its name."""

NAME = "stepper"
"""Name of the library, without extension."""

_SOURCES = [Path(__file__).with_suffix(suffix) for suffix in (".c", ".h")]


def fingerprint() -> bytes:
    """Return the hash that a library compiled of this very source contains."""
    return hashlib.sha256(b"".join(path.read_bytes() for path in _SOURCES)).hexdigest().encode()


def sources() -> dict[str, bytes]:
    """Return the files that a C compiler needs, by name."""
    files = {path.name: path.read_bytes() for path in _SOURCES}
    return {**files, "source.h": b'#define STEPPER_SOURCE "%s"\n' % fingerprint()}


@cache
def load() -> Any:
    """Load the compiled loop.

    Returns
    -------
    ctypes library or None
        None where there is none, or one of another source.
    """
    try:
        library = ctypes.CDLL(str(BUILT / platform_tuple / f"{NAME}{sharedLibraryExtension}"))
        library.stepper_source.restype = ctypes.c_char_p
        if library.stepper_source() != fingerprint():
            return None
        library.stepper_run.restype = ctypes.c_bool
    except (OSError, AttributeError):
        return None
    library.stepper_run.argtypes = [ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64]
    library.stepper_begin.argtypes = [ctypes.c_void_p]
    return library


# ---- the structures of native_stepper.h; a test compares them with it ------------------------------------------------

TYPES = (
    *("float64", "float32", "bool"),
    *("int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64"),
)
"""numpy's names of ``ValueType``, in its order."""


class Cause(IntEnum):
    """What is called, or what went wrong."""

    nothing = 0
    setting = 1
    stepping = 2
    getting = 3
    terminated = 4
    returned_early = 5
    not_finite = 6
    out_of_range = 7
    inexact = 8


def _structure(name: str, **fields: Any) -> type[ctypes.Structure]:
    return type(name, (ctypes.Structure,), {"_fields_": list(fields.items())})


def _fields(kind: Any, names: str) -> dict[str, Any]:
    return dict.fromkeys(names.split(), kind)


_Access = _structure(
    "VariableAccess",
    **_fields(ctypes.c_void_p, "function references buffer index factors offsets low high"),
    **_fields(ctypes.c_int64, "count reference_count"),
    type=ctypes.c_int,
    **_fields(ctypes.c_int64, "may_be_inexact sampled warned"),
)
_Component = _structure(
    "Component",
    **_fields(ctypes.c_void_p, "instance do_step inputs outputs"),
    **_fields(ctypes.c_int64, "input_count output_count fmi_version factor substeps"),
    step_size=ctypes.c_double,
    warned=ctypes.c_int64,
)
_RecordedValue = _structure("RecordedValue", **_fields(ctypes.c_int64, "column index"))
_Call = _structure(
    "Call",
    component=ctypes.c_void_p,
    cause=ctypes.c_int,
    **_fields(ctypes.c_int64, "number element status"),
    reached=ctypes.c_double,
)
_Schedule = _structure(
    "Schedule",
    components=ctypes.c_void_p,
    **_fields(ctypes.c_int64, "component_count group"),
    values=ctypes.c_void_p,
    value_count=ctypes.c_int64,
    **_fields(ctypes.c_void_p, "rows continuous sampled"),
    **_fields(ctypes.c_int64, "width continuous_count sampled_count record_every first_recorded done"),
    **_fields(ctypes.c_double, "start_time step_size"),
    **_fields(ctypes.c_void_p, "warned inexact"),
    call=_Call,
)
STRUCTURES = (_Access, _Component, _RecordedValue, _Call, _Schedule)
"""Mirrors of the structures, each with the name it has in C."""

_Notice = ctypes.CFUNCTYPE(None)
_Verdict = ctypes.CFUNCTYPE(ctypes.c_bool)


def _address(array: np.ndarray[Any, Any] | None) -> int | None:
    return None if array is None else array.ctypes.data


def _function(function: Any) -> int | None:
    return ctypes.cast(function, ctypes.c_void_p).value


def _access(access: VariableAccess) -> ctypes.Structure:
    return _Access(
        function=_function(access.call.function),
        references=ctypes.addressof(access.call.references),
        buffer=_address(access.call.buffer),
        index=None if access.direct else _address(access.index),
        factors=_address(access.factors),
        offsets=_address(access.offsets),
        low=_address(access.low),
        high=_address(access.high),
        count=len(access.index),
        reference_count=len(access.call.references),
        type=TYPES.index(access.call.buffer.dtype.name),
        may_be_inexact=access.connected is not None,
        sampled=access.sampled,
    )


_ACCESSES = {
    Cause.setting: "inputs",
    Cause.out_of_range: "inputs",
    Cause.getting: "outputs",
    Cause.inexact: "outputs",
}
"""Causes that concern an access to variables, each with the field of :class:`cosim.fmi.access.NativeCalls` it is in."""


class NativeCallTracker:
    """Tells which call the loop in C makes.

    Parameters
    ----------
    schedule
        What it follows.
    instances, calls
        Its components and their functions, in the order of the schedule.
    native
        The schedule as a structure of the C source.
    """

    def __init__(
        self, schedule: Schedule, instances: Sequence[Instance], calls: Sequence[NativeCalls], native: Any
    ) -> None:
        self._schedule, self._instances, self._calls, self._native = schedule, instances, calls, native

    @property
    def _number(self) -> int:
        """Which component is called, by its place in the schedule."""
        return int(self._native.call.component - self._native.components) // ctypes.sizeof(_Component)

    def where(self) -> tuple[str, float]:
        """Return the name of the function that is called, and its time in s."""
        call, tick = self._native.call, self._native.done
        if call.cause in _ACCESSES:
            return self._access.call.name, self._schedule.clock.time(tick)
        component = self._schedule.components[self._number]
        return self._calls[self._number].step_name, component.decimation.time(tick, call.number)

    @property
    def _access(self) -> VariableAccess:
        """Which variables are accessed."""
        call, calls = self._native.call, self._calls[self._number]
        access: VariableAccess = getattr(calls, _ACCESSES[call.cause])[call.number]
        return access

    def warned(self) -> None:
        """Note that the current call has returned a warning."""
        self._instances[self._number].messages.warned(*self.where())

    def inexact(self) -> bool:
        """Note that a value is not exact in the table; returns whether the run can go on."""
        _, time = self.where()
        try:
            self._instances[self._number].inexact(self._access, self._native.call.element, time)
        except RunError:
            return False
        return True

    def failure(self) -> RunError:
        """Describe what went wrong, with the messages of the loop in Python."""
        call = self._native.call
        if call.cause == Cause.not_finite:
            try:
                check_finite(self._schedule, self._native.done)
            except RunError as error:
                return error
        instance: Instance = self._instances[self._number]
        name, time = self.where()
        if call.cause in (Cause.out_of_range, Cause.inexact):
            return instance.unfit(self._access, call.element, time)
        if call.cause == Cause.terminated:
            return instance.termination_requested(name, call.reached)
        if call.cause == Cause.returned_early:
            return instance.returned_early(name, call.reached)
        return instance.failure(FMICallException(function=name, status=call.status), name, time)


class NativeStepper:
    """The loop in C; :class:`cosim.engine.python_stepper.PythonStepper` does the same.

    Parameters
    ----------
    schedule
        What to follow.
    instances, calls
        Its components and their functions, in the order of the schedule.
    recorder
        Records the values.
    """

    def __init__(
        self, schedule: Schedule, instances: Sequence[Instance], calls: Sequence[NativeCalls], recorder: Recorder
    ) -> None:
        self._library = load()
        self._recorder = recorder
        self._referenced: list[Any] = []  # what the structures point to
        components = self._keep((_Component * len(calls))(*self._components(schedule, calls)))
        self._native = _Schedule(
            components=ctypes.addressof(components),
            component_count=len(calls),
            group=len(calls) if schedule.jacobi else 1,
            values=_address(schedule.values),
            value_count=len(schedule.values),
            continuous=_address(recorder.continuous),
            sampled=_address(recorder.sampled),
            continuous_count=len(recorder.continuous),
            sampled_count=len(recorder.sampled),
            record_every=recorder.every,
            start_time=schedule.clock.start_time,
            step_size=schedule.clock.step_size,
        )
        self._pointer = ctypes.addressof(self._native)
        self._tracker = NativeCallTracker(schedule, instances, calls, self._native)
        self._logs = [instance.messages for instance in instances]
        self._native.warned = _function(self._keep(_Notice(self._tracker.warned)))
        self._native.inexact = _function(self._keep(_Verdict(self._tracker.inexact)))

    def _keep(self, thing: Any) -> Any:
        self._referenced.append(thing)
        return thing

    def _components(self, schedule: Schedule, components: Sequence[NativeCalls]) -> list[ctypes.Structure]:
        found = []
        for component, calls in zip(schedule.components, components, strict=True):
            accesses = [self._keep((_Access * len(a))(*map(_access, a))) for a in (calls.inputs, calls.outputs)]
            found.append(
                _Component(
                    instance=calls.component,
                    do_step=_function(calls.step),
                    inputs=ctypes.addressof(accesses[0]),
                    outputs=ctypes.addressof(accesses[1]),
                    input_count=len(calls.inputs),
                    output_count=len(calls.outputs),
                    fmi_version=calls.fmi_version,
                    factor=component.decimation.factor,
                    substeps=component.decimation.substeps,
                    step_size=component.decimation.step_size,
                )
            )
        return found

    @property
    def done(self) -> int:
        """Number of ticks that are complete."""
        return int(self._native.done)

    @done.setter
    def done(self, ticks: int) -> None:
        self._native.done = ticks

    def begin(self) -> None:
        """Begin a run."""
        self._library.stepper_begin(self._pointer)

    def run(self, first: int, last: int) -> None:
        """Step from one tick to another and record."""
        self._native.rows = self._recorder.rows.ctypes.data
        self._native.width = self._recorder.rows.shape[1]
        self._native.first_recorded = self._recorder.first_tick
        self._call(self._library.stepper_run, first, last)

    def _call(self, function: Any, *arguments: int) -> None:
        """Call a function of the C source; messages of FMUs are attributed to the call that it makes."""
        for log in self._logs:
            log.native_call = self._tracker.where
        try:
            succeeded = function(self._pointer, *arguments)
        finally:
            for log in self._logs:
                log.native_call = None
        if not succeeded:
            raise self._tracker.failure()
