"""Python modules of FMUs that run a Python script in the process of their host, as those of pythonfmu and pythonfmu3.

The library of such an FMU puts the folder ``resources`` in front of ``sys.path`` and imports the module that
``slavemodule.txt`` names. Python keeps one module of a name for each process, until the process ends. So an FMU would
run the code of another one, or of the host, where both have modules of one name. This module finds that out before an
FMU is loaded.
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Iterator
from pathlib import Path

_MAIN = "slavemodule.txt"
"""File that names the main module; only FMUs with Python scripts have it."""

_SUFFIXES = (".py", ".so", ".pyd")
"""Suffixes of modules."""

Files = dict[str, bytes]
"""Path relative to ``resources`` to a digest of the content."""

_claimed: dict[str, Files] = {}
"""Name of each module that an FMU brought into this process to its files."""


def clash(folder: Path) -> str | None:
    """Find a module of an FMU whose name stands for other code in this process.

    Parameters
    ----------
    folder
        Where the FMU was extracted.

    Returns
    -------
    str or None
        Name of the module; None where the FMU gets its own code, and for FMUs without Python scripts.
    """
    for name, files in _modules(folder / "resources").items():
        if name in _claimed:
            there = _claimed[name]
        elif name in sys.modules:
            there = _files_of_host(name, files)
        else:
            continue
        if any(there.get(path) != digest for path, digest in files.items()):
            return name
    return None


def claim(folder: Path) -> str | None:
    """Note the modules of an FMU that is about to be loaded into this process, unless one of them clashes.

    Threads that claim the same name at once get it in turn.

    Parameters
    ----------
    folder
        Where the FMU was extracted.

    Returns
    -------
    str or None
        As :func:`clash`.
    """
    if name := clash(folder):
        return name
    for name, files in _modules(folder / "resources").items():
        _claimed.setdefault(name, files)
    return clash(folder)


def _modules(resources: Path) -> dict[str, Files]:
    """Return the files of each top-level module and package in an FMU.

    What is neither belongs to the main module, which may look for its data beside its own file.
    """
    if not (resources / _MAIN).is_file():
        return {}
    main = (resources / _MAIN).read_text(encoding="utf-8", errors="replace").partition("\n")[0].strip()
    found: dict[str, Files] = {main: {}}
    for path in _files_in(resources):
        relative = path.relative_to(resources)
        top = resources / relative.parts[0]
        is_module = top.suffix in _SUFFIXES if top == path else (top / "__init__.py").is_file()
        name = top.name.partition(".")[0] if is_module else main
        found.setdefault(name, {})[relative.as_posix()] = _digest(path)
    return found


def _files_in(folder: Path) -> Iterator[Path]:
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.name != _MAIN and "__pycache__" not in path.parts:
            yield path


def _files_of_host(name: str, files: Files) -> Files:
    """Return those of the files that stand in the same places beside a module which the host has imported."""
    origin = getattr(sys.modules[name], "__file__", None)
    if origin is None:
        return {}
    folder = Path(origin).parents[1 if Path(origin).name == "__init__.py" else 0]
    return {path: _digest(folder / path) for path in files if (folder / path).is_file()}


def _digest(path: Path) -> bytes:
    return hashlib.blake2b(path.read_bytes(), digest_size=16).digest()
