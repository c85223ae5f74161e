"""FMU files: written so that the same content gives the same bytes, and recognised by their GUID."""

from __future__ import annotations

import io
import shutil
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import fmpy

CARRIED = Path(__file__).with_name("built")
"""Where a wheel carries built FMUs, each flavour in its subfolder."""

_EPOCH = (1980, 1, 1, 0, 0, 0)


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


def write_archive(path: Path, contents: Mapping[str, bytes]) -> bool:
    """Write an archive with sorted entries and without times; it is there as a whole or not at all.

    Parameters
    ----------
    path
        The file; its folder is made where it does not exist.
    contents
        Name in the archive to content.

    Returns
    -------
    bool
        False where the same file stood there already; it is left alone.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name in sorted(contents):
            info = zipfile.ZipInfo(name, _EPOCH)
            info.external_attr = 0o644 << 16
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, contents[name])
    if path.is_file() and path.read_bytes() == stream.getvalue():
        return False
    unfinished = path.with_suffix(".tmp")
    unfinished.write_bytes(stream.getvalue())
    unfinished.replace(path)
    return True


def read_archive(path: Path) -> dict[str, bytes]:
    """Read all files of an archive."""
    with zipfile.ZipFile(path) as archive:
        return {info.filename: archive.read(info) for info in archive.infolist() if not info.is_dir()}


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
