"""The seeds of the coverage-guided fuzzing, under gcc's sanitizers; `make fuzz` goes on from them."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from fmus.export.native_fmu import STANDARDS
from seat_cosim.components import COMPONENTS
from tests.system.hostile import guided

pytestmark = [pytest.mark.builds, pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")]

OFTEN = {"fmi2/SeatController/address", "fmi3/Shaker/thread"}
"""To compile one takes 5 s: the others are for the longer run."""

PROGRAMS = [f"{flavour}/{c.name}/{name}" for flavour in STANDARDS for c in COMPONENTS for name in ("address", "thread")]


def replay(program: Path, folder: Path, seeds: dict[str, bytes]) -> subprocess.CompletedProcess[str]:
    for name, content in seeds.items():
        (folder / name).write_bytes(content)
    return subprocess.run([program, *seeds], cwd=folder, capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if name in OFTEN else [pytest.mark.long]) for name in PROGRAMS]
)
def test_the_seeds_find_nothing(name: str, tmp_path: Path):
    program = guided.program(name, tmp_path / "program", ["gcc", "-DSTANDALONE"])
    run = replay(program, tmp_path, guided.SEEDS)
    assert (run.returncode, run.stdout, run.stderr) == (0, f"{len(guided.SEEDS)} inputs\n", "")


def test_a_trace_of_a_refused_call_is_found(tmp_path: Path):
    """Glue code that takes the step size of a refused step aborts the program."""
    program = guided.program("fmi2/Shaker/address", tmp_path / "program", ["gcc", "-DSTANDALONE"])
    rules = program.with_name("instance.c")
    text = rules.read_text(encoding="utf-8")
    begin = text.index("Status instance_step(")
    body = text.index("{", begin) + 1
    rules.write_text(f"{text[:body]} if (instance) instance->values[0] += step_size; {text[body:]}", encoding="utf-8")
    sources = [*program.parent.glob("*.c"), *(Path("tests/native", name) for name in ("api_fmi2.c", "fuzz_api.c"))]
    words = ["gcc", "-std=c99", "-DSTANDALONE", f"-I{program.parent}", *sources, "-o", program, "-lm"]
    subprocess.run(words, cwd=guided.ROOT, check=True)
    run = replay(program, tmp_path, {"life": guided.SEEDS["life"]})
    assert run.returncode != 0
    assert "a refused call without a trace" in run.stderr


def test_a_target_without_its_tool_says_so(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(guided.shutil, "which", lambda name: None)
    monkeypatch.setattr(guided, "find_spec", lambda name: None)
    assert guided.missing("guided/fmi2/Shaker/memory") == "clang"
    assert guided.missing("guided/fmi2/Shaker/thread") == "gcc"
    assert "seat-cosim[fuzz]" in (guided.missing("guided/readers/ssv") or "")
