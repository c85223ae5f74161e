"""Search of the defaults of the mode robust, on training seeds; studies/robust_table.py uses others.

python -m studies.tune_robust                some ten minutes; prints each improvement
python -m studies.tune_robust --steps 20
python -m studies.tune_robust --evaluate     the cost of the defaults, by its parts

A (1+1) evolution strategy with multiplicative steps. The controller assumes 75 kg, whoever sits there. The cost
adds the mean SEAT, half the mean SEAT by VDV and 0.3 of the largest SEAT at scale 1. It adds the VDV over that of the
passive seat at scale 1.25, with a penalty above 0.9, the peak over that of the passive seat on slow sines, the peak of
the paper's bump beyond 1.3 m/s2, and contacts with the stops.

What is not searched follows from the delay margins (observer_rate, follow_max) or from the stability of the centring
(bias_rate): see ``seat-cosim design --mode robust``.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fmus.variables import variables_of
from seat_controller_fmu.interface import Parameters
from studies.robust_rides import HARSH, Controller, RideMetrics, RobustRides, World, controllers
from studies.tune_baselines import ROOT

TRAINING_SEEDS = (11, 12)
"""Seeds of the excitation in the search; no table uses them."""

DURATION = 60.0
"""Of a ride, warm-up included, in s."""

SEARCHED = (
    "robust.follow_begin",
    "robust.follow_slope",
    "robust.envelope_frequency",
    "robust.envelope_decay",
    "robust.overload_begin",
    "robust.overload_end",
    "robust.overload_damping",
    "robust.friction_rate",
    "robust.motion_bandwidth",
    "robust.centring_frequency",
    "robust.centring_filter",
    "robust.centring_damping",
)
"""Parameters of the search."""

RIDES = (
    *((name, mass, TRAINING_SEEDS[0]) for name in ("EM1", "EM2", "EM3", "EM4", "EM6", "EM8") for mass in (45.0, 120.0)),
    *((name, mass, TRAINING_SEEDS[1]) for name in ("EM1", "EM2", "EM3") for mass in (45.0, 100.0)),
)
"""Class, driver in kg and seed at scale 1."""

OVERLOADS = tuple(
    (name, mass, seed) for name in ("EM1", "EM2", "EM3") for mass in (45.0, 100.0) for seed in TRAINING_SEEDS
)
"""The same at scale 1.25."""

SINES = tuple((f, a, m) for f, a in ((0.5, 0.03), (0.5, 0.05), (0.7, 0.05), (1.0, 0.05)) for m in (45.0, 120.0))
"""Frequency in Hz, amplitude in m and driver in kg of slow sines."""

BUMPS = tuple((mass, travel) for mass in (45.0, 55.0, 100.0) for travel in (0.0, 0.040))
"""Driver in kg and travel to the stops in m, 0 for none, of the paper's bump at the start."""

OVERLOAD = World(scale=1.25)

STEP, SMALLEST_STEP, LARGEST_STEP = 0.15, 0.04, 0.3
"""Standard deviation of the logarithm of a step: first, smallest, largest."""

SHARE = 0.35
"""Share of the parameters that a step changes."""


class Cost(NamedTuple):
    """Cost of a set of parameters, by its parts.

    Attributes
    ----------
    seat, largest_seat, seat_vdv
        Mean and largest SEAT, mean SEAT by VDV, at scale 1.
    overload, largest_overload
        Mean and largest VDV over that of the passive seat, at scale 1.25.
    excess
        Sum of what exceeds 0.9 of it.
    sines
        Mean peak over that of the passive seat, on slow sines.
    bump
        Sum of what the peaks of the bump exceed 1.3 m/s2, in m/s2.
    hits
        Contacts with the stops at scale 1.
    """

    seat: float
    largest_seat: float
    seat_vdv: float
    overload: float
    largest_overload: float
    excess: float
    sines: float
    bump: float
    hits: int

    @property
    def total(self) -> float:
        """Weighted sum."""
        isolation = self.seat + 0.5 * self.seat_vdv + 0.3 * self.largest_seat
        limits = 0.08 * self.overload + 0.3 * self.excess + 0.01 * self.sines + 0.1 * self.bump + 0.004 * self.hits
        return isolation + limits


class Rating:
    """Rates parameters of the mode robust; a context manager.

    Parameters
    ----------
    fmus
        Folder of the FMUs.
    """

    def __init__(self, fmus: Path) -> None:
        self._fmus = fmus
        self._stack = ExitStack()

    def __enter__(self) -> Rating:
        known = controllers(self._fmus)
        self._robust = self._stack.enter_context(RobustRides(self._fmus, known["robust, estimator"]))
        with RobustRides(self._fmus, known["passive"]) as passive:
            self._vdv = [passive.random(*_ride(each), DURATION).vdv for each in self._overloads()]
            self._peaks = [passive.sine(f, a, HARSH, mass) for f, a, mass in SINES]
        self._base = self._robust.controller
        return self

    def __exit__(self, *exception: object) -> None:
        self._stack.close()

    @staticmethod
    def _overloads() -> Iterator[tuple[str, float, int, World]]:
        yield from ((*each, OVERLOAD) for each in OVERLOADS)

    def cost(self, parameters: Mapping[str, float]) -> Cost:
        """Rate parameters.

        Parameters
        ----------
        parameters
            Name of a parameter of the controller to its value.
        """
        told = {f"controller.{name}": value for name, value in parameters.items()}
        self._robust.controller = Controller({**self._base.parameters, **told}, told=False, is_robust=True)
        rides = [self._random((*each, HARSH)) for each in RIDES]
        over = [self._random(each).vdv for each in self._overloads()]
        ratios = np.array(over) / np.array(self._vdv)
        sines = np.array([self._robust.sine(f, a, HARSH, mass) for f, a, mass in SINES]) / np.array(self._peaks)
        bumps = [self._robust.bump(World(travel=travel), mass) for mass, travel in BUMPS]
        seats = [each.seat for each in rides]
        return Cost(
            seat=float(np.mean(seats)),
            largest_seat=max(seats),
            seat_vdv=float(np.mean([each.seat_vdv for each in rides])),
            overload=float(ratios.mean()),
            largest_overload=float(ratios.max()),
            excess=float(np.maximum(ratios - 0.9, 0.0).sum()),
            sines=float(sines.mean()),
            bump=float(np.maximum(np.array(bumps) - 1.3, 0.0).sum()),
            hits=sum(each.hits for each in rides),
        )

    def _random(self, each: tuple[str, float, int, World]) -> RideMetrics:
        return self._robust.random(*_ride(each), DURATION)


def _ride(each: tuple[str, float, int, World]) -> tuple[str, int, World, float]:
    name, mass, seed, world = each
    return name, seed, world, mass


def defaults() -> dict[str, float]:
    """Return the defaults of the searched parameters."""
    known = {variable.name: variable.start for variable in variables_of(Parameters)}
    return {name: float(known[name] or 0.0) for name in SEARCHED}


def is_legal(parameters: Mapping[str, float]) -> bool:
    """Return whether the centring is stable with a reserve, and the overload damper has a range."""
    known = {variable.name: variable.start for variable in variables_of(Parameters)}
    w_0 = 2.0 * math.pi * parameters["robust.centring_frequency"]
    limit = 2.0 * parameters["robust.centring_damping"] * w_0**3
    ordered = parameters["robust.overload_end"] > 1.05 * parameters["robust.overload_begin"]
    return float(known["robust.bias_rate"] or 0.0) < 0.4 * limit and ordered


def search(rating: Rating, steps: int, seed: int = 1) -> dict[str, float]:
    """Search from the defaults; prints each improvement.

    Parameters
    ----------
    rating
        Rates parameters.
    steps
        Number of steps.
    seed
        Of the steps.

    Returns
    -------
    dict
        Best parameters.
    """
    random = np.random.default_rng(seed)
    best = defaults()
    cost = rating.cost(best)
    print(f"{cost.total:.4f} {cost}", flush=True)
    deviation = STEP
    for step in range(steps):
        changed = {
            name: value * math.exp(deviation * random.normal()) if random.random() < SHARE else value
            for name, value in best.items()
        }
        if not is_legal(changed):
            continue
        found = rating.cost(changed)
        if found.total < cost.total:
            best, cost, deviation = changed, found, min(LARGEST_STEP, 1.3 * deviation)
            print(f"{step}: {cost.total:.4f} { ({name: float(f'{x:.3g}') for name, x in best.items()}) }", flush=True)
        else:
            deviation = max(SMALLEST_STEP, 0.95 * deviation)
    return best


def main() -> None:
    """Search, or rate the defaults."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=200, help="steps of the search")
    parser.add_argument("--seed", type=int, default=1, help="of the steps")
    parser.add_argument("--evaluate", action="store_true", help="rate the defaults only")
    arguments = parser.parse_args()
    with Rating(ROOT / "fmus" / "fmi2") as rating:
        search(rating, 0 if arguments.evaluate else arguments.steps, arguments.seed)


if __name__ == "__main__":
    main()
