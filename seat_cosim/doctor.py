"""What is installed and what it gives: the facts that a bug report should carry."""

from __future__ import annotations

import os
import platform
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from cosim.engine import native_stepper
from cosim.fmi.description import ModelDescription
from cosim.fmi.temporary_folders import leftovers
from fmus import FLAVOURS
from fmus.export.compiler import find_compiler
from fmus.export.fmu_file import BuildError
from fmus.export.native_fmu import PLATFORMS, STANDARDS, host_platform, platforms_of
from seat_cosim import carried

REQUIRED = ("seat-cosim", "fmpy", "numpy", "scipy", "matplotlib", "lxml", "click", "rich", "pythonfmu")
"""Packages that have to be there."""

OPTIONAL = {
    "cvxpy": ("design", "designs gains (seat-cosim design)"),
    "clarabel": ("design", "the default solver of seat-cosim design"),
    "ziglang": ("native", "builds FMUs for all platforms"),
    "asammdf": ("mdf", "--format mdf4"),
    "distributed": ("cluster", "sweep --scheduler, --workers"),
    "pyarrow": ("parquet", "--format parquet, sweep"),
    "pandas": ("measurements", "reads files of data loggers (seat-cosim assess, --recording)"),
    "fmu-manipulation-toolbox": ("interop", "makes a system one FMU"),
    "libcosimpy": ("interop", "another master, for comparison"),
}
"""Optional package to the extra that installs it and what it gives."""


@dataclass(frozen=True)
class Fact:
    """One line of the report.

    Attributes
    ----------
    group
        What it is about.
    name
        What was looked at.
    found
        What was found.
    is_fine
        Whether nothing is in the way of a run; None where it is a matter of taste.
    """

    group: str
    name: str
    found: str
    is_fine: bool | None = True


def facts() -> list[Fact]:
    """Look at this machine and this installation."""
    return [*_machine(), *_packages(), *_fmus(), *_loop(), *_compiler(), *_optional()]


def _machine() -> Iterator[Fact]:
    yield Fact("machine", "Python", f"{platform.python_version()}, {sys.executable}")
    host = host_platform()
    known = host in PLATFORMS
    yield Fact("machine", "platform", f"{platform.platform()}{'' if known else ': no binaries for it'}", known)
    yield Fact("machine", "cores", str(os.cpu_count()))
    folder = Path(tempfile.gettempdir())
    yield Fact("machine", "temporary folder", str(folder), os.access(folder, os.W_OK))
    if found := leftovers():
        yield Fact("machine", "leftovers", f"{len(found)} of killed runs there; run: seat-cosim doctor --clean", None)


def _version(package: str) -> str | None:
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def _packages() -> Iterator[Fact]:
    for package in REQUIRED:
        found = _version(package)
        yield Fact("packages", package, found or "missing", found is not None)


def _fmus() -> Iterator[Fact]:
    host = PLATFORMS.get(host_platform())
    for flavour in FLAVOURS:
        folder = carried.fmu_folder(flavour)
        paths = sorted(folder.glob("*.fmu"))
        if not paths:
            yield Fact("FMUs", flavour, "none; run: seat-cosim build", False if flavour == FLAVOURS[0] else None)
        for path in paths:
            binaries = sorted(platforms_of(path))
            needed = host.folder(STANDARDS[flavour].version) if host and flavour in STANDARDS else None
            fits = needed is None or needed in binaries
            text = f"{path}, FMI {ModelDescription.read(path).description.fmiVersion}, {', '.join(binaries)}"
            yield Fact("FMUs", path.stem, text if fits else f"{text}: none for this machine", fits)


def _loop() -> Iterator[Fact]:
    loaded = native_stepper.load() is not None
    text = "in C" if loaded else "in Python, which is slower; run: seat-cosim build"
    yield Fact("master", "stepping loop", text, True if loaded else None)


def _compiler() -> Iterator[Fact]:
    try:
        found = find_compiler()
    except BuildError:
        yield Fact("master", "C compiler", "none; needed by seat-cosim build only", None)
        return
    scope = "all platforms" if found.takes_target else "this machine"
    yield Fact("master", "C compiler", f"{found.name} {found.version}, for {scope}")


def _optional() -> Iterator[Fact]:
    for package, (extra, gives) in OPTIONAL.items():
        found = _version(package)
        text = found or f'missing: {gives}; pip install "seat-cosim[{extra}]"'
        yield Fact("optional", package, text, None if found is None else True)
