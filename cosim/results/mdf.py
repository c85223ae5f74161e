"""MDF4 files, the measurement format of automotive tools: one channel group over time, channels with units."""

from __future__ import annotations

import struct
from contextlib import ExitStack
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from cosim.errors import SetupError
from cosim.fmi.temporary_folders import temporary_folder
from cosim.results.file_sink import BlockSink, ResultTable, Rows, import_optional
from cosim.results.mdf_reading import opened_mdf

_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
"""Start time of every measurement, so that equal runs give equal bytes."""

_FILE_HISTORY_LINK = 64 + 24 + 8
"""Offset of the link to the first FHBLOCK: after the ID block, the header block's head and its first link."""

_HISTORY_TIME = 24 + 2 * 8
"""Offset of the time in an FHBLOCK: after its head and two links."""

_NO_TIME = struct.pack("<QhhB", 0, 0, 0, 0)
"""Time in ns, offsets of time zone and summer time in min, flags."""


def _asammdf() -> Any:
    return import_optional("asammdf", "mdf")


class MdfSink(BlockSink):
    """Writes an MDF 4.10 file, from a temporary file when the run has ended, complete or not.

    Parameters
    ----------
    folder
        As of :class:`BlockSink`.
    """

    suffix = ".mf4"
    package = "asammdf"

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._asammdf = _asammdf()

    def _begin(self, names: list[str], units: list[str | None]) -> None:
        self._names, self._units = names, units
        self._stack = ExitStack()
        folder = self._stack.enter_context(temporary_folder())  # so that it is cleaned up also after a kill
        self._mdf = self._asammdf.MDF(version="4.10", temporary_folder=str(folder))
        self._mdf.start_time = _EPOCH
        self._group: int | None = None

    def _write_block(self, block: Rows) -> None:
        time, *columns = (np.ascontiguousarray(column) for column in block.T)
        if self._group is not None:
            self._mdf.extend(self._group, [(column, None) for column in (time, *columns)])
            return
        named = zip(columns, self._names[1:], self._units[1:], strict=True)
        signals = [
            self._asammdf.Signal(samples=column, timestamps=time, name=name, unit=unit or "")
            for column, name, unit in named
        ]
        self._group = self._mdf.append(signals, comment="", common_timebase=True)

    def _end(self) -> None:
        with self._stack:
            self._stack.callback(self._mdf.close)
            self._buffer.flush()
            if self._group is None:
                self._write_block(np.empty((0, len(self._names))))
            self._mdf.save(self._partial, overwrite=True)
        self._reset_history_time()

    def _reset_history_time(self) -> None:
        """Set the time and zone of the file's history, which asammdf takes from the system clock, to zero."""
        with self._partial.open("r+b") as stream:
            stream.seek(_FILE_HISTORY_LINK)
            (history,) = struct.unpack("<Q", stream.read(8))
            stream.seek(history + _HISTORY_TIME)
            stream.write(_NO_TIME)

    @classmethod
    def read(cls, path: Path) -> ResultTable:
        """Read the first channel group with its units.

        Parameters
        ----------
        path
            The file.

        Returns
        -------
        ResultTable
            The content of the file.

        Raises
        ------
        SetupError
            If the file has no channel group, or asammdf is not installed.
        """
        asammdf = _asammdf()
        try:
            with opened_mdf(asammdf, path) as mdf:
                channels = [mdf.get(group=0, index=i, raw=True) for i in range(len(mdf.groups[0].channels))]
                rows = np.column_stack([channel.samples.astype(float) for channel in channels])
        except Exception as error:  # asammdf raises exceptions of many types for invalid files
            raise SetupError(f"{path}: expected an MDF4 file with a channel group, got: {error}") from None
        return ResultTable([c.name for c in channels], [c.unit or None for c in channels], rows)
