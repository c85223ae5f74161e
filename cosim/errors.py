"""Errors of this package; each message is one line that says what, where, expected, got."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from difflib import get_close_matches
from pathlib import Path
from time import monotonic


class CosimError(Exception):
    """Base of all errors that this package reports to its user."""


class SetupError(CosimError):
    """An error found before an FMU is instantiated: a missing file, an unknown variable, a value out of range.

    Parameters
    ----------
    *problems
        All problems found, one line each.

    Attributes
    ----------
    problems
        The same as a tuple.
    """

    def __init__(self, *problems: str) -> None:
        super().__init__("; ".join(problems))
        self.problems = problems


class RunError(CosimError):
    """An FMU failed after it was instantiated; the message names component, call and time."""


class SignalError(CosimError, ValueError):
    """A metric cannot be computed from its samples: too few, not finite, of different lengths."""


class Problems:
    """Collects the problems of several checks, so that all are reported at once.

    Attributes
    ----------
    found
        One line for each problem.
    """

    def __init__(self) -> None:
        self.found: list[str] = []

    @contextmanager
    def collected(self, describe: Callable[[str], str] = str) -> Iterator[None]:
        """Add the problems of a :class:`SetupError` that is raised inside.

        Parameters
        ----------
        describe
            Applied to each problem, for example to add its place.
        """
        try:
            yield
        except SetupError as error:
            self.found += map(describe, error.problems)

    def raise_any(self) -> None:
        """Raise the collected problems.

        Raises
        ------
        SetupError
            With all problems, if there are any.
        """
        if self.found:
            raise SetupError(*self.found)


@contextmanager
def prefixed(where: str) -> Iterator[None]:
    """Add a place to each problem of a :class:`SetupError` that is raised inside.

    Parameters
    ----------
    where
        The place.
    """
    try:
        yield
    except SetupError as error:
        raise SetupError(*(f"{where}: {problem}" for problem in error.problems)) from None


@contextmanager
def reading(file: Path) -> Iterator[None]:
    """Add the name of a file to each problem of a :class:`SetupError` that is raised inside and does not name it.

    Parameters
    ----------
    file
        The file that is read.
    """
    try:
        yield
    except SetupError as error:
        raise SetupError(*(p if str(file) in p else f"{file}: {p}" for p in error.problems)) from error


@contextmanager
def writing_to(folder: Path) -> Iterator[None]:
    """Convert an :class:`OSError` that is raised inside to a :class:`SetupError`.

    Parameters
    ----------
    folder
        The folder that is written to, as the user named it.
    """
    try:
        yield
    except OSError as error:
        raise SetupError(f"{folder}: expected a folder to write to, got: {error.strerror}") from error


def did_you_mean(name: str, names: Iterable[str]) -> str:
    """Return a hint at existing names that are similar to an unknown one.

    Parameters
    ----------
    name
        The unknown name.
    names
        The existing names.

    Returns
    -------
    str
        The hint in parentheses, to be appended to a message; empty where no name is similar.

    Examples
    --------
    >>> did_you_mean("seet", ["seat", "shaker"])
    ' (did you mean seat?)'
    """
    names = names if isinstance(names, Collection) else list(names)
    if len(names) > _ALL_COMPARED and _has_suggested_enough():
        return ""
    close = get_close_matches(name, _candidates(name, list(names)), n=3, cutoff=0.5)
    return f" (did you mean {' or '.join(close)}?)" if close else ""


_ALL_COMPARED = 500
"""Up to how many names all are compared, which takes 10 us each."""

_LOOKED_AT = 100_000
"""How many names are looked at; further ones are not suggested."""


_IN_A_ROW = 20
"""How many unknown names in a row are compared with many names: a file may have thousands of them."""

_PAUSE = 1.0
"""Time in s after which a new row begins."""

_row = [0.0, 0.0]
"""When the last unknown name was compared with many names, and how many were in its row."""


def _has_suggested_enough() -> bool:
    now = monotonic()
    _row[1] = _row[1] + 1 if now - _row[0] < _PAUSE else 1
    _row[0] = now
    return _row[1] > _IN_A_ROW


def _candidates(name: str, names: list[str]) -> list[str]:
    """Choose which names to compare: of many, those of a similar length that begin and end most alike."""
    if len(names) <= _ALL_COMPARED:
        return names
    low, high = 0.7 * len(name), 1.4 * len(name)
    found = [each for each in names[:_LOOKED_AT] if low <= len(each) <= high]
    for size in range(2, len(name)):
        if len(found) <= _ALL_COMPARED:
            break
        head, tail = name[:size], name[-size:]
        alike = [each for each in found if each.startswith(head) or each.endswith(tail)]
        if not alike:
            break
        found = alike
    back = name[::-1]
    return heapq.nlargest(_ALL_COMPARED, found, key=lambda each: _shared(each, name) + _shared(each[::-1], back))


def _shared(one: str, other: str) -> int:
    """Return how many characters two names begin with alike."""
    return next((i for i, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), min(len(one), len(other)))


def listed(names: Sequence[str], most: int = 8) -> str:
    """List names with commas between, and the number of those that are left out.

    Parameters
    ----------
    names
        The names.
    most
        How many are listed.

    Returns
    -------
    str
        The list, for a message.

    Examples
    --------
    >>> listed(["a", "b", "c"], most=2)
    'a, b and 1 more'
    """
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more


def with_article(noun: str) -> str:
    """Write a noun with its indefinite article."""
    return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"
