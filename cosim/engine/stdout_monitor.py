"""Which component prints while FMUs step, found without collecting output after every call."""

from __future__ import annotations

from collections.abc import Sequence

from cosim.engine.python_stepper import PythonStepper
from cosim.engine.recorder import Recorder
from cosim.engine.schedule import Schedule, Stepper
from cosim.fmi.output_capture import printed


class StdoutMonitor:
    """A stepper that collects after every chunk of steps what was printed.

    Output of a chunk is ambiguous: any component may have printed it. So the next tick is stepped by a probe, in
    Python, which collects output after each call. That attributes what a component prints in every step; what is
    printed only once stays ambiguous.

    Parameters
    ----------
    stepper
        Steps the components.
    schedule, recorder
        Those of the stepper.
    names
        Components that may print: those in this process.
    """

    def __init__(self, stepper: Stepper, schedule: Schedule, recorder: Recorder, names: Sequence[str]) -> None:
        self._stepper = stepper
        self._probe = PythonStepper(schedule, recorder, collect_stdout=True)
        self._clock = schedule.clock
        self._names = " or ".join(names)
        self._ambiguous = False
        self._report = ""

    @property
    def warnings(self) -> list[str]:
        """What was printed in this run and is not attributed to a component."""
        return [self._report] if self._report else []

    @property
    def done(self) -> int:
        """Number of ticks that are complete."""
        return self._stepper.done

    @done.setter
    def done(self, ticks: int) -> None:
        self._stepper.done = ticks

    def begin(self) -> None:
        """Begin a run."""
        self._report = ""
        self._ambiguous = self._probe.attributed = False
        self._stepper.begin()

    def run(self, first: int, last: int) -> None:
        """Step from one tick to another and record."""
        if self._ambiguous:
            self._attribute(first)
            first += 1
        try:
            if first < last:
                self._stepper.run(first, last)
        finally:
            self._collect(first, self.done)

    def _attribute(self, tick: int) -> None:
        """Step from one tick to the next by the probe."""
        self._ambiguous = False
        self._probe.done = tick
        try:
            self._probe.run(tick, tick + 1)
        finally:
            self._stepper.done = self._probe.done
            if self._probe.attributed:
                self._report = ""

    def _collect(self, first: int, last: int) -> None:
        """Collect what was printed between two ticks."""
        text = printed()
        if not text or self._probe.attributed:
            return
        begin, end = self._clock.time(first), self._clock.time(last)
        self._report = (
            self._report or f"{self._names}: printed to stdout in doStep at t = {begin:g} to {end:g} s: {text}"
        )
        self._ambiguous = True
