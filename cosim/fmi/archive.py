"""Archives: checked before anything of them is extracted, and written so that the same content gives the same bytes."""

from __future__ import annotations

import io
import stat
import zipfile
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path, PurePosixPath
from typing import BinaryIO

from cosim.errors import SetupError

LARGEST = 8 * 2**30
"""Bytes an archive may have when extracted."""

LARGEST_RATIO = 200
"""How many times its own size an archive may have when extracted, where that is more than ``UNSUSPICIOUS``: tables of
numbers shrink 2 to 10 times, what is made to fill a disk 1000 times."""

UNSUSPICIOUS = 100 * 2**20
"""Bytes that do no harm, however well they were compressed."""

_EPOCH = (1980, 1, 1, 0, 0, 0)
"""Time of every member that is written: the same content gives the same bytes."""

_TOLD = 5
"""How many problems of one archive are told."""


def check_archive(archive: zipfile.ZipFile, where: Path) -> None:
    """Check that an archive can be extracted into a folder, and nowhere else.

    Parameters
    ----------
    archive
        An open one; only its table of contents is read.
    where
        The archive, as messages call it.

    Raises
    ------
    SetupError
        If a member's path leaves the folder or is not portable, comes twice, is a link or encrypted, or if the whole is
        too large; with the members' names. What a member declares to be its size is more than it can be extracted to.
    """
    members = archive.infolist()
    problems = [f"{where}: {problem}" for problem in (*_problems(members), *size_problems(archive))]
    if problems:
        more = [f"{where}: {len(problems) - _TOLD} more problems"] if len(problems) > _TOLD else []
        raise SetupError(*problems[:_TOLD], *more)


def open_archive(file: str | Path | BinaryIO, where: Path) -> zipfile.ZipFile:
    """Open an archive that can be extracted safely; exceptions as those of :func:`check_archive` and zipfile."""
    archive = zipfile.ZipFile(file)
    try:
        check_archive(archive, where)
    except BaseException:
        archive.close()
        raise
    return archive


def is_file(path: Path) -> bool:
    """Whether there is a file of that name; there is none of a name that no file can have."""
    try:
        return path.is_file()
    except OSError:
        return False


def leaves(name: str) -> bool:
    """Whether a path may lead out of the folder it is relative to, on any platform."""
    path = PurePosixPath(name)
    return "\\" in name or ":" in name or "\0" in name or path.is_absolute() or ".." in path.parts


def is_special(member: zipfile.ZipInfo) -> bool:
    """Whether a member is neither file nor folder, but a link or a device."""
    return stat.S_IFMT(member.external_attr >> 16) not in (0, stat.S_IFREG, stat.S_IFDIR)


def is_encrypted(member: zipfile.ZipInfo) -> bool:
    """Whether a member is encrypted."""
    return bool(member.flag_bits & 1)


def is_outside(member: zipfile.ZipInfo) -> bool:
    """Whether a member's path, as it was before zipfile makes it harmless, may leave the folder, or names nothing."""
    return leaves(member.orig_filename) or not PurePosixPath(member.orig_filename).parts


def _problems(members: list[zipfile.ZipInfo]) -> Iterator[str]:
    times = Counter(str(PurePosixPath(member.filename)) for member in members)
    for member in members:
        name = member.orig_filename
        if is_outside(member):
            yield f"member {name!r}: expected a relative path with forward slashes inside the archive"
        if is_special(member):
            yield f"member {name!r}: expected a file or folder, got a link or a device"
        if is_encrypted(member):
            yield f"member {name!r}: expected no encryption, got an encrypted member"
        if times[str(PurePosixPath(member.filename))] > 1:
            times[str(PurePosixPath(member.filename))] = 0
            yield f"member {name!r}: expected it once, got it several times"


def size_problems(archive: zipfile.ZipFile) -> Iterator[str]:
    """Tell what is wrong with the size of what an archive holds, as it declares it."""
    members = archive.infolist()
    if not members:
        return
    size = sum(member.file_size for member in members)
    packed = min(sum(member.compress_size for member in members), archive.start_dir)  # members may share their bytes
    largest = max(members, key=lambda member: member.file_size)
    whole = f"got {size / 2**20:.0f} MiB from {packed / 2**20:.3g} MiB (largest member: {largest.filename!r})"
    if size > LARGEST:
        yield f"expected at most {LARGEST / 2**20:.0f} MiB when extracted, {whole}"
    elif size > UNSUSPICIOUS and size > LARGEST_RATIO * packed:
        yield f"expected at most {LARGEST_RATIO} times the packed size when extracted, {whole}"


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
