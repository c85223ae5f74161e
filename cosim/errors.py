"""Errors of this package; each message is one line that says what, where, expected, got."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from difflib import get_close_matches
from pathlib import Path


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
    close = get_close_matches(name, list(names), n=3, cutoff=0.5)
    return f" (did you mean {' or '.join(close)}?)" if close else ""


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
