"""Waiting for an event of a test, however long it takes on a busy machine."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

LIMIT = 120.0
"""Longest time to wait, in s; far more than any event takes."""


def wait_until(condition: Callable[[], bool]) -> None:
    """Wait until a condition holds.

    Raises
    ------
    TimeoutError
        If it does not within :data:`LIMIT`.
    """
    end = time.monotonic() + LIMIT
    while not condition():
        if time.monotonic() > end:
            raise TimeoutError(f"expected an event within {LIMIT:g} s, got none")
        time.sleep(0.01)


@contextmanager
def interrupt_when(condition: Callable[[], bool]) -> Iterator[None]:
    """Send SIGINT to this process, from another thread, as soon as a condition holds in the block."""

    def interrupt() -> None:
        wait_until(condition)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt, daemon=True)
    thread.start()
    yield
    thread.join()
