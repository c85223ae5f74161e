"""Limits of what a file may ask for: what is above is refused at once, what is below costs time in proportion to it."""

from __future__ import annotations

from cosim.errors import SetupError

MAX_MEMBERS = 100_000
"""Maximum number of members of an archive."""

MAX_DOCUMENT = 32 * 2**20
"""Maximum size of an XML document, in bytes; read, it takes some 15 times that."""

SAFE_DOCUMENTS = 8 * 2**20
"""Size in bytes up to which the XML documents of a file may be packed at any ratio."""

MAX_DOCUMENT_RATIO = 100
"""Maximum ratio of the size of the XML documents, all stages unfolded, to that of the file on disk."""

MAX_DOCUMENTS = 128 * 2**20
"""Maximum size of all XML documents of a system, in bytes."""

MAX_VARIABLES = 150_000
"""Maximum number of variables of an FMU."""

MAX_UNITS = 10_000
"""Maximum number of units that an FMU or a system defines."""

MAX_CONNECTIONS = 100_000
"""Maximum number of connections of a system."""


def check_count(where: str, what: str, count: int, most: int) -> None:
    """Refuse too many of something.

    Parameters
    ----------
    where
        Name of the document in messages.
    what
        What is counted, in the plural.
    count
        How many there are.
    most
        How many there may be.

    Raises
    ------
    SetupError
        If there are more.
    """
    if count > most:
        raise SetupError(f"{where}: expected at most {most} {what}, got {count}")


class DocumentBudget:
    """How much XML the stages of one file may unfold to, counted before it is read.

    Parameters
    ----------
    size_on_disk
        Size of the outermost file, in bytes.
    """

    def __init__(self, size_on_disk: int) -> None:
        self._size_on_disk = size_on_disk
        self._spent = 0

    def spend(self, where: str, size: int) -> None:
        """Count a document that is about to be read.

        Parameters
        ----------
        where
            Name of the document in messages.
        size
            Its size, in bytes.

        Raises
        ------
        SetupError
            If it is too large, or all of them are.
        """
        self._spent += size
        if size > MAX_DOCUMENT:
            raise SetupError(f"{where}: expected a document of at most {_mib(MAX_DOCUMENT)}, got {_mib(size)}")
        if self._spent > MAX_DOCUMENTS:
            raise SetupError(
                f"{where}: expected at most {_mib(MAX_DOCUMENTS)} in all documents, got {_mib(self._spent)} so far"
            )
        if self._spent > max(SAFE_DOCUMENTS, MAX_DOCUMENT_RATIO * self._size_on_disk):
            raise SetupError(
                f"{where}: expected documents of at most {MAX_DOCUMENT_RATIO} times the size of the file, got "
                f"{_mib(self._spent)} from {_mib(self._size_on_disk)}"
            )


def _mib(size: int) -> str:
    return f"{size / 2**20:.3g} MiB"
