"""What goes wrong before, in and after a co-simulation, each with one line that says what, where, expected, got."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from difflib import get_close_matches
from pathlib import Path


class CosimError(Exception):
    """Anything this package reports to its user."""


class SetupError(CosimError):
    """Seen before an FMU is instantiated: a missing file, an unknown variable, a wrong unit, a value out of range.

    Parameters
    ----------
    problems
        All problems found, one line each; checks collect before they stop.
    """

    def __init__(self, *problems: str) -> None:
        super().__init__("; ".join(problems))
        self.problems = problems


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
    def collected(self) -> Iterator[None]:
        """Add the problems of a :class:`SetupError` that is raised inside."""
        try:
            yield
        except SetupError as error:
            self.found += error.problems

    def raise_any(self) -> None:
        """Raise what was found.

        Raises
        ------
        SetupError
            With all problems, if there are any.
        """
        if self.found:
            raise SetupError(*self.found)


class RunError(CosimError):
    """An FMU failed after it was instantiated; names component, call and time."""


class SignalError(CosimError, ValueError):
    """A metric was asked of samples it cannot be computed from: too few, not finite, of different lengths."""


@contextmanager
def reading(file: Path) -> Iterator[None]:
    """Name the file in every :class:`SetupError` about what it says, where it is not named already."""
    try:
        yield
    except SetupError as error:
        raise SetupError(*(p if str(file) in p else f"{file}: {p}" for p in error.problems)) from error


@contextmanager
def writing_to(folder: Path) -> Iterator[None]:
    """Turn what goes wrong in writing to a folder the user named into a :class:`SetupError`."""
    try:
        yield
    except OSError as error:
        raise SetupError(f"{folder}: expected a folder to write to, got: {error.strerror}") from error


def did_you_mean(name: str, names: Iterable[str]) -> str:
    """Return a hint at the names most like one that does not exist, or an empty string."""
    close = get_close_matches(name, list(names), n=3, cutoff=0.5)
    return f" (did you mean {' or '.join(close)}?)" if close else ""
