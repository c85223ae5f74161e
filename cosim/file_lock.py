"""Exclusive locks on files, which the operating system releases when the process ends, however that happens."""

from __future__ import annotations

import errno
import os
from contextlib import suppress
from pathlib import Path

_NO_LOCKS = {errno.ENOSYS, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOLCK, errno.EINVAL}
"""What a file system that has no locks answers."""

if os.name == "posix":
    import fcntl

    def _lock(descriptor: int) -> None:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)

else:
    import msvcrt

    def _lock(descriptor: int) -> None:
        os.lseek(descriptor, 2**30, os.SEEK_SET)  # beyond the text, which others read
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
        os.lseek(descriptor, 0, os.SEEK_SET)


class FileLock:
    """An exclusive lock on a file, held from :meth:`acquire` to :meth:`release`.

    A process that is killed leaves the file; the lock ends with the process, so that the next one takes it over. On a
    file system without locks nothing is excluded.

    Parameters
    ----------
    path
        The file; it is made if need be, and removed with the lock.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._descriptor: int | None = None

    def acquire(self, text: str = "") -> bool:
        """Take the lock if nobody has it.

        Parameters
        ----------
        text
            What the file says while the lock is held, for those who want it, too.

        Returns
        -------
        bool
            Whether it is held now.

        Raises
        ------
        OSError
            If the file cannot be made.
        """
        while True:
            descriptor = os.open(self.path, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o644)
            try:
                _lock(descriptor)
            except OSError as error:
                if error.errno not in _NO_LOCKS:
                    os.close(descriptor)
                    return False
            if self._is_of(descriptor):
                break
            os.close(descriptor)  # who had it has removed the file meanwhile
        self._descriptor = descriptor
        os.ftruncate(descriptor, 0)
        os.write(descriptor, text.encode())
        return True

    def _is_of(self, descriptor: int) -> bool:
        """Whether a descriptor is that of the file of this name."""
        try:
            return os.path.samestat(os.fstat(descriptor), self.path.stat())
        except FileNotFoundError:
            return False

    def holder(self) -> str:
        """Return what the file says, empty where there is none."""
        try:
            return self.path.read_text(encoding="utf-8", errors="replace")
        except OSError:
            return ""

    def release(self) -> None:
        """Remove the file and give up the lock."""
        if self._descriptor is None:
            return
        with suppress(OSError):  # Windows removes no open files
            self.path.unlink()
        self.close()
        with suppress(OSError):
            if os.name != "posix":
                self.path.unlink()

    def close(self) -> None:
        """Close the file only; in a fork, the lock stays that of the parent."""
        if self._descriptor is not None:
            os.close(self._descriptor)
        self._descriptor = None
