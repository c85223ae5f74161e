"""What the paper does not publish, fitted on its 55 kg column through the FMUs (docs/explanation/calibration.md).

Of ten unknowns three are fitted, each on one figure of the paper:

    level of the excitation       RMS of the uncontrolled seat
    damping of the passive seat   RMS of the passive seat
    lag of the actuator           RMS of the controlled seat

The others are assumed, and varied to see what that does to the predictions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from cosim.fmi.values import Value
from cosim.ssp import parameter_set, read_parameters
from cosim.system import System
from plant_models import parameter_sets
from seat_cosim.paper.published import BUMP_PEAKS, RMS
from seat_cosim.scenarios import control
from studies.rides import FEW_SEEDS, SEEDS, Array, Parameters, Ride, Rides

# ---- the paper -------------------------------------------------------------------------------------------------------

UNCONTROLLED_RMS, PASSIVE_RMS, CONTROLLED_RMS = (RMS[55.0][name] for name in ("uncontrolled", "passive", "controlled"))
"""m/s2, of the seat, not weighted."""

# ---- what is assumed -------------------------------------------------------------------------------------------------

LOAD: dict[str, Value] = {"seat.cushion_stiffness": 9e6, "seat.cushion_damping": 2.5e4}
"""The experiments' load, "55 kg mass is loaded on the seat": strapped to it, without a cushion between. A hundred times
the cushion's stiffness and ten times its damping, so mass and seat are one up to 100 Hz; the substeps carry it."""
CUSHIONED: dict[str, Value] = {}
"""The load on the cushion of Table 1, as in the paper's simulation."""

CLASS = "EM3"
"""Of ISO 7096; with the shape of EM2 and EM4, and of the three the one nearest to the level that is found."""
FRICTION_SHARE = 0.2
"""Friction of the passive seat over the prototype's: 15 N. It has no gear reducers, and resonates more (Fig. 10)."""
DELAY = 0.002
"""s; what is sampled acts one sample later."""
SENSOR_BANDWIDTH = 50.0
"""Hz; an ADXL203 with the 0.1 uF at which its maker's table gives 50 Hz."""
SINE_AMPLITUDE = 0.005
"""m, of Fig. 10, the smaller one of the paper's friction test; with 10 mm see docs/explanation/calibration.md."""
RESONANCE, BAND = np.array([1.0, 1.2, 1.4, 1.6]), np.array([2.5, 3.0, 3.5, 4.0, 4.5])
"""Hz; where Fig. 10 has the passive seat above the uncontrolled one, and below it."""


ABOVE_LEAST, BELOW_LEAST = (350.0, 1500.0), (60.0, 350.0)
"""N s/m; the RMS is least in between, so two dampings give one RMS."""


def ride(scale: float, name: str = CLASS) -> dict[str, Value]:
    """Return the excitation."""
    return {"shaker.profile": "random", "shaker.random.class": name, "shaker.random.scale": scale}


def passive_seat(rides: Rides, damping: float, friction: float = FRICTION_SHARE) -> dict[str, Value]:
    """Return the passive seat: its damping in N s/m, its friction over the prototype's."""
    alpha = float(f"{friction * rides.system.start('seat.friction.alpha'):.10g}")
    return {"seat.suspension_damping": damping, "seat.friction.alpha": alpha}


def prototype_seat(lag: float, delay: float = DELAY, bandwidth: float = SENSOR_BANDWIDTH) -> dict[str, Value]:
    """Return the prototype's imperfections: in s, s and Hz."""
    return {"seat.actuator.time_constant": lag, "seat.actuator.delay": delay, "seat.sensor.bandwidth": bandwidth}


# ---- fits: one unknown, one figure of the paper ----------------------------------------------------------------------


def solve(measure: Callable[[float], float], target: float, low: float, high: float, digits: int) -> float | None:
    """Find where a measure meets its target; rounded, None if it does not between low and high."""
    try:
        return round(brentq(lambda x: measure(x) - target, low, high, xtol=0.3 * 10.0**-digits), digits)
    except ValueError:
        return None


def fit_scale(rides: Rides, name: str = CLASS, seeds: Iterable[int] = SEEDS) -> float | None:
    """Find the excitation's level at which the uncontrolled seat has its RMS."""
    return solve(
        lambda scale: rides.random({**ride(scale, name), **control(False)}, seeds=seeds).rms,
        UNCONTROLLED_RMS,
        0.3,
        8.0,
        3,
    )


def fit_damping(
    rides: Rides,
    floor: Parameters,
    friction: float = FRICTION_SHARE,
    seeds: Iterable[int] = SEEDS,
    between: tuple[float, float] = ABOVE_LEAST,
) -> float | None:
    """Find the passive seat's damping, in N s/m, at which it has its RMS."""
    return solve(
        lambda damping: (
            rides.random({**floor, **control(False), **passive_seat(rides, damping, friction)}, seeds=seeds).rms
        ),
        PASSIVE_RMS,
        *between,
        0,
    )


def fit_lag(
    rides: Rides,
    floor: Parameters,
    delay: float = DELAY,
    bandwidth: float = SENSOR_BANDWIDTH,
    seeds: Iterable[int] = SEEDS,
) -> float | None:
    """Find the actuator's lag at which the controlled seat has its RMS."""
    return solve(
        lambda lag: rides.random({**floor, **prototype_seat(lag, delay, bandwidth)}, seeds=seeds).rms,
        CONTROLLED_RMS,
        0.0,
        0.1,
        4,
    )


def fit_height(rides: Rides, passive: Parameters) -> float | None:
    """Find the height of a bump (34), in m, at which the passive seat has its peak at 55 kg: not a parameter set's."""
    return solve(
        lambda height: rides.bump({**control(False), **passive, "shaker.bump.height": height}, 55.0)[0],
        BUMP_PEAKS[55.0]["passive"],
        0.02,
        0.1,
        4,
    )


def calibrate(rides: Rides, seeds: Iterable[int] = SEEDS) -> dict[str, dict[str, Value]]:
    """Fit all three, under what ``rides`` have on the seat; returns name to parameter set."""
    floor = ride(insisted(fit_scale(rides, seeds=seeds)))
    damping = insisted(fit_damping(rides, floor, seeds=seeds))
    lag = insisted(fit_lag(rides, floor, seeds=seeds))
    return {
        "load": dict(rides.load),
        "passive": passive_seat(rides, damping),
        "prototype": prototype_seat(lag),
        "ride": floor,
    }


def insisted(value: float | None) -> float:
    """Insist on a solution."""
    if value is None:
        raise SystemExit("calibration: expected a solution between the bounds, got none")
    return value


# ---- parameter sets --------------------------------------------------------------------------------------------------

DESCRIPTIONS = {
    "load": "What the experiments loaded the seats with: a mass strapped to it, not a driver on a cushion",
    "passive": "Well-tuned passive seat beside the prototype (GARPEN GSSC7); use it with controller.enabled = false",
    "prototype": "Imperfections of the active prototype; stand for all that keeps it from what it does ideally",
    "ride": "Random excitation of the experiments",
}
SOURCES = {
    "seat.cushion_stiffness": "assumed: 100 times Table 1, no cushion to speak of",
    "seat.cushion_damping": "assumed: 10 times Table 1, no cushion to speak of",
    "seat.suspension_damping": f"fitted: passive RMS {PASSIVE_RMS} m/s2 at 55 kg, Table 2",
    "seat.friction.alpha": f"assumed: {FRICTION_SHARE} of the prototype's, which has gear reducers besides",
    "seat.actuator.time_constant": f"fitted: controlled RMS {CONTROLLED_RMS} m/s2 at 55 kg, Table 2",
    "seat.actuator.delay": "assumed: one sample of the controller",
    "seat.sensor.bandwidth": "assumed: ADXL203 with 0.1 uF",
    "shaker.profile": "section 3.4",
    "shaker.random.class": "chosen: of the classes with these RMS, the one that agrees with Fig. 10 and 15",
    "shaker.random.scale": f"fitted: uncontrolled RMS {UNCONTROLLED_RMS} m/s2 at 55 kg, Table 2",
}


def contents(system: System, sets: Mapping[str, Parameters]) -> dict[str, bytes]:
    """Write parameter sets; returns name to the file's bytes."""
    return {name: parameter_set(system, name, values, DESCRIPTIONS[name], SOURCES) for name, values in sets.items()}


def committed(system: System) -> dict[str, dict[str, Value]]:
    """Read the parameter sets that come with the package."""
    return {name: read_parameters(parameter_sets.path(name), system) for name in parameter_sets.NAMES}


# ---- what follows ----------------------------------------------------------------------------------------------------


class Comparison(NamedTuple):
    """The seats on the calibrated floor with one driver."""

    passive: Ride
    uncontrolled: Ride
    prototype: Ride
    ideal: Ride

    def reduction(self, which: str) -> float:
        """Return by how much the RMS is below the passive seat's, in %."""
        return 100.0 * (1.0 - float(getattr(self, which).rms) / self.passive.rms)


def compare(
    rides: Rides, sets: Mapping[str, Parameters], mass: float, seeds: Iterable[int] = SEEDS, **how: str
) -> Comparison:
    """Let all seats ride."""
    off, floor, seeds = control(False), sets["ride"], tuple(seeds)
    seats = ({**off, **sets["passive"]}, off, sets["prototype"], {})
    return Comparison(*(rides.random({**floor, **seat}, mass, seeds, **how) for seat in seats))


class Shape(NamedTuple):
    """What Fig. 10 says of a passive seat against the uncontrolled one: differences of transmissibility."""

    resonance: float
    gain: Array

    @classmethod
    def of(cls, rides: Rides, seat: Parameters, amplitude: float = SINE_AMPLITUDE) -> Shape:
        """Measure a passive seat."""
        cases = [{**control(False), **case} for case in ({}, seat)]
        free, passive = (rides.transmissibility(case, RESONANCE, amplitude).max() for case in cases)
        below, above = (rides.transmissibility(case, BAND, amplitude) for case in cases)
        return cls(float(passive - free), below - above)


class Alternative(NamedTuple):
    """Other assumptions that fit the 55 kg column as well."""

    name: str
    sets: Mapping[str, Parameters]


def alternatives(rides: Rides, sets: Mapping[str, Parameters]) -> list[Alternative]:
    """Fit with other assumptions, on few seeds."""
    others = []
    for friction, between in ((0.0, ABOVE_LEAST), (0.5, ABOVE_LEAST), (FRICTION_SHARE, BELOW_LEAST)):
        damping = fit_damping(rides, sets["ride"], friction, FEW_SEEDS, between)
        if damping is not None:
            seat = passive_seat(rides, damping, friction)
            others.append(
                Alternative(f"passive: {damping:.0f} N s/m, friction x {friction:g}", {**sets, "passive": seat})
            )
    for delay, bandwidth in ((0.0, 0.0), (0.002, 10.0), (0.004, 30.0), (0.008, 50.0)):
        lag = fit_lag(rides, sets["ride"], delay, bandwidth, FEW_SEEDS)
        if lag is not None:
            seat = prototype_seat(lag, delay, bandwidth)
            sensor = f"{bandwidth:g} Hz" if bandwidth else "ideal sensors"
            name = f"prototype: lag {1e3 * lag:.1f} ms, delay {1e3 * delay:g} ms, {sensor}"
            others.append(Alternative(name, {**sets, "prototype": seat}))
    return others
