"""Messages of an FMU, each with the call in which it came."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import NamedTuple

WARNING = 1
"""Status of a call that succeeded with a warning; FMI 2.0 and 3.0 number their status alike."""


class Message(NamedTuple):
    """A message of an FMU.

    Attributes
    ----------
    status
        As the FMU gave it.
    text
        The message.
    call
        Name of the function that was called.
    time
        Simulated time of the call, in s.
    """

    status: int
    text: str
    call: str
    time: float


class MessageLog:
    """The messages of one instance, the newest thousand of a run.

    Attributes
    ----------
    call, time
        Name and time in s of the current call; kept up to date by whoever calls.
    native_call
        Returns both while the loop in C calls; None otherwise.
    messages
        The messages.
    length
        How many came since the instance was made.
    """

    def __init__(self) -> None:
        self.call = ""
        self.time = 0.0
        self.native_call: Callable[[], tuple[str, float]] | None = None
        self.length = 0
        self.messages: deque[Message] = deque(maxlen=1000)
        self._reported: set[str] = set()

    def clear(self) -> None:
        """Remove the messages of the run before."""
        if self.messages:
            self.messages.clear()
            self._reported.clear()

    def add(self, status: int, text: str) -> None:
        """Add a message of the FMU.

        Parameters
        ----------
        status
            As the FMU gave it.
        text
            The message.
        """
        self._add(status, text, *(self.native_call() if self.native_call else (self.call, self.time)))

    def warned(self, call: str, time: float) -> None:
        """Note that a call returned a warning, once a run; the FMU may have sent no message.

        Parameters
        ----------
        call
            Name of the function.
        time
            Simulated time, in s.
        """
        if call in self._reported:
            return
        self._reported.add(call)
        if not any(m.status == WARNING and (m.call, m.time) == (call, time) for m in self.messages):
            self._add(WARNING, f"{call} returned a warning", call, time)

    def printed(self, call: str, time: float, text: str) -> None:
        """Note what was printed in a call, once a run.

        Parameters
        ----------
        call
            Name of the function.
        time
            Simulated time, in s.
        text
            What was printed.
        """
        what = f"printed to stdout in {call}"
        if what not in self._reported:
            self._reported.add(what)
            self._add(WARNING, f"{what} at t = {time:g} s: {text}", "", time)

    def _add(self, status: int, text: str, call: str, time: float) -> None:
        self.messages.append(Message(status, text, call, time))
        self.length += 1

    @property
    def last_error(self) -> str:
        """The newest message of a status worse than a warning; empty if there is none."""
        return next((message.text for message in reversed(self.messages) if message.status > WARNING), "")

    @property
    def warnings(self) -> list[str]:
        """Warnings, each text once, with call and time of the first."""
        found: dict[str, str] = {}
        for _, text, call, time in (message for message in self.messages if message.status == WARNING):
            found.setdefault(text, f"{text} ({call}, t = {time:g} s)" if call else text)
        return list(found.values())
