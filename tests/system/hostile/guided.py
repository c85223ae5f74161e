"""Fuzzing that coverage guides: libFuzzer calls the native FMUs under sanitizers, atheris spoils files for the readers.

Both are optional: targets whose tool is not installed say so. Two instances in two threads get changed seeds without
guidance.
"""

from __future__ import annotations

import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from fmus.export.native_fmu import STANDARDS, source_files
from seat_cosim.components import COMPONENTS

ROOT = Path(__file__).parents[3]

SANITIZERS = {
    "address": ["-fsanitize=address,undefined,float-cast-overflow"],
    "memory": ["-fsanitize=memory"],
    "thread": ["-fsanitize=thread", "-DTHREADS"],
}
"""Name of a target's last part to the options of the compiler; the last ones run two instances in two threads."""

READERS = ("ssp", "ssd", "ssv", "fmu", "gains", "manifest", "result")
"""Readers of the house's own."""

TARGETS = (
    *(f"guided/{flavour}/{c.name}/{name}" for flavour in STANDARDS for c in COMPONENTS for name in SANITIZERS),
    *(f"guided/readers/{name}" for name in READERS),
)
"""What can be run, by name."""

_MAX_SIZE = 2048
_BATCH = 100
"""Inputs of one process, where they are not guided."""
_START, _END, _TERMINATE, _RESET, _KEEP, _RESTORE, _SPOIL, _ANEW, _UNSUPPORTED = 0, 1, 2, 3, 4, 5, 7, 9, 11
_SET, _STEP = 12, 20
_RIDE = bytes([_START, 0, _END]) + bytes([_STEP, 0, 0]) * 40

SEEDS = {
    "ride": _RIDE,
    "settings": b"".join(bytes([_SET, reference, 70, 3]) for reference in range(60)) + _RIDE,
    "states": _RIDE + bytes([_KEEP]) + bytes([_STEP, 5, 0]) * 5 + bytes([_RESTORE]) + bytes([_STEP, 6, 0]) * 3,
    "spoiled": _RIDE + bytes([_SPOIL, 2, 0, 40, 255, 1, 9, 127, 0]) + _RIDE + bytes([_SPOIL, 0, 255, 7]),
    "life": bytes([_STEP, 0, 0, _END, _UNSUPPORTED, _START, 2, _START, 2, _END, _TERMINATE, _STEP, 0, 0, _RESET])
    + _RIDE,
    "anew": _RIDE + bytes([_ANEW]) + _RIDE + bytes([_STEP, 250, 195, 0, _STEP, 0, 240, 199]),
    "extremes": b"".join(bytes([_SET, reference, kind]) for reference in range(40) for kind in (6, 7, 8, 195)) + _RIDE,
}
"""Small inputs to begin with, in the bytes of ``tests/native/fuzz_api.c``: they reach every kind of call."""


@dataclass(frozen=True)
class Outcome:
    """What became of a target.

    Attributes
    ----------
    cases
        Number of inputs.
    found
        What was printed if something was found, else None.
    """

    cases: int
    found: str | None = None


def missing(target: str) -> str | None:
    """Return what a target needs and this machine does not have; None where nothing is missing."""
    if target.startswith("guided/readers"):
        return None if find_spec("atheris") else 'atheris (pip install "seat-cosim[fuzz]")'
    if target.endswith("thread"):
        return None if shutil.which("gcc") else "gcc"
    return None if shutil.which("clang") else "clang"


def program(target: str, folder: Path, compiler: Sequence[str]) -> Path:
    """Compile an FMU's own sources with the calls of ``fuzz_api.c``.

    Parameters
    ----------
    target
        ``.../FLAVOUR/MODEL/SANITIZER``.
    folder
        For sources and program.
    compiler
        Its command and further options.
    """
    flavour, name, sanitizer = target.split("/")[-3:]
    (component,) = [each for each in COMPONENTS if each.name == name]
    folder.mkdir(parents=True, exist_ok=True)
    for file, content in source_files(component, STANDARDS[flavour], "{token}").items():
        (folder / file).write_bytes(content)
    sources = sorted(path.name for path in folder.glob("*.c"))
    sources += [str(ROOT / "tests/native" / file) for file in (f"api_{flavour}.c", "fuzz_api.c")]
    options = ["-std=c99", "-O1", "-g", "-ffp-contract=off", "-fno-sanitize-recover=all", *SANITIZERS[sanitizer]]
    words = [*compiler, *options, "-I.", *sources, "-o", "fuzz_api", "-lm", "-pthread"]
    subprocess.run(words, cwd=folder, check=True)
    return folder / "fuzz_api"


def play(target: str, built: Path, number: int, seconds: float) -> Outcome:
    """Run a target for some time.

    Parameters
    ----------
    target
        One of :data:`TARGETS`, with its tool installed.
    built
        Holds the FMUs of all flavours and the systems of them.
    number
        The seed.
    seconds
        The time.
    """
    with tempfile.TemporaryDirectory(prefix="guided-") as name:
        folder = Path(name)
        if target.endswith("thread"):
            return _play_in_threads(target, folder, number, seconds)
        corpus = folder / "corpus"
        corpus.mkdir()
        if target.startswith("guided/readers"):
            words = [sys.executable, "-m", "tests.system.hostile.guided_readers", target.rpartition("/")[2], str(built)]
            options = ["-max_len=65536", "-rss_limit_mb=4096"]
        else:
            for seed, content in SEEDS.items():
                (corpus / seed).write_bytes(content)
            words = [str(program(target, folder, ["clang", "-fsanitize=fuzzer"]))]
            options = [f"-max_len={_MAX_SIZE}"]
        options += [f"-max_total_time={max(1, round(seconds))}", f"-seed={number}", "-print_final_stats=1"]
        run = subprocess.run(
            [*words, *options, f"-artifact_prefix={folder}/", str(corpus)],
            cwd=ROOT,
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
        )
        cases = re.search(r"stat::number_of_executed_units:\s*(\d+)", run.stderr)
        if run.returncode == 0 and cases:
            return Outcome(int(cases[1]))
        kept = [path.read_bytes().hex() for path in folder.glob("*-*") if path.is_file()]
        return Outcome(
            0, f"{target}, seed {number}: ended with {run.returncode}\n{run.stderr[-20_000:]}\ninputs: {kept}"
        )


def _play_in_threads(target: str, folder: Path, number: int, seconds: float) -> Outcome:
    """Run changed seeds in two threads; without guidance, as libFuzzer's own counters are no atomic ones."""
    compiled = program(target, folder / "program", ["gcc", "-DSTANDALONE"])
    until, drawn, cases = time.monotonic() + seconds, random.Random(number), 0
    while not cases or time.monotonic() < until:
        inputs = [_changed(drawn) for _ in range(_BATCH)]
        for i, content in enumerate(inputs):
            (folder / str(i)).write_bytes(content)
        words = [str(compiled), *(str(i) for i in range(_BATCH))]
        run = subprocess.run(words, cwd=folder, capture_output=True, text=True, errors="replace", check=False)
        if run.returncode != 0 or run.stderr:
            said = f"{target}, seed {number}: ended with {run.returncode}\n{run.stderr[-20_000:]}"
            return Outcome(0, f"{said}\ninputs: {[content.hex() for content in inputs]}")
        cases += _BATCH
    return Outcome(cases)


def _changed(drawn: random.Random) -> bytes:
    """Join two seeds and change some bytes."""
    one, other = (drawn.choice(list(SEEDS.values())) for _ in range(2))
    content = bytearray(one[: drawn.randrange(len(one) + 1)] + other[drawn.randrange(len(other)) :])
    for _ in range(drawn.randrange(8) if content else 0):
        content[drawn.randrange(len(content))] = drawn.randrange(256)
    return bytes(content)
