"""Strict reading of TOML tables: every problem is one line that says what, where, expected, got."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from cosim.errors import Problems, did_you_mean
from cosim.fmi.values import Scalar

Kind = Callable[[Any], Any]
"""Converts a value of TOML; raises :class:`TypeError` with what was expected."""


def number(value: Any) -> float:
    """Return a number; whole numbers become floats.

    Parameters
    ----------
    value
        What TOML has.
    """
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError("a number")
    return float(value)


def whole(value: Any) -> int:
    """Return a whole number.

    Parameters
    ----------
    value
        What TOML has.
    """
    if isinstance(value, bool) or not isinstance(value, int):
        raise TypeError("a whole number")
    return value


def text(value: Any) -> str:
    """Return a text as it is.

    Parameters
    ----------
    value
        What TOML has.
    """
    if not isinstance(value, str):
        raise TypeError("a text")
    return value


def truth(value: Any) -> bool:
    """Return true or false.

    Parameters
    ----------
    value
        What TOML has.
    """
    if not isinstance(value, bool):
        raise TypeError("true or false")
    return value


def scalar(value: Any) -> Scalar:
    """Return a number, a text, or true or false.

    Parameters
    ----------
    value
        What TOML has.
    """
    if not isinstance(value, bool | int | float | str):
        raise TypeError("a number, a text, true or false")
    return value


def table(value: Any) -> dict[str, Any]:
    """Return a table as it is.

    Parameters
    ----------
    value
        What TOML has.
    """
    if not isinstance(value, dict):
        raise TypeError("a table")
    return value


def one_of(*choices: str) -> Kind:
    """Return a reader of one of several texts.

    Parameters
    ----------
    *choices
        The texts.
    """

    def read(value: Any) -> str:
        if value not in choices:
            hint = did_you_mean(value, choices) if isinstance(value, str) else ""
            raise TypeError(f"one of {', '.join(choices)}{hint}")
        return str(value)

    return read


def list_of(kind: Kind, length: int | None = None) -> Kind:
    """Return a reader of lists of a kind.

    Parameters
    ----------
    kind
        Reads each of them.
    length
        Length of the list; any where None.
    """
    what = "values" if length is None else f"{length} values"

    def read(value: Any) -> tuple[Any, ...]:
        if not isinstance(value, list) or length not in (None, len(value)):
            raise TypeError(f"a list of {what}")
        try:
            return tuple(kind(each) for each in value)
        except TypeError as error:
            raise TypeError(f"a list of {what}, each {error}") from None

    return read


def table_of(kind: Kind) -> Kind:
    """Return a reader of tables whose values are of a kind.

    Parameters
    ----------
    kind
        Reads each of them.
    """

    def read(value: Any) -> dict[str, Any]:
        found = table(value)
        for name, each in found.items():
            try:
                found[name] = kind(each)
            except TypeError as error:
                raise TypeError(f"a table of values, {name} {error}") from None
        return found

    return read


class TableReader:
    """Reads the keys of a table; each problem is collected.

    Parameters
    ----------
    data
        The table.
    where
        Name of the table in messages, such as the file's.
    problems
        Collects the problems.
    """

    def __init__(self, data: Mapping[str, Any], where: str, problems: Problems) -> None:
        self._data, self._where, self._problems = dict(data), where, problems
        self._known: dict[str, None] = {}

    def __contains__(self, key: str) -> bool:
        return key in self._data

    def take(self, key: str, kind: Kind, default: Any, required: bool = False) -> Any:
        """Return the value of a key.

        Parameters
        ----------
        key
            The key.
        kind
            Reads it.
        default
            Returned where the table does not have the key, or another value.
        required
            Whether the table must have the key.
        """
        self._known[key] = None
        if key not in self._data:
            if required:
                self.add(f"expected a key {key}, got none")
            return default
        try:
            return kind(self._data[key])
        except TypeError as error:
            self.add(f"{key}: expected {error}, got {_shown(self._data[key])}")
            return default

    def add(self, problem: str) -> None:
        """Add a problem of this table.

        Parameters
        ----------
        problem
            The problem, without the place.
        """
        self._problems.found.append(f"{self._where}: {problem}")

    @contextmanager
    def checking(self) -> Iterator[None]:
        """Collect the problems of a :class:`SetupError` that is raised inside."""
        with self._problems.collected(lambda problem: f"{self._where}: {problem}"):
            yield

    def close(self) -> None:
        """Add a problem for each key that was not read."""
        for key in self._data:
            if key not in self._known:
                self.add(f"expected keys among {', '.join(self._known)}, got {key}{did_you_mean(key, self._known)}")


def _shown(value: Any) -> str:
    """Return a value as text, shortened where it is long."""
    shown = repr(value) if not isinstance(value, bool) else str(value).lower()
    return shown if len(shown) <= 40 else f"{shown[:40]}…"
