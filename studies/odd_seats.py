"""The mode robust on seats that SeatPlant does not model: friction of other shapes, a driver who leaves or sits down.

    python -m studies.odd_seats                  # two to five minutes
    python -m studies.odd_seats --seconds 20     # shorter rides

The kernels run in Python, where the friction force and the driver's mass can be changed while they run. The floor comes
from the Shaker FMU. 5 ms of lag, 0.05 m/s2 of bias, noise, 40 mm of travel, as in ``studies.robust_rides``.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np

from cosim import System
from plant_models.seat import seat
from plant_models.seat.interface import Inputs as SeatInputs
from plant_models.seat.interface import Parameters as SeatParameters
from seat_controller_fmu import controller
from seat_controller_fmu.interface import Inputs, Mode, Parameters
from seat_cosim import fmu
from studies.robust_rides import DEFLECTION, DRIVER, FAULT, FLOOR, FORCE, HARSH, WARM_UP, metrics

STEP = 0.002
GRAVITY = 9.81
SEED = 4
"""Of the floors; no tuning saw it."""

Shape = Callable[[float], float]
"""Factor on the friction force, of the deflection rate in m/s."""

SHAPES: Mapping[str, Shape] = {
    "as modelled": lambda v: 1.0,
    "Stribeck peak, + 30 % below 10 mm/s": lambda v: 1.0 + 0.3 * math.exp(-((v / 0.01) ** 2)),
    "stiction, + 60 % below 2 mm/s": lambda v: 1.0 + 0.6 * math.exp(-((v / 0.002) ** 2)),
    "asymmetric, 120 % up, 80 % down": lambda v: 1.0 + 0.2 * math.tanh(v / 0.001),
}

CELLS = (("EM1", 80.0), ("EM3", 55.0), ("EM4", 45.0), ("EM6", 45.0), ("EM6", 100.0))
"""Class of the floor and mass of the driver in kg."""


@contextmanager
def friction_of(shape: Shape) -> Iterator[None]:
    """Let the seat's kernel have a friction of another shape."""
    original = seat._seat_acceleration

    def shaped(x: float, v: float, cushion: float, rate: float, z_d: float, force: float, c: Any) -> float:
        return original(x, v, cushion, rate, z_d * shape(v), force, c)

    seat._seat_acceleration = shaped
    try:
        yield
    finally:
        seat._seat_acceleration = original


def floor(kind: str, seconds: float) -> list[SeatInputs]:
    """Return the motion of a class of ISO 7096 at the communication points."""
    system = System()
    system.add("shaker", fmu("Shaker"))
    found = system.simulate(
        seconds, STEP, {"shaker.profile": "random", "shaker.random.class": kind, "shaker.random.seed": SEED}
    )
    names = ("floor_displacement", "floor_velocity", "floor_acceleration")
    rows = zip(*(found[f"shaker.{name}"].tolist() for name in names), strict=True)
    return [SeatInputs(**dict(zip(names, row, strict=True))) for row in rows]


def seat_parameters(mass: float) -> SeatParameters:
    """Return the parameters of a real seat."""
    given = {name.partition(".")[2].replace(".", "_"): value for name, value in HARSH.parameters().items()}
    given = {name: value for name, value in given.items() if name in SeatParameters.__dataclass_fields__}
    return SeatParameters(driver_mass=mass, **given)


def ride(
    floors: list[SeatInputs], mass: float, is_robust: bool = True, masses: Mapping[int, float] | None = None
) -> dict[str, np.ndarray[Any, Any]]:
    """Ride a floor.

    Parameters
    ----------
    floors
        Its motion.
    mass
        Mass of the driver in kg; the controller has its default.
    is_robust
        Whether the mode robust runs; otherwise the actuator gives no force.
    masses
        Step to the mass of the driver from then on; the spring keeps its preload.
    """
    law = controller.prepare(
        Parameters(mode=Mode.robust, enabled=is_robust, actuator_time_constant=HARSH.lag, travel=HARSH.travel)
    )
    plant = seat.prepare(seat_parameters(mass))
    state, out = seat.initialize(floors[0], plant, 0.0)
    memory, demand = controller.initialize(Inputs(), law, 0.0)
    rows, extra = [], 0.0
    for k, motion in enumerate(floors[:-1]):
        if masses and k in masses:
            plant = seat.prepare(seat_parameters(masses[k]))
            extra = (mass - masses[k]) * GRAVITY  # the preload that nobody balances
        measured = Inputs(out.seat_acceleration_measured, out.suspension_deflection_measured)
        memory, demand = controller.advance(memory, measured, law, k * STEP, STEP)
        rows.append(
            (out.driver_acceleration, motion.floor_acceleration, out.suspension_deflection, demand.force, demand.fault)
        )
        motion.force = demand.force + extra
        state, out = seat.advance(state, motion, plant, k * STEP, STEP)
    return dict(zip((DRIVER, FLOOR, DEFLECTION, FORCE, FAULT), np.array(rows).T, strict=True))


def shapes(seconds: float) -> None:
    """Print SEAT, contacts and fault for each shape of friction."""
    print(f"{'friction':38}" + "".join(f"{f'{kind}, {mass:g} kg':>16}" for kind, mass in CELLS))
    for name, shape in SHAPES.items():
        line = f"{name:38}"
        for kind, mass in CELLS:
            with friction_of(shape):
                found = metrics(ride(floor(kind, WARM_UP + seconds), mass), HARSH.travel)
            line += f"{found.seat:8.2f} / {found.hits:d} / {found.fault:d}"
        print(line, flush=True)


def events(seconds: float) -> None:
    """Print what happens when a driver of 80 kg leaves, and sits down again."""
    half = round(0.5 * seconds / STEP)
    for name, masses in {"leaves": {half: 1.0}, "leaves, sits down": {half: 1.0, half + 1500: 80.0}}.items():
        found = ride(floor("EM3", seconds), 80.0, masses=masses)
        after = {key: values[half:] for key, values in found.items()}
        force, deflection = np.abs(after[FORCE]), 1e3 * after[DEFLECTION]
        print(
            f"{name}: force up to {force.max():.0f} N, {force[-500:].mean():.0f} N in the last second; deflection "
            f"{deflection.min():.0f} to {deflection.max():.0f} mm; fault {int(after[FAULT][-1])}"
        )


def main() -> None:
    """Print both."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60.0, help="of each ride")
    seconds = parser.parse_args().seconds
    shapes(seconds)
    events(seconds)


if __name__ == "__main__":
    main()
