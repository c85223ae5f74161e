"""Loaded FMUs of a system: extracted, instantiated and wired once, run as often as wanted, freed whatever happens."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from copy import copy
from pathlib import Path
from typing import Any, NamedTuple, TypedDict

import numpy as np

from cosim import stepper
from cosim.clock import Pacer
from cosim.errors import CosimError, RunError, SetupError
from cosim.instance import Instance, extract, instantiate
from cosim.master import PythonLoop, crank, watch
from cosim.model import Value
from cosim.plan import Loop, Plan, Turn, rates
from cosim.recording import Recorder
from cosim.results import LoopName, Result, Sink
from cosim.structure import ALGORITHMS, Algorithm, Port, Structure


class Options(TypedDict, total=False):
    """How a run is made, beyond what is run; see :meth:`Session.run`."""

    algorithm: Algorithm | None
    record_every: int
    sinks: Sequence[Sink]
    keep: bool
    real_time: bool
    loop: LoopName | None


class _Preparation(NamedTuple):
    """All of a run that does not depend on the values of its parameters."""

    plan: Plan
    recorder: Recorder
    loop: Loop


class Session:
    """A system whose FMUs are loaded; a context manager.

    Parameters
    ----------
    system
        What to load; later changes of it do not count.
    """

    def __init__(self, system: Structure) -> None:
        self._system = copy(system)
        vars(self._system).update({name: copy(value) for name, value in vars(system).items()})
        self._stack = ExitStack()
        self._instances: dict[str, Instance] = {}
        self._names = self._system.outputs()
        self._places = {name: place for place, name in enumerate(self._names)}
        self._table = np.zeros(len(self._names))
        self._request: tuple[object, ...] = ()
        self._preparation: _Preparation

    def __enter__(self) -> Session:
        """Extract, instantiate and wire all FMUs."""
        try:
            for name, model in self._system.models.items():
                folder = self._stack.enter_context(tempfile.TemporaryDirectory(prefix="seat-cosim-"))
                extract(model, Path(folder))
                instance = instantiate(name, model, Path(folder))
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
        except BaseException:
            self._stack.close()
            raise
        return self

    def __exit__(self, *exception: object) -> None:
        """Free all FMUs and remove their folders."""
        self._instances.clear()
        self._stack.close()

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
        loop: LoopName | None = None,
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
        self._set_up(ready, parameters or {})
        pacer = Pacer(ready.plan.clock) if real_time else None
        with ready.recorder.recording(keep, sinks):
            ended: Exception | None = None
            try:
                error = _turn(ready, progress, pacer)
            finally:
                ended = self._terminate()
            error = error or ended
            ready.recorder.complete = error is None
        rows = ready.recorder.recorded()
        return Result(
            time=rows[:, 0],
            values=dict(zip(ready.recorder.names, rows.T[1:], strict=True)) if keep else {},
            units=dict(zip(ready.recorder.names, ready.recorder.units, strict=True)),
            complete=error is None,
            error=error,
            warnings=[
                *self._system.notes(parameters or {}),
                *(f"{i.name}: {text}" for i in self._instances.values() for text in i.warnings),
            ],
            loop="c" if isinstance(ready.loop, stepper.CLoop) else "python",
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
        loop: LoopName | None,
    ) -> _Preparation:
        system = self._system
        check_choices(algorithm, record_every, loop)
        clock = system.clock(stop_time, step_size)
        names = system.recorded(record)
        rate = rates(system.component_steps, list(system.models), clock)
        turns = [Turn(self._instances[name], rate[name]) for name in system.order]
        plan = Plan(turns, (algorithm or system.algorithm) == "jacobi", clock, self._table, self._names)
        recorder = Recorder(
            plan,
            names,
            units=[system.unit(name) for name in names],
            discrete=[self._instances[n.component].is_discrete(n.variable) for n in map(Port.parse, names)],
            every=record_every,
        )
        calls = [turn.instance.calls() for turn in turns] if stepper.load() and loop != "python" else [None]
        callable_ = [call for call in calls if call is not None]
        if len(callable_) == len(calls):
            return _Preparation(plan, recorder, stepper.CLoop(plan, callable_, recorder))
        if loop == "c":
            raise SetupError("loop: expected FMUs that can be called from C, got one in a process of its own")
        return _Preparation(plan, recorder, PythonLoop(plan, recorder))

    def _set_up(self, ready: _Preparation, parameters: Mapping[str, Value]) -> None:
        """Start all FMUs and pass initial outputs along the connections until they settle."""
        values = self._system.check(parameters)
        self._table[:] = 0.0
        ready.loop.done = 0
        for instance in self._instances.values():
            instance.start(ready.plan.clock.stop_time, values[instance.name])
        ready.loop.settle()
        for instance in self._instances.values():
            instance.finish_initialisation()
        ready.loop.read()

    def _terminate(self) -> Exception | None:
        """Terminate all FMUs; one that fails to does not keep the others from it."""
        error: Exception | None = None
        for instance in self._instances.values():
            try:
                instance.terminate()
            except RunError as failure:
                error = error or failure
        return error


def check_choices(algorithm: Algorithm | None, record_every: int, loop: LoopName | None) -> None:
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


def _turn(ready: _Preparation, progress: Callable[[float], None] | None, pacer: Pacer | None) -> Exception | None:
    """Step to the end; returns why that was not reached."""
    plan, recorder, loop = ready.plan, ready.recorder, ready.loop

    def between(done: int) -> None:
        recorder.flush(done)
        if progress is not None:
            progress(plan.clock.time(done))

    try:
        crank(loop, plan, recorder.room, between, pacer)
        watch(plan, plan.clock.steps)
    except CosimError as failure:
        error: CosimError = failure
    except KeyboardInterrupt:
        error = RunError(f"interrupted at t = {plan.clock.time(loop.done):g} s")
    else:
        recorder.last()
        return None
    recorder.flush(loop.done)
    return error
