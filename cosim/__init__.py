"""How FMUs run together: a system of components, its sessions, their results. Knows FMUs, no models.

Names are loaded when they are first used: the package itself costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cosim.engine.session import Session
    from cosim.errors import CosimError, RunError, SetupError
    from cosim.manifest import Manifest
    from cosim.results.result import Result
    from cosim.run_folder import run_to_folder
    from cosim.system import System

__version__: str

__all__ = ["CosimError", "Manifest", "Result", "RunError", "Session", "SetupError", "System", "run_to_folder"]

_MODULES = {
    "CosimError": "cosim.errors",
    "Manifest": "cosim.manifest",
    "Result": "cosim.results.result",
    "RunError": "cosim.errors",
    "Session": "cosim.engine.session",
    "SetupError": "cosim.errors",
    "System": "cosim.system",
    "run_to_folder": "cosim.run_folder",
}
"""Public name to the module that defines it."""


def __getattr__(name: str) -> Any:
    """Load a public name, or the version of the package."""
    if name == "__version__":
        from importlib.metadata import version

        return version("seat-cosim")
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    found = getattr(import_module(_MODULES[name]), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__, "__version__"})
