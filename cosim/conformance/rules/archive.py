"""Rules about the archive: where files lie in it, what they are called and what kind they are of."""

from __future__ import annotations

import re
import zipfile
from collections import Counter
from collections.abc import Iterator
from pathlib import PurePosixPath

from lxml import etree

from cosim.conformance.fmu_archive import Subject
from cosim.conformance.rule import Advice, NotApplicableError, rule
from cosim.fmi.archive import is_encrypted, is_outside, is_special, leaves
from cosim.fmi.repairs import DESCRIPTION

_CLAUSE = "2.0 §2.3; 3.0 §2.5.1"

ROOT = {
    2: {"documentation", "sources", "binaries", "resources", "extra", "modelDescription.xml", "model.png"},
    3: {"documentation", "sources", "binaries", "resources", "extra", "modelDescription.xml", "terminalsAndIcons"},
}
"""What may lie in the archive's root."""

LITTER = re.compile(r"(^|/)(__MACOSX|\.DS_Store|Thumbs\.db|desktop\.ini|\.git|\.svn)(/|$)|(~|\.bak|\.orig|\.tmp)$")
"""What systems and editors leave behind."""

PLATFORMS = {
    "win32": (".dll", "PE x86"),
    "win64": (".dll", "PE x86_64"),
    "linux32": (".so", "ELF x86"),
    "linux64": (".so", "ELF x86_64"),
    "darwin32": (".dylib", "Mach-O x86"),
    "darwin64": (".dylib", "Mach-O x86_64"),
}
"""Folders of FMI 2.0 to a library's suffix and format."""

_TUPLE = re.compile(r"(?P<machine>[a-z0-9_]+)-(?P<system>windows|linux|darwin)(-[a-z0-9_]+)?")
_SYSTEMS = {"windows": (".dll", "PE"), "linux": (".so", "ELF"), "darwin": (".dylib", "Mach-O")}
_MACHINES = {"aarch32", "aarch64", "x86", "x86_64", "riscv32", "riscv64", "ppc32", "ppc64"}

_ELF = {3: "x86", 40: "aarch32", 62: "x86_64", 183: "aarch64", 20: "ppc32", 21: "ppc64", 243: "riscv64"}
_PE = {0x14C: "x86", 0x8664: "x86_64", 0x1C4: "aarch32", 0xAA64: "aarch64"}
_MACH = {7: "x86", 0x01000007: "x86_64", 12: "aarch32", 0x0100000C: "aarch64"}


@rule("archive.readable", "The FMU is a zip archive without damage", clause=_CLAUSE, stage="archive")
def readable(fmu: Subject) -> Iterator[str]:
    if fmu.archive is None:
        yield f"{fmu.path.name}: expected a zip archive, got another kind of file"
        return
    if fmu.unsafe:
        return  # do not read what may have no end
    try:
        damaged = fmu.archive.testzip()
    except Exception as error:
        yield f"{fmu.path.name}: expected an archive that can be extracted, got: {error}"
    else:
        if damaged:
            yield f"member {damaged}: expected what its checksum says, got damaged content"


@rule("archive.paths", "Paths are relative, with forward slashes, and stay inside", clause=_CLAUSE, stage="archive")
def paths(fmu: Subject) -> Iterator[str]:
    for member in fmu.members:
        if is_outside(member):
            yield f"member {member.orig_filename!r}: expected a relative path with forward slashes inside the archive"


@rule("archive.duplicates", "Each path comes once", clause=_CLAUSE, stage="archive")
def duplicates(fmu: Subject) -> Iterator[str]:
    times = Counter(str(PurePosixPath(member.filename)) for member in fmu.members)
    yield from (f"member {name}: expected it once, got it {n} times" for name, n in times.items() if n > 1)
    lower = Counter(name.lower() for name in times)
    for name in times:
        if lower[name.lower()] > 1:
            yield Advice(f"member {name}: expected a name that differs in more than capitals, got several")
            lower[name.lower()] = 0


@rule("archive.kinds", "Members are files and folders, neither links nor encrypted", clause=_CLAUSE, stage="archive")
def kinds(fmu: Subject) -> Iterator[str]:
    for member in fmu.members:
        if is_special(member):
            yield f"member {member.filename}: expected a file or folder, got a link or a device"
        if is_encrypted(member):
            yield f"member {member.filename}: expected no encryption, got an encrypted member"


@rule("archive.compression", "Members are stored or deflated", clause=_CLAUSE, stage="archive")
def compression(fmu: Subject) -> Iterator[str]:
    for member in fmu.members:
        if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            yield f"member {member.filename}: expected method 0 (store) or 8 (deflate), got {member.compress_type}"


@rule("archive.size", "The archive does not grow out of proportion when extracted", stage="archive")
def size(fmu: Subject) -> list[str]:
    return fmu.size_problems


@rule("archive.description", f"There is a {DESCRIPTION} in the root", clause=_CLAUSE, stage="archive")
def description(fmu: Subject) -> Iterator[str]:
    if fmu.archive is not None and PurePosixPath(DESCRIPTION) not in fmu.files:
        deeper = [str(path) for path in fmu.files if path.name.lower() == DESCRIPTION.lower()]
        yield f"expected {DESCRIPTION} in the archive's root, got {', '.join(deeper) or 'none'}"


@rule(
    "archive.stray",
    "The root holds what the standard names, and nothing is left over from editing",
    clause=_CLAUSE,
    stage="archive",
    severity="warning",
)
def stray(fmu: Subject) -> Iterator[str]:
    known = ROOT[_standard(fmu)]
    inside = (path for path, member in fmu.files.items() if path.parts and not leaves(member.orig_filename))
    for name in dict.fromkeys(path.parts[0] for path in inside):
        if name not in known and not LITTER.search(name) and name.lower() != DESCRIPTION.lower():
            yield f"{name}: expected one of {', '.join(sorted(known))} in the root, got an unknown entry"
    for path in fmu.files:
        if LITTER.search(str(path)):
            yield f"{path}: expected files of the FMU, got what a system or an editor left behind"


@rule("archive.implementation", "There are binaries or sources", clause=_CLAUSE, stage="archive")
def implementation(fmu: Subject) -> Iterator[str]:
    if fmu.archive is not None and not fmu.under("binaries") and not fmu.under("sources"):
        yield "expected files in binaries or sources, got none"


@rule(
    "archive.platforms",
    "Folders of binaries have the names of the FMI version",
    clause="2.0 §2.3; 3.0 §2.5.1.4.1",
    stage="archive",
)
def platforms(fmu: Subject) -> Iterator[str]:
    standard = _standard(fmu)
    for path in fmu.under("binaries"):
        if len(path.parts) == 1:
            yield Advice(f"binaries/{path}: expected it in the folder of a platform")
    for folder in _platforms(fmu):
        match = _TUPLE.fullmatch(folder)
        if standard == 3 and folder.lower() in PLATFORMS:
            yield f"binaries/{folder}: expected a name like x86_64-linux, got one of FMI 2.0"
        elif standard == 2 and folder not in PLATFORMS and folder.lower() in PLATFORMS:
            yield f"binaries/{folder}: expected {folder.lower()}, got capitals"
        elif standard == 2 and match and (match["machine"], match["system"]) in _NAMED:
            yield f"binaries/{folder}: expected {_NAMED[match['machine'], match['system']]}, got a name of FMI 3.0"
        elif standard == 3 and (match is None or match["machine"] not in _MACHINES):
            yield Advice(f"binaries/{folder}: expected a platform that importers know, got another name")


_NAMED = {
    (machine, system): f"{name}{bits}"
    for system, name in (("windows", "win"), ("linux", "linux"), ("darwin", "darwin"))
    for machine, bits in (("x86", "32"), ("x86_64", "64"))
}
"""Platforms that have names in FMI 2.0."""


@rule("archive.binaries", "Each platform has a library named by the model identifier", clause=_CLAUSE, stage="archive")
def binaries(fmu: Subject) -> Iterator[str]:
    name = _identifier(fmu)
    for folder in _platforms(fmu):
        suffix = _expected(folder)[0]
        found = [str(path) for path in fmu.under(f"binaries/{folder}")]
        static = any(path.endswith((".a", ".lib")) for path in found)
        if suffix and f"{name}{suffix}" not in found and not static:
            yield f"binaries/{folder}: expected {name}{suffix}, got {', '.join(sorted(found)[:3]) or 'nothing'}"


@rule("archive.machine", "Libraries have the format and machine of their folder", clause=_CLAUSE, stage="archive")
def machine(fmu: Subject) -> Iterator[str]:
    name = _identifier(fmu)
    for folder in _platforms(fmu):
        suffix, expected = _expected(folder)
        member = fmu.under(f"binaries/{folder}").get(PurePosixPath(f"{name}{suffix}"))
        if member is None or not suffix:
            continue
        found = formats(fmu.head(member, 4096))
        if expected not in found:
            got = " and ".join(found) or "another kind of file"
            yield f"binaries/{folder}/{name}{suffix}: expected a library for {expected}, got {got}"


def formats(head: bytes) -> list[str]:
    """Tell a library's format and machines from its first bytes; nothing of one that is none."""
    if head[:4] == b"\x7fELF" and len(head) > 20:
        machine = int.from_bytes(head[18:20], "little" if head[5] == 1 else "big")
        return [f"ELF {_ELF.get(machine, machine)}".replace("riscv64", "riscv64" if head[4] == 2 else "riscv32")]
    if head[:2] == b"MZ" and len(head) > 64:
        at = int.from_bytes(head[60:64], "little")
        if head[at : at + 4] == b"PE\0\0":
            return [f"PE {_PE.get(int.from_bytes(head[at + 4 : at + 6], 'little'), 'unknown')}"]
    if head[:4] in (b"\xcf\xfa\xed\xfe", b"\xce\xfa\xed\xfe"):
        return [f"Mach-O {_MACH.get(int.from_bytes(head[4:8], 'little'), 'unknown')}"]
    if head[:4] == b"\xca\xfe\xba\xbe":  # several machines in one file
        count = min(int.from_bytes(head[4:8], "big"), 8)
        numbers = (int.from_bytes(head[8 + 20 * i : 12 + 20 * i], "big") for i in range(count))
        return [f"Mach-O {_MACH.get(number, 'unknown')}" for number in numbers]
    return []


@rule(
    "archive.sources",
    "Sources come with the list of what is to be compiled, and all of that is there",
    clause="2.0 §4.3.1; 3.0 §2.5.1.3",
    stage="archive",
)
def sources(fmu: Subject) -> Iterator[str]:
    found = {str(path) for path in fmu.under("sources")}
    if not found and not (fmu.description and fmu.description.source_files):
        raise NotApplicableError("the FMU has no sources")
    if _standard(fmu) == 2:
        listed = fmu.description.source_files if fmu.description else ()
        where = "SourceFiles"
    else:
        where = "buildDescription.xml"
        if where not in found:
            text = f"sources: expected a {where}, got none"
            yield Advice(text) if fmu.under("binaries") else text  # they may be there for reading
            return
        listed = tuple(_listed(fmu))
    for name in listed:
        if str(PurePosixPath(name)) not in found:
            yield f"{where}: expected files in sources, got {name}, which is not there"


def _listed(fmu: Subject) -> Iterator[str]:
    assert fmu.archive is not None
    try:
        root = etree.fromstring(fmu.archive.read("sources/buildDescription.xml"))
    except Exception:  # told by the rule on archives, or by the next tool
        return
    yield from (file.get("name", "") for file in root.iter("SourceFile"))


@rule(
    "archive.documentation",
    "Documentation and licences have the entry points that importers open",
    clause=_CLAUSE,
    stage="archive",
    severity="warning",
)
def documentation(fmu: Subject) -> Iterator[str]:
    found = {str(path) for path in fmu.under("documentation")}
    if not found:
        raise NotApplicableError("the FMU has no documentation")
    entries = {f"licenses/license.{suffix}" for suffix in ("txt", "html", "spdx")}
    if any(name.startswith("licenses/") for name in found) and not found & entries:
        yield "documentation/licenses: expected license.txt, license.html or license.spdx, got none"
    if "index.html" not in found and any(name.endswith((".html", ".htm")) for name in found):
        yield "documentation: expected an index.html, got pages without it"


def _standard(fmu: Subject) -> int:
    return fmu.description.standard if fmu.description else 3 if fmu.under("terminalsAndIcons") else 2


def _identifier(fmu: Subject) -> str:
    if fmu.description is None or not fmu.description.identifier:
        raise NotApplicableError("the description names no model identifier for co-simulation")
    return fmu.description.identifier


def _platforms(fmu: Subject) -> list[str]:
    """Return the folders with binaries."""
    return list(dict.fromkeys(path.parts[0] for path in fmu.under("binaries") if len(path.parts) > 1))


def _expected(folder: str) -> tuple[str, str]:
    """Return suffix and format of the libraries in a folder; nothing for a platform that is not known."""
    if folder in PLATFORMS:
        return PLATFORMS[folder]
    match = _TUPLE.fullmatch(folder)
    if match is None or match["machine"] not in _MACHINES:
        return "", ""
    suffix, kind = _SYSTEMS[match["system"]]
    return suffix, f"{kind} {match['machine']}"
