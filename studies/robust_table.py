"""Tables of docs/explanation/robust.md: the mode robust beside the other controllers, on seeds that no tuning saw.

python -m studies.robust_table                   four classes, two drivers, 60 s: some minutes
python -m studies.robust_table --full            nine classes, six drivers, 200 s
python -m studies.robust_table --no-baselines    without the skyhook and LQG scripts, which are slow Python FMUs
python -m studies.robust_table --output DIR      where robust.csv with all metrics goes

All rides use the FMUs and the master. Each cell is SEAT / SEAT by VDV / contacts with the end stops. The mode robust
assumes 75 kg, whoever sits there; the others get the driver's mass.
"""

from __future__ import annotations

import argparse
import csv
import sys
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from studies.robust_rides import (
    HARSH,
    Controller,
    RideMetrics,
    RobustRides,
    World,
    controllers,
)
from studies.tune_baselines import BASELINES, ROOT, build
from studies.tune_robust import TRAINING_SEEDS

TEST_SEEDS = (21, 22)
"""Seeds of the excitation; those of the search are others."""

CLASSES = tuple(f"EM{number}" for number in range(1, 10))
MASSES = (45.0, 55.0, 70.0, 80.0, 100.0, 120.0)

LIMITS = {
    "EM1": (0.13, 0.003),
    "EM2": (0.12, 0.004),
    "EM3": (0.04, 0.001),
    "EM4": (0.0, 0.001),
    "EM5": (0.0, 0.001),
    "EM6": (0.0, 0.0),
    "EM7": (0.0, 0.0),
    "EM8": (0.0, 0.0),
    "EM9": (0.0, 0.0),
}
"""SEAT of the best linear law without preview and friction, and with full preview and 250 N, at 40 mm of travel.

Computed once, outside this repository: the former from covariances of a linear-quadratic law that knows the floor's
state, the latter by a convex programme over the recorded floor.
"""

WORLDS = {
    "ideal actuator": World(lag=0.0),
    "5 ms lag": HARSH,
    "10 ms lag, 10 ms delay": World(lag=0.010, delay=0.010),
    "24.8 ms lag, 2 ms delay": World(lag=0.0248, delay=0.002),
    "no bias": World(bias=0.0),
    "bias 0.1 m/s², offset 5 mm": World(bias=0.1, offset=0.005),
    "50 mm travel": World(travel=0.050),
    "friction x 0.5": World(friction=0.5),
    "friction x 1.5": World(friction=1.5),
    "floor x 1.25": World(scale=1.25),
}
"""Variations of the world, of which the second is the reference."""


class Scope(NamedTuple):
    """What is ridden.

    Attributes
    ----------
    classes, masses, seeds
        Of the first table.
    duration
        Of a ride, warm-up included, in s.
    cells
        Class and driver of the second table.
    """

    classes: tuple[str, ...]
    masses: tuple[float, ...]
    seeds: tuple[int, ...]
    duration: float
    cells: tuple[tuple[str, float], ...]


REDUCED = Scope(
    ("EM1", "EM3", "EM4", "EM6"), (55.0, 100.0), TEST_SEEDS[:1], 60.0, (("EM2", 100.0), ("EM3", 55.0), ("EM6", 45.0))
)
FULL = Scope(
    CLASSES, MASSES, TEST_SEEDS, 200.0, (("EM1", 55.0), ("EM2", 100.0), ("EM3", 55.0), ("EM4", 45.0), ("EM6", 45.0))
)


class Row(NamedTuple):
    """A ride: who, in which world, over what, and its metrics."""

    controller: str
    world: str
    name: str
    mass: float
    seed: int
    found: RideMetrics


def with_baselines(known: dict[str, Controller], folder: Path) -> dict[str, Controller]:
    """Add the tuned baselines, built into a folder; without the PID controller."""
    build(folder)
    others = {name: Controller({}, fmu=folder / f"{name}.fmu") for name in BASELINES if name != "Pid"}
    return {**known, **others}


def rides(known: dict[str, Controller], scope: Scope, fmus: Path) -> Iterator[Row]:
    """Ride all tables.

    Parameters
    ----------
    known
        Controllers by name.
    scope
        What is ridden.
    fmus
        Folder of the FMUs.
    """
    for controller, definition in known.items():
        with RobustRides(fmus, definition) as session:
            for name in scope.classes:
                for mass in scope.masses:
                    for seed in scope.seeds:
                        found = session.random(name, seed, HARSH, mass, scope.duration)
                        yield Row(controller, "5 ms lag", name, mass, seed, found)
            for world, definition_of_world in WORLDS.items():
                for name, mass in scope.cells:
                    if definition_of_world != HARSH or (name, mass) not in _pairs(scope):
                        seed = scope.seeds[0]
                        found = session.random(name, seed, definition_of_world, mass, scope.duration)
                        yield Row(controller, world, name, mass, seed, found)


def _pairs(scope: Scope) -> set[tuple[str, float]]:
    return {(name, mass) for name in scope.classes for mass in scope.masses}


def bumps(known: dict[str, Controller], scope: Scope, fmus: Path) -> dict[str, list[str]]:
    """Ride the paper's bump; returns the driver's peak acceleration with and without end stops, as cells.

    Parameters
    ----------
    known, scope, fmus
        As of :func:`rides`.
    """
    cells: dict[str, list[str]] = {}
    for controller, definition in known.items():
        with RobustRides(fmus, definition) as session:
            for mass in scope.masses:
                peaks = [session.bump(World(travel=travel), mass) for travel in (0.0, 0.040)]
                cells.setdefault(controller, []).append(" / ".join(f"{each:.1f}" for each in peaks))
    return cells


def cell(found: Iterable[RideMetrics]) -> str:
    """Return the mean SEAT, the mean SEAT by VDV and all contacts of some rides as a cell."""
    rides = list(found)
    seat = sum(each.seat for each in rides) / len(rides)
    vdv = sum(each.seat_vdv for each in rides) / len(rides)
    return f"{seat:.2f} / {vdv:.2f} / {sum(each.hits for each in rides)}"


def print_table(heads: Iterable[str], rows: dict[str, list[str]]) -> None:
    """Print a table in Markdown."""
    columns = list(heads)
    print(f"\n| | {' | '.join(columns)} |\n|---|{'---:|' * len(columns)}")
    for name, cells in rows.items():
        print(f"| {name} | {' | '.join(cells)} |")


def print_tables(rows: list[Row], scope: Scope) -> None:
    """Print the tables over classes and over worlds, and a summary of the mode robust."""
    names = list(dict.fromkeys(row.controller for row in rows))

    def of(controller: str, world: str, name: str, mass: float) -> list[RideMetrics]:
        key = (controller, world, name, mass)
        return [row.found for row in rows if (row.controller, row.world, row.name, row.mass) == key]

    for mass in scope.masses:
        print(f"\n{mass:g} kg, 5 ms lag, 40 mm, bias 0.05 m/s2, noise")
        table = {name: [cell(of(name, "5 ms lag", kind, mass)) for kind in scope.classes] for name in names}
        table["best linear law, no friction"] = [f"{LIMITS[kind][0]:.2f}" for kind in scope.classes]
        table["full preview, 250 N"] = [f"{LIMITS[kind][1]:.3f}" for kind in scope.classes]
        print_table(scope.classes, table)
    for kind, mass in scope.cells:
        print(f"\n{kind}, {mass:g} kg")
        print_table(WORLDS, {name: [cell(of(name, world, kind, mass)) for world in WORLDS] for name in names})
    for name in names:
        if name.startswith("robust"):
            _print_summary(name, rows, scope)


def _print_summary(name: str, rows: list[Row], scope: Scope) -> None:
    """Print the worst of the mode robust, and where the passive seat's VDV is lower."""
    own = [row for row in rows if row.controller == name and row.world == "5 ms lag"]
    worst = max(own, key=lambda row: row.found.seat)
    passive = {
        (row.world, row.name, row.mass, row.seed): row.found.seat_vdv for row in rows if row.controller == "passive"
    }
    all_own = [row for row in rows if row.controller == name]
    beaten = [row for row in all_own if row.found.seat_vdv > passive[row.world, row.name, row.mass, row.seed]]
    at = ", ".join(f"{row.world} {row.name} {row.mass:g} kg" for row in beaten) or "none"
    biased = max(abs(row.found.mean) for row in all_own if row.world.startswith("bias"))
    faults = sum(row.found.fault != 1 for row in all_own)
    print(f"\n{name}: worst SEAT {worst.found.seat:.3f} ({worst.name}, {worst.mass:g} kg)")
    print(f"{name}: largest mean deflection with bias and offset {1e3 * biased:.1f} mm, {faults} faults")
    print(f"{name}: SEAT by VDV above the passive seat's: {at}")


def write_csv(rows: Iterable[Row], path: Path) -> None:
    """Write all rides with all metrics."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([*Row._fields[:-1], *RideMetrics._fields])
        writer.writerows([*row[:-1], *row.found] for row in rows)


def main() -> None:
    """Ride and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--full", action="store_true", help="all classes, drivers and seeds")
    parser.add_argument("--no-baselines", action="store_true", help="without the skyhook and LQG scripts")
    parser.add_argument("--output", type=Path, default=ROOT / "results" / "robust", help="folder of robust.csv")
    arguments = parser.parse_args()
    if set(TEST_SEEDS) & set(TRAINING_SEEDS):
        raise SystemExit("expected seeds that no tuning saw")
    scope, fmus = FULL if arguments.full else REDUCED, ROOT / "fmus" / "fmi2"
    with tempfile.TemporaryDirectory() as folder:
        known = controllers(fmus)
        if not arguments.no_baselines:
            known = with_baselines(known, Path(folder))
        rows = []
        for row in rides(known, scope, fmus):
            rows.append(row)
            print(f"{len(rows)} rides: {row.controller}", end="\r", file=sys.stderr, flush=True)
        bump = bumps(known, scope, fmus)
    write_csv(rows, arguments.output / "robust.csv")
    print_tables(rows, scope)
    print("\nThe paper's bump: peak of the driver's acceleration in m/s2, without end stops / with them at 40 mm")
    print_table([f"{mass:g} kg" for mass in scope.masses], bump)


if __name__ == "__main__":
    main()
