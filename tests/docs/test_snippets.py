"""Every command and script of README and documentation runs as it is written, each page by itself in an empty folder.

Blocks `sh` and `python` are run. Blocks `console` are set-ups of a clone or of an environment; `text` is output.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.docs.test_tutorial import RUNNERS, blocks, run
from tests.helpers.paths import ROOT

LONG = (
    "docs/explanation/calibration.md",
    "docs/how-to/assess-a-measured-ride.md",
    "docs/how-to/choose-an-excitation.md",
    "docs/how-to/compute-metrics.md",
    "docs/how-to/design-gains.md",
    "docs/how-to/evaluate-a-system.md",
    "docs/how-to/isolate-an-fmu.md",
    "docs/how-to/model-imperfections.md",
    "docs/how-to/record-runs.md",
    "docs/how-to/replace-a-component.md",
    "docs/how-to/reproduce-the-paper.md",
    "docs/how-to/run-a-sweep.md",
    "docs/how-to/set-parameters-and-gains.md",
    "docs/how-to/write-a-controller.md",
    "examples/controllers/README.md",
)
"""Pages whose commands take long; they run in ``make test-all``."""

CANDIDATES = [
    ROOT / "README.md",
    *sorted(path for path in (ROOT / "docs").rglob("*.md") if path.parent.name != "tutorial"),
    *sorted((ROOT / "examples").rglob("README.md")),
]
GENERATED = {ROOT / "docs" / "reference" / "command-line.md"}
"""Pages made of the commands' help, whose examples name files of nobody."""


def runnable() -> list[Path]:
    """Return the pages that have something to run."""
    texts = {page: page.read_text("utf-8") for page in CANDIDATES if page not in GENERATED}
    return [page for page, text in texts.items() if any(f"```{name}\n" in text for name in RUNNERS)]


def marked(page: Path) -> object:
    name = page.relative_to(ROOT).as_posix()
    return pytest.param(page, id=name, marks=[pytest.mark.long] if name in LONG else [])


@pytest.mark.builds
@pytest.mark.parametrize("page", [marked(page) for page in runnable()])
def test_the_commands_of_a_page_run_in_an_empty_folder(page: Path, native: Path, tmp_path: Path):
    if page.is_relative_to(ROOT / "examples"):  # they start from the folder that holds the examples
        shutil.copytree(ROOT / "examples", tmp_path / "examples", ignore=shutil.ignore_patterns("__pycache__"))
    for block in blocks(page.read_text(encoding="utf-8")):
        if block.language in RUNNERS:
            run(block, tmp_path)


def test_the_readme_fits_its_bound_and_names_what_it_takes():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 120
    assert "500 MB" in text
    assert ".venv/bin/seat-cosim" not in text


@pytest.mark.parametrize("word", ["SEAT", "VDV", "MTVV", "SSP", "direct feedthrough", "a_w", "Jacobi", "LMI"])
def test_the_glossary_explains(word: str):
    text = (ROOT / "docs" / "reference" / "glossary.md").read_text(encoding="utf-8")
    assert any(line.startswith("| ") and word in line.split("|")[1] for line in text.splitlines())
