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
"""What an interrupt would have called, while it is held."""

_waiting: list[tuple[Any, ...]] = []
"""An interrupt that waits: what it would have called, and with what."""


@contextmanager
def held() -> Iterator[None]:
    """Hold Ctrl-C back until :func:`check` or the end; the second one in a row is raised at once."""
    handler = signal.getsignal(signal.SIGINT)
    if not _in_main_thread() or not callable(handler) or handler is _hold:
        yield
        return
    _handlers.append(handler)
    signal.signal(signal.SIGINT, _hold)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)
        _handlers.pop()
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


def _hold(number: int, frame: FrameType | None) -> None:
    insisting = bool(_waiting)
    _waiting[:] = [(_handlers[-1], number, frame)]
    if insisting:
        check()


def _in_main_thread() -> bool:
    return threading.current_thread() is threading.main_thread()
