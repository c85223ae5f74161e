"""MDF files opened by asammdf: what it finds wrong with one leaves nothing and prints nothing."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from traceback import walk_tb
from typing import Any

from cosim.fmi.output_capture import OutputCapture
from cosim.fmi.temporary_folders import temporary_folder

_MAX_RATIO = 1000
"""Most bytes of samples that a byte of a file can hold; zlib packs no denser."""


@contextmanager
def opened_mdf(asammdf: Any, path: Path) -> Iterator[Any]:
    """Open an MDF file to read it.

    Parameters
    ----------
    asammdf
        The package.
    path
        The file.

    Yields
    ------
    asammdf.MDF
        The open file.

    Raises
    ------
    Exception
        Of any type, from asammdf, for an invalid file; ValueError for one that announces more samples than it can hold.
    """
    with temporary_folder() as folder, _without_messages():
        try:
            with asammdf.MDF(path, temporary_folder=str(folder)) as mdf:
                for group in mdf.groups:
                    _check_size(group.channel_group, path.stat().st_size)
                yield mdf
        except Exception as error:
            _close_unfinished(error)
            raise


@contextmanager
def _without_messages() -> Iterator[None]:
    """Keep asammdf from logging and printing what it finds wrong with a file: the exception says it."""

    def nothing(record: logging.LogRecord) -> bool:
        return False

    log = logging.getLogger("asammdf")
    log.addFilter(nothing)
    try:
        with closing(OutputCapture()) as printed, printed.on():
            yield
    finally:
        log.removeFilter(nothing)


def _check_size(group: Any, size: int) -> None:
    """Refuse a channel group that announces more samples than the file can hold: asammdf would look for them all."""
    announced = group.cycles_nr * max(1, group.samples_byte_nr)
    if announced > _MAX_RATIO * size:
        raise ValueError(f"{announced} bytes of samples announced in {size} bytes")


def _close_unfinished(error: BaseException) -> None:
    """Close the objects of asammdf whose construction an error has ended: they would print another one when deleted."""
    for frame, _ in walk_tb(error.__traceback__):
        unfinished: Any = frame.f_locals.get("self")
        if hasattr(unfinished, "_closed") and hasattr(unfinished, "_tempfile"):
            unfinished._closed = True
            unfinished._tempfile.close()
