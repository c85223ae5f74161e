"""Who prints while FMUs step: found out without a look after every call, which would cost more than most steps."""

from __future__ import annotations

from collections.abc import Sequence

from cosim.engine.python_stepper import PythonStepper
from cosim.engine.recorder import Recorder
from cosim.engine.schedule import Schedule, Stepper
from cosim.fmi.output_capture import printed


class StdoutMonitor:
    """A loop, and a look after every chunk of its steps at what was printed.

    What turns up there may be anybody's. So the next tick is turned in Python, with a look after each component: that
    finds who prints in every step. Who prints but once stays one of many.

    Parameters
    ----------
    loop
        What turns the crank.
    plan, recorder
        Its own.
    names
        Components that may print: those in this process.

    """

    def __init__(self, loop: Stepper, schedule: Schedule, recorder: Recorder, names: Sequence[str]) -> None:
        self._loop = loop
        self._alone = PythonStepper(schedule, recorder, listening=True)
        self._clock = schedule.clock
        self._who = " or ".join(names)
        self._wondering = False
        self._told: dict[str, str] = {}

    @property
    def warnings(self) -> list[str]:
        """What was printed in this run by nobody knows whom."""
        return list(self._told.values())

    @property
    def done(self) -> int:
        """Number of ticks that are complete."""
        return self._loop.done

    @done.setter
    def done(self, ticks: int) -> None:
        self._loop.done = ticks

    def settle(self) -> None:
        """Pass initial outputs along the connections until they settle."""
        self._told.clear()
        self._wondering = self._alone.heard = False
        try:
            self._loop.settle()
        finally:
            self._look(0, 0)

    def read(self) -> None:
        """Read all outputs."""
        try:
            self._loop.read()
        finally:
            self._look(0, 0)

    def run(self, first: int, last: int) -> None:
        """Step from one tick to another, recording."""
        if self._wondering:
            self._find_out(first)
            first += 1
        try:
            if first < last:
                self._loop.run(first, last)
        finally:
            self._look(first, self.done)

    def _find_out(self, tick: int) -> None:
        """Step from one tick to the next and see who prints."""
        self._wondering = False
        self._alone.done = tick
        try:
            self._alone.run(tick, tick + 1)
        finally:
            self._loop.done = self._alone.done
            if self._alone.heard:
                self._told.pop("doStep", None)

    def _look(self, first: int, last: int) -> None:
        """Look what was printed between two ticks; 0 and 0 stand for the initial exchange."""
        text = printed()
        if not text or self._alone.heard:
            return
        begin, end = self._clock.time(first), self._clock.time(last)
        call, when = ("doStep", f"{begin:g} to {end:g}") if last else ("initial exchange", "0")
        self._told.setdefault(call, f"{self._who}: printed to stdout in {call} at t = {when} s: {text}")
        self._wondering = last > 0
