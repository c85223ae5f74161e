"""Main script of every Python FMU: loads the component that ``component.json`` beside it names.

The sources lie in ``model``. They are imported privately, so that an FMU runs the code it carries, whatever other FMUs
or the host have loaded under the same module names. (The script's own name carries the FMU's GUID for that reason.)

pythonfmu 0.7.0 imports this file once per process, but also executes it anew with every instance, in the same names; by
then the folder of the first instance may be gone. So everything that reads files is done the first time only.
The class is made anew, and some kilobytes of it stay with each instance; but it must be: pythonfmu releases it once too
often, and a host crashes as it ends if all instances share one.
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
    """Import modules from a folder, and leave the process's table of modules as it was."""
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


def _make_up_for_pythonfmu(resources: Path, name: str) -> None:
    """Mend what pythonfmu 0.7.0 does to its host with every instance."""
    # It returns one reference too many to this module's names, which crashes the process after a few instances: lend
    # it one each time.
    _held.append(globals())
    # It leaves the FMU's folder in the host's search path, where it would outlive the folder.
    if str(resources) in sys.path:
        sys.path.remove(str(resources))
    # On Linux its library touches freed memory as the process exits, unless it is told to let go before. (Where the
    # library itself has started Python, there is no original command line, and it lets go by itself.)
    library = resources.parent / "binaries" / "linux64" / f"{name}.so"
    if sys.orig_argv and library.exists() and library not in _libraries:
        _libraries.append(library)
        atexit.register(ctypes.CDLL(str(library)).finalizePythonInterpreter)


class Slave(_slave.ComponentSlave):  # type: ignore[misc, name-defined]
    """The slave that pythonfmu instantiates."""

    component = getattr(_model, _identity["attribute"])
    content_guid = _identity["guid"]
    experiment = _identity["experiment"]

    def __init__(self, **kwargs: Any) -> None:
        if "logger" in kwargs:  # which a host passes, and the builder does not
            _make_up_for_pythonfmu(Path(kwargs["resources"]), self.component.name)
        super().__init__(**kwargs)
