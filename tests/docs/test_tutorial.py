"""The tutorial's blocks run as they are written, print what the page shows, and leave the files that it names."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.helpers.paths import ROOT

PAGES = sorted((ROOT / "docs" / "tutorial").glob("*.md"))

FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"`([\w./-]+\.(?:csv|fmu|json|png|py|ssp))`")

RUNNERS = {"sh": ["bash", "-eu"], "python": [sys.executable, "-"]}
"""Language of a block to what runs it, from its standard input."""

SHOWN = {
    **dict.fromkeys(("c", "json", "xml", "toml", "mermaid"), "a listing"),
    "text": "output of the block before",
    "console": "set-up of a clone, which `.ci/run` runs",
    "": "the same",
}
"""Languages of blocks that are not run, and why."""


class Block(NamedTuple):
    """A block to run, and the output that the page shows for it."""

    language: str
    text: str
    output: str


def blocks(page: str) -> list[Block]:
    """Read the blocks of a page, in order."""
    found: list[Block] = []
    for language, text in FENCE.findall(page):
        assert language in RUNNERS or language in SHOWN, f"```{language}: expected {', '.join({**RUNNERS, **SHOWN})}"
        if language in RUNNERS:
            found.append(Block(language, text, ""))
        elif language == "text" and found:
            found[-1] = found[-1]._replace(output=text)
    return found


def run(block: Block, folder: Path) -> str:
    """Run a block in a folder, as after ``source .venv/bin/activate``; returns what it printed."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    environment = {**os.environ, "PATH": path, "COLUMNS": "200", "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(
        RUNNERS[block.language],
        input=block.text,
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
    )
    assert done.returncode == 0, f"{block.text}\n{done.stdout}\n{done.stderr}"
    return done.stdout


@pytest.mark.parametrize("page", PAGES, ids=[page.stem for page in PAGES])
def test_the_page_can_be_followed(page: Path, native: Path, tmp_path: Path):
    text = page.read_text(encoding="utf-8")
    if not text.count("\nseat-cosim export\n"):  # the page takes it for done
        run(Block("sh", "seat-cosim export\n", ""), tmp_path)
    for block in blocks(text):
        printed = [" ".join(line.split()) for line in run(block, tmp_path).splitlines()]
        for line in filter(None, block.output.splitlines()):
            assert " ".join(line.split()) in printed, f"{block.text}\nexpected {line}, got:\n" + "\n".join(printed)
    for name in FILE.findall(FENCE.sub("", text)):
        assert (tmp_path / name).is_file(), f"{page.name} names {name}, which no command made"
