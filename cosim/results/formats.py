"""Files that hold a run's table: written row by row as it comes, and read back."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from cosim.fmi.archive import is_file
from cosim.errors import SetupError
from cosim.results.file_sink import FileSink, Table, file_name
from cosim.results.csv_file import CsvSink
from cosim.results.mdf import MdfSink
from cosim.results.parquet import ParquetSink

__all__ = ["FORMATS", "CsvSink", "FileSink", "MdfSink", "ParquetSink", "Table", "file_names", "read", "sinks"]

FORMATS: dict[str, type[FileSink]] = {"csv": CsvSink, "parquet": ParquetSink, "mdf4": MdfSink}
"""Name of a format to what writes and reads it; the first is always written."""


def sinks(folder: Path, formats: Iterable[str] = ()) -> list[FileSink]:
    """Make what writes a run's table to a folder: CSV first, then the formats asked for.

    Raises
    ------
    SetupError
        If a format does not exist, or its package is not installed; nothing is written yet.
    """
    wanted = dict.fromkeys([next(iter(FORMATS)), *formats])
    problems = [f"format: expected one of {', '.join(FORMATS)}, got {name}" for name in wanted if name not in FORMATS]
    found: list[FileSink] = []
    for name in wanted:
        try:
            found += [FORMATS[name](folder)] if name in FORMATS else []
        except SetupError as error:
            problems += error.problems
    if problems:
        raise SetupError(*problems)
    return found


def file_names() -> list[str]:
    """Name every file that may hold the result of a run, complete or not."""
    return [file_name(kind.suffix, complete) for kind in FORMATS.values() for complete in (True, False)]


def read(path: Path) -> Table:
    """Read a table from a file of any format, known by its suffix.

    Raises
    ------
    SetupError
        If there is no such file, its format is not known or needs a package that is missing, or it does not hold a
        table of numbers over time.
    """
    kinds = {kind.suffix: kind for kind in FORMATS.values()}
    if path.suffix not in kinds:
        raise SetupError(f"{path}: expected a file named {', '.join(f'*{s}' for s in kinds)}, got {path.name}")
    if not is_file(path):
        raise SetupError(f"{path}: expected the result of a run, got no such file")
    table = kinds[path.suffix].read(path)
    if not table.names or table.names[0] != "time":
        raise SetupError(f"{path}: expected a first column time, got {table.names[0] if table.names else 'no column'}")
    return table
