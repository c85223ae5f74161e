"""What a step of each component costs in C: ``python -m benchmarks.step_cost [gcc]``.

Prints medians in ns for a communication step of 2 ms, and in brackets the quickest rounds, which other programs
disturbed least; compiled by zig with the options of the built FMUs, or by gcc with the same. The controller takes one
sample in a step, the seat four Runge-Kutta substeps. "By FMI" includes setting all inputs and getting an output.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from fmus.component import Component
from fmus.export.native_fmu import OPTIONS, STANDARDS, source_files
from seat_cosim.components import COMPONENTS

WANTED = {"SeatController": "100", "SeatPlant": "400"}
"""What a step may cost, through FMI, in ns."""


def cost(component: Component, compiler: list[str]) -> list[list[float]]:
    """Measure a step of the kernel alone and one through the functions of FMI 2.0: median and quickest, in ns.

    Parameters
    ----------
    component
        Which.
    compiler
        Command and options.
    """
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        for name, content in source_files(component, STANDARDS["fmi2"], "{}").items():
            (folder / name).write_bytes(content)
        sources = [path.name for path in folder.glob("*.c")] + [str(Path(__file__).with_suffix(".c").resolve())]
        subprocess.run([*compiler, "-I.", *sources, "-o", "cost", "-lm"], cwd=folder, check=True)
        run = subprocess.run([folder / "cost"], capture_output=True, text=True, check=True)
    return [[float(word) for word in line.split()] for line in run.stdout.splitlines()]


def main() -> None:
    """Print a table."""
    gcc = sys.argv[1:] == ["gcc"]
    options = [option for option in OPTIONS if not (gcc and option == "-fno-slp-vectorize")]
    compiler = ["gcc", *options] if gcc else [sys.executable, "-m", "ziglang", "cc", *options]
    print(f"{'ns per step of 2 ms':<20}{'kernel':>16}{'by FMI':>16}{'wanted':>8}")
    for component in COMPONENTS:
        cells = [f"{median:.0f} ({quickest:.0f})" for median, quickest in cost(component, compiler)]
        print(f"{component.name:<20}{cells[0]:>16}{cells[1]:>16}{WANTED.get(component.name, ''):>8}")


if __name__ == "__main__":
    main()
