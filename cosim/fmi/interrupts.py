"""Ctrl-C while FMUs are called: it waits until nothing is left half done.

Python raises :class:`KeyboardInterrupt` between any two of its instructions. In the middle of making or freeing an
instance that loses it; in the code of an FMU written in Python it looks like an error of the FMU; in a function that an
FMU calls it is swallowed. So it is held back, and raised by those who look.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

_handlers: list[Any] = []
"""What an interrupt calls where it is not held, once for each session that watches."""

_holding: list[None] = []
"""As many as there are blocks that hold it."""

_waiting: list[tuple[Any, ...]] = []
"""An interrupt that waits: what it would have called, and with what."""


@contextmanager
def deferring_sigint() -> Iterator[None]:
    """Let Ctrl-C be held in some parts of a block; only the main thread hears it."""
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
    """Hold Ctrl-C back until :func:`check` or the end of the block; the second one in a row is raised at once."""
    if not _in_main_thread():
        yield
        return
    _holding.append(None)
    try:
        yield
    finally:
        _holding.pop()
        check()


def check() -> None:
    """Let an interrupt that waits happen now.

    Raises
    ------
    KeyboardInterrupt
        If there is one, and the program has not decided otherwise.
    """
    if _waiting and _in_main_thread():
        handler, *arguments = _waiting.pop()
        handler(*arguments)


def _handle(number: int, frame: FrameType | None) -> None:
    at_once = bool(_waiting) or not _holding
    _waiting[:] = [(_handlers[-1], number, frame)]
    if at_once:
        check()


def _in_main_thread() -> bool:
    return threading.current_thread() is threading.main_thread()
