"""Delay margins: predicted by the linear sampled loop, found through the FMUs, and with friction and force limit.

.venv/bin/python -m benchmarks.delay_margin [FOLDER OF FMUS]
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from plant_models.seat.interface import Parameters as Seat
from seat_controller_fmu.design.sampled_loop import delay_margin
from seat_controller_fmu.interface import Parameters
from seat_controller_fmu.parameters import OBSERVERS
from tests.helpers.rig import LINEAR, Rig, bump, driver, settles

MASSES = (45.0, 55.0, 70.0, 80.0, 100.0, 120.0)
MILLISECONDS = 2.0
QUIET = 0.315
"""With friction, a loop that is unstable in the small hums on at some amplitude; it survives if the driver's RMS
acceleration in the last second, in m/s2, is below this (ISO 2631-1: not uncomfortable)."""


def largest(stable: Callable[[int], bool], guess: int, most: int = 60) -> int:
    """Find the largest delay in samples up to which a loop is stable, walking from a guess; -1 if it never is."""
    delay = guess
    while delay >= 0 and not stable(delay):
        delay -= 1
    while delay < most and stable(delay + 1):
        delay += 1
    return delay


def main() -> None:
    """Print the table."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "fmus/fmi2")
    table = Table("driver (kg)", *(f"{mass:g}" for mass in MASSES), title="Delay margin in ms")
    kick, whole = bump(8.0, height=0.001), bump(6.0)
    with Rig(folder) as rig:
        for number, gamma in OBSERVERS.items():
            observer = {"controller.observer_gamma": gamma.value}
            rows: dict[str, list[str]] = {"predicted": [], "FMUs, linear": [], "FMUs, friction and limit": []}
            for mass in MASSES:
                margin = delay_margin(Parameters(driver_mass=mass, observer_gamma=gamma.value), Seat(driver_mass=mass))
                guess = round(margin / MILLISECONDS)
                linear = {**LINEAR, **observer, **driver(mass)}
                full = {**observer, **driver(mass)}
                found = largest(lambda d, p=linear: settles(rig.run(kick, p, d)), guess)
                real = largest(
                    lambda d, p=full: np.sqrt(np.mean(rig.run(whole, p, d).acceleration[-500:] ** 2)) < QUIET, guess
                )
                for name, value in zip(rows, (margin, found * MILLISECONDS, real * MILLISECONDS), strict=True):
                    rows[name].append(f"{value:g}")
            for name, values in rows.items():
                table.add_row(f"Observer {number}, {name}", *values)
    Console(width=100).print(table)


if __name__ == "__main__":
    main()
