"""Built FMU files: recognised by their GUID, and copied out of an installed wheel."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import fmpy

CARRIED = Path(__file__).parents[1] / "built"
"""Where a wheel carries built FMUs, each flavour in its subfolder."""


class BuildError(RuntimeError):
    """A build tool failed; the message ends with what it said."""


@dataclass(frozen=True)
class Built:
    """One built FMU.

    Attributes
    ----------
    path
        Where it lies.
    fresh
        False where a file of the same content stood there already.
    """

    path: Path
    fresh: bool


def guid_of(path: Path) -> str | None:
    """Read the GUID of an FMU that may not be there or may be broken."""
    try:
        return str(fmpy.read_model_description(str(path), validate=False).guid)
    except Exception:  # whatever is wrong with it, it is not the FMU to be built
        return None


def export(carried: Path, folder: Path) -> Iterator[Path]:
    """Copy the FMUs that came with an installed package, and what lies beside them.

    Parameters
    ----------
    carried
        Where they lie, each flavour in its subfolder.
    folder
        Where to; each flavour goes to its subfolder.

    Yields
    ------
    Path
        Each FMU as soon as it is there.

    Raises
    ------
    BuildError
        If there are none: the package was not installed from a wheel that carries them.
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
