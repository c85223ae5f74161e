"""The dataset of a sweep: one Parquet file of all runs, and a part for each finished batch until then.

``runs.parquet`` has a row for each run, in their order, with the study, versions and hashes in its metadata; its bytes
do not depend on how the runs were batched. ``parts`` holds the batches that are finished; a part is whole or not there.
"""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from cosim.errors import RunError, SetupError
from cosim.results.file_sink import import_optional
from cosim.results.folder_lock import LOCK
from cosim.results.parquet import UNIT
from cosim.sweep.plan import Column, ColumnKind, Rows

RUNS, PARTS, MANIFEST, STUDY = "runs.parquet", "parts", "sweep.json", "study.toml"
"""Names in a sweep's folder: the table, the finished batches, what the sweep is and how far it is, the study."""

METADATA = b"seat-cosim"
"""Key of the table's metadata that holds the same as ``sweep.json`` of the study, versions and hashes, as JSON."""

_ROW_GROUP = 4096
"""Rows of a row group."""

_NAME = re.compile(r"(\d+)-(\d+)\.parquet")


class Dataset:
    """The files of a sweep.

    Parameters
    ----------
    folder
        The sweep's folder.
    columns
        Columns of the table.
    runs
        Number of runs.
    about
        What the sweep is, as of JSON: its study, versions and hashes.

    Raises
    ------
    SetupError
        If pyarrow is not installed.
    """

    def __init__(self, folder: Path, columns: Sequence[Column], runs: int, about: Mapping[str, Any]) -> None:
        self._pa = import_optional("pyarrow", "parquet")
        self._parquet = import_optional("pyarrow.parquet", "parquet")
        self.folder, self.runs, self.about = folder, runs, dict(about)
        self.path, self._parts = folder / RUNS, folder / PARTS
        self._names = [column.name for column in columns]
        self._schema = self._pa.schema(
            [
                self._pa.field(c.name, self._type(c.kind), metadata={UNIT: c.unit.encode()} if c.unit else None)
                for c in columns
            ]
        )
        self._texts = [column.name for column in columns if column.kind == "text"]

    def _type(self, kind: ColumnKind) -> Any:
        pa = self._pa
        return {
            "integer": pa.int64(),
            "number": pa.float64(),
            "truth": pa.bool_(),
            "text": pa.string(),
            "series": pa.list_(pa.float64()),
        }[kind]

    # ---- what was done before ----------------------------------------------------------------------------------------

    def prepare(self, force: bool) -> bool:
        """Prepare the folder: keep what the same sweep has left, refuse what another one has.

        Parameters
        ----------
        force
            Whether to remove what another one has left.

        Returns
        -------
        bool
            Whether the table is complete already.

        Raises
        ------
        SetupError
            If the folder holds another sweep, and it is not to be removed.
        """
        earlier = read_manifest(self.folder)
        others = [path.name for path in self.folder.iterdir() if path.name != LOCK] if earlier is None else []
        if others and not force:
            raise SetupError(
                f"{self.folder}: expected a new folder, or that of a sweep, got one with {sorted(others)[0]}; "
                "--force writes beside it"
            )
        if earlier is not None and earlier.get("fingerprint") != self.about["fingerprint"]:
            if not force:
                raise SetupError(self._difference(earlier))
            self.path.unlink(missing_ok=True)
            shutil.rmtree(self._parts, ignore_errors=True)
        elif earlier is not None and earlier.get("complete") and self.path.is_file():
            return True
        self._parts.mkdir(parents=True, exist_ok=True)
        for path in self._parts.iterdir():
            if not _NAME.fullmatch(path.name):
                path.unlink()  # a batch that was being written
        self.write_manifest(complete=False)
        return False

    def _difference(self, earlier: Mapping[str, Any]) -> str:
        """Say how an earlier sweep differs."""
        before = earlier.get("versions", {})
        changed = [
            f"{name} {v}, before {before.get(name)}"
            for name, v in self.about["versions"].items()
            if before.get(name) != v
        ]
        if earlier.get("study") != self.about["study"]:
            what = "another study"
        elif changed:
            what = f"one of other versions ({'; '.join(changed)})"
        else:
            what = "one of other FMUs or files"
        return f"{self.folder}: expected no sweep, or one of the same study, got {what}; --force removes it"

    def write_manifest(self, complete: bool, **more: Any) -> None:
        """Write the file ``sweep.json``, as a whole.

        Parameters
        ----------
        complete
            Whether the table is complete.
        **more
            What is known at the end.
        """
        unfinished = self.folder / f"{MANIFEST}.tmp"
        text = json.dumps({"format": 1, "complete": complete, **self.about, **more}, indent=2, ensure_ascii=False)
        unfinished.write_text(text + "\n", encoding="utf-8")
        unfinished.replace(self.folder / MANIFEST)

    def finished(self) -> list[tuple[int, int]]:
        """Return the runs that are done: first, and the one after the last, of each part, in their order."""
        if not self._parts.is_dir():
            return []
        found = [_NAME.fullmatch(path.name) for path in self._parts.iterdir()]
        return sorted((int(each[1]), int(each[2]) + 1) for each in found if each)

    def missing(self) -> Iterator[tuple[int, int]]:
        """Yield the runs that are not done: first, and the one after the last."""
        reached = 0
        for start, stop in self.finished():
            if start > reached:
                yield reached, start
            reached = max(reached, stop)
        if reached < self.runs:
            yield reached, self.runs

    # ---- rows --------------------------------------------------------------------------------------------------------

    def add(self, rows: Rows) -> None:
        """Write a finished batch; it is there as a whole or not at all.

        Parameters
        ----------
        rows
            Its rows.

        Raises
        ------
        RunError
            If it cannot be written.
        """
        columns = dict(rows.columns)
        for name in self._texts:  # values of several kinds
            columns[name] = [None if value is None else str(value) for value in columns[name]]
        table = self._pa.table({name: columns[name] for name in self._names}, schema=self._schema)
        path = self._parts / f"{rows.start:09d}-{rows.start + rows.runs - 1:09d}.parquet"
        unfinished = path.with_suffix(".tmp")
        try:
            self._parquet.write_table(table, str(unfinished))
            unfinished.replace(path)
        except OSError as error:
            raise RunError(f"{path}: expected to write it, got: {error.strerror or error}") from error

    def write_table(self) -> None:
        """Write the table of all parts, in the order of the runs.

        Raises
        ------
        RunError
            If it cannot be written.
        """
        schema = self._schema.with_metadata({METADATA: json.dumps(self.about, ensure_ascii=False).encode()})
        unfinished = self.path.with_suffix(".tmp")
        try:
            with self._parquet.ParquetWriter(str(unfinished), schema) as writer:
                for table in self._row_groups(schema):
                    writer.write_table(table)
            unfinished.replace(self.path)
        except OSError as error:
            raise RunError(f"{self.path}: expected to write it, got: {error.strerror or error}") from error

    def complete(self, **more: Any) -> None:
        """Say that the table is complete, and remove the parts.

        Parameters
        ----------
        **more
            What is known at the end, for ``sweep.json``.
        """
        self.write_manifest(complete=True, **more)
        shutil.rmtree(self._parts, ignore_errors=True)

    def _row_groups(self, schema: Any) -> Iterator[Any]:
        """Yield tables of one size, whatever the parts are."""
        waiting: list[Any] = []
        count = 0
        for start, stop in self.finished():
            part = self._parquet.read_table(str(self._parts / f"{start:09d}-{stop - 1:09d}.parquet"))
            part = part.cast(self._schema).replace_schema_metadata(schema.metadata)
            waiting.append(part)
            count += part.num_rows
            while count >= _ROW_GROUP:
                joined = self._pa.concat_tables(waiting)
                yield joined.slice(0, _ROW_GROUP).combine_chunks()
                waiting, count = [joined.slice(_ROW_GROUP)], count - _ROW_GROUP
        if count:
            yield self._pa.concat_tables(waiting).combine_chunks()

    def failures(self) -> tuple[int, list[tuple[int, str]]]:
        """Return the number of failed runs of the table, and the first of them with their reasons."""
        table = self._parquet.read_table(str(self.path), columns=["run", "error"])
        failed = table.filter(self._pa.compute.is_valid(table["error"]))
        first = failed.slice(0, 20).to_pylist()
        return failed.num_rows, [(row["run"], row["error"]) for row in first]


def read_manifest(folder: Path) -> dict[str, Any] | None:
    """Return what ``sweep.json`` of a folder says; None where there is none.

    Parameters
    ----------
    folder
        The folder.

    Raises
    ------
    SetupError
        If it cannot be read.
    """
    path = folder / MANIFEST
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise SetupError(f"{path}: expected that of a sweep, got: {error}") from None
    if not isinstance(found, dict):
        raise SetupError(f"{path}: expected that of a sweep, got other JSON")
    return found


def read_columns(path: Path, names: Sequence[str] | None = None) -> dict[str, Any]:
    """Read a table of runs.

    Parameters
    ----------
    path
        The file ``runs.parquet``.
    names
        Columns to read; all where None.

    Returns
    -------
    dict
        Name of each column to its values: an array of floats for numbers, NaN where there is none; a list otherwise.

    Raises
    ------
    SetupError
        If the file is not such a table, or pyarrow is not installed.
    """
    import numpy as np

    pa, parquet = import_optional("pyarrow", "parquet"), import_optional("pyarrow.parquet", "parquet")
    try:
        table = parquet.read_table(str(path), columns=None if names is None else list(names))
    except (pa.ArrowException, ValueError, OSError) as error:
        raise SetupError(f"{path}: expected the table of a sweep, got: {error}") from None
    found: dict[str, Any] = {}
    for name, column in zip(table.column_names, table.columns, strict=True):
        values = column.to_pylist()
        is_number = pa.types.is_floating(column.type) or pa.types.is_integer(column.type)
        found[name] = np.array([np.nan if v is None else v for v in values], dtype=float) if is_number else values
    return found
