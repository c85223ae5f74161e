"""Signals that interrupt or end the program while FMUs are called: deferred until nothing is left half done.

Python raises :class:`KeyboardInterrupt` between any two of its instructions. While an instance is made or freed, that
would lose the instance; in an FMU written in Python it looks like an error of the FMU; in a function that an FMU calls
it is swallowed. So the interrupt is deferred, and raised by :func:`check` where that is safe.

SIGTERM and SIGHUP, by which batch systems and closed terminals end a process, are deferred in the same way where the
program does nothing about them itself: rows are written and folders removed; then the signal ends the process.

Python calls handlers in the main thread only, and all functions of this module do nothing in others.
"""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any

ENDING = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))
"""Signals that end the process where the program does nothing about them; Windows has not both."""

_SIGNALS = (signal.SIGINT, *ENDING)

_before: dict[int, Any] = {}
"""Handlers of the signals that are deferred, as they were before."""

_sections: list[None] = []
"""One entry for each critical section that is open."""

_deferred: list[tuple[Any, ...]] = []
"""A deferred signal: the handler that it would have called, and its arguments."""

_ending: list[int] = []
"""Signals that end the process when nothing defers them any more."""


class Ended(SystemExit):
    """A signal ends the process.

    Parameters
    ----------
    number
        Of the signal.

    Attributes
    ----------
    signal_name
        Its name, for example ``SIGTERM``.
    """

    def __init__(self, number: int) -> None:
        super().__init__(128 + number)
        self.signal_name = signal.Signals(number).name

    def __str__(self) -> str:
        return f"ended by {self.signal_name}"


@contextmanager
def deferring_signals() -> Iterator[None]:
    """Defer signals in the critical sections of a block.

    A signal that ends the process is delivered again, to its default handler, at the end of the outermost block.
    """
    if not _in_main_thread():
        yield
        return
    outer = dict(_before)
    taken = [number for number in _SIGNALS if _take_over(number)]
    try:
        yield
    finally:
        for number in taken:
            last = _before.pop(number)
            if number in outer:
                _before[number] = outer[number]
            if signal.getsignal(number) is _handle:
                signal.signal(number, last)
        _end_process()


def _take_over(number: int) -> bool:
    """Take over a signal, unless it is ours already, ignored, or handled by nothing that Python has set."""
    handler = signal.getsignal(number)
    if handler is _handle or not (callable(handler) or (number in ENDING and handler is signal.SIG_DFL)):
        return False
    _before[number] = handler
    signal.signal(number, _handle)
    return True


def _end_process() -> None:
    """Deliver the signals that end the process, unless an outer block defers them."""
    for number in [number for number in _ending if number not in _before]:
        _ending.remove(number)
        for stream in (sys.stdout, sys.stderr):
            with suppress(AttributeError, OSError, ValueError):
                stream.flush()
        signal.raise_signal(number)


@contextmanager
def critical_section() -> Iterator[None]:
    """Defer signals until :func:`check` or the end of the block; a second one in a row is raised immediately."""
    if not _in_main_thread():
        yield
        return
    _sections.append(None)
    try:
        yield
    finally:
        _sections.pop()
        check()


def check() -> None:
    """Raise a deferred signal.

    Raises
    ------
    KeyboardInterrupt
        If there is an interrupt and the handler of the program raises it.
    Ended
        If there is a signal that ends the process.
    """
    if _deferred and _in_main_thread():
        handler, *arguments = _deferred.pop()
        handler(*arguments)


def check_ended() -> None:
    """Refuse to begin anything while a signal waits to end the process.

    Raises
    ------
    Ended
        If one does.
    """
    if _ending and _in_main_thread():
        raise Ended(_ending[-1])


def _handle(number: int, frame: FrameType | None) -> None:
    immediately = bool(_deferred) or not _sections
    handler = _before[number]
    if handler is signal.SIG_DFL:
        _ending.append(number)
        handler = _raise_ended
    _deferred[:] = [(handler, number, frame)]
    if immediately:
        check()


def _raise_ended(number: int, frame: FrameType | None) -> None:
    raise Ended(number)


def _in_main_thread() -> bool:
    return threading.current_thread() is threading.main_thread()
