"""The Python flavour is what it is: an FMU for hosts that are Python themselves."""

from __future__ import annotations

import re
import shutil
import subprocess
import zipfile
from pathlib import Path

import numpy as np
import pytest

from seat_cosim.scenarios import seat_suspension
from tests.helpers.peers import SIGNALS, differences, here, missing, run

STEP_SIZE = 0.002
STEPS = 250
BOUNDS = [1e-11, 1e-9]
"""As in test_peers.py, in m/s2 and N."""

LOADER = """
#include <dlfcn.h>
#include <stdio.h>
int main(int count, char **words)
{
    void *library = dlopen(words[count - 1], RTLD_NOW);
    puts(library ? "loaded" : dlerror());
    return 0;
}
"""


@pytest.mark.parametrize("peer", ["libcosim", "Ecos", "fmucontainer"])
def test_masters_that_run_inside_python_run_it(peer: str, fmus: Path, tmp_path: Path):
    if reason := missing(peer):
        pytest.skip(f"{peer}: {reason}")
    system = seat_suspension(fmus)
    system.stop_time = STEPS * STEP_SIZE
    system.save(tmp_path / "SeatSuspension.ssp")
    found = run(peer, tmp_path / "SeatSuspension.ssp", STEPS, STEP_SIZE, list(SIGNALS))
    assert np.less(differences(found, here(system, "jacobi")), BOUNDS).all()


@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")
def test_a_program_in_c_loads_the_native_fmus_only(fmus: Path, native: Path, tmp_path: Path):
    (tmp_path / "loader.c").write_text(LOADER)
    subprocess.run(["gcc", "loader.c", "-o", "loader", "-ldl"], cwd=tmp_path, check=True)
    said = {}
    for flavour, folder in {"fmi2": native / "fmi2", "python": fmus}.items():
        with zipfile.ZipFile(folder / "SeatPlant.fmu") as archive:
            library = archive.extract("binaries/linux64/SeatPlant.so", tmp_path / flavour)
        loading = subprocess.run([tmp_path / "loader", library], capture_output=True, text=True, check=True)
        said[flavour] = loading.stdout
    assert said["fmi2"] == "loaded\n"
    assert re.search(r"undefined symbol: _?Py", said["python"])
