"""Standard output while FMUs run: what they print goes to a file and becomes a warning.

File descriptor 1 belongs to the whole process. While it is captured, what another thread prints is captured, too, and
cannot be distinguished from what an FMU prints; sessions that overlap in several threads share the newest capture.
"""

from __future__ import annotations

import ctypes
import io
import os
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TextIO

_libc = ctypes.CDLL(None) if os.name == "posix" else ctypes.CDLL("ucrtbase")
_FD = 1

_lock = threading.Lock()
_captures: list[OutputCapture] = []
"""Captures that are on; output goes to the last."""

_original: list[int] = []
"""A copy of the descriptor as it was before the first capture, or nothing where it was closed."""


def _c_stdout() -> ctypes.c_void_p:
    """Find C's ``stdout``; where its name is not known, the null pointer, which makes ``fflush`` flush all streams."""
    for name in ("stdout", "__stdoutp"):
        with suppress(ValueError):
            return ctypes.c_void_p.in_dll(_libc, name)
    return ctypes.c_void_p()


_STREAM = _c_stdout()
_libc.fflush.argtypes = [ctypes.c_void_p]  # also faster


class OutputCapture:
    """A file that receives standard output while the context ``on`` is open, any number of times, until ``close``."""

    def __init__(self) -> None:
        self._file = tempfile.TemporaryFile(buffering=0)  # noqa: SIM115
        self._number = self._file.fileno()
        self._text = io.TextIOWrapper(self._file, encoding="utf-8", errors="backslashreplace", write_through=True)
        self._python: TextIO | None = None

    def close(self) -> None:
        """Close the file."""
        self._text.close()

    @contextmanager
    def on(self) -> Iterator[None]:
        """Capture descriptor 1 and ``sys.stdout``; both are restored afterwards."""
        self._begin()
        try:
            yield
        finally:
            self._end()

    @contextmanager
    def off(self) -> Iterator[None]:
        """Inside ``on``: restore standard output for a caller's own code."""
        self._end()
        try:
            yield
        finally:
            self._begin()

    def _begin(self) -> None:
        with _lock:
            _flush()
            if not _captures:
                with suppress(OSError):  # a process may have no standard output
                    _original.append(os.dup(_FD))
            _captures.append(self)
            self._redirect()
            self._python, sys.stdout = sys.stdout, self._text

    def _end(self) -> None:
        with _lock:
            _flush()
            _captures.remove(self)
            self._redirect()
            if not _captures and _original:
                os.close(_original.pop())
            if sys.stdout is self._text and self._python is not None:
                sys.stdout = self._python

    @staticmethod
    def _redirect() -> None:
        """Point the descriptor to the last capture, or to where it pointed before all of them."""
        if _original:
            os.dup2(_captures[-1]._number if _captures else _original[0], _FD)

    def take(self) -> str:
        """Return what was printed since the last time, and remove it from the file."""
        size = os.lseek(self._number, 0, os.SEEK_CUR)  # the descriptors share their position; much faster than fstat
        if not size:  # nearly always, and called often
            return ""
        os.lseek(self._number, 0, os.SEEK_SET)
        found = os.read(self._number, size)
        os.lseek(self._number, 0, os.SEEK_SET)
        os.ftruncate(self._number, 0)
        return found.decode(errors="replace")


def _flush() -> None:
    with suppress(AttributeError, OSError, ValueError):  # None, or closed
        sys.stdout.flush()
    _libc.fflush(_STREAM)


def printed() -> str:
    """Describe what was printed since the last time while output is captured.

    Returns
    -------
    str
        The first line and the number of further ones; empty if nothing was printed.
    """
    if not _captures:
        return ""
    _libc.fflush(_STREAM)
    text = _captures[-1].take()
    if not text:
        return ""
    lines = text.strip().splitlines()
    more = f" (and {len(lines) - 1} more line{'s' if len(lines) > 2 else ''})" if len(lines) > 1 else ""
    return lines[0] + more if lines else ""
