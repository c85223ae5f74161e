"""Blocks of the how-to guides that make something, and their results."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import fmpy
import numpy as np

from cosim.conformance.suite import validate
from seat_cosim.scenarios import seat_suspension
from tests.docs.test_tutorial import blocks, run
from tests.helpers.paths import ROOT

PYTHON = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def test_a_controller_without_boolean_outputs(native: Path, tmp_path: Path):
    page = (ROOT / "docs" / "how-to" / "use-other-masters.md").read_text(encoding="utf-8")
    (block,) = (block for block in PYTHON.findall(page) if "SeatControllerReal.fmu" in block)
    shutil.copytree(native / "fmi2", tmp_path / "fmus" / "fmi2")
    subprocess.run([sys.executable, "-"], input=block, text=True, cwd=tmp_path, check=True)
    copy = tmp_path / "SeatControllerReal.fmu"
    assert validate(copy).findings == []
    outputs = [v for v in fmpy.read_model_description(str(copy)).modelVariables if v.causality == "output"]
    assert {v.type for v in outputs} == {"Real"}

    found = {}
    for name in ("fmus/fmi2/SeatController.fmu", copy.name):
        system = seat_suspension(tmp_path / "fmus" / "fmi2")
        system.replace("controller", tmp_path / name)
        found[name] = system.simulate(stop_time=0.5).values
    ours, copied = found.values()
    lost = {"saturated", "fault", "driver_mass_trusted", "friction_trusted"}
    assert set(ours) - set(copied) == {f"controller.{name}" for name in lost}
    for name, values in copied.items():
        np.testing.assert_array_equal(values, ours[name])


def test_the_seat_as_one_block_prints_what_its_page_says(native: Path, tmp_path: Path):
    page = (ROOT / "docs" / "how-to" / "use-the-seat-as-one-block.md").read_text(encoding="utf-8")
    (tmp_path / "fmus").symlink_to(native)
    scripts = [block for block in blocks(page) if block.language == "python"]
    assert len(scripts) == 3
    for script in scripts:
        assert run(script, tmp_path) == script.output
