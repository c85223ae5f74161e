"""What a step of each component costs in C: ``python -m benchmarks.step_cost [gcc]``.

Prints medians in ns for a communication step of 2 ms, and in brackets the quickest rounds, which other programs
disturbed least; compiled by zig with the options of the built FMUs, or by gcc with the same. The controller takes one
sample in a step, the seat four Runge-Kutta substeps. "By FMI" includes setting all inputs and getting an output.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from fmus.component import Component
from fmus.export.native_fmu import OPTIONS, STANDARDS, source_files
from seat_controller_fmu.interface import Mode
from seat_cosim.components import COMPONENTS

CHOICES = {
    "SeatController": {"mode": (Mode.robust, "0.001, 0.005", "outputs.fault == FAULT_NONE && outputs.friction_trusted")}
}
"""Component to enumerations that are measured besides their default, with amplitudes of the inputs that suit them, and
what must be true at the end.
"""

WANTED = {"SeatController": "100", "SeatController robust": "150", "SeatPlant": "400", "TruckCab": "400"}
"""What a step may cost, through FMI, in ns."""


def cost(component: Component, compiler: list[str], choice: Sequence[str] = ()) -> list[list[float]]:
    """Measure a step of the kernel alone and one through the functions of FMI 2.0: median and quickest, in ns.

    Parameters
    ----------
    component
        Which.
    compiler
        Command and options.
    choice
        Definitions from :func:`choices`.
    """
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        for name, content in source_files(component, STANDARDS["fmi2"], "{}").items():
            (folder / name).write_bytes(content)
        sources = [path.name for path in folder.glob("*.c")] + [str(Path(__file__).with_suffix(".c").resolve())]
        subprocess.run([*compiler, *choice, "-I.", *sources, "-o", "cost", "-lm"], cwd=folder, check=True)
        run = subprocess.run([folder / "cost"], capture_output=True, text=True, check=True)
    return [[float(word) for word in line.split()] for line in run.stdout.splitlines()]


def choices(component: Component) -> dict[str, list[str]]:
    """Return what is measured of a component: name to definitions for the compiler.

    Parameters
    ----------
    component
        Which.
    """
    found: dict[str, list[str]] = {component.name: []}
    names = [variable.name for variable in component.variables]
    for name, (item, amplitudes, normal) in CHOICES.get(component.name, {}).items():
        variable = component.variables[names.index(name)]
        found[f"{component.name} {item.name}"] = [
            f"-DCHOICE={variable.field}",
            f"-DCHOICE_REFERENCE={names.index(name)}",
            f"-DCHOICE_VALUE={item.value}",
            f"-DAMPLITUDES={amplitudes}",
            f"-DCHOICE_NORMAL={normal}",
        ]
    return found


def main() -> None:
    """Print a table."""
    gcc = sys.argv[1:] == ["gcc"]
    options = [option for option in OPTIONS if not (gcc and option == "-fno-slp-vectorize")]
    compiler = ["gcc", *options] if gcc else [sys.executable, "-m", "ziglang", "cc", *options]
    print(f"{'ns per step of 2 ms':<24}{'kernel':>16}{'by FMI':>16}{'wanted':>8}")
    for component in COMPONENTS:
        for name, choice in choices(component).items():
            cells = [f"{median:.0f} ({quickest:.0f})" for median, quickest in cost(component, compiler, choice)]
            print(f"{name:<24}{cells[0]:>16}{cells[1]:>16}{WANTED.get(name, ''):>8}")


if __name__ == "__main__":
    main()
