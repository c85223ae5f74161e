"""Standard output and error of a command: any encoding, closed ones, full disks and pipes that nobody reads."""

from __future__ import annotations

import codecs
import io
import os
import sys
import unicodedata
from contextlib import suppress
from pathlib import Path

ERRORS = "seat-cosim.plain"
"""Name of the handler of characters that an encoding has not."""

_PLAIN = {
    "–": "-",
    "—": "-",
    "−": "-",
    "‘": "'",
    "’": "'",
    "“": '"',
    "”": '"',
    "·": ".",
    "…": "...",
    "×": "x",
    "µ": "u",
}
"""Characters to what stands for them where they cannot be written."""


def _plain(error: UnicodeError) -> tuple[str, int]:
    """Replace characters that cannot be encoded by similar ones, others by their escapes."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    found = []
    for character in error.object[error.start : error.end]:
        similar = _PLAIN.get(character) or unicodedata.normalize("NFKD", character)
        similar = "".join(each for each in similar if each.isascii())
        found.append(similar or character.encode("ascii", "backslashreplace").decode())
    return "".join(found), error.end


def prepare() -> None:
    """Make standard output and error accept every text, also where the process has none."""
    codecs.register_error(ERRORS, _plain)
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, Path(os.devnull).open("w", encoding="utf-8"))  # noqa: SIM115
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors=ERRORS)


def tell(message: str) -> None:
    """Print a line to standard error, if it can be.

    Parameters
    ----------
    message
        The line.
    """
    with suppress(OSError, ValueError):
        print(message, file=sys.stderr, flush=True)


def flush() -> bool:
    """Write what is buffered.

    Returns
    -------
    bool
        Whether standard output has taken everything; False for a full disk or a pipe that nobody reads.
    """
    try:
        sys.stdout.flush()
    except (OSError, ValueError):
        discard()
        return False
    return True


def discard() -> None:
    """Discard what is buffered and what follows, so that Python does not complain at its end."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):
            try:
                stream.flush()
            except (OSError, ValueError):
                descriptor = os.open(os.devnull, os.O_WRONLY)
                os.dup2(descriptor, stream.fileno())
                os.close(descriptor)
