"""FMU files: written so that the same content gives the same bytes, and recognised by their GUID."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import fmpy

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


def write_archive(path: Path, contents: Mapping[str, bytes]) -> None:
    """Write an archive with sorted entries and without times; it is there as a whole or not at all.

    Parameters
    ----------
    path
        The file; its folder is made where it does not exist.
    contents
        Name in the archive to content.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_suffix(".tmp")
    with zipfile.ZipFile(unfinished, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name in sorted(contents):
            info = zipfile.ZipInfo(name, _EPOCH)
            info.external_attr = 0o644 << 16
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, contents[name])
    unfinished.replace(path)


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
