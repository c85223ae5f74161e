"""Loaded FMUs of a system: extracted, instantiated and wired once, run as often as wanted, freed whatever happens."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from cosim.clock import Clock
from cosim.errors import CosimError, RunError
from cosim.instance import Instance, extract, instantiate
from cosim.master import Observer, gauss_seidel
from cosim.model import Value
from cosim.results import Result
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
    """Stops a run in which an FMU gives something that is no number."""

    def __init__(self, table: np.ndarray[Any, Any], names: list[str], clock: Clock) -> None:
        self._table = table
        self._names = names
        self._clock = clock

    def before(self, tick: int) -> None:
        """Check all values at t_k."""
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


class Session:
    """A system whose FMUs are loaded; a context manager.

    Parameters
    ----------
    system
        What to load; later changes of it do not count.
    """

    def __init__(self, system: Structure) -> None:
        self._system = system
        self._stack = ExitStack()
        self._instances: dict[str, Instance] = {}
        self._names = system.outputs()
        self._places = {name: place for place, name in enumerate(self._names)}
        self._table = np.zeros(len(self._names))

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
            An incomplete one, with its ``error``, if an FMU failed or the user interrupted after the first step.

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
        order = [self._instances[name] for name in self._system.order]
        self._initialise(clock.stop_time, values)
        recorder = Recorder(
            self._table,
            [self._places[name] for name in recorded],
            [self._is_discrete(n) for n in recorded],
            clock.steps + 1,
        )
        watch = Watch(self._table, self._names, clock)
        observers: list[Observer] = [watch, recorder]
        if progress is not None:
            observers.append(Progress(progress, clock))
        error: Exception | None = None
        try:
            gauss_seidel(order, clock, observers)
            watch.before(clock.steps)
            recorder.last(clock.steps)
        except CosimError as failure:
            error = failure
        except KeyboardInterrupt:
            error = RunError(f"interrupted at t = {clock.time(recorder.rows_filled):g} s")
        error = self._terminate() or error
        return Result(
            time=np.array([clock.time(tick) for tick in range(recorder.rows_filled)]),
            values=dict(zip(recorded, recorder.columns(), strict=True)),
            units={name: self._system.unit(name) for name in recorded},
            complete=error is None,
            error=error,
            warnings=[f"{i.name}: {text}" for i in self._instances.values() for text in i.warnings],
        )

    def _is_discrete(self, name: str) -> bool:
        component, _, variable = name.partition(".")
        return bool(self._system.models[component].variables[variable].variability != "continuous")

    def _initialise(self, stop_time: float, values: Mapping[str, Mapping[str, float | str]]) -> None:
        """Start all FMUs and pass initial outputs along the connections until they settle."""
        instances = self._instances.values()
        self._table[:] = 0.0
        for instance in instances:
            instance.start(stop_time, values[instance.name])
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
            with instance.calling("initial exchange"):
                instance.give_outputs()

    def _terminate(self) -> Exception | None:
        """Terminate all FMUs; one that fails to does not keep the others from it."""
        error: Exception | None = None
        for instance in self._instances.values():
            try:
                instance.terminate()
            except RunError as failure:
                error = error or failure
        return error
