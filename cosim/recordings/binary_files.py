"""MDF, MAT and Parquet files of measurements."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from cosim.errors import SetupError
from cosim.recordings.columns import Column, read_column
from cosim.recordings.measurement_file import Floats, package
from cosim.results.mdf_reading import opened_mdf
from cosim.results.parquet import UNIT


class MdfFile:
    """An MDF file, read by asammdf; each channel has the times of its group.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    SetupError
        If it cannot be read.

    Attributes
    ----------
    clocks
        Names of the channels of times.
    """

    description = "MDF"

    def __init__(self, path: Path) -> None:
        self.path = path
        self._asammdf = package("asammdf")
        self._places: list[tuple[int, int]] = []
        self._signals: dict[int, Any] = {}
        self.clocks: set[str] = set()
        columns = []
        with self._open() as mdf:
            for group, content in enumerate(mdf.groups):
                master = mdf.masters_db.get(group)
                for index, channel in enumerate(content.channels):
                    if index != master:
                        unit = channel.unit or getattr(channel.conversion, "unit", "")
                        columns.append(read_column(channel.name, unit))
                        self._places.append((group, index))
                    else:
                        self.clocks.add(channel.name)
        self.columns: Sequence[Column] = columns

    @contextmanager
    def _open(self) -> Iterator[Any]:
        try:
            with opened_mdf(self._asammdf, self.path) as mdf:
                yield mdf
        except SetupError:
            raise
        except Exception as error:  # asammdf raises exceptions of many types for invalid files
            raise SetupError(f"{self.path}: expected an MDF file, got: {' '.join(str(error).split())}") from None

    def load(self, indices: Sequence[int]) -> None:
        """Read columns of the file.

        Parameters
        ----------
        indices
            Indices of the columns.
        """
        with self._open() as mdf:
            for index in indices:
                group, channel = self._places[index]
                try:
                    self._signals[index] = mdf.get(group=group, index=channel)
                except Exception as error:
                    where = f"{self.path}, {self.columns[index].text}"
                    raise SetupError(f"{where}: expected samples, got: {' '.join(str(error).split())}") from None

    def values(self, index: int) -> np.ndarray[Any, Any]:
        """Return the values of a channel, NaN where the logger marked them as invalid.

        Parameters
        ----------
        index
            Index of a loaded column.
        """
        signal = self._signals[index]
        samples = np.asarray(signal.samples)
        if samples.dtype.kind not in "biuf" or samples.ndim != 1:
            return samples.astype(object) if samples.ndim == 1 else samples
        samples = samples.astype(np.float64)
        if signal.invalidation_bits is not None:
            samples[np.asarray(signal.invalidation_bits, dtype=bool)] = np.nan
        return samples

    def times(self, index: int) -> Floats | None:
        """Return the times of a channel's group.

        Parameters
        ----------
        index
            Index of a loaded column.
        """
        return np.asarray(self._signals[index].timestamps, dtype=np.float64)

    def place(self, row: int) -> str:
        """Return the number of a sample.

        Parameters
        ----------
        row
            Number of the row from 0.
        """
        return f"sample {row + 1}"


class _Columns:
    """Values by column in memory.

    Parameters
    ----------
    path
        The file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._arrays: dict[int, np.ndarray[Any, Any]] = {}

    def values(self, index: int) -> np.ndarray[Any, Any]:
        """Return the values of a column.

        Parameters
        ----------
        index
            Index of a loaded column.
        """
        array = self._arrays[index]
        return array.astype(np.float64) if array.dtype.kind in "biuf" else array

    def times(self, index: int) -> Floats | None:
        """Return None: times are in a column.

        Parameters
        ----------
        index
            Index of a loaded column.
        """
        return None

    def place(self, row: int) -> str:
        """Return the number of a row.

        Parameters
        ----------
        row
            Number of the row from 0.
        """
        return f"row {row + 1}"


class MatFile(_Columns):
    """A MAT file of version 4 to 7, read by scipy: vectors, columns of matrices, and those in structures.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    SetupError
        If it cannot be read, or has no vectors.
    """

    description = "MAT"

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        import scipy.io

        try:
            content = scipy.io.loadmat(str(path), squeeze_me=True, struct_as_record=False, chars_as_strings=True)
        except NotImplementedError:
            raise SetupError(f'{path}: expected a MAT file up to version 7, got 7.3; save it with "-v7"') from None
        except Exception as error:  # scipy raises exceptions of many types for invalid files
            raise SetupError(f"{path}: expected a MAT file, got: {' '.join(str(error).split())}") from None
        found = [item for name, value in content.items() if not name.startswith("__") for item in _vectors(name, value)]
        if not found:
            raise SetupError(f"{path}: expected vectors or matrices of numbers, got none; save arrays or structures")
        units = {name: text for name, text in _texts(content) if len(text) < 20}
        self.columns: Sequence[Column] = [read_column(name, _unit_of(name, units)) for name, _ in found]
        self._arrays = dict(enumerate(array for _, array in found))

    def load(self, indices: Sequence[int]) -> None:
        """Do nothing: all variables are in memory.

        Parameters
        ----------
        indices
            Indices of the columns.
        """


def _vectors(name: str, value: Any) -> Iterator[tuple[str, np.ndarray[Any, Any]]]:
    """Yield the vectors of a variable: itself, the columns of a matrix, or those of a structure's fields."""
    if hasattr(value, "_fieldnames"):
        for field in value._fieldnames:
            yield from _vectors(f"{name}.{field}", getattr(value, field))
        return
    array = np.asarray(value)
    if array.dtype.kind not in "biuf" or array.size < 2:
        return
    if array.ndim == 1:
        yield name, array
    elif array.ndim == 2:
        columns = array if array.shape[0] >= array.shape[1] else array.T
        for i, column in enumerate(columns.T):
            yield f"{name}({i + 1})", column


def _texts(content: Any, prefix: str = "") -> Iterator[tuple[str, str]]:
    """Yield the texts of variables and of structures' fields."""
    for name, value in content.items():
        if hasattr(value, "_fieldnames"):
            yield from _texts({field: getattr(value, field) for field in value._fieldnames}, f"{prefix}{name}.")
        elif isinstance(value, str):
            yield prefix + name, value


def _unit_of(name: str, texts: dict[str, str]) -> str | None:
    """Return the unit beside a vector: ``acc_unit`` of ``acc``, ``s.unit`` or ``s.Units`` of ``s.data``."""
    outer = name.rpartition(".")[0]
    candidates = [f"{name}_unit", f"{name}_units", *(f"{outer}.{word}" for word in ("unit", "units", "Unit", "Units"))]
    return next((texts[each] for each in candidates if each in texts), None)


class ParquetFile(_Columns):
    """A Parquet file, read by pyarrow.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    SetupError
        If it cannot be read.
    """

    description = "Parquet"

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self._arrow, self._parquet = package("pyarrow"), package("pyarrow.parquet")
        try:
            schema = self._parquet.read_schema(str(path))
        except (self._arrow.ArrowException, OSError) as error:
            raise SetupError(f"{path}: expected a Parquet file, got: {' '.join(str(error).split())}") from None
        units = [(field.metadata or {}).get(UNIT) for field in schema]
        self._names = list(schema.names)
        self.columns: Sequence[Column] = [
            read_column(name, unit.decode(errors="replace") if unit else None)
            for name, unit in zip(schema.names, units, strict=True)
        ]

    def load(self, indices: Sequence[int]) -> None:
        """Read columns of the file.

        Parameters
        ----------
        indices
            Indices of the columns.
        """
        wanted = sorted(set(indices))
        try:
            table = self._parquet.read_table(str(self.path), columns=[self._names[i] for i in wanted])
        except (self._arrow.ArrowException, OSError) as error:
            raise SetupError(f"{self.path}: expected a Parquet table, got: {' '.join(str(error).split())}") from None
        for i in wanted:
            self._arrays[i] = self._array(table.column(self._names[i]))

    def _array(self, column: Any) -> np.ndarray[Any, Any]:
        """Return numbers as floats, moments as datetime64, durations and times of day in s, and others as objects."""
        types, kind = self._arrow.types, column.type
        if types.is_timestamp(kind):
            return np.asarray(column.cast(self._arrow.timestamp("ns")).to_numpy(), dtype="datetime64[ns]")
        if types.is_duration(kind) or types.is_time(kind):
            scale = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}[kind.unit]
            width = self._arrow.int64() if kind.bit_width == 64 else self._arrow.int32()
            return np.asarray(column.cast(width).to_numpy(), dtype=np.float64) * scale
        if types.is_integer(kind) or types.is_floating(kind) or types.is_decimal(kind):
            return np.asarray(column.cast(self._arrow.float64()).to_numpy(), dtype=np.float64)
        return np.asarray(column.to_pylist(), dtype=object)
