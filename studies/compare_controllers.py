"""Evaluation of all controllers of this project, side by side: tables and figure of docs/explanation/evaluation.md.

python -m studies.compare_controllers                 some ten minutes on two cores; figure into docs/figures
python -m studies.compare_controllers --output DIR
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from pathlib import Path

import numpy as np

from seat_controller_fmu.parameters import OBSERVERS
from seat_cosim.evaluation.protocol import Protocol
from seat_cosim.evaluation.results import DriverClassResult, Evaluation
from seat_cosim.evaluation.runner import evaluate, measure
from seat_cosim.evaluation.seat import passive_seat, seat_signals
from seat_cosim.evaluation.system import EvaluatedSystem
from seat_cosim.heat_map import HeatMap, draw_heat_maps
from seat_cosim.scenarios import control, gains, observer, read_parameter_sets, seat_suspension
from studies.tune_baselines import BASELINES, DELAY, ROOT, build

MASS, CLASS = 80.0, "EM3"
"""Driver's mass in kg, and class, of the tables over classes, drivers and delays."""
DELAYS = (0.0, 0.005, 0.010, 0.015, 0.020, 0.030, 0.040)
"""Delays of the actuator, in s."""


def systems(folder: Path) -> list[EvaluatedSystem]:
    """Return the seats: passive, uncontrolled, with the paper's controller three times, and with the baselines.

    Parameters
    ----------
    folder
        Folder of the baselines' FMUs.
    """
    ours = {
        "uncontrolled": control(False),
        **{f"Observer {number}": observer(gamma.value) for number, gamma in OBSERVERS.items()},
        "recommended": gains("recommended"),
    }
    reference = seat_suspension(ROOT / "fmus" / "fmi2")
    found = [passive_seat(reference, read_parameter_sets(["passive"], reference))]
    for title, parameters in ours.items():
        system = seat_suspension(ROOT / "fmus" / "fmi2")
        system.parameters |= parameters
        found.append(EvaluatedSystem(title, system, seat_signals()))
    for title in BASELINES:
        system = seat_suspension(ROOT / "fmus" / "fmi2")
        system.replace("controller", folder / f"{title}.fmu")
        found.append(EvaluatedSystem(title, system, seat_signals()))
    return found


def delayed(evaluated: EvaluatedSystem) -> EvaluatedSystem:
    """Return a copy of a seat whose actuator has a delay of :data:`studies.tune_baselines.DELAY`."""
    system = copy(evaluated.system)
    system.parameters = {**evaluated.system.parameters, "seat.actuator.delay": DELAY}
    return replace(evaluated, system=system)


def table(heads: Sequence[str], rows: Mapping[str, Sequence[str]]) -> None:
    """Print a table in Markdown.

    Parameters
    ----------
    heads
        Names of the columns.
    rows
        Name of a row to its cells.
    """
    print(f"\n| | {' | '.join(heads)} |\n|---|{'---:|' * len(heads)}")
    for name, cells in rows.items():
        print(f"| {name} | {' | '.join(cells)} |")


def details(result: DriverClassResult) -> list[str]:
    """Return all metrics of a result as cells of a table."""
    force, power = result.mean(lambda ride: ride.force_rms), result.mean(lambda ride: ride.driving_power)
    numbers = (result.seat, result.mean(lambda ride: ride.seat_vdv), result.a_w, result.mean(lambda r: r.seat.mtvv))
    lengths = f"{1e3 * (result.peak_deflection or 0.0):.0f}"
    return [*(f"{number:.2f}" for number in numbers if number is not None), lengths] + (
        ["–", "–"] if force is None or power is None else [f"{force:.0f}", f"{power:.1f}"]
    )


def main() -> None:
    """Evaluate all seats, print the tables and draw the figure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=ROOT / "docs" / "figures", help="where the figure goes")
    folder = parser.parse_args().output
    protocol, processes = Protocol(seeds=(1, 2, 3)), os.cpu_count() or 1

    def progress(done: int, of: int) -> None:
        print(f"{done} of {of}", end="\r", file=sys.stderr, flush=True)

    with tempfile.TemporaryDirectory() as built:
        build(Path(built))
        seats = systems(Path(built))
        found = evaluate(seats, replace(protocol, masses=(MASS,)), processes, progress)
        by_delay = {seat.title: with_delay(seat) for seat in seats}
        late = evaluate([delayed(seat) for seat in seats], replace(protocol, classes=(CLASS,)), processes, progress)
    names = [seat.title for seat in seats]
    of_class = np.array([[each.results[kind, MASS].seat for kind in protocol.classes] for each in found])
    of_mass = np.array([[each.results[CLASS, mass].seat for mass in protocol.masses] for each in late])
    masses = [f"{mass:g} kg" for mass in protocol.masses]
    table(protocol.classes, dict(zip(names, _written(of_class), strict=True)))
    table(masses, dict(zip(names, _written(of_mass), strict=True)))
    table([f"{1e3 * delay:g} ms" for delay in DELAYS], by_delay)
    heads = ["SEAT", "SEAT by VDV", "a_w, m/s²", "MTVV, m/s²", "deflection, mm", "force RMS, N", "power, W"]
    table(heads, {each.evaluated.title: details(each.results[CLASS, MASS]) for each in found})
    scattered = [f"{each.evaluated.title} {key}" for each in found + late for key in _not_repeatable(each)]
    print(f"\nruns more than 5 % from their mean: {', '.join(scattered) or 'none'}")
    delay = f"SEAT on {CLASS}, actuator {1e3 * DELAY:g} ms late"
    maps = [
        HeatMap(f"SEAT at {MASS:g} kg", names, protocol.classes, of_class, np.zeros_like(of_class, dtype=bool)),
        HeatMap(delay, names, masses, of_mass, np.zeros_like(of_mass, dtype=bool)),
    ]
    draw_heat_maps([folder / "controllers.svg"], maps)


def with_delay(evaluated: EvaluatedSystem) -> list[str]:
    """Return the SEAT over :data:`DELAYS`, as cells of a table: one ride of 60 s each."""
    found, signals = [], evaluated.signals
    with evaluated.system.open() as session:
        for delay in DELAYS:
            parameters = {**signals.parameters(CLASS, MASS, 1), "seat.actuator.delay": delay}
            result = session.run(70.0, parameters=parameters, record=list(signals.outputs))
            found.append(f"{measure(evaluated, result, 500.0, 10.0).seat_rms:.2f}")
    return found


def _written(values: np.ndarray) -> list[list[str]]:
    return [[f"{value:.2f}" for value in row] for row in values]


def _not_repeatable(evaluation: Evaluation) -> list[str]:
    return [f"{name} {mass:g} kg" for (name, mass), result in evaluation.results.items() if not result.is_repeatable]


if __name__ == "__main__":
    main()
