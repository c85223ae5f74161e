"""The master without the project's other packages: a copy of ``cosim`` runs, checks and writes systems."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

from tests.helpers.paths import ROOT

OTHERS = ("fmus", "plant_models", "seat_controller_fmu", "seat_cosim", "tests", "matplotlib", "pythonfmu", "cvxpy")

SCRIPT = """
import sys
from pathlib import Path


class Hidden:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in OTHERS:
            raise ModuleNotFoundError(name)


sys.meta_path.insert(0, Hidden())
folder, fmus = map(Path, sys.argv[1:])
sys.path.insert(0, str(folder))

import cosim
from cosim import System
from cosim.conformance.suite import validate
from cosim.metrics import rms

assert Path(cosim.__file__).is_relative_to(folder), cosim.__file__
system = System()
system.add("shaker", fmus / "Shaker.fmu")
system.add("seat", fmus / "SeatPlant.fmu")
system.connect("shaker.floor_displacement", "seat.floor_displacement")
system.save(folder / "ride.ssp")
result = System.load(folder / "ride.ssp").simulate(0.5, 0.002)
assert result.complete and rms(result["seat.seat_acceleration"]) > 0.0
report = validate(fmus / "SeatPlant.fmu", only=["archive", "description", "lifecycle.sequence"])
assert not report.findings, report.findings
"""


def test_cosim_runs_alone(native: Path, tmp_path: Path):
    shutil.copytree(ROOT / "cosim", tmp_path / "cosim", ignore=shutil.ignore_patterns("__pycache__"))
    script = tmp_path / "script.py"
    script.write_text(f"OTHERS = {OTHERS}\n{SCRIPT}", encoding="utf-8")
    found = subprocess.run(
        [sys.executable, "-P", str(script), str(tmp_path), str(native / "fmi2")],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert found.returncode == 0, found.stderr
