"""Interrupts by the user (SIGINT) while FMUs are called: deferred until nothing is left half done.

Python raises :class:`KeyboardInterrupt` between any two of its instructions. While an instance is made or freed, that
would lose the instance; in an FMU written in Python it looks like an error of the FMU; in a function that an FMU calls
it is swallowed. So the interrupt is deferred, and raised by :func:`check` where that is safe.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

_handlers: list[Any] = []
"""Handlers that were installed before, one for each block that defers interrupts."""

_sections: list[None] = []
"""One entry for each critical section that is open."""

_deferred: list[tuple[Any, ...]] = []
"""A deferred interrupt: the handler that it would have called, and its arguments."""


@contextmanager
def deferring_sigint() -> Iterator[None]:
    """Defer interrupts in the critical sections of a block; only the main thread receives signals."""
    handler = signal.getsignal(signal.SIGINT)
    if not _in_main_thread() or not callable(handler):
        yield
        return
    _handlers.append(_handlers[-1] if handler is _handle else handler)
    signal.signal(signal.SIGINT, _handle)
    try:
        yield
    finally:
        last = _handlers.pop()
        if not _handlers and signal.getsignal(signal.SIGINT) is _handle:
            signal.signal(signal.SIGINT, last)


@contextmanager
def critical_section() -> Iterator[None]:
    """Defer interrupts until :func:`check` or the end of the block; a second one in a row is raised immediately."""
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
    """Raise a deferred interrupt.

    Raises
    ------
    KeyboardInterrupt
        If there is one and the handler of the program raises it.
    """
    if _deferred and _in_main_thread():
        handler, *arguments = _deferred.pop()
        handler(*arguments)


def _handle(number: int, frame: FrameType | None) -> None:
    immediately = bool(_deferred) or not _sections
    _deferred[:] = [(_handlers[-1], number, frame)]
    if immediately:
        check()


def _in_main_thread() -> bool:
    return threading.current_thread() is threading.main_thread()
