"""Parameters that name a file: paths start where the user stands."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path

from cosim.engine.structure import Structure
from cosim.errors import SetupError
from cosim.fmi.archive import is_file

_FILE_PATH = "file.path"
"""Parameter of our Shaker that names a file."""


def with_user_paths(values: Mapping[str, str], system: Structure) -> dict[str, str]:
    """Return settings in which files of the user have absolute paths.

    An FMU looks for relative paths in its own resources. The user's folder comes first, and ``~`` is expanded.

    Parameters
    ----------
    values
        ``component.variable`` to value, as the user gave them.
    system
        The system that has the variables.

    Raises
    ------
    SetupError
        If there is no such file, neither here nor in the FMU.
    """
    return {name: _path(name, value, system) if _is_path(name, system) else value for name, value in values.items()}


def _is_path(name: str, system: Structure) -> bool:
    component, _, variable = name.partition(".")
    model = system.models.get(component)
    return model is not None and variable == _FILE_PATH and variable in model.variables


def _path(name: str, value: str, system: Structure) -> str:
    path = Path(value).expanduser()
    if is_file(path):
        return str(path.resolve())
    if not path.is_absolute() and f"resources/{value}" in _members(name, system):
        return value
    raise SetupError(f"{name}: expected a file, got none at {path if path.is_absolute() else Path.cwd() / path}")


def _members(name: str, system: Structure) -> set[str]:
    """Return the names in the FMU that has a variable."""
    model = system.models[system.parse(name).component]
    with zipfile.ZipFile(model.open()) as archive:
        return set(archive.namelist())
