"""The loop in C: loads ``native_stepper.c`` as it was compiled, and lays a plan out as its structures."""

from __future__ import annotations

import ctypes
import hashlib
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any, ClassVar

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

_SOURCE = Path(__file__).with_name("native_stepper.c")

_TYPES = (
    *("float64", "float32", "bool"),
    *("int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64"),
)
"""Types of values, in the order of the C source."""


def fingerprint() -> bytes:
    """Return what a library compiled of this very source contains."""
    return hashlib.sha256(_SOURCE.read_bytes()).hexdigest().encode()


def sources() -> dict[str, bytes]:
    """Collect what a C compiler needs."""
    return {_SOURCE.name: _SOURCE.read_bytes(), "source.h": b'#define STEPPER_SOURCE "%s"\n' % fingerprint()}


@cache
def load() -> Any:
    """Load the compiled loop; None where there is none, or one of another source."""
    try:
        library = ctypes.CDLL(str(BUILT / platform_tuple / f"{NAME}{sharedLibraryExtension}"))
        library.stepper_source.restype = ctypes.c_char_p
        if library.stepper_source() != fingerprint():
            return None
        for function in (library.stepper_settle, library.stepper_read, library.stepper_run):
            function.restype = ctypes.c_bool
    except (OSError, AttributeError):
        return None
    library.stepper_run.argtypes = [ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64]
    library.stepper_settle.argtypes = library.stepper_read.argtypes = [ctypes.c_void_p]
    return library


# ---- the structures of the C source ----------------------------------------------------------------------------------


def _structure(**fields: Any) -> type[ctypes.Structure]:
    return type("Structure", (ctypes.Structure,), {"_fields_": list(fields.items())})


def _fields(kind: Any, names: str) -> dict[str, Any]:
    return dict.fromkeys(names.split(), kind)


_Port = _structure(
    **_fields(ctypes.c_void_p, "function references buffer places factors offsets"),
    **_fields(ctypes.c_int64, "count type discrete warned"),
)
_Component = _structure(
    **_fields(ctypes.c_void_p, "instance step inputs outputs"),
    **_fields(ctypes.c_int64, "input_count output_count standard every parts"),
    step_size=ctypes.c_double,
    warned=ctypes.c_int64,
)
_Now = _structure(component=ctypes.c_void_p, **_fields(ctypes.c_int64, "cause which status"), reached=ctypes.c_double)
_Plan = _structure(
    **_fields(ctypes.c_void_p, "components table before rows continuous discrete"),
    **_fields(ctypes.c_int64, "component_count group table_size width continuous_count discrete_count"),
    **_fields(ctypes.c_int64, "record_every first_recorded done"),
    step_size=ctypes.c_double,
    warned=ctypes.c_void_p,
    now=_Now,
)
_Notice = ctypes.CFUNCTYPE(None)


def _address(array: np.ndarray[Any, Any] | None) -> int | None:
    return None if array is None else array.ctypes.data


def _function(function: Any) -> int | None:
    return ctypes.cast(function, ctypes.c_void_p).value


def _port(port: VariableAccess) -> ctypes.Structure:
    return _Port(
        function=_function(port.access.function),
        references=ctypes.addressof(port.access.references),
        buffer=_address(port.access.buffer),
        places=None if port.direct else _address(port.places),
        factors=_address(port.factors),
        offsets=_address(port.offsets),
        count=len(port.places),
        type=_TYPES.index(port.access.buffer.dtype.name),
        discrete=port.discrete,
    )


class NativeCallTracker:
    """Knows where the loop in C is.

    Parameters
    ----------
    plan
        What it steps.
    instances, calls
        Its components and their functions, in the order of the plan.
    c
        The plan as a structure of the C source.
    """

    CAUSES: ClassVar = ("nothing", "setting", "stepping", "getting", "asked to end", "returned early", "not finite")
    """What may be called or go wrong, in the order of the C source."""

    def __init__(self, schedule: Schedule, instances: Sequence[Instance], calls: Sequence[NativeCalls], c: Any) -> None:
        self._plan, self._instances, self._calls, self._c = schedule, instances, calls, c

    @property
    def _place(self) -> int:
        """Which component is called, by its place in the plan."""
        return int(self._c.now.component - self._c.components) // ctypes.sizeof(_Component)

    def where(self) -> tuple[str, float]:
        """Name what is called, and its time in s."""
        now, tick = self._c.now, self._c.done
        calls = self._calls[self._place]
        if self.CAUSES[now.cause] in ("setting", "getting"):
            ports = calls.inputs if self.CAUSES[now.cause] == "setting" else calls.outputs
            return ports[now.which].access.name, self._plan.clock.time(tick)
        return calls.step_name, self._plan.components[self._place].rate.time(tick, now.which)

    def warned(self) -> None:
        """Take note that what is called has warned."""
        self._instances[self._place].messages.warned(*self.where())

    def failure(self) -> RunError:
        """Describe what went wrong, in the words of the loop in Python."""
        now = self._c.now
        cause = self.CAUSES[now.cause]
        if cause == "not finite":
            try:
                check_finite(self._plan, self._c.done)
            except RunError as error:
                return error
        instance: Instance = self._instances[self._place]
        name, time = self.where()
        if cause == "asked to end":
            return instance.asked_to_end(name, now.reached)
        if cause == "returned early":
            return instance.returned_early(name, now.reached)
        return instance.failure(FMICallException(function=name, status=now.status), name, time)


class NativeStepper:
    """The loop in C; :class:`cosim.engine.python_stepper.PythonStepper` does the same.

    Parameters
    ----------
    plan
        What to step.
    instances, calls
        Its components and their functions, in the order of the plan.
    recorder
        What records it.
    """

    def __init__(
        self, schedule: Schedule, instances: Sequence[Instance], calls: Sequence[NativeCalls], recorder: Recorder
    ) -> None:
        self._library = load()
        self._recorder = recorder
        self._held: list[Any] = []  # what the structures point to
        components = self._hold((_Component * len(calls))(*self._components(schedule, calls)))
        before = self._hold(np.zeros_like(schedule.table))
        self._c = _Plan(
            components=ctypes.addressof(components),
            table=_address(schedule.table),
            before=_address(before),
            continuous=_address(recorder.continuous),
            discrete=_address(recorder.discrete),
            component_count=len(calls),
            group=len(calls) if schedule.jacobi else 1,
            table_size=len(schedule.table),
            continuous_count=len(recorder.continuous),
            discrete_count=len(recorder.discrete),
            record_every=recorder.every,
            step_size=schedule.clock.step_size,
        )
        self._pointer = ctypes.addressof(self._c)
        self._watcher = NativeCallTracker(schedule, instances, calls, self._c)
        self._journals = [instance.messages for instance in instances]
        self._c.warned = _function(self._hold(_Notice(self._watcher.warned)))

    def _hold(self, thing: Any) -> Any:
        self._held.append(thing)
        return thing

    def _components(self, schedule: Schedule, components: Sequence[NativeCalls]) -> list[ctypes.Structure]:
        found = []
        for component, calls in zip(schedule.components, components, strict=True):
            ports = [self._hold((_Port * len(p))(*map(_port, p))) for p in (calls.inputs, calls.outputs)]
            found.append(
                _Component(
                    instance=calls.component,
                    step=_function(calls.step),
                    inputs=ctypes.addressof(ports[0]),
                    outputs=ctypes.addressof(ports[1]),
                    input_count=len(calls.inputs),
                    output_count=len(calls.outputs),
                    standard=calls.standard,
                    every=component.rate.every,
                    parts=component.rate.parts,
                    step_size=component.rate.step_size,
                )
            )
        return found

    @property
    def done(self) -> int:
        """Number of ticks that are complete."""
        return int(self._c.done)

    @done.setter
    def done(self, ticks: int) -> None:
        self._c.done = ticks

    def settle(self) -> None:
        """Pass initial outputs along the connections until they settle."""
        self._call(self._library.stepper_settle)

    def read(self) -> None:
        """Read all outputs."""
        self._call(self._library.stepper_read)

    def run(self, first: int, last: int) -> None:
        """Step from one tick to another, recording."""
        self._c.rows = self._recorder.rows.ctypes.data
        self._c.width = self._recorder.rows.shape[1]
        self._c.first_recorded = self._recorder.first_tick
        self._call(self._library.stepper_run, first, last)

    def _call(self, function: Any, *arguments: int) -> None:
        """Call a function of the C source; what FMUs say meanwhile they say where the loop in C is."""
        for messages in self._journals:
            messages.native_call = self._watcher.where
        try:
            well = function(self._pointer, *arguments)
        finally:
            for messages in self._journals:
                messages.native_call = None
        if not well:
            raise self._watcher.failure()
