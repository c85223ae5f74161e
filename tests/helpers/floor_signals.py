"""Seat and controller FMUs on one signal of the floor, and the implicit solution with all of it."""

from __future__ import annotations

import numpy as np

from plant_models.seat.interface import FloorSignals
from seat_cosim.scenarios import control
from tests.helpers import reference
from tests.helpers.rig import STEP_SIZE, Floor, Motion, Rig

STEPS = 1000
"""Length of a run: 2 s."""

EXCITATIONS = {"bump": reference.bump(), "sine": reference.sine()}
CASES = {"uncontrolled": False, "Observer 1": True}

MOVING = {"seat.floor_velocity": reference.sine()(0.0)[1]}
"""Start value of an input that is not alive: the sine's velocity at t = 0, in m/s, which no acceleration tells."""


def sampled(excitation: str) -> Floor:
    """Sample an excitation, by its name from :data:`EXCITATIONS`."""
    return Floor(*np.array([EXCITATIONS[excitation](k * STEP_SIZE) for k in range(STEPS)]).T)


def alone(floor: Floor, signal: FloorSignals) -> Floor:
    """Leave one signal of a floor, the others zero."""
    if signal == FloorSignals.all:
        return floor
    dead = np.zeros(len(floor.displacement))
    return Floor(*(values if name == signal.name else dead for name, values in floor._asdict().items()))


def run(
    rig: Rig, floor: Floor, signal: FloorSignals, controlled: bool, start: dict[str, float] | None = None
) -> Motion:
    """Run seat and controller on one signal of a floor, or on all.

    Parameters
    ----------
    rig, floor, signal
        On what.
    controlled
        By Observer 1.
    start
        Start values beside the defaults.
    """
    parameters = {"seat.floor_signals": float(signal), **control(controlled), **(start or {})}
    return rig.run(alone(floor, signal), parameters)


def errors(found: Motion, expected: Motion) -> tuple[float, float]:
    """Compute relative RMS errors of the driver's acceleration and of the deflection."""
    acceleration, deflection = (
        float(np.sqrt(np.mean((a - b) ** 2) / np.mean(b**2))) for a, b in zip(found[:2], expected[:2], strict=True)
    )
    return acceleration, deflection


def exact(excitation: str, controlled: bool) -> Motion:
    """Solve the equations implicitly."""
    solution = reference.solve(reference.Case(enabled=controlled), EXCITATIONS[excitation], STEPS)
    return Motion(solution["driver_acceleration"][:STEPS], solution["suspension_deflection"][:STEPS])
