"""Temporary folders: those of one process lie in a folder that it holds locked, so that others know whether it lives.

The folder is made with the first temporary folder and removed with the last one. What a killed process leaves is
removed by a later one of the same user.
"""

from __future__ import annotations

import os
import shutil
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path

from cosim.file_lock import FileLock

PREFIX = "seat-cosim-"
"""Prefix of every process's folder."""

_LOCK = "lock"
"""Name of the file that a process holds locked in its folder."""

_YOUNGEST = 60.0
"""Age in s below which a folder is never a leftover: it may be about to be locked."""

_UNLOCKED = 24 * 3600.0
"""Age in s from which one without a lock file, as the versions before 0.2 made them, is a leftover."""


class _ProcessFolder:
    """The folder of this process, while it has temporary folders."""

    def __init__(self) -> None:
        self._guard = threading.Lock()
        self._numbers = count(1)
        self._start()

    def _start(self) -> None:
        self._path: Path | None = None
        self._lock: FileLock | None = None
        self._users = 0
        self._cleaned = False

    def enter(self) -> Path:
        """Make a temporary folder, and the process's folder around the first one."""
        with self._guard:
            if self._path is None:
                self._path = Path(tempfile.mkdtemp(prefix=f"{PREFIX}{os.getpid()}-")).absolute()
                self._lock = FileLock(self._path / _LOCK)
                self._lock.acquire(str(os.getpid()))
            folder = self._path / str(next(self._numbers))
            folder.mkdir()
            self._users += 1
            must_clean, self._cleaned = not self._cleaned, True
        if must_clean:
            remove_leftovers()
        return folder

    def leave(self, folder: Path) -> None:
        """Remove a temporary folder, and the process's folder with the last one."""
        shutil.rmtree(folder, ignore_errors=True)
        with self._guard:
            self._users -= 1
            if self._users or self._path is None:
                return
            path, lock = self._path, self._lock
            self._path = self._lock = None
            if lock is not None:
                lock.release()
            shutil.rmtree(path, ignore_errors=True)

    def forget(self) -> None:
        """Leave everything to the parent, in a fork."""
        self._guard = threading.Lock()  # another thread of the parent may hold it
        if self._lock is not None:
            self._lock.close()
        self._start()


_own = _ProcessFolder()
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_own.forget)


@contextmanager
def temporary_folder() -> Iterator[Path]:
    """Make a temporary folder and remove it at the end; a fork of the process does not remove it.

    Yields
    ------
    Path
        An empty folder, absolute.
    """
    process, folder = os.getpid(), _own.enter()
    try:
        yield folder
    finally:
        if os.getpid() == process:
            _own.leave(folder)


def leftovers() -> list[Path]:
    """Return the folders that killed processes of this user have left."""
    try:
        found = list(Path(tempfile.gettempdir()).glob(f"{PREFIX}*"))
    except OSError:
        return []
    return sorted(path for path in found if _is_leftover(path))


def remove_leftovers() -> list[Path]:
    """Remove what killed processes of this user have left.

    Returns
    -------
    list of Path
        The folders that are gone.
    """
    found = leftovers()
    for path in found:
        shutil.rmtree(path, ignore_errors=True)
    return [path for path in found if not path.exists()]


def _is_leftover(path: Path) -> bool:
    """Whether a folder is this user's, old enough, and that of a process that has ended."""
    try:
        about = path.lstat()
    except OSError:
        return False
    mine = not hasattr(os, "getuid") or about.st_uid == os.getuid()
    age = time.time() - about.st_mtime
    if not mine or path.is_symlink() or not path.is_dir() or age < _YOUNGEST:
        return False
    if not (path / _LOCK).exists():
        return age > _UNLOCKED
    lock = FileLock(path / _LOCK)
    with suppress(OSError):
        if lock.acquire():
            lock.close()  # and leave the file: without it the folder would look young again
            return True
    return False
