"""Compilers of native FMUs: zig, for any platform and with the same bytes everywhere; without it the machine's own."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, version
from typing import NamedTuple

from fmus.export.fmu_file import BuildError


class Compiler(NamedTuple):
    """A C compiler that builds the libraries.

    Attributes
    ----------
    name
        Name in messages.
    version
        Text that changes with the compiler; part of the GUIDs of what it compiles.
    command
        Words that start it.
    takes_target
        Whether it compiles for any platform, by ``-target``; otherwise for this machine only.
    """

    name: str
    version: str
    command: tuple[str, ...]
    takes_target: bool


def find_compiler() -> Compiler:
    """Return zig where the package ziglang is installed, else the C compiler of this machine (``CC``, cc, gcc, clang).

    Raises
    ------
    BuildError
        If there is none.
    """
    try:
        return Compiler("zig", version("ziglang"), (sys.executable, "-m", "ziglang", "cc"), takes_target=True)
    except PackageNotFoundError:
        pass
    candidates = filter(None, (os.environ.get("CC"), "cc", "gcc", "clang"))
    found = next((path for name in candidates if (path := shutil.which(name))), None)
    if found is None:
        raise BuildError(
            'native FMUs: expected a C compiler, got none; run: pip install "seat-cosim[native]", or use the FMUs of a '
            "wheel: seat-cosim export"
        )
    about = subprocess.run([found, "--version"], capture_output=True, text=True, check=False).stdout
    return Compiler("cc", about.partition("\n")[0] or found, (found,), takes_target=False)
