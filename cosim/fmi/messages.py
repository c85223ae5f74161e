"""What an FMU says in a run, and in which call it said it."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import NamedTuple

WARNING = 1
"""The status of a call that went well, but not quite; FMI 2.0 and 3.0 number alike."""


class Entry(NamedTuple):
    """A message: its status, its text, in which call and at which time in s it came."""

    status: int
    text: str
    call: str
    time: float


class MessageLog:
    """The messages of one instance, the newest thousand of a run.

    Attributes
    ----------
    call, time
        What is called now and at which time, in s; kept up to date by those who call.
    elsewhere
        Tells both while calls are made by others than Python; None otherwise.
    entries
        The messages.
    length
        How many came since the instance was made.
    """

    def __init__(self) -> None:
        self.call = ""
        self.time = 0.0
        self.native_call: Callable[[], tuple[str, float]] | None = None
        self.length = 0
        self.entries: deque[Entry] = deque(maxlen=1000)
        self._reported: set[str] = set()

    def clear(self) -> None:
        """Begin a run."""
        if self.entries:
            self.entries.clear()
            self._reported.clear()

    def add(self, status: int, text: str) -> None:
        """Take a message of the FMU."""
        self._add(status, text, *(self.native_call() if self.native_call else (self.call, self.time)))

    def warned(self, call: str, time: float) -> None:
        """Take note of a call at a time in s that went well with a warning, once a run; it may not have said why."""
        if call in self._reported:
            return
        self._reported.add(call)
        if not any(e.status == WARNING and (e.call, e.time) == (call, time) for e in self.entries):
            self._add(WARNING, f"{call} returned a warning", call, time)

    def printed(self, call: str, time: float, text: str) -> None:
        """Take note of what was printed in a call at a time in s, once a run."""
        said = f"printed to stdout in {call}"
        if said not in self._reported:
            self._reported.add(said)
            self._add(WARNING, f"{said} at t = {time:g} s: {text}", "", time)

    def _add(self, status: int, text: str, call: str, time: float) -> None:
        self.entries.append(Entry(status, text, call, time))
        self.length += 1

    @property
    def last_error(self) -> str:
        """The newest message that tells of more than a warning; empty if there is none."""
        return next((entry.text for entry in reversed(self.entries) if entry.status > WARNING), "")

    @property
    def warnings(self) -> list[str]:
        """What was warned of, each text once, with the call and the time of the first."""
        found: dict[str, str] = {}
        for _, text, call, time in (entry for entry in self.entries if entry.status == WARNING):
            found.setdefault(text, f"{text} ({call}, t = {time:g} s)" if call else text)
        return list(found.values())
