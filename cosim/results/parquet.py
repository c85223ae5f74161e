"""Parquet files, for large studies: columns of floats, each with its unit in the column's metadata."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from cosim.errors import SetupError
from cosim.results.file_sink import BlockSink, ResultTable, Rows, import_optional

UNIT = b"unit"
"""Key of the unit in a column's metadata."""


def _pyarrow() -> tuple[Any, Any]:
    return import_optional("pyarrow", "parquet"), import_optional("pyarrow.parquet", "parquet")


class ParquetSink(BlockSink):
    """Writes a Parquet file with row groups of :data:`BLOCK_ROWS` rows; readable when the run has ended.

    Parameters
    ----------
    folder
        As of :class:`BlockSink`.
    """

    suffix = ".parquet"
    package = "pyarrow"

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._pyarrow, self._parquet = _pyarrow()

    def _begin(self, names: list[str], units: list[str | None]) -> None:
        pa = self._pyarrow
        columns = [
            pa.field(name, pa.float64(), metadata={UNIT: unit.encode()} if unit else None)
            for name, unit in zip(names, units, strict=True)
        ]
        self._schema = pa.schema(columns)
        self._writer = self._parquet.ParquetWriter(str(self._partial), self._schema)

    def _write_block(self, block: Rows) -> None:
        columns = [np.ascontiguousarray(column) for column in block.T]
        self._writer.write_table(self._pyarrow.table(columns, schema=self._schema))

    def _end(self) -> None:
        self._buffer.flush()
        self._writer.close()

    @classmethod
    def read(cls, path: Path) -> ResultTable:
        """Read a table with its units.

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
            If the file is not a table of numbers, or pyarrow is not installed.
        """
        pa, parquet = _pyarrow()
        try:
            table = parquet.read_table(str(path))
            rows = np.column_stack([np.asarray(column, dtype=float) for column in table.columns])
        except (pa.ArrowException, ValueError, OSError) as error:
            raise SetupError(f"{path}: expected a Parquet table of numbers, got: {error}") from None
        found = [(column.metadata or {}).get(UNIT) for column in table.schema]
        return ResultTable(table.column_names, [unit.decode() if unit else None for unit in found], rows)
