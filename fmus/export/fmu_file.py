"""Built FMU files: result of a build, GUID of a file, export from an installed wheel."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import fmpy

CARRIED = Path(__file__).parents[1] / "built"
"""Folder of the built FMUs in a wheel, each flavour in its subfolder."""


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


def export(carried: Path, folder: Path) -> Iterator[Path]:
    """Copy the FMUs of an installed wheel and the files beside them.

    Parameters
    ----------
    carried
        Folder of the FMUs in the wheel, each flavour in its subfolder.
    folder
        Target folder; each flavour is copied to its subfolder.

    Yields
    ------
    Path
        Each FMU when it is copied.

    Raises
    ------
    BuildError
        If there are none: the package was not installed from a wheel with FMUs.
    """
    files = sorted(path for path in carried.glob("*/*") if path.is_file())
    if not files:
        raise BuildError(f"{carried}: expected the FMUs of a wheel, got none; build them: seat-cosim build")
    for file in files:
        target = folder / file.parent.name / file.name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, target)
        if target.suffix == ".fmu":
            yield target
