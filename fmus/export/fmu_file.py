"""Built FMU files: result of a build, GUID of a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import fmpy


class BuildError(RuntimeError):
    """A failed build; the message ends with the output of the build tool."""


@dataclass(frozen=True)
class BuildResult:
    """Result of the build of one file.

    Attributes
    ----------
    path
        Path of the file.
    fresh
        Whether the file was built; False if one of the same content existed.
    """

    path: Path
    fresh: bool


def guid_of(path: Path) -> str | None:
    """Return the GUID of an FMU file.

    Parameters
    ----------
    path
        Path of the FMU.

    Returns
    -------
    str or None
        None if the file does not exist or cannot be read.
    """
    try:
        return str(fmpy.read_model_description(str(path), validate=False).guid)
    except Exception:  # whatever the reason, it is not the FMU to be built
        return None
