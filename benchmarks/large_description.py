"""CPU time and memory to validate an FMU whose description has 100,000 variables.

    python -m benchmarks.large_description

A fresh process for each of the standards; both grow with the number of variables.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
COUNTS = (25_000, 50_000, 100_000)

_SCRIPT = """
import re, sys, os
from pathlib import Path
from cosim.conformance.suite import validate
validate(Path(sys.argv[1]))
peak = re.search(r"VmHWM:\\s*(\\d+)", Path("/proc/self/status").read_text())
print(sum(os.times()[:4]), int(peak[1]) / 1024)
"""


class Cost(NamedTuple):
    """What a validation costs.

    Attributes
    ----------
    seconds
        CPU time in s, that of the processes that run the FMU included.
    megabytes
        Largest resident memory of the validating process, in MiB.
    """

    seconds: float
    megabytes: float


def with_description(fmu: Path, target: Path, old: str, new: str) -> Path:
    """Copy an FMU with a change of its description."""
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as copy:
        for name in source.namelist():
            content = source.read(name)
            if name == "modelDescription.xml":
                content = content.replace(old.encode(), new.encode(), 1)
            copy.writestr(name, content)
    return target


def with_variables(fmu: Path, target: Path, count: int) -> Path:
    """Copy an FMU with more local variables."""
    two = "<ScalarVariable" in zipfile.ZipFile(fmu).read("modelDescription.xml").decode()
    form = (
        '<ScalarVariable name="part{0}.x{1}" valueReference="{2}" causality="local"><Real unit="m"/></ScalarVariable>'
        if two
        else '<Float64 name="part{0}.x{1}" valueReference="{2}" causality="local" unit="m"/>'
    )
    more = "\n".join(form.format(i % 97, i, 100_000 + i) for i in range(count))
    return with_description(fmu, target, "</ModelVariables>", f"{more}</ModelVariables>")


def measure(fmu: Path) -> Cost:
    """Validate an FMU in a fresh process (Linux)."""
    command = [sys.executable, "-c", _SCRIPT, str(fmu)]
    found = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    return Cost(*map(float, found.stdout.split()))


def main() -> None:
    """Print the table."""
    print(f"{'FMI':5} {'variables':>9} {'CPU, s':>7} {'MiB':>5}")
    with tempfile.TemporaryDirectory() as folder:
        for flavour in ("fmi2", "fmi3"):
            for count in COUNTS:
                path = with_variables(ROOT / "fmus" / flavour / "SeatPlant.fmu", Path(folder, "large.fmu"), count)
                found = measure(path)
                print(f"{flavour:5} {count:9} {found.seconds:7.1f} {found.megabytes:5.0f}", flush=True)


if __name__ == "__main__":
    main()
