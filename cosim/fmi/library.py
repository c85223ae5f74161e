"""Load the shared library of an FMU into fmpy's slave without a change of the process's working folder.

fmpy's own constructor changes to the library's folder while it loads, which every other thread of the process sees. It
needs not: Linux and macOS search the libraries that a library needs by its own run path, and Python has Windows search
the folder of a library that is named by its full path.
"""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

from fmpy import platform, platform_tuple, sharedLibraryExtension

_PLATFORMS = {2: platform, 3: platform_tuple}
"""Major version of FMI to its name of this machine's folder in ``binaries``."""


def load_library(slave: Any, fmi_version: int, token: str, identifier: str, folder: Path, name: str) -> None:
    """Do what fmpy's constructor of a slave does.

    Parameters
    ----------
    slave
        fmpy's slave, whose constructor has not run.
    fmi_version
        Major version of FMI.
    token
        Its instantiation token or GUID.
    identifier
        Its model identifier, the library's name without extension.
    folder
        Where the FMU was extracted.
    name
        Of the instance.

    Raises
    ------
    OSError
        If there is no such library or it cannot be loaded.
    AttributeError
        If a function of the standard is missing in it.
    """
    path = folder.absolute() / "binaries" / _PLATFORMS[fmi_version] / f"{identifier}{sharedLibraryExtension}"
    if not path.is_file():
        raise OSError(f"Cannot find shared library {path}.")
    slave.guid, slave.modelIdentifier, slave.instanceName = token, identifier, name
    slave.unzipDirectory = str(folder)
    slave.fmiCallLogger, slave.requireFunctions = None, True
    slave._functions = {}
    try:
        slave.dll = ctypes.cdll.LoadLibrary(str(path))
    except OSError as error:
        raise OSError(f"Failed to load shared library {path}. {error}") from None
    slave._loadFunctions()
    slave.component = slave.callbacks = None
