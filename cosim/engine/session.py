"""Loaded FMUs of a system: extracted, instantiated and wired once, run as often as wanted, freed whatever happens."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from copy import copy
from pathlib import Path
from typing import Any, NamedTuple, TypedDict

import numpy as np

from cosim.engine import native_stepper as stepper
from cosim.engine.clock import Pacer
from cosim.engine.python_stepper import PythonStepper, check_finite, run_in_chunks
from cosim.engine.recorder import Recorder
from cosim.engine.schedule import Schedule, ScheduledComponent, Stepper, decimations
from cosim.engine.stdout_monitor import StdoutMonitor
from cosim.engine.structure import ALGORITHMS, Algorithm, Structure, VariableRef
from cosim.engine.unconnected_inputs import UnconnectedInputs
from cosim.errors import CosimError, RunError, SetupError, did_you_mean
from cosim.fmi.description import ModelDescription, Value
from cosim.fmi.instance import Instance, extract, instantiate
from cosim.fmi.interrupts import check, critical_section, deferring_sigint
from cosim.fmi.isolated import MAX_TIME_LIMIT, TIME_LIMIT, AnyInstance, IsolatedInstance
from cosim.fmi.output_capture import Diversion
from cosim.results.result import Result, Sink, StepperName


class Options(TypedDict, total=False):
    """How a run is made, beyond what is run; see :meth:`Session.run`."""

    algorithm: Algorithm | None
    record_every: int
    sinks: Sequence[Sink]
    keep: bool
    real_time: bool
    loop: StepperName | None


class _Preparation(NamedTuple):
    """All of a run that does not depend on the values of its parameters."""

    schedule: Schedule
    recorder: Recorder
    loop: Stepper
    loop_name: StepperName


class Session:
    """A system whose FMUs are loaded; a context manager.

    Parameters
    ----------
    system
        What to load; later changes of it do not count.
    isolate
        Components whose FMUs run in processes of their own.
    time_limit
        How long a call of an isolated FMU may take, in s.
    divert_stdout
        Whether what FMUs print becomes warnings; otherwise it goes where our own output goes.

    Attributes
    ----------
    isolated, time_limit
        As given, the components in the system's order.

    Raises
    ------
    SetupError
        If a component to isolate does not exist or the time limit is none.
    """

    def __init__(
        self,
        system: Structure,
        isolate: Iterable[str] = (),
        time_limit: float = TIME_LIMIT,
        divert_stdout: bool = True,
    ) -> None:
        isolate = set(isolate)
        check_isolation(system, isolate, time_limit)
        self.isolated = [name for name in system.models if name in isolate]
        self.time_limit = time_limit
        self._system = copy(system)
        vars(self._system).update({name: copy(value) for name, value in vars(system).items()})
        self._divert = divert_stdout
        self._diversion: Diversion | None = None
        self._stack = ExitStack()
        self._instances: dict[str, AnyInstance] = {}
        self._warnings: list[str] = []
        self._names = self._system.outputs()
        self._places = {name: place for place, name in enumerate(self._names)}
        self._table = np.zeros(len(self._names))
        self._request: tuple[object, ...] = ()
        self._preparation: _Preparation
        self._given: tuple[str, ...] | None = None
        self._settled: dict[str, UnconnectedInputs] = {}

    def __enter__(self) -> Session:
        """Extract, instantiate and wire all FMUs."""
        self._diversion = Diversion() if self._divert else None
        self._stack.enter_context(deferring_sigint())
        try:
            with self._careful():
                for name, model in self._system.models.items():
                    self._load(name, model)
                    check()
        except BaseException:
            self._free()
            raise
        return self

    def __exit__(self, *exception: object) -> None:
        """Free all FMUs and remove their folders."""
        self._free()

    def _load(self, name: str, model: ModelDescription) -> None:
        folder = Path(self._stack.enter_context(tempfile.TemporaryDirectory(prefix="seat-cosim-")))
        extract(model, folder)
        instance: AnyInstance
        if name in self.isolated:
            instance = IsolatedInstance(name, model, folder, self.time_limit)
        else:
            instance = instantiate(name, model, folder)
        self._stack.callback(instance.free)
        self._instances[name] = instance
        instance.wire(
            self._table,
            outputs={v.name: self._places[f"{name}.{v.name}"] for v in model.outputs},
            inputs={
                sink.variable: (self._places[str(feed.source)], feed.transformation)
                for sink, feed in self._system.connections.items()
                if sink.component == name
            },
        )

    def _free(self) -> None:
        """Free what was loaded; what the FMUs say to that joins the warnings of the last run."""
        instances = {name: (instance, set(instance.warnings)) for name, instance in self._instances.items()}
        self._instances.clear()
        self._request = ()
        try:
            with self._careful():
                self._stack.close()
        finally:
            if self._diversion is not None:
                self._diversion.close()
            for name, (instance, known) in instances.items():
                self._warnings += [f"{name}: {text}" for text in instance.warnings if text not in known]

    @contextmanager
    def _careful(self) -> Iterator[None]:
        """Call FMUs: what they print does not reach our output, Ctrl-C waits until nothing is half done."""
        with critical_section(), self._diversion.on() if self._diversion is not None else nullcontext():
            yield

    def _outside(self) -> AbstractContextManager[None]:
        """Call a caller's own code from there: it has its standard output."""
        return self._diversion.off() if self._diversion is not None else nullcontext()

    def run(
        self,
        stop_time: float | None = None,
        step_size: float | None = None,
        parameters: Mapping[str, Value] | None = None,
        record: Iterable[str] | None = None,
        progress: Callable[[float], None] | None = None,
        *,
        algorithm: Algorithm | None = None,
        record_every: int = 1,
        sinks: Sequence[Sink] = (),
        keep: bool = True,
        real_time: bool = False,
        loop: StepperName | None = None,
    ) -> Result:
        """Initialise, step to the stop time, terminate.

        Parameters
        ----------
        stop_time, step_size
            In s; the first a multiple of the second. Where None, the system's.
        parameters
            ``component.variable`` to value; all others start from their defaults, whatever ran before.
        record
            Outputs to record as ``component.variable``; all where None.
        progress
            Called with the simulated time reached, in s, some twenty times a second or after each longer step.
        algorithm
            How values are exchanged; the system's where None.
        record_every
            N: rows of t_0, t_N, t_2N, ... and of the stop time are recorded.
        sinks
            What takes the rows as they come.
        keep
            Whether the result has them, too; where not, memory does not grow with the run.
        real_time
            Whether no step begins before its time has come.
        loop
            Which loop turns the crank: ``"c"`` or ``"python"``, with the same results; the first that can where None.

        Returns
        -------
        Result
            An incomplete one, with its ``error``, if an FMU failed or the user interrupted after the first step.

        Raises
        ------
        SetupError
            If something is wrong that can be seen before a run.
        RunError
            If an FMU failed while initialising.
        """
        ready = self._prepared(
            stop_time, step_size, None if record is None else tuple(record), algorithm, record_every, loop
        )
        with self._careful():
            try:
                self._set_up(ready, parameters or {})
            except BaseException as failure:
                self._terminate(0.0, failure)
                raise
            pacer = Pacer(ready.schedule.clock) if real_time else None
            with ready.recorder.recording(keep, sinks, self._outside):
                error: Exception | None = None
                try:
                    error = self._turn(ready, progress, pacer)
                finally:
                    error = self._terminate(ready.schedule.clock.time(ready.loop.done), error)
                ready.recorder.complete = error is None
        self._warnings = [f"{i.name}: {text}" for i in self._instances.values() for text in i.warnings]
        if isinstance(ready.loop, StdoutMonitor):
            self._warnings += ready.loop.warnings
        self._warnings[:0] = self._system.notes(settled=self._settled)
        rows = ready.recorder.recorded()
        return Result(
            time=rows[:, 0],
            values=dict(zip(ready.recorder.names, rows.T[1:], strict=True)) if keep else {},
            units=dict(zip(ready.recorder.names, ready.recorder.units, strict=True)),
            complete=error is None,
            error=error,
            warnings=self._warnings,
            loop=ready.loop_name,
            missed_deadlines=pacer.missed if pacer else 0,
            worst_lateness=pacer.worst if pacer else 0.0,
        )

    def _prepared(self, *request: Any) -> _Preparation:
        """Prepare a run, unless the last one was of the same kind."""
        if request != self._request:
            self._preparation, self._request = self._prepare(*request), request
        return self._preparation

    def _prepare(
        self,
        stop_time: float | None,
        step_size: float | None,
        record: tuple[str, ...] | None,
        algorithm: Algorithm | None,
        record_every: int,
        loop: StepperName | None,
    ) -> _Preparation:
        system = self._system
        check_choices(algorithm, record_every, loop)
        clock = system.clock(stop_time, step_size)
        names = system.recorded(record)
        rate = decimations(system.component_steps, list(system.models), clock)
        components = [ScheduledComponent(self._instances[name], rate[name]) for name in system.order]
        schedule = Schedule(components, (algorithm or system.algorithm) == "jacobi", clock, self._table, self._names)
        recorder = Recorder(
            schedule,
            names,
            units=[system.unit(name) for name in names],
            discrete=[system.models[n.component].is_discrete(n.variable) for n in map(VariableRef.parse, names)],
            every=record_every,
        )
        turning = self._loop_in_c(schedule, recorder) if stepper.load() and loop != "python" else None
        if turning is None and loop == "c":
            raise SetupError("loop: expected FMUs that can be called from C, got one in a process of its own")
        chosen: Stepper = turning or PythonStepper(schedule, recorder)
        here = [name for name in self._instances if name not in self.isolated]
        if self._diversion is not None and here:
            chosen = StdoutMonitor(chosen, schedule, recorder, here)
        return _Preparation(schedule, recorder, chosen, "c" if turning else "python")

    @staticmethod
    def _loop_in_c(schedule: Schedule, recorder: Recorder) -> stepper.NativeStepper | None:
        """Make the loop in C, if it can call all FMUs."""
        instances = [
            component.instance for component in schedule.components if isinstance(component.instance, Instance)
        ]
        calls = [call for instance in instances if (call := instance.calls()) is not None]
        return (
            stepper.NativeStepper(schedule, instances, calls, recorder)
            if len(calls) == len(schedule.components)
            else None
        )

    def _set_up(self, ready: _Preparation, parameters: Mapping[str, Value]) -> None:
        """Start all FMUs and pass initial outputs along the connections until they settle."""
        if tuple(parameters) != self._given:  # what becomes of inputs depends on names, not on values
            self._settled, self._given = self._system.settled(parameters), tuple(parameters)
        values = self._system.check(parameters, self._settled)
        self._table[:] = 0.0
        ready.loop.done = 0
        for instance in self._instances.values():
            instance.start(ready.schedule.clock.stop_time, values[instance.name])
            check()
        ready.loop.settle()
        for instance in self._instances.values():
            instance.finish_initialisation()
            check()
        ready.loop.read()

    def _turn(
        self, ready: _Preparation, progress: Callable[[float], None] | None, pacer: Pacer | None
    ) -> Exception | None:
        """Step to the end; returns why that was not reached."""
        schedule, recorder, loop = ready.schedule, ready.recorder, ready.loop

        def between(done: int) -> None:
            recorder.flush(done)
            if progress is not None:
                with self._outside():
                    progress(schedule.clock.time(done))

        try:
            run_in_chunks(loop, schedule, recorder.room, between, pacer)
            check_finite(schedule, schedule.clock.steps)
        except CosimError as failure:
            error: CosimError = failure
        except KeyboardInterrupt:
            error = RunError(f"interrupted at t = {schedule.clock.time(loop.done):g} s")
        else:
            recorder.last()
            return None
        recorder.flush(loop.done)
        return error

    def _terminate(self, time: float = 0.0, error: BaseException | None = None) -> Exception | None:
        """Terminate all FMUs at a time in s; one that fails to does not keep the others from it.

        Returns what went wrong first: ``error``, if it is not None.
        """
        for instance in self._instances.values():
            try:
                instance.terminate(time)
            except RunError as failure:
                error = error or failure
        try:
            check()
        except KeyboardInterrupt:
            error = error or RunError(f"interrupted at t = {time:g} s")
        return error if isinstance(error, Exception) else None


def check_isolation(system: Structure, components: Iterable[str], time_limit: float = TIME_LIMIT) -> None:
    """Check what to isolate.

    Raises
    ------
    SetupError
        With all problems found.
    """
    problems = [
        f"isolate {name}: expected a component among {', '.join(system.models) or 'none'}, got none of that name"
        + did_you_mean(name, system.models)
        for name in sorted(set(components).difference(system.models))
    ]
    if not 0.0 < time_limit <= MAX_TIME_LIMIT:
        problems.append(f"time limit: expected more than 0 and at most {MAX_TIME_LIMIT:g} s, got {time_limit} s")
    if problems:
        raise SetupError(*problems)


def check_choices(algorithm: Algorithm | None, record_every: int, loop: StepperName | None) -> None:
    """Check how a run is to be made.

    Raises
    ------
    SetupError
        With all problems found.
    """
    problems = []
    if algorithm is not None and algorithm not in ALGORITHMS:
        problems.append(f"algorithm: expected {' or '.join(ALGORITHMS)}, got {algorithm}")
    if not isinstance(record_every, int) or record_every < 1:
        problems.append(f"record every: expected a whole number of steps above 0, got {record_every}")
    if loop not in (None, "c", "python"):
        problems.append(f"loop: expected c or python, got {loop}")
    elif loop == "c" and stepper.load() is None:
        problems.append("loop: expected the one in C to be built, got none of this version; run: seat-cosim build")
    if problems:
        raise SetupError(*problems)
