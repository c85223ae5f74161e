"""Formats of result files: which exist, how sinks are created, how files are read."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from cosim.errors import Problems, SetupError
from cosim.fmi.archive import is_file
from cosim.results.csv_file import CsvSink
from cosim.results.file_sink import FileSink, ResultTable, result_file_name
from cosim.results.mdf import MdfSink
from cosim.results.parquet import ParquetSink

__all__ = [
    "FORMATS",
    "CsvSink",
    "FileSink",
    "MdfSink",
    "ParquetSink",
    "ResultTable",
    "create_sinks",
    "read_table",
    "result_file_names",
]

FORMATS: dict[str, type[FileSink]] = {"csv": CsvSink, "parquet": ParquetSink, "mdf4": MdfSink}
"""Name of a format to the class that writes and reads it; the first is always written."""


def create_sinks(folder: Path, formats: Iterable[str] = ()) -> list[FileSink]:
    """Create the sinks that write a run's rows to files; no file is created yet.

    Parameters
    ----------
    folder
        Folder of the files.
    formats
        Names of further formats, see :data:`FORMATS`.

    Returns
    -------
    list of FileSink
        CSV first, then the further formats.

    Raises
    ------
    SetupError
        With all formats that do not exist or whose package is not installed.
    """
    names = dict.fromkeys([next(iter(FORMATS)), *formats])
    problems = Problems()
    problems.found += [f"format: expected one of {', '.join(FORMATS)}, got {n}" for n in names if n not in FORMATS]
    sinks: list[FileSink] = []
    for name in names:
        with problems.collected():
            sinks += [FORMATS[name](folder)] if name in FORMATS else []
    problems.raise_any()
    return sinks


def result_file_names() -> list[str]:
    """Return the names of all files that may hold the result of a run, complete or not."""
    return [result_file_name(kind.suffix, complete) for kind in FORMATS.values() for complete in (True, False)]


def read_table(path: Path) -> ResultTable:
    """Read a result file; its suffix determines the format.

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
        If there is no such file, its format is unknown or needs a package that is not installed, or it does not hold a
        table of numbers with the first column ``time``.
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
