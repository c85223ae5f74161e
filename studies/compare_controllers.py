"""Evaluate all controllers of this project side by side: tables and figure of docs/explanation/evaluation.md.

python -m studies.compare_controllers                 some ten minutes on two cores; figure into docs/figures
python -m studies.compare_controllers --output DIR
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from cosim.fmi.values import Value
from seat_controller_fmu.design.gains import load
from seat_controller_fmu.parameters import OBSERVERS
from seat_cosim.cli.options import parameter_sets
from seat_cosim.evaluation.evaluation import Cell, Evaluation, Protocol, evaluate, measure
from seat_cosim.evaluation.seat import passive_seat, ports
from seat_cosim.evaluation.system import EvaluatedSystem
from seat_cosim.heat_map import HeatMap, draw_heat_maps
from seat_cosim.scenarios import control, observer, seat_suspension
from studies.tune_baselines import BASELINES, DELAY, ROOT, build

MASS, CLASS = 80.0, "EM3"
DELAYS = (0.0, 0.005, 0.010, 0.015, 0.020, 0.030, 0.040)
"""s"""


def subjects(folder: Path) -> list[EvaluatedSystem]:
    """Name the seats: passive, uncontrolled, the paper's controller three times, and what is in its place."""
    recommended: dict[str, Value] = {f"controller.{k}": v for k, v in load("recommended").parameters().items()}
    ours = {
        "uncontrolled": control(False),
        **{f"Observer {number}": observer(gamma.value) for number, gamma in OBSERVERS.items()},
        "recommended": recommended,
    }
    reference = seat_suspension(ROOT / "fmus" / "fmi2")
    found = [passive_seat(reference, parameter_sets(["passive"], reference))]
    for title, parameters in ours.items():
        system = seat_suspension(ROOT / "fmus" / "fmi2")
        system.parameters |= parameters
        found.append(EvaluatedSystem(title, system, ports()))
    for title in BASELINES:
        system = seat_suspension(ROOT / "fmus" / "fmi2")
        system.replace("controller", folder / f"{title}.fmu")
        found.append(EvaluatedSystem(title, system, ports()))
    return found


def late(subject: EvaluatedSystem) -> EvaluatedSystem:
    """Give a seat an actuator that is late."""
    system = seat_suspension(ROOT / "fmus" / "fmi2")
    system.__dict__.update(vars(subject.system))
    system.parameters = {**subject.system.parameters, "seat.actuator.delay": DELAY}
    return replace(subject, system=system)


def table(heads: Sequence[str], rows: dict[str, Sequence[str]]) -> None:
    """Print a table for a document."""
    print(f"\n| | {' | '.join(heads)} |\n|---|{'---:|' * len(heads)}")
    for name, cells in rows.items():
        print(f"| {name} | {' | '.join(cells)} |")


def details(cell: Cell) -> list[str]:
    """Write what a driver of 80 kg has of EM3."""
    force, power = cell.mean(lambda run: run.force), cell.mean(lambda run: run.power)
    numbers = (cell.seat, cell.mean(lambda run: run.seat_vdv), cell.a_w, cell.mean(lambda run: run.seat.mtvv))
    lengths = f"{1e3 * (cell.peak or 0.0):.0f}"
    return [*(f"{number:.2f}" for number in numbers if number is not None), lengths] + (
        ["–", "–"] if force is None or power is None else [f"{force:.0f}", f"{power:.1f}"]
    )


def main() -> None:
    """Evaluate, print, draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=ROOT / "docs" / "figures", help="where the figure goes")
    folder = parser.parse_args().output
    protocol, processes = Protocol(), os.cpu_count() or 1

    def progress(done: int, of: int) -> None:
        print(f"{done} of {of}", end="\r", file=sys.stderr, flush=True)

    with tempfile.TemporaryDirectory() as built:
        build(Path(built))
        seats = subjects(Path(built))
        found = evaluate(seats, replace(protocol, masses=(MASS,)), processes, progress)
        by_delay = {seat.title: with_delay(seat) for seat in seats}
        delayed = evaluate([late(seat) for seat in seats], replace(protocol, classes=(CLASS,)), processes, progress)
    names = [seat.title for seat in seats]
    of_class = np.array([[each.cells[kind, MASS].seat for kind in protocol.classes] for each in found])
    of_mass = np.array([[each.cells[CLASS, mass].seat for mass in protocol.masses] for each in delayed])
    masses = [f"{mass:g} kg" for mass in protocol.masses]
    table(protocol.classes, dict(zip(names, _written(of_class), strict=True)))
    table(masses, dict(zip(names, _written(of_mass), strict=True)))
    table([f"{1e3 * delay:g} ms" for delay in DELAYS], by_delay)
    heads = ["SEAT", "SEAT by VDV", "a_w, m/s²", "MTVV, m/s²", "deflection, mm", "force RMS, N", "power, W"]
    table(heads, {each.subject.title: details(each.cells[CLASS, MASS]) for each in found})
    loose = [f"{each.subject.title} {key}" for each in found + delayed for key in _loose(each)]
    print(f"\nruns more than 5 % from their mean: {', '.join(loose) or 'none'}")
    delay = f"SEAT on {CLASS}, actuator {1e3 * DELAY:g} ms late"
    maps = [
        HeatMap(f"SEAT at {MASS:g} kg", names, protocol.classes, of_class, np.zeros_like(of_class, dtype=bool)),
        HeatMap(delay, names, masses, of_mass, np.zeros_like(of_mass, dtype=bool)),
    ]
    draw_heat_maps([folder / "controllers.svg"], maps)


def with_delay(subject: EvaluatedSystem) -> list[str]:
    """Write the SEAT of a driver of 80 kg on EM3 over delays of the actuator: one run of a minute each."""
    found = []
    with subject.system.open() as session:
        for delay in DELAYS:
            ride = {**subject.ports.parameters(CLASS, MASS, 1), "seat.actuator.delay": delay}
            result = session.run(70.0, parameters=ride, record=list(subject.ports.signals))
            found.append(f"{measure(subject, result, 500.0, 10.0).seat_rms:.2f}")
    return found


def _written(values: np.ndarray) -> list[list[str]]:
    return [[f"{value:.2f}" for value in row] for row in values]


def _loose(evaluation: Evaluation) -> list[str]:
    return [f"{kind} {mass:g} kg" for (kind, mass), cell in evaluation.cells.items() if not cell.repeats]


if __name__ == "__main__":
    main()
