"""Rules about the archive: locations, names and types of its files."""

from __future__ import annotations

import re
import zipfile
from collections import Counter
from collections.abc import Iterator
from pathlib import PurePosixPath

from lxml import etree

from cosim.conformance.fmu_archive import FmuArchive
from cosim.conformance.rule import Advice, NotApplicableError, rule
from cosim.fmi.archive import is_encrypted, is_outside, is_special, is_unsafe_path
from cosim.fmi.repairs import DESCRIPTION
from cosim.fmi.xml import safe_parser

_CLAUSE = "2.0 §2.3; 3.0 §2.5.1"

ROOT = {
    2: {"documentation", "sources", "binaries", "resources", "extra", "modelDescription.xml", "model.png"},
    3: {"documentation", "sources", "binaries", "resources", "extra", "modelDescription.xml", "terminalsAndIcons"},
}
"""Major version of FMI to the allowed entries of the archive's root."""

LITTER = re.compile(r"(^|/)(__MACOSX|\.DS_Store|Thumbs\.db|desktop\.ini|\.git|\.svn)(/|$)|(~|\.bak|\.orig|\.tmp)$")
"""Paths of files that operating systems and editors create."""

PLATFORMS = {
    "win32": (".dll", "PE x86"),
    "win64": (".dll", "PE x86_64"),
    "linux32": (".so", "ELF x86"),
    "linux64": (".so", "ELF x86_64"),
    "darwin32": (".dylib", "Mach-O x86"),
    "darwin64": (".dylib", "Mach-O x86_64"),
}
"""Platform folder of FMI 2.0 to the suffix and format of its libraries."""

_TUPLE = re.compile(r"(?P<machine>[a-z0-9_]+)-(?P<system>windows|linux|darwin)(-[a-z0-9_]+)?")
_SYSTEMS = {"windows": (".dll", "PE"), "linux": (".so", "ELF"), "darwin": (".dylib", "Mach-O")}
_MACHINES = {"aarch32", "aarch64", "x86", "x86_64", "riscv32", "riscv64", "ppc32", "ppc64"}

_ELF = {3: "x86", 40: "aarch32", 62: "x86_64", 183: "aarch64", 20: "ppc32", 21: "ppc64", 243: "riscv64"}
_PE = {0x14C: "x86", 0x8664: "x86_64", 0x1C4: "aarch32", 0xAA64: "aarch64"}
_MACH = {7: "x86", 0x01000007: "x86_64", 12: "aarch32", 0x0100000C: "aarch64"}


@rule("archive.readable", "The FMU is a zip archive without damage", clause=_CLAUSE, stage="archive")
def readable(fmu: FmuArchive) -> Iterator[str]:
    if fmu.zip_file is None:
        yield f"{fmu.path.name}: expected a zip archive, got another kind of file"
        return
    if fmu.extraction_problem:
        return  # another rule reports it, and the archive may be too large to read
    try:
        damaged = fmu.zip_file.testzip()
    except Exception as error:  # zipfile raises exceptions of many types for damaged archives
        yield f"{fmu.path.name}: expected an archive that can be extracted, got: {error}"
    else:
        if damaged:
            yield f"member {damaged}: expected the content of its checksum, got damaged content"


@rule(
    "archive.paths",
    "Paths are relative, with forward slashes, and stay inside the archive",
    clause=_CLAUSE,
    stage="archive",
)
def paths(fmu: FmuArchive) -> Iterator[str]:
    for member in fmu.members:
        if is_outside(member):
            yield f"member {member.orig_filename!r}: expected a relative path with forward slashes inside the archive"


@rule("archive.duplicates", "Paths are unique", clause=_CLAUSE, stage="archive")
def duplicates(fmu: FmuArchive) -> Iterator[str]:
    times = Counter(str(PurePosixPath(member.filename)) for member in fmu.members)
    yield from (f"member {name}: expected it once, got it {n} times" for name, n in times.items() if n > 1)
    lower = Counter(name.lower() for name in times)
    for name in times:
        if lower[name.lower()] > 1:
            yield Advice(f"member {name}: expected a name that differs in more than capitals, got several")
            lower[name.lower()] = 0


@rule("archive.kinds", "Members are files and folders, neither links nor encrypted", clause=_CLAUSE, stage="archive")
def kinds(fmu: FmuArchive) -> Iterator[str]:
    for member in fmu.members:
        if is_special(member):
            yield f"member {member.filename}: expected a file or folder, got a link or a device"
        if is_encrypted(member):
            yield f"member {member.filename}: expected no encryption, got an encrypted member"


@rule("archive.compression", "Members are stored or deflated", clause=_CLAUSE, stage="archive")
def compression(fmu: FmuArchive) -> Iterator[str]:
    for member in fmu.members:
        if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            yield f"member {member.filename}: expected method 0 (store) or 8 (deflate), got {member.compress_type}"


@rule("archive.size", "The archive does not grow out of proportion when extracted", stage="archive")
def size(fmu: FmuArchive) -> list[str]:
    return fmu.size_problems


@rule("archive.description", f"There is a {DESCRIPTION} in the root", clause=_CLAUSE, stage="archive")
def description(fmu: FmuArchive) -> Iterator[str]:
    if fmu.zip_file is not None and PurePosixPath(DESCRIPTION) not in fmu.files:
        deeper = [str(path) for path in fmu.files if path.name.lower() == DESCRIPTION.lower()]
        yield f"expected {DESCRIPTION} in the archive's root, got {', '.join(deeper) or 'none'}"


@rule(
    "archive.stray",
    "The root holds the entries of the standard only, and no files of operating systems and editors",
    clause=_CLAUSE,
    stage="archive",
    severity="warning",
)
def stray(fmu: FmuArchive) -> Iterator[str]:
    known = ROOT[_standard(fmu)]
    inside = (path for path, member in fmu.files.items() if path.parts and not is_unsafe_path(member.orig_filename))
    for name in dict.fromkeys(path.parts[0] for path in inside):
        if name not in known and not LITTER.search(name) and name.lower() != DESCRIPTION.lower():
            yield f"{name}: expected one of {', '.join(sorted(known))} in the root, got an unknown entry"
    for path in fmu.files:
        if LITTER.search(str(path)):
            yield f"{path}: expected files of the FMU, got one of an operating system or an editor"


@rule("archive.implementation", "There are binaries or sources", clause=_CLAUSE, stage="archive")
def implementation(fmu: FmuArchive) -> Iterator[str]:
    if fmu.zip_file is not None and not fmu.files_under("binaries") and not fmu.files_under("sources"):
        yield "expected files in binaries or sources, got none"


@rule(
    "archive.platforms",
    "Folders of binaries have the names of the FMI version",
    clause="2.0 §2.3; 3.0 §2.5.1.4.1",
    stage="archive",
)
def platforms(fmu: FmuArchive) -> Iterator[str]:
    standard = _standard(fmu)
    for path in fmu.files_under("binaries"):
        if len(path.parts) == 1:
            yield Advice(f"binaries/{path}: expected a file in a platform's folder")
    for folder in _platforms(fmu):
        match = _TUPLE.fullmatch(folder)
        if standard == 3 and folder.lower() in PLATFORMS:
            yield f"binaries/{folder}: expected a name like x86_64-linux, got one of FMI 2.0"
        elif standard == 2 and folder not in PLATFORMS and folder.lower() in PLATFORMS:
            yield f"binaries/{folder}: expected {folder.lower()}, got capitals"
        elif standard == 2 and match and (match["machine"], match["system"]) in _NAMED:
            yield f"binaries/{folder}: expected {_NAMED[match['machine'], match['system']]}, got a name of FMI 3.0"
        elif standard == 3 and (match is None or match["machine"] not in _MACHINES):
            yield Advice(f"binaries/{folder}: expected a known platform, got another name")


_NAMED = {
    (machine, system): f"{name}{bits}"
    for system, name in (("windows", "win"), ("linux", "linux"), ("darwin", "darwin"))
    for machine, bits in (("x86", "32"), ("x86_64", "64"))
}
"""Machine and operating system of FMI 3.0 to the platform folder of FMI 2.0."""


@rule("archive.binaries", "Each platform has a library named by the model identifier", clause=_CLAUSE, stage="archive")
def binaries(fmu: FmuArchive) -> Iterator[str]:
    name = _identifier(fmu)
    for folder in _platforms(fmu):
        suffix = _expected(folder)[0]
        found = [str(path) for path in fmu.files_under(f"binaries/{folder}")]
        static = any(path.endswith((".a", ".lib")) for path in found)
        if suffix and f"{name}{suffix}" not in found and not static:
            text = f"binaries/{folder}: expected {name}{suffix}, got {', '.join(sorted(found)[:3]) or 'nothing'}"
            yield Advice(text) if _library(fmu, folder, f"{name}{suffix}") else text


@rule("archive.machine", "Libraries have the format and machine of their folder", clause=_CLAUSE, stage="archive")
def machine(fmu: FmuArchive) -> Iterator[str]:
    name = _identifier(fmu)
    for folder in _platforms(fmu):
        suffix, expected = _expected(folder)
        library = _library(fmu, folder, f"{name}{suffix}") if suffix else None
        if library is None:
            continue
        found = formats(fmu.first_bytes(fmu.files_under(f"binaries/{folder}")[library], 4096))
        if expected not in found:
            got = " and ".join(found) or "another kind of file"
            yield f"binaries/{folder}/{library}: expected a library for {expected}, got {got}"


def formats(head: bytes) -> list[str]:
    """Determine a library's format and machines.

    Parameters
    ----------
    head
        The first bytes of the library, at least its headers.

    Returns
    -------
    list of str
        Format and machine, for example ``ELF x86_64``; several for a universal binary, none for another kind of file.
    """
    if head[:4] == b"\x7fELF" and len(head) > 20:
        machine = int.from_bytes(head[18:20], "little" if head[5] == 1 else "big")
        return [f"ELF {_ELF.get(machine, machine)}".replace("riscv64", "riscv64" if head[4] == 2 else "riscv32")]
    if head[:2] == b"MZ" and len(head) > 64:
        at = int.from_bytes(head[60:64], "little")
        if head[at : at + 4] == b"PE\0\0":
            return [f"PE {_PE.get(int.from_bytes(head[at + 4 : at + 6], 'little'), 'unknown')}"]
    if head[:4] in (b"\xcf\xfa\xed\xfe", b"\xce\xfa\xed\xfe"):
        return [f"Mach-O {_MACH.get(int.from_bytes(head[4:8], 'little'), 'unknown')}"]
    if head[:4] == b"\xca\xfe\xba\xbe":  # a universal binary for several machines
        count = min(int.from_bytes(head[4:8], "big"), 8)
        numbers = (int.from_bytes(head[8 + 20 * i : 12 + 20 * i], "big") for i in range(count))
        return [f"Mach-O {_MACH.get(number, 'unknown')}" for number in numbers]
    return []


@rule(
    "archive.sources",
    "Sources come with a list of the files to compile, and these exist",
    clause="2.0 §4.3.1; 3.0 §2.5.1.3",
    stage="archive",
)
def sources(fmu: FmuArchive) -> Iterator[str]:
    found = {str(path) for path in fmu.files_under("sources")}
    if not found and not (fmu.description and fmu.description.source_files):
        raise NotApplicableError("the FMU has no sources")
    has_binaries = bool(fmu.files_under("binaries"))  # then importers need no sources, which may be for reading only
    if _standard(fmu) == 2:
        listed = fmu.description.source_files if fmu.description else ()
        where = "SourceFiles"
    else:
        where = "buildDescription.xml"
        if where not in found:
            text = f"sources: expected a {where}, got none"
            yield Advice(text) if has_binaries else text
            return
        listed = tuple(_listed(fmu))
    for name in listed:
        if str(PurePosixPath(name)) not in found:
            text = f"{where}: expected files in sources, got {name}, which does not exist"
            yield Advice(text) if has_binaries else text


def _listed(fmu: FmuArchive) -> Iterator[str]:
    assert fmu.zip_file is not None
    try:
        root = etree.fromstring(fmu.zip_file.read("sources/buildDescription.xml"), safe_parser())
    except Exception:  # a damaged archive, which archive.readable reports, or invalid XML
        return
    yield from (file.get("name", "") for file in root.iter("SourceFile"))


@rule(
    "archive.documentation",
    "Documentation and licences have the entry points that importers open",
    clause=_CLAUSE,
    stage="archive",
    severity="warning",
)
def documentation(fmu: FmuArchive) -> Iterator[str]:
    found = {str(path) for path in fmu.files_under("documentation")}
    if not found:
        raise NotApplicableError("the FMU has no documentation")
    entries = {f"licenses/license.{suffix}" for suffix in ("txt", "html", "spdx")}
    if any(name.startswith("licenses/") for name in found) and not found & entries:
        yield "documentation/licenses: expected license.txt, license.html or license.spdx, got none"
    if "index.html" not in found and any(name.endswith((".html", ".htm")) for name in found):
        yield "documentation: expected an index.html, got pages without it"


def _standard(fmu: FmuArchive) -> int:
    return fmu.description.fmi_major if fmu.description else 3 if fmu.files_under("terminalsAndIcons") else 2


def _identifier(fmu: FmuArchive) -> str:
    if fmu.description is None or not fmu.description.model_identifier:
        raise NotApplicableError("the description names no model identifier for co-simulation")
    return fmu.description.model_identifier


def _platforms(fmu: FmuArchive) -> list[str]:
    """Return the platform folders that contain files."""
    return list(dict.fromkeys(path.parts[0] for path in fmu.files_under("binaries") if len(path.parts) > 1))


def _library(fmu: FmuArchive, folder: str, name: str) -> PurePosixPath | None:
    """Find a library in a platform's folder; Windows finds it by any capitals."""
    found = fmu.files_under(f"binaries/{folder}")
    if _expected(folder)[0] == _SYSTEMS["windows"][0]:
        return next((path for path in found if str(path).lower() == name.lower()), None)
    return next((path for path in found if str(path) == name), None)


def _expected(folder: str) -> tuple[str, str]:
    """Return the suffix and format of the libraries in a platform folder; empty for an unknown platform."""
    if folder in PLATFORMS:
        return PLATFORMS[folder]
    match = _TUPLE.fullmatch(folder)
    if match is None or match["machine"] not in _MACHINES:
        return "", ""
    suffix, kind = _SYSTEMS[match["system"]]
    return suffix, f"{kind} {match['machine']}"
