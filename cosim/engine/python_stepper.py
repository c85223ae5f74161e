"""The master: the loop over the components in Python, and what goes on between chunks of steps of either loop."""

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
"""Longest time in s between two looks at the world outside: progress, sinks, interruption."""

_GROWTH = 8
"""How much longer a chunk may be than the one before: how fast the FMUs are is not known at first."""


def run_in_chunks(
    loop: Stepper, schedule: Schedule, room: int, between: Callable[[int], None], pacer: Pacer | None = None
) -> None:
    """Step to the end in chunks.

    Parameters
    ----------
    loop
        What steps.
    plan
        What it steps.
    room
        How many ticks may pass between two looks outside.
    between
        Called there, with the number of ticks that are complete.
    pacer
        Where the run is held to real time.

    Raises
    ------
    RunError
        If an FMU failed.
    KeyboardInterrupt
        If the user wants to end.
    """
    steps, tick, seen, size = schedule.clock.steps, 0, 0, 1
    looked = perf_counter()
    while tick < steps:
        if pacer is not None:
            pacer.wait(tick)
        begin = perf_counter()
        last = min(tick + size, steps)
        loop.run(tick, last)
        check()
        now = perf_counter()
        if pacer is None:
            size = max(1, min(room, _GROWTH * size, int(0.5 * CHUNK * (last - tick) / (now - begin))))
        tick = last
        if pacer is None or now - looked > 0.5 * CHUNK or tick - seen >= room or tick == steps:
            between(tick)
            looked, seen = now, tick
    if pacer is not None:
        pacer.wait(steps)


def check_finite(schedule: Schedule, tick: int) -> None:
    """Check that all values are numbers.

    Raises
    ------
    RunError
        If one is not.
    """
    finite = np.isfinite(schedule.table)
    if not finite.all():
        place = int(np.flatnonzero(~finite)[0])
        name, value, time = schedule.names[place], schedule.table[place], schedule.clock.time(tick)
        raise RunError(f"{name}: expected a finite output, got {value} at t = {time:g} s")


class PythonStepper:
    """The loop in Python; :class:`cosim.engine.native_stepper.NativeStepper` does the same.

    Parameters
    ----------
    plan
        What to step.
    recorder
        What records it.
    listening
        Whether to look after each component whether it has printed, which takes its time.

    Attributes
    ----------
    done
        Number of ticks that are complete.
    heard
        Whether anybody has printed.
    """

    def __init__(self, schedule: Schedule, recorder: Recorder, listening: bool = False) -> None:
        self._plan = schedule
        self._recorder = recorder
        self._groups = schedule.groups
        self._listening = listening
        self.done = 0
        self.heard = False

    def settle(self) -> None:
        """Pass initial outputs along the connections until they settle."""
        for _ in self._plan.components:  # the longest chain of connections without a loop
            before = self._plan.table.copy()
            for component in self._plan.components:
                with component.instance.calling("initial exchange"):
                    component.instance.set_inputs(0.0)
                    component.instance.get_outputs(0.0)
            if np.array_equal(before, self._plan.table, equal_nan=True):
                break

    def read(self) -> None:
        """Read all outputs."""
        for component in self._plan.components:
            with component.instance.calling("initial exchange"):
                component.instance.get_outputs(0.0)

    def run(self, first: int, last: int) -> None:
        """Step from one tick to another, recording."""
        for tick in range(first, last):
            check()
            check_finite(self._plan, tick)
            self._recorder.before(tick)
            for group in self._groups:
                self._step(group, tick)
            self._recorder.after(tick)
            self.done = tick + 1

    def _step(self, group: Sequence[ScheduledComponent], tick: int) -> None:
        """Step components that exchange nothing in between."""
        due = [component for component in group if tick % component.rate.every == 0]
        component, time = group[0], self._plan.clock.time(tick)
        try:
            for component in due:
                component.instance.set_inputs(time)
                self._listen(component, time)
            for component in due:
                for part in range(component.rate.parts):
                    time = component.rate.time(tick, part)
                    component.instance.advance(time, component.rate.step_size)
                    self._listen(component, time)
            time = self._plan.clock.time(tick)
            for component in group:
                _give(component, tick, time)
                self._listen(component, time)
        except RunError:
            raise
        except Exception as error:
            raise component.instance.failure(error, "doStep", time) from error

    def _listen(self, component: ScheduledComponent, time: float) -> None:
        if self._listening and component.instance.listen("doStep", time):
            self.heard = True


def _give(component: ScheduledComponent, tick: int, time: float) -> None:
    """Give a component's outputs: what is discrete where its step begins, what is continuous where it ends."""
    every = component.rate.every
    if every == 1:
        component.instance.get_outputs(time)
        return
    if tick % every == 0:
        component.instance.get_outputs(time, discrete=True)
    if (tick + 1) % every == 0:
        component.instance.get_outputs(time, discrete=False)
