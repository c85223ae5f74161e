"""The complete API of the native FMUs, called by a C program under a sanitizer or valgrind."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from fmus.component import Component
from fmus.export.native_fmu import STANDARDS, source_files
from seat_cosim.components import COMPONENTS
from tests.helpers.paths import NATIVE, ROOT

WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wno-type-limits", "-Werror"]  # a model may have no inputs

UNDER_VALGRIND = {("SeatController", "fmi2"), ("Shaker", "fmi3")}
"""Those which run under valgrind in every run of the tests, the others under sanitizers; `make test-all` runs all."""

RARELY = {("PassiveSeat", "fmi2"), ("PassiveSeat", "fmi3"), ("ActiveSeat", "fmi2"), ("SemiActiveSeat", "fmi3")}
"""Those which run in `make test-all` only: their kernels are those of others, their glue that of the other flavour."""

pytestmark = [pytest.mark.builds, pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")]


def test_program(flavour: str, component: Component, folder: Path, *options: str) -> Path:
    """Compile the walk through the API with an FMU's own sources."""
    for name, content in source_files(component, STANDARDS[flavour], "{token}").items():
        (folder / name).write_bytes(content)
    sources = [*sorted(path.name for path in folder.glob("*.c"))]
    sources += [str(ROOT / "tests/native" / name) for name in (f"api_{flavour}.c", "api_test.c")]
    command = ["gcc", "-std=c99", "-g", *WARNINGS, *options, "-I.", *sources, "-o", "walk", "-lm", "-pthread"]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return folder / "walk"


test_program.__test__ = False  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("component", "flavour"),
    [
        pytest.param(c, flavour, marks=[pytest.mark.long] if (c.name, flavour) in UNDER_VALGRIND | RARELY else [])
        for c in COMPONENTS
        for flavour in NATIVE
    ],
    ids=lambda value: getattr(value, "name", value),
)
def test_walk_through_the_api_is_silent_under_sanitizers(component: Component, flavour: str, tmp_path: Path):
    sanitizers = ["-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    program = test_program(flavour, component, tmp_path, *sanitizers)
    run = subprocess.run([program], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout, run.stderr) == (0, "0 failures\n", "")


@pytest.mark.skipif(shutil.which("valgrind") is None, reason="valgrind is not installed")
@pytest.mark.parametrize(
    ("component", "flavour"),
    [
        pytest.param(c, flavour, marks=[] if (c.name, flavour) in UNDER_VALGRIND else [pytest.mark.long])
        for c in COMPONENTS
        for flavour in NATIVE
    ],
    ids=lambda value: getattr(value, "name", value),
)
def test_walk_through_the_api_is_silent_under_valgrind(component: Component, flavour: str, tmp_path: Path):
    program = test_program(flavour, component, tmp_path, "-O1")
    command = ["valgrind", "--quiet", "--leak-check=full", "--error-exitcode=9", str(program)]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout, run.stderr) == (0, "0 failures\n", "")


@pytest.mark.parametrize("flavour", NATIVE)
@pytest.mark.parametrize("component", COMPONENTS, ids=lambda c: c.name)
def test_glue_compiles_without_any_warning(component: Component, flavour: str, tmp_path: Path):
    for name, content in source_files(component, STANDARDS[flavour], "{token}").items():
        (tmp_path / name).write_bytes(content)
    command = ["gcc", "-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror", "-c"]
    files = sorted(path.name for path in tmp_path.glob("*.c"))
    run = subprocess.run([*command, *files], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr


def test_the_walk_detects_a_broken_rule(tmp_path: Path):
    """Glue code that accepts a fixed parameter while stepping fails the walk."""
    component = COMPONENTS[0]
    program = test_program("fmi2", component, tmp_path)
    rules = (tmp_path / "instance.c").read_text(encoding="utf-8")
    broken = rules.replace("instance->phase != PHASE_STEPPING)", "true)")
    assert broken != rules
    (tmp_path / "instance.c").write_text(broken, encoding="utf-8")
    sources = sorted(path.name for path in tmp_path.glob("*.c"))
    sources += [str(ROOT / "tests/native" / name) for name in ("api_fmi2.c", "api_test.c")]
    subprocess.run(["gcc", "-std=c99", "-I.", *sources, "-o", program, "-lm", "-pthread"], cwd=tmp_path, check=True)
    run = subprocess.run([program], capture_output=True, text=True, check=False)
    assert run.returncode == 1
    assert "settable(v, phase)" in run.stdout
