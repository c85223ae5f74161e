"""The master: the loop over the components in Python, and what goes on between chunks of steps of either loop."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from time import perf_counter

import numpy as np

from cosim.engine.clock import Pacer
from cosim.engine.recorder import Recorder
from cosim.engine.schedule import Loop, Plan, Turn
from cosim.errors import RunError
from cosim.fmi.interrupts import check

CHUNK = 0.05
"""Longest time in s between two looks at the world outside: progress, sinks, interruption."""

_GROWTH = 8
"""How much longer a chunk may be than the one before: how fast the FMUs are is not known at first."""


def crank(loop: Loop, plan: Plan, room: int, between: Callable[[int], None], pacer: Pacer | None = None) -> None:
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
    steps, tick, seen, size = plan.clock.steps, 0, 0, 1
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


def watch(plan: Plan, tick: int) -> None:
    """Check that all values are numbers.

    Raises
    ------
    RunError
        If one is not.
    """
    finite = np.isfinite(plan.table)
    if not finite.all():
        place = int(np.flatnonzero(~finite)[0])
        name, value, time = plan.names[place], plan.table[place], plan.clock.time(tick)
        raise RunError(f"{name}: expected a finite output, got {value} at t = {time:g} s")


class PythonLoop:
    """The loop in Python; :class:`cosim.engine.native_stepper.CLoop` does the same.

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

    def __init__(self, plan: Plan, recorder: Recorder, listening: bool = False) -> None:
        self._plan = plan
        self._recorder = recorder
        self._groups = plan.groups
        self._listening = listening
        self.done = 0
        self.heard = False

    def settle(self) -> None:
        """Pass initial outputs along the connections until they settle."""
        for _ in self._plan.turns:  # the longest chain of connections without a loop
            before = self._plan.table.copy()
            for turn in self._plan.turns:
                with turn.instance.calling("initial exchange"):
                    turn.instance.take_inputs(0.0)
                    turn.instance.give_outputs(0.0)
            if np.array_equal(before, self._plan.table, equal_nan=True):
                break

    def read(self) -> None:
        """Read all outputs."""
        for turn in self._plan.turns:
            with turn.instance.calling("initial exchange"):
                turn.instance.give_outputs(0.0)

    def run(self, first: int, last: int) -> None:
        """Step from one tick to another, recording."""
        for tick in range(first, last):
            check()
            watch(self._plan, tick)
            self._recorder.before(tick)
            for group in self._groups:
                self._step(group, tick)
            self._recorder.after(tick)
            self.done = tick + 1

    def _step(self, group: Sequence[Turn], tick: int) -> None:
        """Step components that exchange nothing in between."""
        due = [turn for turn in group if tick % turn.rate.every == 0]
        turn, time = group[0], self._plan.clock.time(tick)
        try:
            for turn in due:
                turn.instance.take_inputs(time)
                self._listen(turn, time)
            for turn in due:
                for part in range(turn.rate.parts):
                    time = turn.rate.time(tick, part)
                    turn.instance.advance(time, turn.rate.step_size)
                    self._listen(turn, time)
            time = self._plan.clock.time(tick)
            for turn in group:
                _give(turn, tick, time)
                self._listen(turn, time)
        except RunError:
            raise
        except Exception as error:
            raise turn.instance.failure(error, "doStep", time) from error

    def _listen(self, turn: Turn, time: float) -> None:
        if self._listening and turn.instance.listen("doStep", time):
            self.heard = True


def _give(turn: Turn, tick: int, time: float) -> None:
    """Give a component's outputs: what is discrete where its step begins, what is continuous where it ends."""
    every = turn.rate.every
    if every == 1:
        turn.instance.give_outputs(time)
        return
    if tick % every == 0:
        turn.instance.give_outputs(time, discrete=True)
    if (tick + 1) % every == 0:
        turn.instance.give_outputs(time, discrete=False)
