"""Standard output while FMUs run: what they print goes to a file and becomes a warning.

File descriptor 1 and ``sys.stdout`` belong to the whole process. So there is one diversion, counted, which only the
main thread switches on; in other threads nothing is captured. While it is on, what other threads print in Python goes
where it went before. What their C code prints goes to the file, and cannot be distinguished from what an FMU prints.
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
from typing import TYPE_CHECKING, Any, TextIO

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer

_libc = ctypes.CDLL(None) if os.name == "posix" else ctypes.CDLL("ucrtbase")
_FD = 1

_captures: list[OutputCapture] = []
"""Captures that are on; output goes to the last."""

_original: list[int] = []
"""A copy of the descriptor as it was before the first capture, or nothing where it was closed."""

_before: list[TextIO | None] = []
"""``sys.stdout`` as it was before the first capture."""


def _c_stdout() -> ctypes.c_void_p:
    """Find C's ``stdout``; where its name is not known, the null pointer, which makes ``fflush`` flush all streams."""
    for name in ("stdout", "__stdoutp"):
        with suppress(ValueError):
            return ctypes.c_void_p.in_dll(_libc, name)
    return ctypes.c_void_p()


_STREAM = _c_stdout()
_libc.fflush.argtypes = [ctypes.c_void_p]  # also faster


def _in_main_thread() -> bool:
    return threading.current_thread() is threading.main_thread()


class _Router(io.RawIOBase):
    """Takes what is printed while output is captured, and later by whoever has kept the stream; never closed."""

    def writable(self) -> bool:
        return True

    def fileno(self) -> int:
        return _FD

    def close(self) -> None:
        """Do nothing: others have the same stream."""

    def write(self, data: ReadableBuffer, /) -> int:
        content = bytes(data)
        captures, original = [*_captures], [*_original]
        if captures and _in_main_thread():
            _write_all(captures[-1]._number, content)
            return len(content)
        stream = next(iter([*_before]), None) if captures else sys.stdout
        stream = sys.__stdout__ if stream is _stdout else stream
        if captures and original and _is_of_descriptor(stream):
            text = content.decode("utf-8", errors="replace")
            encoding = getattr(stream, "encoding", None) or "utf-8"
            _write_all(original[0], text.encode(encoding, errors="backslashreplace"))
        elif stream is not None:
            with suppress(ValueError):  # closed
                stream.write(content.decode("utf-8", errors="replace"))
        return len(content)


_router: Any = _Router()
_stdout = io.TextIOWrapper(_router, encoding="utf-8", errors="backslashreplace", write_through=True)
"""``sys.stdout`` while output is captured."""


def _is_of_descriptor(stream: TextIO | None) -> bool:
    try:
        return stream is not None and stream.fileno() == _FD
    except (AttributeError, OSError, ValueError):
        return False


def _write_all(descriptor: int, content: bytes) -> None:
    while content:
        content = content[os.write(descriptor, content) :]


class OutputCapture:
    """A file that receives standard output while the context ``on`` is open, any number of times, until ``close``."""

    def __init__(self) -> None:
        self._file = tempfile.TemporaryFile(buffering=0)  # noqa: SIM115
        self._number = self._file.fileno()

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    @contextmanager
    def on(self) -> Iterator[None]:
        """Capture descriptor 1 and ``sys.stdout`` in the main thread; both are restored afterwards."""
        captured = _in_main_thread()
        if captured:
            self._begin()
        try:
            yield
        finally:
            if captured:
                self._end()

    @contextmanager
    def off(self) -> Iterator[None]:
        """Inside ``on``: restore standard output for a caller's own code."""
        captured = _in_main_thread() and self in _captures
        if captured:
            self._end()
        try:
            yield
        finally:
            if captured:
                self._begin()

    def _begin(self) -> None:
        _flush()
        if not _captures:
            with suppress(OSError):  # a process may have no standard output
                _original.append(os.dup(_FD))
            _before.append(sys.stdout)
            sys.stdout = _stdout
        _captures.append(self)
        self._redirect()

    def _end(self) -> None:
        _flush()
        _captures.remove(self)
        self._redirect()
        if _captures:
            return
        if _original:
            os.close(_original.pop())
        before = _before.pop()
        if sys.stdout is _stdout:  # not replaced by an FMU's Python code meanwhile
            sys.stdout = before  # type: ignore[assignment]

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
    if not _captures or not _in_main_thread():
        return ""
    _libc.fflush(_STREAM)
    text = _captures[-1].take()
    if not text:
        return ""
    lines = text.strip().splitlines()
    more = f" (and {len(lines) - 1} more line{'s' if len(lines) > 2 else ''})" if len(lines) > 1 else ""
    return lines[0] + more if lines else ""
