"""The #include graph of the C code: no cycle, and helpers do not include the models that use them."""

from __future__ import annotations

import re
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

from tests.helpers.paths import ROOT

PARTS = ("plant_models/seat", "src/seat_controller_fmu")
"""Folders of the models that the blocks join."""

_MODELS = ("plant_models", "plant_models/driver", "plant_models/shaker", "plant_models/truck", *PARTS, "seat_blocks")

FOLDERS = ("fmus", "fmus/native", *_MODELS)
"""Folders of the C code; an FMU has the files of several of them in one folder."""

GENERATED = {"model.h", "defaults.h"}
"""Headers that the exporter writes."""

STANDARD = re.compile(r"fmi[23]\w+\.h")
"""Headers of the FMI standards."""

HELPERS = {
    "actuator",
    "body",
    "floor",
    "friction",
    "motion",
    "noise",
    "platform",
    "profiles",
    "random_numbers",
    "recording",
    "replay",
    "road",
    "runge_kutta",
    "sensors",
    "smooth_step",
    "vehicle",
}
MODELS = {"driver.h", "seat.h", "shaker.h", "truck.h"}

FILES = sorted(path for folder in FOLDERS for suffix in ("*.c", "*.h") for path in (ROOT / folder).glob(suffix))


def includes(path: Path) -> list[Path]:
    """Return the files of the project that a file includes, from its own folder or the folders of shared headers."""
    found = []
    for name in re.findall(r'^#include "(.+)"', path.read_text(encoding="utf-8"), re.MULTILINE):
        if name in GENERATED or STANDARD.fullmatch(name):
            continue
        folders = [path.parent, path.parent.parent, ROOT / "fmus", ROOT / "plant_models/driver"]
        folders += [ROOT / part for part in PARTS if path.parent.name == "seat_blocks"]
        candidates = [folder / name for folder in folders]
        found.append(next(path for path in candidates if path.is_file()))
    return found


GRAPH = {path: includes(path) for path in FILES}


def reachable(path: Path) -> set[Path]:
    """Return the files that a file includes, directly or indirectly."""
    return {path, *(file for included in GRAPH[path] for file in reachable(included))}


def test_the_graph_has_no_cycle():
    assert len(FILES) > 30
    list(TopologicalSorter(GRAPH).static_order())


@pytest.mark.parametrize("path", [path for path in FILES if path.stem in HELPERS], ids=lambda path: path.name)
def test_helpers_do_not_include_the_models(path: Path):
    assert not {file.name for file in reachable(path)} & MODELS


def test_every_helper_is_found():
    assert {path.stem for path in FILES} >= HELPERS


def test_packages_include_no_file_of_one_another():
    """Models include their own package and the shared headers of fmus; the glue code includes no model by name.

    The blocks, a layer above, include the models that they join.
    """
    for path, included in GRAPH.items():
        package = path.relative_to(ROOT).parts[0]
        for file in included:
            other = file.relative_to(ROOT).parts[0]
            joined = ("plant_models", "src") if package == "seat_blocks" else ()
            assert other in (package, "fmus", *joined), f"{path.name} includes {file}"
            assert "native" not in file.parts or "native" in path.parts, f"{path.name} includes {file}"
