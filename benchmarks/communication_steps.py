"""How the closed loop fares at other communication steps: ``python -m benchmarks.communication_steps [FMUS]``.

Prints the table of docs/reference/accuracy-and-speed.md: the paper's bump at 55 kg against a run at 0.1 ms. The
controller samples every 2 ms whatever the step; at longer steps it meets stale measurements, several samples in a row,
and its force reaches the seat late. FMUS is a folder of built FMUs, ``fmus/fmi2`` by default.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from cosim import System
from seat_controller_fmu.parameters import OBSERVERS
from seat_cosim.scenarios import SCENARIOS, control, observer, seat_suspension

STEPS = (0.5e-3, 1e-3, 2e-3, 4e-3, 10e-3)
"""Communication steps, in s."""

FINEST = 0.1e-3
"""Communication step of the run that the others are compared with, in s; the order is the same."""

CASES = {
    "uncontrolled": control(False),
    "Observer 1": observer(OBSERVERS[1].value),
    "Observer 2": observer(OBSERVERS[2].value),
}


def driver_acceleration(system: System, case: str, step_size: float) -> np.ndarray:
    """Run the bump; returns the driver's acceleration, in m/s2, at multiples of 20 ms, and after that its peak.

    Parameters
    ----------
    system
        The seat suspension.
    case
        Name from :data:`CASES`.
    step_size
        In s.
    """
    bump = SCENARIOS["bump"]
    result = system.simulate(bump.stop_time, step_size, {**bump.parameters, **CASES[case]})
    values = result["seat.driver_acceleration"]
    return np.array([*values[:: round(0.02 / step_size)], np.abs(values).max()])


def main() -> None:
    """Print the table."""
    system = seat_suspension(Path(sys.argv[1] if len(sys.argv) > 1 else "fmus/fmi2"))
    print("| case | " + " | ".join(f"{1e3 * step:g} ms" for step in STEPS) + " |")
    print("|---" * (len(STEPS) + 1) + "|")
    for case in CASES:
        *finest, _ = driver_acceleration(system, case, FINEST)
        cells = []
        for step in STEPS:
            *values, peak = driver_acceleration(system, case, step)
            error = np.sqrt(np.mean((np.array(values) - finest) ** 2) / np.mean(np.square(finest)))
            cells.append(f"{100 * error:.2g} %, {peak:.2f}")
        print(f"| {case} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
