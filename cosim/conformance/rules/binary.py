"""Rules about the library for this platform: it can be loaded and exports all functions of the standard."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator
from contextlib import chdir

from cosim.conformance.harness import Harness
from cosim.conformance.raw_instance import library_class, library_path
from cosim.conformance.rule import rule
from cosim.errors import listed

NEEDS_LIBRARY = ("binary.loads",)
"""Needs of the rules that call functions of the FMU."""


@rule("binary.loads", "The library can be loaded", clause="2.0 §2.3; 3.0 §2.5.1.4", stage="behaviour")
def loads(harness: Harness) -> Iterator[str]:
    path = library_path(harness.description, harness.folder)
    try:
        with chdir(path.parent):
            ctypes.CDLL(str(path), mode=getattr(os, "RTLD_NOW", 2))
    except OSError as error:
        reason = str(error).replace(f"{path.parent}{os.sep}", "")
        yield f"{path.name}: expected a library that loads without anything else, got: {reason}"


@rule(
    "binary.symbols",
    "The library exports every function of the standard",
    clause="2.0 §2.1, §2.3; 3.0 §2.2.1, §2.5",
    stage="behaviour",
    needs=("binary.loads",),
)
def symbols(harness: Harness) -> Iterator[str]:
    path = library_path(harness.description, harness.folder)
    with chdir(path.parent):
        library = ctypes.CDLL(str(path))
    expected = library_class(harness.description).prototypes()
    missing = [name for name in expected if not hasattr(library, name)]
    if missing:
        yield f"{path.name}: expected {len(expected)} functions, got none of {listed(missing, most=5)}"


@rule(
    "binary.version",
    "The library has the version of the standard that the description declares",
    clause="2.0 §2.1.4; 3.0 §2.2.5",
    stage="behaviour",
    needs=NEEDS_LIBRARY,
)
def version(harness: Harness) -> Iterator[str]:
    returned = (harness.library.function("GetVersion")() or b"").decode(errors="replace")
    expected = harness.description.attributes["fmiVersion"]
    if returned.split(".")[:2] != expected.split(".")[:2]:
        yield f"{harness.library.PREFIX}GetVersion: expected {expected}, got {returned or 'nothing'}"
    if harness.description.fmi_major == 2:
        platform = (harness.library.function("GetTypesPlatform")() or b"").decode(errors="replace")
        if platform != "default":
            yield f"fmi2GetTypesPlatform: expected default, got {platform or 'nothing'}"
