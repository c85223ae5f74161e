"""Main script of every Python FMU: loads the component that ``component.json`` beside it names.

The sources are in ``model``. They are imported privately, so that an FMU runs its own code even if other FMUs or the
host have loaded modules of the same names. (For the same reason the file name of this script contains the GUID.)

pythonfmu 0.7.0 imports this file once per process, but also executes it again in the same namespace for every instance.
By then the folder of the first instance may be deleted, so files are read the first time only. The class is created for
each instance, which leaves some kilobytes behind: pythonfmu releases the class once too often, and the host would crash
at its end if all instances shared one.
"""

from __future__ import annotations

import atexit
import ctypes
import importlib
import json
import sys
from pathlib import Path
from types import ModuleType
from typing import Any


def _import_privately(folder: Path, names: list[str]) -> list[ModuleType]:
    """Import modules from a folder and restore ``sys.modules``."""
    packages = {path.name for path in folder.iterdir()}
    outside = {name: module for name, module in sys.modules.items() if name.partition(".")[0] in packages}
    for name in outside:
        del sys.modules[name]
    sys.path.insert(0, str(folder))
    try:
        return [importlib.import_module(name) for name in names]
    finally:
        sys.path.remove(str(folder))
        for name in [name for name in sys.modules if name.partition(".")[0] in packages]:
            del sys.modules[name]
        sys.modules.update(outside)


if "_slave" not in globals():
    _resources = Path(__file__).parent
    _identity = json.loads((_resources / "component.json").read_text(encoding="utf-8"))
    _slave, _model = _import_privately(_resources / "model", ["fmus.pythonfmu.component_slave", _identity["module"]])
    _held: list[dict[str, Any]] = []
    _libraries: list[Path] = []


def _work_around_pythonfmu(resources: Path, name: str) -> None:
    """Work around errors of pythonfmu 0.7.0 that concern the host."""
    # It releases one reference too many to the namespace of this module with every instance, which would crash the
    # process after a few instances: hold one reference each time.
    _held.append(globals())
    # It leaves the folder of the FMU in the search path of the host, also when the folder is deleted.
    if str(resources) in sys.path:
        sys.path.remove(str(resources))
    # On Linux its library accesses freed memory at the exit of the process, unless it is finalized before. (If the
    # library has started Python itself, there is no original command line, and it finalizes itself.)
    library = resources.parent / "binaries" / "linux64" / f"{name}.so"
    if sys.orig_argv and library.exists() and library not in _libraries:
        _libraries.append(library)
        atexit.register(ctypes.CDLL(str(library)).finalizePythonInterpreter)


class PythonSlave(_slave.ComponentSlave):  # type: ignore[misc, name-defined]
    """The slave that pythonfmu instantiates."""

    component = getattr(_model, _identity["attribute"])
    content_guid = _identity["guid"]
    experiment = _identity["experiment"]

    def __init__(self, **kwargs: Any) -> None:
        if "logger" in kwargs:  # passed by a host, not by the builder
            _work_around_pythonfmu(Path(kwargs["resources"]), self.component.name)
        super().__init__(**kwargs)
