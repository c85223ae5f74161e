"""What a component is made of: the modules of this project that its module imports, and their twins in C."""

from __future__ import annotations

import ast
import importlib.util
from collections.abc import Iterator
from pathlib import Path

_PACKAGES = ("fmus", "plant_models", "seat_controller_fmu")


def _source(module: str) -> Path | None:
    """Find a module's file; None for a name that is not a module but stands within one."""
    try:
        spec = importlib.util.find_spec(module)
    except ModuleNotFoundError:
        return None
    return Path(spec.origin) if spec and spec.origin else None


def _imports(path: Path) -> Iterator[str]:
    """Yield the names that a file imports at its top level, functions' own imports left out."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def source_files(*modules: str) -> dict[str, Path]:
    """Find the project's modules that the given ones import, directly or not, packages included.

    Parameters
    ----------
    modules
        Names of modules of this project.

    Returns
    -------
    dict
        Path inside a folder of sources (``plant_models/seat/seat.py``) to the file, sorted by that path.
    """
    files: dict[str, Path] = {}
    waiting = list(modules)
    while waiting:
        name = waiting.pop()
        package, _, _ = name.rpartition(".")
        if name.partition(".")[0] not in _PACKAGES or (path := _source(name)) is None:
            continue
        inside = name.replace(".", "/") + ("/__init__.py" if path.name == "__init__.py" else ".py")
        if inside not in files:
            files[inside] = path
            waiting += [package, *_imports(path)]
    return dict(sorted(files.items()))


def kernel_files(module: str) -> tuple[Path, ...]:
    """Find the C files and headers that lie beside a module and the modules it imports: their twins.

    Parameters
    ----------
    module
        Name of a component's module.
    """
    twins = (path.with_suffix(suffix) for path in source_files(module).values() for suffix in (".c", ".h"))
    return tuple(path for path in twins if path.exists())
