"""The page on the microcontroller: what it shows compiles strictly and does what the FMU does."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from fmus.export.c_header import defaults_header
from fmus.export.sources import kernel_files
from seat_cosim.components import COMPONENTS
from tests.helpers.paths import ROOT

MAIN = """
#include <stdio.h>

static seat_controller_real commanded;

seat_controller_real read_seat_acceleration(void) { return (seat_controller_real)0.1; }
seat_controller_real read_suspension_deflection(void) { return (seat_controller_real)0.01; }
void command_force(seat_controller_real force) { commanded = force; }

int main(void)
{
    if (control_begin((seat_controller_real)70.0) != NULL) {
        return 1;
    }
    for (int k = 0; k < 100; ++k) {
        control_interrupt();
    }
    printf("%.6f", (double)commanded);
    return 0;
}
"""


@pytest.mark.builds
@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")
@pytest.mark.parametrize("real", ["double", "float"])
def test_the_interrupt_of_the_page_gives_the_force_of_the_script(real: str, tmp_path: Path):
    page = (ROOT / "docs" / "how-to" / "microcontroller.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```c\n(.*?)```", page, re.DOTALL)
    (tmp_path / "main.c").write_text(code + MAIN, encoding="utf-8")
    (tmp_path / "defaults.h").write_text(defaults_header(COMPONENTS[0]), encoding="utf-8")
    kernel = kernel_files("seat_controller_fmu.controller")
    for path in kernel:
        shutil.copy(path, tmp_path)
    sources = [path.name for path in kernel if path.suffix == ".c"]
    strict = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror", f"-DSEAT_CONTROLLER_REAL={real}"]
    command = ["gcc", *strict, "main.c", *sources, "-o", "main", "-lm"]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    force = float(subprocess.run([tmp_path / "main"], capture_output=True, text=True, check=True).stdout)
    script = (ROOT / "docs" / "how-to" / "run-one-fmu.md").read_text(encoding="utf-8")
    assert force == pytest.approx(float(re.search(r"# prints ([-\d.]+)", script)[1]), abs=0.05)
