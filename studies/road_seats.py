"""Four seats in the truck: the table of docs/explanation/truck.md.

python -m studies.road_seats                    five roads at 60 km/h and class C at 30 and 90 km/h: two minutes of CPU
python -m studies.road_seats --classes B60,C60  fewer roads

Three realizations of each road, 60 s after 10 s; end stops at 40 mm each way. The mode robust gets actuator and travel.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from seat_cosim.evaluation.installation import Installation
from seat_cosim.evaluation.protocol import survey
from seat_cosim.evaluation.results import DriverClassResult
from seat_cosim.evaluation.runner import evaluate
from seat_cosim.evaluation.seat import installed, passive_seat, semi_active_seat, truck_signals
from seat_cosim.evaluation.system import EvaluatedSystem
from seat_cosim.scenarios import TRUCK, mode, read_parameter_sets, seat_block, seat_suspension
from studies.robust_table import print_table
from studies.tune_baselines import ROOT

CLASSES = "A60,B60,C30,C60,C90,D60,E60"
MASSES = (55.0, 100.0)
"""Drivers in kg."""


def seats(fmus: Path) -> list[EvaluatedSystem]:
    """Return the four seats in one installation.

    Parameters
    ----------
    fmus
        Folder of the FMUs.
    """
    installation = Installation()
    found = []
    for name in ("published", "robust"):
        system = seat_suspension(fmus, TRUCK)
        parameters = installed(system, installation)
        system.parameters |= mode(name, parameters) | parameters
        found.append(EvaluatedSystem(f"active, {name}", system, truck_signals(), installation.travel))
    reference = seat_suspension(fmus, TRUCK)
    fixture = installed(reference, installation)
    block = semi_active_seat(seat_block(fmus, "SemiActiveSeat", TRUCK), fixture, TRUCK)
    passive = read_parameter_sets(["passive"], reference)
    return [*found, block, passive_seat(reference, passive, fixture, signals=truck_signals())]


def numbers(result: DriverClassResult) -> str:
    """Return SEAT by a_w and by VDV, largest deflection in mm and end-stop hits of a minute, as a cell."""
    minutes = len(result.rides)
    hits = 0 if result.end_stop_hits is None else result.end_stop_hits / minutes
    return f"{result.seat:.2f} / {result.seat_vdv:.2f} / {1e3 * (result.peak_deflection or 0.0):.0f} / {hits:.0f}"


def main() -> None:
    """Ride all roads with all seats and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--classes", default=CLASSES, help="roads at speeds in km/h, with commas between")
    parser.add_argument("--processes", type=int, default=1, help="number of processes")
    arguments = parser.parse_args()
    protocol = survey(classes=tuple(arguments.classes.split(",")), masses=MASSES, duration=60.0)

    def progress(done: int, of: int) -> None:
        print(f"{done} of {of}", end="\r", file=sys.stderr, flush=True)

    evaluations = evaluate(seats(ROOT / "fmus" / "fmi2"), protocol, arguments.processes, progress)
    heads = ("floor a_w, m/s²", *(each.evaluated.title for each in evaluations))
    rows = {}
    for name in protocol.classes:
        for mass in protocol.masses:
            results = [each.results[name, mass] for each in evaluations]
            rows[f"{name}, {mass:g} kg"] = [f"{results[-1].a_w / results[-1].seat:.2f}", *map(numbers, results)]
    print("SEAT by a_w / SEAT by VDV / largest deflection in mm / end-stop hits a minute")
    print_table(heads, rows)


if __name__ == "__main__":
    main()
