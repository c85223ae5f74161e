"""Loaded FMUs of a system: extracted, instantiated and connected once, run any number of times, freed in every case."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from copy import copy
from os import getpid
from pathlib import Path
from typing import NamedTuple

import numpy as np

from cosim.engine import native_stepper
from cosim.engine.clock import Pacer
from cosim.engine.initialization import Initialization
from cosim.engine.layout import Layout, Sizes, layout_of
from cosim.engine.native_stepper import NativeStepper
from cosim.engine.python_stepper import PythonStepper, check_finite, run_in_chunks
from cosim.engine.recorder import Recorder
from cosim.engine.run_options import CheckedRun, RunOptions, isolation_problems, takes_run_options
from cosim.engine.schedule import Schedule, ScheduledComponent, Stepper
from cosim.engine.stdout_monitor import StdoutMonitor
from cosim.engine.structure import Structure
from cosim.errors import CosimError, RunError, SetupError
from cosim.fmi import python_modules
from cosim.fmi.description import ModelDescription
from cosim.fmi.instance import Experiment, Instance
from cosim.fmi.interrupts import Ended, check, check_ended, critical_section, deferring_signals
from cosim.fmi.isolated import TIME_LIMIT, AnyInstance, IsolatedInstance
from cosim.fmi.output_capture import OutputCapture
from cosim.fmi.temporary_folders import temporary_folder
from cosim.fmi.versions import instantiate
from cosim.results.result import Result, StepperName

_taken: dict[str, object] = {}
"""Tokens of FMUs that are instantiated in this process and allow one instance per process only, with who has them."""


class _Preparation(NamedTuple):
    """All of a run that does not depend on the values of its parameters."""

    schedule: Schedule
    recorder: Recorder
    stepper: Stepper
    stepper_name: StepperName


class Session:
    """A system whose FMUs are loaded; a context manager.

    Parameters
    ----------
    system
        What to load; later changes of it have no effect.
    isolate
        Components whose FMUs run in processes of their own.
    time_limit
        How long a call of an isolated FMU may take, in s.
    capture_stdout
        Whether what FMUs print becomes warnings; otherwise it goes to this process's standard output.

    Attributes
    ----------
    isolated
        Components that run in processes of their own, in the system's order.
    time_limit
        As given.

    Raises
    ------
    SetupError
        If a component to isolate does not exist or the time limit is out of range.
    """

    def __init__(
        self,
        system: Structure,
        isolate: Iterable[str] = (),
        time_limit: float = TIME_LIMIT,
        capture_stdout: bool = True,
    ) -> None:
        isolate = {isolate} if isinstance(isolate, str) else set(isolate)
        if problems := isolation_problems(system, isolate, time_limit):
            raise SetupError(*problems)
        self.isolated = [name for name in system.models if name in isolate]
        self.time_limit = time_limit
        self._system = copy(system)
        vars(self._system).update({name: copy(value) for name, value in vars(system).items()})
        self._capturing = capture_stdout
        self._capture: OutputCapture | None = None
        self._stack = ExitStack()
        self._process = getpid()
        self._owned: set[str] = set()
        self._instances: dict[str, AnyInstance] = {}
        self._warnings: list[str] = []
        self._load_notes: list[str] = []
        self._sizes: Sizes | None = None
        self._layout = Layout()
        self._values = np.zeros(0)
        self._checked: CheckedRun | None = None
        self._preparation: tuple[tuple[object, ...], _Preparation] | None = None

    def __enter__(self) -> Session:
        """Extract, instantiate and connect all FMUs."""
        self._process = getpid()
        self._capture = OutputCapture() if self._capturing else None
        self._stack.enter_context(deferring_signals())
        try:
            with self._calling_fmus():
                for name, model in self._system.models.items():
                    self._load(name, model)
                    check()
                self._lay_out(self._system.sizes({}))
        except BaseException:
            self._free()
            raise
        return self

    def __exit__(self, *exception: object) -> None:
        """Free all FMUs and remove their folders."""
        self._free()

    def _load(self, name: str, model: ModelDescription) -> None:
        folder = self._stack.enter_context(temporary_folder())
        model.extract(folder)
        instance: AnyInstance
        if name in self.isolated or self._must_be_isolated(name, model, folder):
            instance = IsolatedInstance(name, model, folder, self.time_limit)
        else:
            instance = instantiate(name, model, folder)
        self._stack.callback(instance.free)
        self._instances[name] = instance

    def _must_be_isolated(self, name: str, model: ModelDescription, folder: Path) -> bool:
        """Whether an FMU cannot run in this process; if it can, note what it takes there for itself."""
        reason = ""
        if self._is_taken(model):
            reason = "its FMU can be instantiated only once in a process"
        elif module := python_modules.claim(folder):
            reason = f"its Python module {module} is another one than the {module} of this process"
        if reason and os.name != "posix":
            raise SetupError(
                f"{name}: expected Linux or macOS, where it could run in a process of its own, got {sys.platform}; "
                f"it needs that as {reason}"
            )
        if reason:
            self._load_notes.append(f"{name}: runs in a process of its own, as {reason}")
        return bool(reason)

    def _is_taken(self, model: ModelDescription) -> bool:
        """Whether this process has an instance of an FMU already that allows one per process only."""
        if not model.description.coSimulation.canBeInstantiatedOnlyOncePerProcess:
            return False
        token = str(model.description.guid)
        if _taken.setdefault(token, self) is not self or token in self._owned:
            return True
        self._owned.add(token)
        self._stack.callback(_taken.pop, token)
        return False

    def _lay_out(self, sizes: Sizes) -> None:
        """Lay out the table of values and map all variables to it, unless that was done for the same sizes."""
        if sizes == self._sizes:
            return
        self._layout = layout_of(self._system, sizes)
        self._values = np.zeros(self._layout.size)
        for name, instance in self._instances.items():
            instance.map_variables(self._values, self._layout.mappings[name])
        order = {name: self._instances[name] for name in self._system.order}
        graph = self._system.dependencies("initialization")
        self._initialization = Initialization(order, self._layout.mappings, self._values, self._layout.names, graph)
        self._sizes, self._preparation = sizes, None

    def _free(self) -> None:
        """Free what was loaded; messages of the FMUs meanwhile join the warnings of the last run.

        A fork frees nothing: folders and processes are its parent's.
        """
        if getpid() != self._process:
            self._stack.pop_all()
            return
        instances = {name: (instance, set(instance.warnings)) for name, instance in self._instances.items()}
        self._instances.clear()
        self._preparation = None
        try:
            with self._calling_fmus():
                self._stack.close()
        finally:
            if self._capture is not None:
                self._capture.close()
            for name, (instance, known) in instances.items():
                self._warnings += [f"{name}: {text}" for text in instance.warnings if text not in known]

    @contextmanager
    def _calling_fmus(self) -> Iterator[None]:
        """Capture what FMUs print, and defer signals until nothing is left half done."""
        with critical_section(), self._capture.on() if self._capture is not None else nullcontext():
            yield

    def _callback_context(self) -> AbstractContextManager[None]:
        """Restore standard output for a caller's own code."""
        return self._capture.off() if self._capture is not None else nullcontext()

    @takes_run_options
    def run(self, options: RunOptions) -> Result:
        """Initialize, step to the stop time, terminate.

        Parameters
        ----------
        options
            Given as keyword arguments: the fields of :class:`cosim.engine.run_options.RunOptions`. Isolation and
            capture of standard output are the session's own.

        Returns
        -------
        Result
            An incomplete one, with its ``error``, if an FMU failed or the user interrupted after the first step.

        Raises
        ------
        SetupError
            If something is wrong that can be seen before a run.
        RunError
            If an FMU failed during initialization.
        """
        return self.execute(options)

    def execute(self, options: RunOptions, checked: CheckedRun | None = None) -> Result:
        """Run with given options, see :meth:`run`.

        Parameters
        ----------
        options
            Of the run.
        checked
            What :meth:`RunOptions.check` returned for this session's system, where it was called already.
        """
        if getpid() != self._process:
            raise SetupError(
                f"session: expected the process that loaded the FMUs ({self._process}), got a fork of it "
                f"({getpid()}); open a session there, or start processes with spawn"
            )
        check_ended()
        checked = self._checked = checked or options.check(self._system, self._checked)
        with self._calling_fmus():
            self._lay_out(checked.sizes)
        prepared = self._prepared(options, checked)
        stepper, recorder, clock = prepared.stepper, prepared.recorder, checked.clock
        with self._calling_fmus():
            try:
                self._initialize(prepared, checked, options)
            except BaseException as failure:
                self._terminate(clock.start_time, failure)
                raise
            pacer = Pacer(clock) if options.real_time else None
            with recorder.recording(options.keep, options.sinks, self._callback_context):
                error: Exception | None = None
                try:
                    error = self._step(prepared, options, pacer)
                finally:
                    error = self._terminate(clock.time(stepper.done), error)
                recorder.complete = error is None
        self._warnings = [f"{i.name}: {text}" for i in self._instances.values() for text in i.warnings]
        if isinstance(stepper, StdoutMonitor):
            self._warnings += stepper.warnings
        self._warnings[:0] = [*checked.notes, *self._load_notes]
        rows = recorder.recorded()
        return Result(
            time=rows[:, 0],
            values=dict(zip(recorder.names, rows.T[1:], strict=True)) if options.keep else {},
            units=dict(zip(recorder.names, recorder.units, strict=True)),
            complete=error is None,
            error=error,
            warnings=self._warnings,
            stepper=prepared.stepper_name,
            missed_deadlines=pacer.missed if pacer else 0,
            worst_lateness=pacer.worst if pacer else 0.0,
        )

    def _prepared(self, options: RunOptions, checked: CheckedRun) -> _Preparation:
        """Prepare a run, unless the one before was of the same kind."""
        if self._preparation is None or self._preparation[0] != checked.key:
            self._preparation = checked.key, self._prepare(options, checked)
        return self._preparation[1]

    def _prepare(self, options: RunOptions, checked: CheckedRun) -> _Preparation:
        system, names = self._system, checked.record
        components = [ScheduledComponent(self._instances[name], checked.decimations[name]) for name in system.order]
        jacobi = (options.algorithm or system.algorithm) == "jacobi"
        schedule = Schedule(components, jacobi, checked.clock, self._values, self._layout.names)
        recorder = Recorder(
            schedule,
            names,
            units=[system.unit(name) for name in names],
            sampled=[system.is_sampled(system.parse(name)) for name in names],
            every=options.record_every,
        )
        native = self._native_stepper(schedule, recorder) if options.stepper != "python" else None
        if native is None and options.stepper == "c":
            raise SetupError("stepper: expected FMUs that can be called from C, got one in a process of its own")
        stepper: Stepper = native or PythonStepper(schedule, recorder)
        in_process = [name for name, instance in self._instances.items() if isinstance(instance, Instance)]
        if self._capture is not None and in_process:
            stepper = StdoutMonitor(stepper, schedule, recorder, in_process)
        return _Preparation(schedule, recorder, stepper, "c" if native else "python")

    @staticmethod
    def _native_stepper(schedule: Schedule, recorder: Recorder) -> NativeStepper | None:
        """Make the loop in C, if it is built and can call all FMUs."""
        if native_stepper.load() is None:
            return None
        instances = [c.instance for c in schedule.components if isinstance(c.instance, Instance)]
        calls = [call for instance in instances if (call := instance.native_calls()) is not None]
        return NativeStepper(schedule, instances, calls, recorder) if len(calls) == len(schedule.components) else None

    def _initialize(self, prepared: _Preparation, checked: CheckedRun, options: RunOptions) -> None:
        """Initialize all FMUs and exchange initial values along the connections."""
        clock = checked.clock
        self._values[:] = 0.0
        self._values[len(self._layout.names) :] = self._layout.constant_values(self._system, checked.values)
        prepared.stepper.begin()
        for name, instance in self._instances.items():
            tolerance = instance.model.default_tolerance if options.tolerance is None else options.tolerance
            stop_time = checked.decimations[name].stop_time(clock)
            instance.enter_initialization(Experiment(clock.start_time, stop_time, tolerance), checked.values[name])
            check()
        self._initialization.run(clock.start_time)
        for instance in self._instances.values():
            instance.exit_initialization()
            check()
        for name in self._system.order:
            with self._instances[name].calling("initial exchange", clock.start_time):
                self._instances[name].get_outputs(clock.start_time)

    def _step(self, prepared: _Preparation, options: RunOptions, pacer: Pacer | None) -> Exception | None:
        """Step to the end; returns why that was not reached."""
        schedule, recorder, stepper = prepared.schedule, prepared.recorder, prepared.stepper
        clock = schedule.clock

        def between(done: int) -> None:
            recorder.flush(done)
            if options.progress is not None:
                with self._callback_context():
                    options.progress(clock.time(done))

        try:
            run_in_chunks(stepper, schedule, recorder.capacity, between, pacer)
            check_finite(schedule, clock.steps)
        except CosimError as failure:
            error: CosimError = failure
        except KeyboardInterrupt:
            error = RunError(f"interrupted at t = {clock.time(stepper.done):g} s")
        except Ended as ended:
            error = RunError(f"{ended} at t = {clock.time(stepper.done):g} s")
        except BaseException:  # of the caller's own code
            recorder.flush(stepper.done)
            raise
        else:
            recorder.record_last()
            return None
        recorder.flush(stepper.done)
        return error

    def _terminate(self, time: float = 0.0, error: BaseException | None = None) -> Exception | None:
        """Terminate all FMUs at a time in s, also where one of them fails.

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
        except Ended as ended:
            error = error or RunError(f"{ended} at t = {time:g} s")
        return error if isinstance(error, Exception) else None
