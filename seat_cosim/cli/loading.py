"""Ctrl-C while modules are loaded: an import may swallow the exception, so the process ends at once."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def leaving_at_once() -> Iterator[None]:
    """End the process at Ctrl-C in a block that loads modules: nothing has begun, and nothing is left behind.

    Python calls handlers in the main thread only; in others, and where Ctrl-C is ignored, the block runs as it is.
    """
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield
        return
    signal.signal(signal.SIGINT, _leave)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _leave(number: int, frame: FrameType | None) -> None:
    os.write(2, b"seat-cosim: error: interrupted\n")
    os._exit(1)
