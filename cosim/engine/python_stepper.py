"""The master's loop in Python, and what happens between chunks of steps of either loop."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from time import perf_counter

import numpy as np

from cosim.engine.clock import Pacer
from cosim.engine.recorder import Recorder
from cosim.engine.schedule import Schedule, ScheduledComponent, Stepper
from cosim.errors import RunError
from cosim.fmi.interrupts import check

CHUNK = 0.05
"""Longest time in s between two calls of progress and sinks and two checks for an interrupt."""

_GROWTH = 8
"""How many times longer a chunk may be than the one before: the speed of the FMUs is not known at first."""


def run_in_chunks(
    stepper: Stepper, schedule: Schedule, capacity: int, between: Callable[[int], None], pacer: Pacer | None = None
) -> None:
    """Step to the end in chunks.

    Parameters
    ----------
    stepper
        Steps the components.
    schedule
        What it follows.
    capacity
        How many ticks may pass between two calls of ``between``.
    between
        Called after chunks, with the number of ticks that are complete.
    pacer
        Holds the run to real time, where it is given.

    Raises
    ------
    RunError
        If an FMU failed.
    KeyboardInterrupt
        If the user interrupted.
    """
    steps, tick, flushed, size = schedule.clock.steps, 0, 0, 1
    last_call = perf_counter()
    while tick < steps:
        if pacer is not None:
            pacer.wait(tick)
        begin = perf_counter()
        last = min(tick + size, steps)
        stepper.run(tick, last)
        check()
        now = perf_counter()
        if pacer is None:
            size = max(1, min(capacity, _GROWTH * size, int(0.5 * CHUNK * (last - tick) / (now - begin))))
        tick = last
        if pacer is None or now - last_call > 0.5 * CHUNK or tick - flushed >= capacity or tick == steps:
            between(tick)
            last_call, flushed = now, tick
    if pacer is not None:
        pacer.wait(steps)


def check_finite(schedule: Schedule, tick: int) -> None:
    """Check that all outputs are finite.

    Parameters
    ----------
    schedule
        Whose values.
    tick
        For the message.

    Raises
    ------
    RunError
        With the first output that is not.
    """
    finite = np.isfinite(schedule.values)
    if not finite.all():
        index = int(np.flatnonzero(~finite)[0])
        name, value, time = schedule.names[index], schedule.values[index], schedule.clock.time(tick)
        raise RunError(f"{name}: expected a finite output, got {value} at t = {time:g} s")


class PythonStepper:
    """The loop in Python; :class:`cosim.engine.native_stepper.NativeStepper` does the same.

    Parameters
    ----------
    schedule
        What to follow.
    recorder
        Records the values.
    collect_stdout
        Whether to collect after each call what the component has printed, which takes time.

    Attributes
    ----------
    done
        Number of ticks that are complete.
    attributed
        Whether something that was printed has been attributed to a component.
    """

    def __init__(self, schedule: Schedule, recorder: Recorder, collect_stdout: bool = False) -> None:
        self._schedule = schedule
        self._recorder = recorder
        self._groups = schedule.groups
        self._collecting = collect_stdout
        self.done = 0
        self.attributed = False

    def begin(self) -> None:
        """Begin a run."""
        self.done = 0

    def run(self, first: int, last: int) -> None:
        """Step from one tick to another and record."""
        for tick in range(first, last):
            check()
            check_finite(self._schedule, tick)
            self._recorder.before(tick)
            for group in self._groups:
                self._step(group, tick)
            self._recorder.after(tick)
            self.done = tick + 1

    def _step(self, group: Sequence[ScheduledComponent], tick: int) -> None:
        """Step components that exchange no values in between."""
        due = [component for component in group if tick % component.decimation.factor == 0]
        component, time = group[0], self._schedule.clock.time(tick)
        try:
            for component in due:
                component.instance.set_inputs(time)
                self._collect_stdout(component, time)
            for component in due:
                for substep in range(component.decimation.substeps):
                    time = component.decimation.time(tick, substep)
                    component.instance.do_step(time, component.decimation.step_size)
                    self._collect_stdout(component, time)
            time = self._schedule.clock.time(tick)
            for component in group:
                _get_due_outputs(component, tick, time)
                self._collect_stdout(component, time)
        except RunError:
            raise
        except Exception as error:
            raise component.instance.failure(error, "doStep", time) from error

    def _collect_stdout(self, component: ScheduledComponent, time: float) -> None:
        if self._collecting and component.instance.collect_stdout("doStep", time):
            self.attributed = True


def _get_due_outputs(component: ScheduledComponent, tick: int, time: float) -> None:
    """Get a component's outputs: samples where its step begins, all others where it ends."""
    factor = component.decimation.factor
    if factor == 1:
        component.instance.get_outputs(time)
        return
    if tick % factor == 0:
        component.instance.get_outputs(time, sampled=True)
    if (tick + 1) % factor == 0:
        component.instance.get_outputs(time, sampled=False)
