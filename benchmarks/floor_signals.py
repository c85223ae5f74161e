"""What a floor that gives one signal costs in accuracy: ``python -m benchmarks.floor_signals [FMUS]``.

Prints the tables of docs/explanation/floor.md at 2 ms and 55 kg: first the paper's bump and a sine of 3 Hz against the
implicit solution of tests/helpers/reference.py, then imperfect signals against the run with all three, perfect ones.
FMUS is a folder of built FMUs, ``fmus/fmi2`` by default.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from plant_models.seat.interface import FloorSignals
from tests.helpers.floor_signals import CASES, EXCITATIONS, MOVING, errors, exact, run, sampled
from tests.helpers.rig import Array, Rig


def held(values: Array, samples: int = 5) -> Array:
    """Hold every so many samples: a floor with a longer step of its own."""
    return np.repeat(values[::samples], samples)[: len(values)]


IMPERFECT: dict[str, tuple[FloorSignals, Callable[[Array], Array]]] = {
    "displacement + 10 mm": (FloorSignals.displacement, lambda z: z + 0.01),
    "displacement rounded to 1 µm": (FloorSignals.displacement, lambda z: np.round(z, 6)),
    "displacement rounded to 10 µm": (FloorSignals.displacement, lambda z: np.round(z, 5)),
    "displacement rounded to 0.1 mm": (FloorSignals.displacement, lambda z: np.round(z, 4)),
    "displacement held for 10 ms": (FloorSignals.displacement, held),
    "velocity + 1 mm/s": (FloorSignals.velocity, lambda v: v + 1e-3),
    "velocity rounded to 1 mm/s": (FloorSignals.velocity, lambda v: np.round(v, 3)),
    "velocity held for 10 ms": (FloorSignals.velocity, held),
    "acceleration + 0.01 m/s²": (FloorSignals.acceleration, lambda a: a + 0.01),
    "acceleration + 0.1 m/s²": (FloorSignals.acceleration, lambda a: a + 0.1),
    "acceleration rounded to 0.01 m/s²": (FloorSignals.acceleration, lambda a: np.round(a, 2)),
    "acceleration held for 10 ms": (FloorSignals.acceleration, held),
}
"""What may be wrong with a signal."""


def table(title: str, columns: list[str], rows: dict[str, list[tuple[float, float]]]) -> None:
    """Print errors as a Markdown table, in percent."""

    def percent(error: float) -> str:
        return f"{float(f'{100 * error:.2g}'):g}"

    print(f"| {title} | " + " | ".join(columns) + " |")
    print("|---" * (len(columns) + 1) + "|")
    for name, cells in rows.items():
        print(f"| {name} | " + " | ".join(f"{percent(a)}, {percent(d)}" for a, d in cells) + " |")


def main() -> None:
    """Print both tables."""
    columns = {f"{excitation}, {case}": (excitation, on) for excitation in EXCITATIONS for case, on in CASES.items()}
    solutions = {name: exact(*key) for name, key in columns.items()}
    with Rig(Path(sys.argv[1] if len(sys.argv) > 1 else "fmus/fmi2")) as rig:
        rows = {
            signal.name: [
                errors(run(rig, sampled(excitation), signal, on), solutions[name])
                for name, (excitation, on) in columns.items()
            ]
            for signal in FloorSignals
        }
        for signal in (FloorSignals.displacement, FloorSignals.acceleration):
            moving = [
                errors(run(rig, sampled("sine"), signal, on, MOVING), solutions[f"sine, {case}"])
                for case, on in CASES.items()
            ]
            rows[f"{signal.name}, started with the sine's velocity"] = rows[signal.name][:2] + moving
        table("living signal", list(columns), rows)
        print()
        bump = sampled("bump")
        perfect = [run(rig, bump, FloorSignals.all, on) for on in CASES.values()]
        rows = {}
        for name, (signal, spoil) in IMPERFECT.items():
            spoiled = bump._replace(**{signal.name: spoil(getattr(bump, signal.name))})
            rows[name] = [
                errors(run(rig, spoiled, signal, on), motion)
                for on, motion in zip(CASES.values(), perfect, strict=True)
            ]
        table("imperfect signal", [f"bump, {case}" for case in CASES], rows)


if __name__ == "__main__":
    main()
