"""The repository as a whole: what imports load, and documents that agree with the code; `make lint` checks the rest."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from seat_cosim.components import COMPONENTS
from seat_cosim.reference import PAGES
from tests.helpers.paths import ROOT


def run(*command: str) -> None:
    tool = Path(sys.executable).with_name(command[0])
    found = subprocess.run([tool, *command[1:]], cwd=ROOT, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stdout + found.stderr


def test_cosim_loads_without_models_plots_or_builder():
    script = "import sys, cosim; assert not {m.partition('.')[0] for m in sys.modules} & {names}"
    names = "{'plant_models', 'seat_controller_fmu', 'fmus', 'matplotlib', 'cvxpy', 'pythonfmu'}"
    run("python", "-c", script.replace("{names}", names))


@pytest.mark.parametrize("path", PAGES)
def test_generated_pages_are_up_to_date(path: str):
    assert (ROOT / path).read_text(encoding="utf-8") == PAGES[path](), "run: python -m seat_cosim.reference"


def test_the_readme_names_every_input_and_output():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    for component in COMPONENTS:
        for variable in component.variables:
            if variable.causality in ("input", "output"):
                assert f"`{variable.name}`" in readme, f"{component.name}.{variable.name}"


def test_the_script_of_one_fmu_prints_what_its_page_says(native: Path, tmp_path: Path):
    page = (ROOT / "docs" / "how-to" / "run-one-fmu.md").read_text(encoding="utf-8")
    script = next(block for block in re.findall(r"```python\n(.*?)```", page, re.DOTALL) if "FMU2Slave" in block)
    (tmp_path / "fmus").symlink_to(native)
    (tmp_path / "script.py").write_text(script, encoding="utf-8")
    found = subprocess.run([sys.executable, "script.py"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr
    assert float(found.stdout.split()[0]) == pytest.approx(float(re.search(r"# prints ([-\d.]+)", script)[1]), abs=0.05)


def test_links_between_documents_lead_somewhere():
    for document in [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "examples").rglob("*.md")]:
        for target in re.findall(r"\]\((?!http|#)([^)#]+)", document.read_text(encoding="utf-8")):
            assert (document.parent / target).exists(), f"{document.relative_to(ROOT)}: {target}"
