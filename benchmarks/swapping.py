"""Swap shaker, seat and controller for FMUs of other tools, and draw the results.

The figures are those of docs/how-to/replace-a-component.md.

python -m benchmarks.swapping                   figures into docs/figures
python -m benchmarks.swapping --output DIR
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from cosim import Result, System
from cosim.fmi.values import Value
from seat_cosim.plotting import Curve, Panel, draw
from seat_cosim.scenarios import SCENARIOS, control, seat_suspension

ROOT = Path(__file__).parent.parent
STYLES: dict[str, Mapping[str, Any]] = {
    "off": {"color": "0.45", "linestyle": "--"},
    "ours": {"color": "C0"},
    "theirs": {"color": "C3"},
}


def build_foreign(folder: Path) -> None:
    """Build the FMUs of examples/foreign with the tools they are written for."""
    for script in sorted((ROOT / "examples" / "foreign").glob("*.py")):
        tool = "pythonfmu3" if "pythonfmu3" in script.read_text() else "pythonfmu"
        subprocess.run([sys.executable, "-m", tool, "build", "-f", str(script), "-d", str(folder)], check=True)


def run(system: System, foreign: str, stop_time: float, parameters: Mapping[str, Value]) -> Result:
    """Run a system, the FMU that is not ours in a process of its own."""
    result = system.simulate(stop_time, parameters=parameters, isolate=(foreign,))
    if result.error is not None:
        raise result.error
    return result


def rms(values: np.ndarray[Any, Any]) -> str:
    """Tell an RMS for a legend."""
    return f"RMS {np.sqrt(np.mean(values**2)):.2f} m/s²"


def another_floor(foreign: Path, folder: Path) -> None:
    """Put the cabin in the shaker's place: displacement alone, in mm."""
    system = seat_suspension(ROOT / "fmus" / "fmi2")
    system.replace("shaker", foreign / "Cabin.fmu", {"seat.floor_displacement": "0.001*z"})
    off, on = (run(system, "shaker", 4.0, control(switch)) for switch in (False, True))
    signal = "seat.driver_acceleration"
    panels = [
        Panel("Cabin floor (mm)", on.time, [Curve("shaker.z", on["shaker.z"], STYLES["theirs"])], {}),
        Panel(
            "Driver acceleration (m/s²)",
            on.time,
            [
                Curve(f"uncontrolled, {rms(off[signal])}", off[signal], STYLES["off"]),
                Curve(f"Observer 1, {rms(on[signal])}", on[signal], STYLES["ours"]),
            ],
            {},
        ),
    ]
    draw(folder / "swapped_shaker.png", "Another floor: Cabin.fmu (pythonfmu) gives its displacement in mm", panels)


def another_seat(foreign: Path, folder: Path) -> None:
    """Put the chair in the seat's place: other names, deflection in mm."""
    system = seat_suspension(ROOT / "fmus" / "fmi3")
    connections = {
        "seat.zv": "shaker.floor_displacement",
        "seat.dzv": "shaker.floor_velocity",
        "seat.F": "controller.force",
        "controller.seat_acceleration": "acc_seat",
        "controller.suspension_deflection": "stroke",
    }
    system.replace("seat", foreign / "Chair.fmu", connections)
    bump: dict[str, Value] = {**SCENARIOS["bump"].parameters, "controller.driver_mass": 62.0}
    off, on = (run(system, "seat", 3.0, {**bump, **control(switch)}) for switch in (False, True))
    panels = [
        Panel(
            "Seat acceleration (m/s²)",
            on.time,
            [
                Curve(f"chair alone, {rms(off['seat.acc_seat'])}", off["seat.acc_seat"], STYLES["off"]),
                Curve(f"Observer 1, {rms(on['seat.acc_seat'])}", on["seat.acc_seat"], STYLES["ours"]),
            ],
            {},
        ),
        Panel("Force (N)", on.time, [Curve("controller.force", on["controller.force"], STYLES["ours"])], {}),
    ]
    draw(folder / "swapped_seat.png", "Another seat: Chair.fmu (pythonfmu3) under our controller, bump", panels)


def another_controller(foreign: Path, folder: Path) -> None:
    """Put the skyhook in the controller's place: other names, no units."""
    ours, theirs = (seat_suspension(ROOT / "fmus" / "fmi2") for _ in range(2))
    theirs.replace(
        "controller",
        foreign / "Damper.fmu",
        {"controller.acc": "seat.seat_acceleration_measured", "seat.force": "F"},
    )
    bump = SCENARIOS["bump"].parameters
    off, on = (ours.simulate(3.0, parameters={**bump, **control(switch)}) for switch in (False, True))
    skyhook = run(theirs, "controller", 3.0, bump)
    signal = "seat.driver_acceleration"
    panels = [
        Panel(
            "Driver acceleration (m/s²)",
            on.time,
            [
                Curve(f"uncontrolled, {rms(off[signal])}", off[signal], STYLES["off"]),
                Curve(f"Observer 1, {rms(on[signal])}", on[signal], STYLES["ours"]),
                Curve(f"skyhook, {rms(skyhook[signal])}", skyhook[signal], STYLES["theirs"]),
            ],
            {},
        ),
        Panel(
            "Force (N)",
            on.time,
            [
                Curve("Observer 1", on["controller.force"], STYLES["ours"]),
                Curve("skyhook", skyhook["controller.F"], STYLES["theirs"]),
            ],
            {},
        ),
    ]
    draw(folder / "swapped_controller.png", "Another controller: Damper.fmu (pythonfmu), bump", panels)


def main() -> None:
    """Build, run, draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=ROOT / "docs" / "figures")
    output: Path = parser.parse_args().output
    output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        build_foreign(Path(folder))
        for swap in (another_floor, another_seat, another_controller):
            swap(Path(folder), output)
            print((swap.__doc__ or "").strip())


if __name__ == "__main__":
    main()
