"""What this project runs: the seat suspension's wiring, and the excitations with their defaults.

With :mod:`seat_cosim.paper.bump_test` and :mod:`seat_cosim.paper` all that knows signal names of the components in this
package.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from cosim.errors import SetupError
from cosim.fmi.values import Value
from cosim.system import System

_FMUS = {"shaker": "Shaker", "seat": "SeatPlant", "controller": "SeatController"}

SYSTEM_FILES = {"fmi2": "SeatSuspension.ssp", "fmi3": "SeatSuspension-fmi3.ssp"}
"""Flavour to the file that describes the system of its FMUs."""

_CONNECTIONS = {
    "seat.floor_displacement": "shaker.floor_displacement",
    "seat.floor_velocity": "shaker.floor_velocity",
    "seat.floor_acceleration": "shaker.floor_acceleration",
    "seat.force": "controller.force",
    "controller.seat_acceleration": "seat.seat_acceleration_measured",
    "controller.suspension_deflection": "seat.suspension_deflection_measured",
}


@dataclass(frozen=True)
class Scenario:
    """An excitation and how long to look at it.

    Attributes
    ----------
    description
        One line for the help.
    parameters
        What makes the shaker do it.
    stop_time
        In s.
    """

    description: str
    parameters: Mapping[str, Value]
    stop_time: float


SCENARIOS: dict[str, Scenario] = {
    "bump": Scenario("the paper's bump (34), met at t = 0", {"shaker.profile": "bump"}, 3.0),
    "sine": Scenario("a sine of the floor, 3 Hz and 6 mm by default", {"shaker.profile": "sine"}, 5.0),
    "sweep": Scenario("a logarithmic sweep, 0.5 to 20 Hz at 1 m/s2 by default", {"shaker.profile": "sweep"}, 60.0),
    "random": Scenario("random motion of an ISO 7096 class, EM1 by default", {"shaker.profile": "random"}, 60.0),
    "file": Scenario("a recording, the FMU's example by default", {"shaker.profile": "file"}, 10.0),
}


OVERVIEW = {
    "Displacement": ["shaker.floor_displacement", "seat.suspension_deflection"],
    "Acceleration": ["shaker.floor_acceleration", "seat.seat_acceleration", "seat.driver_acceleration"],
    "Force": ["controller.force", "controller.disturbance_estimate", "seat.friction_force"],
}
"""What a figure of one run shows: a panel's quantity, and its signals of one unit."""


def seat_suspension(folder: Path) -> System:
    """Wire shaker, seat and controller.

    The order is controller, seat, shaker: no delay from sample to force, and the seat meets the floor of the step's
    begin. (A shaker that steps before the seat would feed it the floor of the step's end.)

    Parameters
    ----------
    folder
        Where the three FMUs lie.

    Raises
    ------
    SetupError
        If one of them does not.
    """
    missing = [fmu for fmu in _FMUS.values() if not (folder / f"{fmu}.fmu").is_file()]
    if missing:
        raise SetupError(
            f"{folder}: expected {', '.join(f'{fmu}.fmu' for fmu in missing)}, got no such file; run: seat-cosim build"
        )
    system = System()
    system.name = "SeatSuspension"
    for name, fmu in _FMUS.items():
        system.add(name, folder / f"{fmu}.fmu")
    for sink, source in _CONNECTIONS.items():
        system.connect(source, sink)
    system.order = ("controller", "seat", "shaker")
    return system


def driver_mass(kilograms: float) -> dict[str, Value]:
    """Seat a driver, and tell the controller."""
    return {"seat.driver_mass": kilograms, "controller.driver_mass": kilograms}


def observer(gamma: float) -> dict[str, Value]:
    """Choose the observer by its constant Gamma, in s/kg2, whatever gains it had."""
    return {"controller.observer_gamma": gamma, "controller.L1": 0.0, "controller.L2": 0.0}


def control(on: bool) -> dict[str, Value]:
    """Switch the controller on or off."""
    return {"controller.enabled": on}
