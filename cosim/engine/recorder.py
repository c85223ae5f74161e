"""Recording: rows of values, filled tick by tick, kept in memory or handed on to sinks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Any

import numpy as np

from cosim.engine.schedule import Schedule
from cosim.results.result import Sink

BLOCK = 4096
"""Rows in memory where they are not kept."""


class Recorder:
    """Rows of ticks 0, N, 2 N, ... and the last: what is continuous as a step finds it, what is discrete as left by it.

    Parameters
    ----------
    plan
        Of the run.
    names, units, discrete
        Of what is recorded: name in the plan, unit, whether it is discrete.
    every
        N.

    Attributes
    ----------
    rows
        Time and recorded values, shape (rows, 1 + names): all rows of a run, or a block of them.
    first_tick
        Whose row ``rows[0]`` is.
    continuous, discrete
        Pairs of a column in ``rows`` and a place in the table.
    complete
        Whether the run reached its stop time.
    """

    def __init__(
        self,
        schedule: Schedule,
        names: Sequence[str],
        units: Sequence[str | None],
        discrete: Sequence[bool],
        every: int,
    ) -> None:
        self.names, self.units, self.every = names, units, every
        self._table, self._clock = schedule.table, schedule.clock
        places = {name: place for place, name in enumerate(schedule.names)}
        cells = np.array([(column, places[name]) for column, name in enumerate(names, 1)], np.int64).reshape(-1, 2)
        chosen = np.array(discrete, dtype=bool)
        self._places = cells[:, 1].copy()
        self.continuous, self.discrete = cells[~chosen], cells[chosen]
        self._set_up(0, keep=False, sinks=())

    def _set_up(self, rows: int, keep: bool, sinks: Sequence[Sink]) -> None:
        self.rows = np.empty((rows, len(self.names) + 1))
        self._keep, self._sinks = keep, sinks
        self._outside: Callable[[], AbstractContextManager[None]] = nullcontext
        self.first_tick = self._filled = self._written = 0
        self.complete = False

    @contextmanager
    def recording(
        self, keep: bool, sinks: Sequence[Sink], outside: Callable[[], AbstractContextManager[None]] = nullcontext
    ) -> Iterator[None]:
        """Record a run: make room for all its rows, or for a block of them; begin and end the sinks.

        Parameters
        ----------
        keep
            Whether all rows stay in memory.
        sinks
            What else takes them.
        outside
            Around each call of those, which are the caller's own.
        """
        rows = -(-self._clock.steps // self.every) + 1
        self._set_up(rows if keep else min(rows, BLOCK), keep, sinks)
        if not sinks:
            yield
            return
        self._outside = outside
        begun = []
        try:
            with outside():
                for sink in sinks:
                    begun.append(sink)
                    sink.begin(self.names, self.units)
            yield
        finally:
            with outside():
                for sink in begun:
                    sink.end(self.complete)

    @property
    def room(self) -> int:
        """How many ticks fit between two calls of :meth:`flush`."""
        return (len(self.rows) - 1) * self.every

    def before(self, tick: int) -> None:
        """Record time and what is continuous."""
        if tick % self.every == 0:
            row = self.rows[(tick - self.first_tick) // self.every]
            row[0] = self._clock.time(tick)
            row[self.continuous[:, 0]] = self._table[self.continuous[:, 1]]

    def after(self, tick: int) -> None:
        """Record what is discrete; with that the row is complete."""
        if tick % self.every == 0:
            row = self.rows[(tick - self.first_tick) // self.every]
            row[self.discrete[:, 0]] = self._table[self.discrete[:, 1]]

    def flush(self, done: int) -> None:
        """Hand the rows of all complete ticks, so many, on to the sinks."""
        self._write(self._row_after(done))
        if not self._keep:
            self.first_tick += self._filled * self.every
            self._filled = self._written = 0

    def last(self) -> None:
        """Record and hand on the last row, which no step follows."""
        steps = self._clock.steps
        row = self._row_after(steps)
        self.rows[row, 0] = self._clock.time(steps)
        self.rows[row, 1:] = self._table[self._places]
        self._write(row + 1)

    def _row_after(self, done: int) -> int:
        return -(-(done - self.first_tick) // self.every)

    def _write(self, filled: int) -> None:
        self._filled = filled
        if filled > self._written:
            if self._sinks:
                with self._outside():
                    for sink in self._sinks:
                        sink.write(self.rows[self._written : filled])
            self._written = filled

    def recorded(self) -> np.ndarray[Any, Any]:
        """Return the rows that are kept, shape (rows, 1 + names)."""
        return self.rows[: self._filled if self._keep else 0]
