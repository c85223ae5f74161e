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


MOST_RECENT = 1000
"""How many of the newest messages are kept, whatever their status."""

MOST_WARNINGS = 1000
"""How many different warnings of a run are kept; the number of the others is reported."""


class MessageLog:
    """The messages of one instance in a run.

    Warnings and the last error outlive any number of other messages.

    Attributes
    ----------
    call, time
        Name and time in s of the current call; kept up to date by whoever calls.
    native_call
        Returns both while the loop in C calls; None otherwise.
    messages
        The newest messages of any status.
    length
        How many came since the instance was made.
    """

    def __init__(self) -> None:
        self.call = ""
        self.time = 0.0
        self.native_call: Callable[[], tuple[str, float]] | None = None
        self.length = 0
        self.messages: deque[Message] = deque(maxlen=MOST_RECENT)
        self._reported: set[str] = set()
        self._warnings: dict[str, Message] = {}
        self._dropped = 0
        self._last_warning: tuple[str, float] | None = None
        self._last_error = ""

    def clear(self) -> None:
        """Remove the messages of the run before."""
        if self.messages:
            self.messages.clear()
            self._reported.clear()
            self._warnings.clear()
            self._dropped, self._last_warning, self._last_error = 0, None, ""

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
        if self._once(call) and self._last_warning != (call, time):
            self._add(WARNING, f"{call} returned a warning", call, time)

    def rounded(self, call: str, time: float, text: str) -> None:
        """Note that the values of a call were rounded, once a run for each text.

        Parameters
        ----------
        call
            Name of the function.
        time
            Simulated time, in s.
        text
            What was rounded.
        """
        if self._once(text):
            self._add(WARNING, text, call, time)

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
        if self._once(what):
            self._add(WARNING, f"{what} at t = {time:g} s: {text}", "", time)

    def _once(self, what: str) -> bool:
        """Whether something is reported for the first time in this run."""
        known = what in self._reported
        self._reported.add(what)
        return not known

    def _add(self, status: int, text: str, call: str, time: float) -> None:
        message = Message(status, text, call, time)
        self.messages.append(message)
        self.length += 1
        if status == WARNING:
            self._last_warning = call, time
            if text not in self._warnings:
                if len(self._warnings) < MOST_WARNINGS:
                    self._warnings[text] = message
                else:
                    self._dropped += 1
        elif status > WARNING:
            self._last_error = text

    @property
    def last_error(self) -> str:
        """The newest message of a status worse than a warning; empty if there is none."""
        return self._last_error

    @property
    def warnings(self) -> list[str]:
        """Warnings, each text once, with call and time of the first; in the end how many more there were."""
        found = [f"{m.text} ({m.call}, t = {m.time:g} s)" if m.call else m.text for m in self._warnings.values()]
        more = f"{self._dropped} more warnings, which are not kept"
        return [*found, more] if self._dropped else found
