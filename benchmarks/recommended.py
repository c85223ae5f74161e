"""The recommended gains against the published ones, through the FMUs with friction and force limit.

.venv/bin/python -m benchmarks.recommended [FOLDER OF FMUS]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from seat_controller_fmu.design.gains import PRESETS, preset
from tests.helpers.rig import Floor, Motion, Rig, bump, driver, noise

MASSES = (45.0, 60.0, 75.0, 90.0, 105.0, 120.0)


def numbers(motion: Motion) -> tuple[float, float, float]:
    """Driver's RMS and peak acceleration in m/s2, largest deflection in mm."""
    a, x = motion
    return float(np.sqrt(np.mean(a**2))), float(np.abs(a).max()), float(1e3 * np.abs(x).max())


def compare(rig: Rig, floor: Floor) -> dict[str, np.ndarray]:
    """Run all presets at all masses; returns (mass, number) arrays by preset."""
    return {
        name: np.array(
            [
                numbers(
                    rig.run(floor, {f"controller.{k}": v for k, v in preset(name).parameters().items()} | driver(m))
                )
                for m in MASSES
            ]
        )
        for name in PRESETS
    }


def main() -> None:
    """Print the table."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "fmus/fmi2")
    floors = {"bump": bump(3.0), "noise 0.9-11 Hz, 1.2 m/s2": noise(12.0, 1.2, (0.9, 11.0), seed=1)}
    console = Console(width=150)
    with Rig(folder) as rig:
        for title, floor in floors.items():
            found = compare(rig, floor)
            table = Table("gains", *(f"{m:g} kg" for m in MASSES), "mean RMS", "mean peak", "deflection", title=title)
            for name, values in found.items():
                ratio = (values / found["published"]).mean(axis=0)
                cells = [f"{rms:.3f} / {peak:.2f}" for rms, peak, _ in values]
                table.add_row(name, *cells, f"{ratio[0]:.3f}", f"{ratio[1]:.3f}", f"{values[:, 2].max():.0f} mm")
            console.print(table)
    console.print("Cells: driver's RMS / peak acceleration in m/s2; means are relative to the published gains.")


if __name__ == "__main__":
    main()
