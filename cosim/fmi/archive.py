"""Check zip archives before they are extracted, and write them reproducibly."""

from __future__ import annotations

import io
import stat
import zipfile
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path, PurePosixPath
from typing import BinaryIO

from cosim.errors import SetupError
from cosim.fmi.budgets import MAX_MEMBERS, check_count

MAX_SIZE = 8 * 2**30
"""Maximum size of an extracted archive, in bytes."""

MAX_RATIO = 200
"""Maximum ratio of extracted to packed size, for archives larger than :data:`SAFE_SIZE` when extracted.

Tables of numbers have ratios of 2 to 10, archives that are made to fill a disk about 1000.
"""

SAFE_SIZE = 100 * 2**20
"""Extracted size in bytes up to which any compression ratio is accepted."""

_EPOCH = (1980, 1, 1, 0, 0, 0)
"""Modification time of every written member, so that the same content gives the same bytes."""

_MAX_REPORTED = 5
"""How many problems of one archive are reported."""


def check_archive(archive: zipfile.ZipFile, where: Path, size_on_disk: int | None = None) -> None:
    """Check that extracting an archive writes to the target folder only, and not too much.

    Parameters
    ----------
    archive
        An open archive. Only its table of contents is read; zipfile never extracts more than a member's declared size.
    where
        Name of the archive in messages.
    size_on_disk
        What the archive takes in the file that holds it, in bytes, where it is packed itself.

    Raises
    ------
    SetupError
        If there are too many members, if a member's path leaves the folder, is not portable or occurs twice, if a
        member is a link or encrypted, or if the extracted size is too large.
    """
    members = archive.infolist()
    check_count(str(where), "members", len(members), MAX_MEMBERS)
    found = *_member_problems(members), *size_problems(archive, size_on_disk)
    problems = [f"{where}: {problem}" for problem in found]
    if problems:
        more = [f"{where}: {len(problems) - _MAX_REPORTED} more problems"] if len(problems) > _MAX_REPORTED else []
        raise SetupError(*problems[:_MAX_REPORTED], *more)


def open_archive(file: str | Path | BinaryIO, where: Path, size_on_disk: int | None = None) -> zipfile.ZipFile:
    """Open an archive that can be extracted safely.

    Parameters
    ----------
    file
        The archive, as a file name or an open file.
    where
        Name of the archive in messages.
    size_on_disk
        As of :func:`check_archive`.

    Returns
    -------
    zipfile.ZipFile
        The open archive; the caller closes it.

    Raises
    ------
    SetupError
        If it cannot be extracted safely, see :func:`check_archive`.
    zipfile.BadZipFile
        If the file is not a zip archive.
    """
    archive = zipfile.ZipFile(file)
    try:
        check_archive(archive, where, size_on_disk)
    except BaseException:
        archive.close()
        raise
    return archive


def is_file(path: Path) -> bool:
    """Return whether a file exists; False also for names that are too long or otherwise invalid.

    Parameters
    ----------
    path
        Any path, for example one from a file that a user provided.
    """
    try:
        return path.is_file()
    except OSError:
        return False


def is_unsafe_path(name: str) -> bool:
    """Return whether a relative path may lead out of its folder on any platform.

    Parameters
    ----------
    name
        A path with forward slashes.
    """
    path = PurePosixPath(name)
    return "\\" in name or ":" in name or "\0" in name or path.is_absolute() or ".." in path.parts


def is_special(member: zipfile.ZipInfo) -> bool:
    """Return whether a member is a link or a device, not a file or a folder."""
    return stat.S_IFMT(member.external_attr >> 16) not in (0, stat.S_IFREG, stat.S_IFDIR)


def is_encrypted(member: zipfile.ZipInfo) -> bool:
    """Return whether a member is encrypted."""
    return bool(member.flag_bits & 1)


def is_outside(member: zipfile.ZipInfo) -> bool:
    """Return whether a member's path is empty or may leave the folder, before zipfile sanitizes it.

    Parameters
    ----------
    member
        A member of an archive.
    """
    return is_unsafe_path(member.orig_filename) or not PurePosixPath(member.orig_filename).parts


def _member_problems(members: list[zipfile.ZipInfo]) -> Iterator[str]:
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


def size_problems(archive: zipfile.ZipFile, size_on_disk: int | None = None) -> Iterator[str]:
    """Yield the problems with the extracted size that an archive declares.

    Parameters
    ----------
    archive
        An open archive; only its table of contents is read.
    size_on_disk
        As of :func:`check_archive`.

    Yields
    ------
    str
        A message for a total size or a compression ratio that is too large.
    """
    members = archive.infolist()
    if not members:
        return
    size = sum(member.file_size for member in members)
    packed = min(sum(member.compress_size for member in members), archive.start_dir)  # members may share their bytes
    packed = packed if size_on_disk is None else min(packed, size_on_disk)
    largest = max(members, key=lambda member: member.file_size)
    whole = f"got {size / 2**20:.0f} MiB from {packed / 2**20:.3g} MiB (largest member: {largest.filename!r})"
    if size > MAX_SIZE:
        yield f"expected at most {MAX_SIZE / 2**20:.0f} MiB when extracted, {whole}"
    elif size > SAFE_SIZE and size > MAX_RATIO * packed:
        yield f"expected at most {MAX_RATIO} times the packed size when extracted, {whole}"


def write_archive(path: Path, contents: Mapping[str, bytes]) -> bool:
    """Write an archive with sorted members and a fixed modification time.

    The file is replaced atomically. The same contents give the same bytes.

    Parameters
    ----------
    path
        The file; its folder is created where it does not exist.
    contents
        Member name to content.

    Returns
    -------
    bool
        False where the same file existed already; it is not written again.
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
    """Read an archive into a dict of member name to content, without folders.

    Parameters
    ----------
    path
        The file.
    """
    with zipfile.ZipFile(path) as archive:
        return {info.filename: archive.read(info) for info in archive.infolist() if not info.is_dir()}
