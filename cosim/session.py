"""Loaded FMUs of a system: extracted, instantiated and wired once, run as often as wanted, freed whatever happens."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, nullcontext
from pathlib import Path
from typing import Any

import numpy as np

from cosim.clock import Clock
from cosim.errors import CosimError, RunError, SetupError
from cosim.instance import extract, instantiate
from cosim.interrupts import check, held, watched
from cosim.isolated import MAX_TIME_LIMIT, TIME_LIMIT, IsolatedInstance, Slave
from cosim.master import Observer, gauss_seidel
from cosim.model import Model, Value, nearest
from cosim.results import Result
from cosim.stdout import Diversion, printed
from cosim.structure import Structure

PROGRESS_EVERY = 256
"""Ticks between two calls of a progress function."""


class Recorder:
    """Fills a table row by row: continuous outputs as a step finds them, discrete ones as it leaves them."""

    def __init__(self, table: np.ndarray[Any, Any], places: list[int], discrete: list[bool], rows: int) -> None:
        self._table = table
        self._rows = np.zeros((rows, len(places)))
        self._continuous = np.flatnonzero(~np.array(discrete, dtype=bool))
        self._discrete = np.flatnonzero(np.array(discrete, dtype=bool))
        self._places = np.array(places, dtype=int)
        self.rows_filled = 0

    def before(self, tick: int) -> None:
        """Record what is continuous."""
        self._rows[tick, self._continuous] = self._table[self._places[self._continuous]]

    def after(self, tick: int) -> None:
        """Record what is discrete; with that the row is complete."""
        self._rows[tick, self._discrete] = self._table[self._places[self._discrete]]
        self.rows_filled = tick + 1

    def last(self, tick: int) -> None:
        """Record the last row, which no step follows."""
        self._rows[tick] = self._table[self._places]
        self.rows_filled = tick + 1

    def columns(self) -> list[np.ndarray[Any, Any]]:
        """Return the recorded values, one array an output."""
        return [self._rows[: self.rows_filled, i].copy() for i in range(len(self._places))]


class Watch:
    """Stops a run in which an FMU gives something that is no number, or the user wants to end."""

    def __init__(self, table: np.ndarray[Any, Any], names: list[str], clock: Clock) -> None:
        self._table = table
        self._names = names
        self._clock = clock

    def before(self, tick: int) -> None:
        """Check all values at t_k, and whether the user wants to end."""
        check()
        if np.isfinite(self._table).all():
            return
        place = int(np.flatnonzero(~np.isfinite(self._table))[0])
        name, value, time = self._names[place], self._table[place], self._clock.time(tick)
        raise RunError(f"{name}: expected a finite output, got {value} at t = {time:g} s")

    def after(self, tick: int) -> None:
        """Nothing: the next step or the end looks again."""


class Progress:
    """Calls a function with the time reached, every few ticks."""

    def __init__(self, report: Callable[[float], None], clock: Clock) -> None:
        self._report = report
        self._clock = clock

    def before(self, tick: int) -> None:
        """Nothing."""

    def after(self, tick: int) -> None:
        """Report every few ticks and at the end."""
        if (tick + 1) % PROGRESS_EVERY == 0 or tick + 1 == self._clock.steps:
            self._report(self._clock.time(tick + 1))


class Printing:
    """Says that one of several components printed while they stepped; once, as looking costs a little."""

    def __init__(self, components: list[str], clock: Clock) -> None:
        self._who = " or ".join(components)
        self._clock = clock
        self._since = 0
        self.warnings: list[str] = []

    def before(self, tick: int) -> None:
        """Nothing."""

    def after(self, tick: int) -> None:
        """Look every few ticks and at the end."""
        if (tick + 1) % PROGRESS_EVERY == 0 or tick + 1 == self._clock.steps:
            self.look(tick + 1)

    def look(self, tick: int) -> None:
        """Look what was printed up to t_k."""
        text = printed()
        if text and not self.warnings:
            first, last = self._clock.time(self._since), self._clock.time(tick)
            self.warnings.append(f"{self._who}: printed to stdout in doStep at t = {first:g} to {last:g} s: {text}")
        self._since = tick


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
        self._system = system
        self._isolate = _isolated(system, isolate, time_limit)
        self._time_limit = time_limit
        self._divert = divert_stdout
        self._diversion: Diversion | None = None
        self._stack = ExitStack()
        self._instances: dict[str, Slave] = {}
        self._warnings: list[str] = []
        self._names = system.outputs()
        self._places = {name: place for place, name in enumerate(self._names)}
        self._table = np.zeros(len(self._names))

    def __enter__(self) -> Session:
        """Extract, instantiate and wire all FMUs."""
        self._diversion = Diversion() if self._divert else None
        self._stack.enter_context(watched())
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

    def _load(self, name: str, model: Model) -> None:
        folder = self._stack.enter_context(tempfile.TemporaryDirectory(prefix=f"seat-cosim-{name}-"))
        extract(model, Path(folder))
        instance: Slave
        if name in self._isolate:
            instance = IsolatedInstance(name, model, Path(folder), self._time_limit)
        else:
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

    def _free(self) -> None:
        """Free what was loaded; what the FMUs say to that joins the warnings of the last run."""
        instances = {name: (instance, set(instance.warnings)) for name, instance in self._instances.items()}
        self._instances.clear()
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
        with held(), self._diversion.on() if self._diversion is not None else nullcontext():
            yield

    def _outside(self, report: Callable[[float], None]) -> Callable[[float], None]:
        """Let a function of the caller have its standard output."""
        diversion = self._diversion
        if diversion is None:
            return report

        def undiverted(time: float) -> None:
            with diversion.off():
                report(time)

        return undiverted

    def run(
        self,
        stop_time: float | None = None,
        step_size: float | None = None,
        parameters: Mapping[str, Value] | None = None,
        record: Iterable[str] | None = None,
        progress: Callable[[float], None] | None = None,
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
            Called with the simulated time reached, in s.

        Returns
        -------
        Result
            An incomplete one, with its ``error``, if an FMU failed or the user interrupted while stepping.

        Raises
        ------
        SetupError
            If something is wrong that can be seen before a run.
        RunError
            If an FMU failed while initialising.
        """
        clock = self._system.clock(stop_time, step_size)
        values = self._system.check(parameters or {})
        recorded = self._system.recorded(record)
        recorder = Recorder(
            self._table,
            [self._places[name] for name in recorded],
            [self._is_discrete(n) for n in recorded],
            clock.steps + 1,
        )
        printing = Printing([name for name in self._instances if name not in self._isolate], clock)
        with self._careful():
            error = self._initialise_and_step(clock, values, recorder, printing, progress)
            printing.look(recorder.rows_filled)
            error = self._terminate(clock.time(max(recorder.rows_filled - 1, 0)), error)
        self._warnings = [f"{i.name}: {text}" for i in self._instances.values() for text in i.warnings]
        self._warnings += printing.warnings
        return Result(
            time=np.array([clock.time(tick) for tick in range(recorder.rows_filled)]),
            values=dict(zip(recorded, recorder.columns(), strict=True)),
            units={name: self._system.unit(name) for name in recorded},
            complete=error is None,
            error=error,
            warnings=self._warnings,
        )

    def _initialise_and_step(
        self,
        clock: Clock,
        values: Mapping[str, Mapping[str, float | str]],
        recorder: Recorder,
        printing: Printing,
        progress: Callable[[float], None] | None,
    ) -> Exception | None:
        """Return why a run ended early, or None."""
        try:
            self._initialise(clock.stop_time, values)
        except BaseException as error:
            self._terminate(0.0, error)
            raise
        watch = Watch(self._table, self._names, clock)
        observers: list[Observer] = [watch, recorder, printing]
        if progress is not None:
            observers.append(Progress(self._outside(progress), clock))
        try:
            gauss_seidel([self._instances[name] for name in self._system.order], clock, observers)
            watch.before(clock.steps)
            recorder.last(clock.steps)
        except CosimError as failure:
            return failure
        except KeyboardInterrupt:
            return RunError(f"interrupted at t = {clock.time(recorder.rows_filled):g} s")
        return None

    def _is_discrete(self, name: str) -> bool:
        component, _, variable = name.partition(".")
        return bool(self._system.models[component].variables[variable].variability != "continuous")

    def _initialise(self, stop_time: float, values: Mapping[str, Mapping[str, float | str]]) -> None:
        """Start all FMUs and pass initial outputs along the connections until they settle."""
        instances = self._instances.values()
        self._table[:] = 0.0
        for instance in instances:
            instance.start(stop_time, values[instance.name])
            check()
        for _ in instances:  # the longest chain of connections without a loop
            before = self._table.copy()
            for instance in instances:
                with instance.calling("initial exchange"):
                    instance.take_inputs()
                    instance.give_outputs()
            if np.array_equal(before, self._table, equal_nan=True):
                break
        for instance in instances:
            instance.finish_initialisation()
            check()
            with instance.calling("initial exchange"):
                instance.give_outputs()

    def _terminate(self, time: float, error: BaseException | None) -> Exception | None:
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


def _isolated(system: Structure, components: Iterable[str], time_limit: float) -> frozenset[str]:
    """Check what to isolate."""
    components = frozenset(components)
    problems = [
        f"isolate {name}: expected a component among {', '.join(system.models) or 'none'}, got none of that name"
        + nearest(name, system.models)
        for name in sorted(components.difference(system.models))
    ]
    if not 0.0 < time_limit <= MAX_TIME_LIMIT:
        problems.append(f"time limit: expected more than 0 and at most {MAX_TIME_LIMIT:g} s, got {time_limit} s")
    if problems:
        raise SetupError(*problems)
    return components
