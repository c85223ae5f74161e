"""Fig. 11 and 12: the bump of the experiments, with the passive seat and the prototype as calibrated."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from cosim.metrics import peak
from cosim.results.result import Result
from seat_cosim.paper.bump_test import Case
from seat_cosim.paper.finding import Finding, Kind, Row, text
from seat_cosim.paper.fitting_sets import extremes, read
from seat_cosim.paper.published import BUMP_PEAKS
from seat_cosim.paper.runner import SEAT_MEASURED, ExperimentRunner, change
from seat_cosim.plotting import Curve, Panel
from seat_cosim.scenarios import SCENARIOS

_KEYS = dict(zip(BUMP_PEAKS, ("fig11", "fig12"), strict=True))
_REMARKS = {
    "passive": "The bump of the experiment is not described; (34) of the simulation is taken.",
    "controlled": "The force stops at its limit while the floor falls, and the lag that was fitted lets the jump of "
    "the friction through.",
    "ideal": "Beside the paper's prototype: one without lag, delay and filters.",
}


def rig_bumps(runner: ExperimentRunner) -> Iterator[Finding]:
    """Make Fig. 11 and 12: the bump with either load.

    Parameters
    ----------
    runner
        Runs the seat suspension.
    """
    bump, seats = SCENARIOS["bump"], runner.seats()
    del seats["uncontrolled"]  # the paper does not show it
    for mass, key in _KEYS.items():
        results = {
            name: runner.run(bump.stop_time, bump.parameters, seat.parameters, mass=mass)
            for name, seat in seats.items()
        }
        yield Finding(
            key,
            f"The bump (34) of the simulation, {mass:g} kg strapped to the seats as calibrated on the 55 kg random "
            "ride; nothing is fitted here. The acceleration is that of the seat's sensor, as in the paper.",
            [*_rows(seats, mass, results)],
            [_panel(seats, results)],
        )


def _rows(seats: Mapping[str, Case], mass: float, results: Mapping[str, Result]) -> Iterator[Row]:
    paper = BUMP_PEAKS[mass]
    peaks = {name: peak(result[SEAT_MEASURED]) for name, result in results.items()}
    for name, value in peaks.items():
        printed = paper["controlled" if name == "ideal" else name]
        yield Row(f"{seats[name].title}, peak", "m/s²", f"{printed:.2f}", (value,), Kind.PREDICTED, _REMARKS[name])
    yield Row(
        "Controlled against passive",
        "%",
        text(change(paper["controlled"], paper["passive"]), 1),
        (change(peaks["controlled"], peaks["passive"]),),
        Kind.PREDICTED,
        "Less than in the paper, and more with the heavier load, as in the paper.",
        1,
    )
    for name in ("passive", "controlled"):
        values = read()[f"bump_{name}_{mass:g}"]
        yield Row(
            f"{seats[name].title}, peak, {len(values)} sets that fit at 55 kg",
            "m/s²",
            f"{paper[name]:.2f}",
            extremes(values),
            Kind.PREDICTED,
            f"Least to most. Median {np.median(values):.2f}; the bump is (34) in all of them.",
        )


def _panel(seats: Mapping[str, Case], results: Mapping[str, Result]) -> Panel:
    curves = [Curve(seats[name].title, result[SEAT_MEASURED], seats[name].style) for name, result in results.items()]
    return Panel("Seat acceleration\n(m/s²)", results["passive"].time, curves, {})
