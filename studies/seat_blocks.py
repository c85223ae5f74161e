"""The three blocks of one seat: tuning of the semi-active one, and the table of docs/explanation/seat-blocks.md.

python -m studies.seat_blocks --tune   searches damper.skyhook and damper.velocity_corner (minutes)
python -m studies.seat_blocks          prints the table of the blocks as they are, on seeds that the search did not use

All runs use the FMUs and the master at 2 ms: the shaker's classes of ISO 7096, end stops 40 mm each way. The search
minimises the mean over rides of the larger of SEAT and SEAT by VDV, by the simplex method of Nelder and Mead over
logarithms; it is deterministic. In its rides the accelerometer has a bias of 50 mm/s2 (5 mg), without which the best
integrator would be one without a leak. The range of the damper and its lag are given, not searched: the best least
damping would be none.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.optimize import minimize

from cosim import System
from cosim.engine.session import Session
from cosim.fmi.values import Value
from seat_cosim.evaluation.installation import Installation
from seat_cosim.evaluation.protocol import CLASSES
from seat_cosim.evaluation.results import RideResult
from seat_cosim.evaluation.runner import measure
from seat_cosim.evaluation.seat import seat_signals
from seat_cosim.evaluation.system import EvaluatedSystem
from seat_cosim.scenarios import read_parameter_sets, seat_suspension

ROOT = Path(__file__).parent.parent

TRAINING_SEEDS, TEST_SEEDS = (11,), (1, 2, 3)
"""Seeds of the excitation in the search, and in the table."""

MASSES = (55.0, 100.0)
"""Drivers, in kg."""

DURATION, WARM_UP = 60.0, 10.0
"""Evaluated time of a ride, and time before it, in s."""

BIAS = 0.05
"""Bias of the accelerometer in the search, in m/s2."""

SEARCHED = {"damper.skyhook": 1000.0, "damper.velocity_corner": 0.2}
"""Parameter of SemiActiveSeat to where its search begins."""

ROBUST: dict[str, Value] = {"seat.controller.mode": "robust"}

SEATS: dict[str, tuple[str, dict[str, Value], bool]] = {
    "passive": ("PassiveSeat", {}, False),
    "semi-active": ("SemiActiveSeat", {}, False),
    "active, published": ("ActiveSeat", {}, False),
    "active, robust": ("ActiveSeat", ROBUST, False),
    "active, robust, prototype": ("ActiveSeat", ROBUST, True),
}
"""Row of the table to its FMU, its parameters, and whether it has the imperfections of the parameter set prototype."""


def imperfections(folder: Path) -> dict[str, Value]:
    """Return the parameter set ``prototype``, for a block.

    Parameters
    ----------
    folder
        Folder of the FMUs.
    """
    return {
        f"seat.{name}": value for name, value in read_parameter_sets(["prototype"], seat_suspension(folder)).items()
    }


def on_shaker(folder: Path, model: str) -> EvaluatedSystem:
    """Return a block on the shaker as an evaluated system, with the end stops of a test.

    Parameters
    ----------
    folder
        Folder of the FMUs.
    model
        Name of the block.
    """
    system = System()
    system.add("shaker", folder / "Shaker.fmu")
    system.add("seat", folder / f"{model}.fmu")
    for signal in ("floor_displacement", "floor_velocity", "floor_acceleration"):
        system.connect(f"shaker.{signal}", f"seat.{signal}")
    system.order = ("seat", "shaker")
    stops = Installation()
    system.parameters |= {
        "seat.seat.end_stop.travel": stops.travel or 0.0,
        "seat.seat.end_stop.stiffness": stops.stiffness,
        "seat.seat.end_stop.damping": stops.damping,
    }
    signals = replace(
        seat_signals(),
        driver_mass=("seat.seat.driver_mass",),
        actuator_force="seat.force",
        end_stop_travel="seat.seat.end_stop.travel",
        end_stop_height="seat.seat.end_stop.height",
        force_limit=None,
        noise_seed=None,
    )
    return EvaluatedSystem(model, system, signals)


def ride(
    seat: EvaluatedSystem, session: Session, name: str, mass: float, seed: int, parameters: Mapping[str, Value]
) -> RideResult:
    """Ride once.

    Parameters
    ----------
    seat
        From :func:`on_shaker`.
    session
        Session of its system.
    name
        Class of the excitation.
    mass
        The driver's, in kg.
    seed
        Of the excitation.
    parameters
        ``component.variable`` to value.
    """
    given = {**seat.system.parameters, **seat.signals.parameters(name, mass, seed), **parameters}
    result = session.run(DURATION + WARM_UP, parameters=given, record=list(seat.signals.outputs))
    if result.error is not None:
        raise result.error
    return measure(seat, result, 500.0, WARM_UP)


def cost(seat: EvaluatedSystem, session: Session, parameters: Mapping[str, Value]) -> float:
    """Return the mean over the rides of the search of the larger of SEAT and SEAT by VDV.

    Parameters
    ----------
    seat, session
        As of :func:`ride`.
    parameters
        ``component.variable`` to value.
    """
    rides = [
        ride(seat, session, name, mass, seed, {"seat.seat.sensor.acceleration_bias": BIAS, **parameters})
        for name in CLASSES
        for mass in MASSES
        for seed in TRAINING_SEEDS
    ]
    return float(np.mean([max(each.seat_rms, each.seat_vdv) for each in rides]))


def tune(folder: Path) -> None:
    """Search the numbers of the semi-active seat and print them.

    Parameters
    ----------
    folder
        Folder of the FMUs.
    """
    seat = on_shaker(folder, "SemiActiveSeat")
    names, start = list(SEARCHED), np.log(list(SEARCHED.values()))

    def numbers(x: np.ndarray) -> dict[str, Value]:
        return {f"seat.{name}": float(f"{math.exp(value):.3g}") for name, value in zip(names, x, strict=True)}

    with seat.system.open() as session:

        def rated(x: np.ndarray) -> float:
            found = cost(seat, session, numbers(x))
            print(f"{found:.4f} {numbers(x)}", flush=True)
            return found

        simplex = np.vstack([start, start + 0.5 * np.eye(len(names))])
        options = {"initial_simplex": simplex, "xatol": 0.03, "fatol": 5e-4, "maxfev": 90}
        found = minimize(rated, start, method="Nelder-Mead", options=options)
    print(f"found: {found.fun:.4f} {numbers(found.x)}")


def table(folder: Path) -> None:
    """Print SEAT / SEAT by VDV / contacts with the stops in a minute of each seat, in Markdown.

    Parameters
    ----------
    folder
        Folder of the FMUs.
    """
    for mass in MASSES:
        print(f"\n| {mass:g} kg | {' | '.join(CLASSES)} |\n|---|{'---:|' * len(CLASSES)}")
        for row, (model, parameters, is_imperfect) in SEATS.items():
            seat = on_shaker(folder, model)
            parameters = {**parameters, **(imperfections(folder) if is_imperfect else {})}
            with seat.system.open() as session:
                cells = []
                for name in CLASSES:
                    rides = [ride(seat, session, name, mass, seed, parameters) for seed in TEST_SEEDS]
                    means = [np.mean([each.seat_rms for each in rides]), np.mean([each.seat_vdv for each in rides])]
                    contacts = np.mean([each.end_stop_hits or 0 for each in rides])
                    cells.append(f"{means[0]:.2f} / {means[1]:.2f} / {contacts:.0f}")
            print(f"| {row} | {' | '.join(cells)} |", flush=True)


def main() -> None:
    """Search, or print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tune", action="store_true", help="search the numbers of the semi-active seat")
    parser.add_argument("--fmus", type=Path, default=ROOT / "fmus" / "fmi2", help="folder of the FMUs")
    arguments = parser.parse_args()
    (tune if arguments.tune else table)(arguments.fmus)


if __name__ == "__main__":
    main()
