"""Recording: rows of values, filled tick by tick, kept in memory or written to sinks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Any

import numpy as np

from cosim.engine.schedule import Schedule
from cosim.results.result import Sink

BLOCK = 4096
"""Rows in memory where they are not kept for the result."""


class Recorder:
    """Records rows of ticks 0, N, 2 N, ... and the last.

    A row holds outputs as they were before the tick's step, samples at the begin of that step as they were after it.

    Parameters
    ----------
    schedule
        Of the run.
    names, units, sampled
        Outputs to record as ``component.element``, their units, and whether they are samples at the begin of a step.
    every
        N.

    Attributes
    ----------
    rows
        Time and recorded values, shape (rows, 1 + names): all rows of a run, or a block of them.
    first_tick
        Tick of ``rows[0]``.
    continuous, sampled
        Pairs of a column in ``rows`` and an index in the schedule's values.
    complete
        Whether the run reached its stop time.
    """

    def __init__(
        self,
        schedule: Schedule,
        names: Sequence[str],
        units: Sequence[str | None],
        sampled: Sequence[bool],
        every: int,
    ) -> None:
        self.names, self.units, self.every = names, units, every
        self._values, self._clock = schedule.values, schedule.clock
        index = {name: i for i, name in enumerate(schedule.names)}
        pairs = np.array([(column, index[name]) for column, name in enumerate(names, 1)], np.int64).reshape(-1, 2)
        chosen = np.array(sampled, dtype=bool)
        self._index = pairs[:, 1].copy()
        self.continuous, self.sampled = pairs[~chosen], pairs[chosen]
        self._set_up(0, keep=False, sinks=())

    def _set_up(self, rows: int, keep: bool, sinks: Sequence[Sink]) -> None:
        self.rows = np.empty((rows, len(self.names) + 1))
        self._keep, self._sinks = keep, sinks
        self._callback_context: Callable[[], AbstractContextManager[None]] = nullcontext
        self.first_tick = self._filled = self._written = 0
        self.complete = False

    @contextmanager
    def recording(
        self,
        keep: bool,
        sinks: Sequence[Sink],
        callback_context: Callable[[], AbstractContextManager[None]] = nullcontext,
    ) -> Iterator[None]:
        """Record a run: allocate all its rows, or a block of them; begin and end the sinks.

        Parameters
        ----------
        keep
            Whether all rows stay in memory.
        sinks
            What else takes them.
        callback_context
            Context in which the sinks, which are the caller's own code, are called.
        """
        rows = -(-self._clock.steps // self.every) + 1
        self._set_up(rows if keep else min(rows, BLOCK), keep, sinks)
        if not sinks:
            yield
            return
        self._callback_context = callback_context
        begun: list[Sink] = []
        try:
            with callback_context():
                for sink in sinks:
                    begun.append(sink)
                    sink.begin(self.names, self.units)
            yield
        finally:
            with callback_context():
                _for_all(begun, lambda sink: sink.end(self.complete))

    @property
    def capacity(self) -> int:
        """How many ticks fit between two calls of :meth:`flush`."""
        return (len(self.rows) - 1) * self.every

    def before(self, tick: int) -> None:
        """Record time and outputs before the step of a tick."""
        if tick % self.every == 0:
            row = self.rows[(tick - self.first_tick) // self.every]
            row[0] = self._clock.time(tick)
            row[self.continuous[:, 0]] = self._values[self.continuous[:, 1]]

    def after(self, tick: int) -> None:
        """Record samples after the step of a tick; with that the row is complete."""
        if tick % self.every == 0:
            row = self.rows[(tick - self.first_tick) // self.every]
            row[self.sampled[:, 0]] = self._values[self.sampled[:, 1]]

    def flush(self, done: int) -> None:
        """Write the rows of all complete ticks to the sinks.

        Parameters
        ----------
        done
            Number of complete ticks.
        """
        self._write(self._row_after(done))
        if not self._keep:
            self.first_tick += self._filled * self.every
            self._filled = self._written = 0

    def record_last(self) -> None:
        """Record and write the last row, which no step follows."""
        steps = self._clock.steps
        row = self._row_after(steps)
        self.rows[row, 0] = self._clock.time(steps)
        self.rows[row, 1:] = self._values[self._index]
        self._write(row + 1)

    def _row_after(self, done: int) -> int:
        return -(-(done - self.first_tick) // self.every)

    def _write(self, filled: int) -> None:
        self._filled = filled
        if filled > self._written:
            rows, self._written = self.rows[self._written : filled], filled
            if self._sinks:
                with self._callback_context():
                    _for_all(self._sinks, lambda sink: sink.write(rows))

    def recorded(self) -> np.ndarray[Any, Any]:
        """Return the rows that are kept, shape (rows, 1 + names)."""
        return self.rows[: self._filled if self._keep else 0]


def _for_all(sinks: Sequence[Sink], call: Callable[[Sink], None]) -> None:
    """Call all sinks in their order, also where one of them fails."""
    if sinks:
        try:
            call(sinks[0])
        finally:
            _for_all(sinks[1:], call)
