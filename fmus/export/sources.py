"""Source files of a component: the modules of this project that its module imports, and the C files beside them."""

from __future__ import annotations

import ast
import importlib.util
from collections.abc import Iterator
from pathlib import Path

_PACKAGES = ("fmus", "plant_models", "seat_blocks", "seat_controller_fmu")


def _source(module: str) -> Path | None:
    """Return the file of a module; None for a name that is no module but one inside a module."""
    try:
        spec = importlib.util.find_spec(module)
    except ModuleNotFoundError:
        return None
    return Path(spec.origin) if spec and spec.origin else None


def _imports(path: Path) -> Iterator[str]:
    """Yield the names that a file imports at its top level; imports inside functions are ignored."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def source_files(*modules: str) -> dict[str, Path]:
    """Return the modules of this project that the given ones import, directly or indirectly, and their packages.

    Parameters
    ----------
    modules
        Names of modules of this project.

    Returns
    -------
    dict
        Relative path (``plant_models/seat/seat.py``) to the file, sorted by that path.
    """
    files: dict[str, Path] = {}
    pending = list(modules)
    while pending:
        name = pending.pop()
        package, _, _ = name.rpartition(".")
        if name.partition(".")[0] not in _PACKAGES or (path := _source(name)) is None:
            continue
        relative = name.replace(".", "/") + ("/__init__.py" if path.name == "__init__.py" else ".py")
        if relative not in files:
            files[relative] = path
            pending += [package, *_imports(path)]
    return dict(sorted(files.items()))


def kernel_files(module: str) -> tuple[Path, ...]:
    """Return the C files and headers beside a module and the modules that it imports.

    The twin of ``interface.py`` in the package ``seat`` is ``interface.h`` or ``seat_interface.h``: an FMU has
    all files in one folder, where no two may have one name.

    Parameters
    ----------
    module
        Name of a component's module.

    Returns
    -------
    tuple of Path
        The C twins of the modules.

    Raises
    ------
    ValueError
        If two files have one name.
    """
    files: dict[str, Path] = {}
    for path in source_files(module).values():
        for stem in (path.stem, f"{path.parent.name}_{path.stem}"):
            for twin in (path.with_name(f"{stem}.c"), path.with_name(f"{stem}.h")):
                if twin.exists() and files.setdefault(twin.name, twin) != twin:
                    raise ValueError(
                        f"kernel of {module}: expected one file of each name, got {files[twin.name]} and {twin}"
                    )
    return tuple(files.values())
