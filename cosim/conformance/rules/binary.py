"""Rules about the library for this machine: it can be loaded, and has all functions of the standard."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator
from contextlib import chdir

from cosim.conformance.harness import Bench
from cosim.conformance.raw_instance import Library2, Library3, library_path
from cosim.conformance.rule import rule

LOADED = ("binary.loads",)
"""What rules need that call the FMU."""


@rule("binary.loads", "The library can be loaded", clause="2.0 §2.3; 3.0 §2.5.1.4", stage="behaviour")
def loads(bench: Bench) -> Iterator[str]:
    path = library_path(bench.description, bench.folder)
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
def symbols(bench: Bench) -> Iterator[str]:
    path = library_path(bench.description, bench.folder)
    with chdir(path.parent):
        library = ctypes.CDLL(str(path))
    expected = {2: Library2, 3: Library3}[bench.description.standard].prototypes()
    missing = [name for name in expected if not hasattr(library, name)]
    if missing:
        more = f" and {len(missing) - 5} more" if len(missing) > 5 else ""
        yield f"{path.name}: expected {len(expected)} functions, got none of {', '.join(missing[:5])}{more}"


@rule(
    "binary.version",
    "The library is of the standard's version that the description names",
    clause="2.0 §2.1.4; 3.0 §2.2.5",
    stage="behaviour",
    needs=LOADED,
)
def version(bench: Bench) -> Iterator[str]:
    told = (bench.library.function("GetVersion")() or b"").decode(errors="replace")
    expected = bench.description.attributes["fmiVersion"]
    if told.split(".")[:2] != expected.split(".")[:2]:
        yield f"{bench.library.PREFIX}GetVersion: expected {expected}, got {told or 'nothing'}"
    if bench.description.standard == 2:
        platform = (bench.library.function("GetTypesPlatform")() or b"").decode(errors="replace")
        if platform != "default":
            yield f"fmi2GetTypesPlatform: expected default, got {platform or 'nothing'}"
