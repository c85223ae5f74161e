"""A folder of results belongs to one run at a time, whatever thread, process or machine of a shared disk it is on."""

from __future__ import annotations

import os
import platform
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from cosim.errors import SetupError, writing_to
from cosim.file_lock import FileLock

LOCK = ".lock"
"""Name of the file that a run holds locked in its folder; removed at the end, left by a killed run, then taken over."""

_held: dict[Path, int] = {}
"""Folders that are locked by this process to the threads that hold them."""

if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_held.clear)


@contextmanager
def locked_folder(folder: Path) -> Iterator[None]:
    """Lock a folder for a run; inside, the same thread may lock it again.

    Parameters
    ----------
    folder
        The folder; created where it does not exist, and then removed at the end if nothing was written.

    Raises
    ------
    SetupError
        If another run writes to it, or it cannot be written to.
    """
    place = folder.resolve()
    if _held.get(place) == threading.get_ident():
        yield
        return
    lock = FileLock(place / LOCK)
    made = [each for each in (place, *place.parents) if not each.exists()]
    with writing_to(folder):
        place.mkdir(parents=True, exist_ok=True)
        acquired = lock.acquire(f"process {os.getpid()} on {platform.node()}")
    if not acquired:
        holder = lock.holder() or "another process"
        raise SetupError(f"{folder}: expected a folder that no other run writes to, got that of a run in {holder}")
    _held[place] = threading.get_ident()
    process = os.getpid()
    try:
        yield
    finally:
        if os.getpid() == process:
            del _held[place]
            lock.release()
            with suppress(OSError):  # as soon as one is not empty
                for each in made:
                    each.rmdir()
