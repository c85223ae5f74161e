"""Calibration of what the paper does not publish, on its 55 kg column (docs/explanation/calibration.md).

Of ten unknowns three are fitted, each on one number of the paper:

    level of the excitation       RMS of the uncontrolled seat
    damping of the passive seat   RMS of the passive seat
    lag of the actuator           RMS of the controlled seat

The others are assumed, and varied to find how the predictions depend on them.
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
"""RMS accelerations of the seat, unweighted, in m/s2."""

# ---- assumptions -----------------------------------------------------------------------------------------------------

LOAD: dict[str, Value] = {"seat.cushion_stiffness": 9e6, "seat.cushion_damping": 2.5e4}
"""The experiments' load, "55 kg mass is loaded on the seat": strapped to it, without a cushion between. A hundred times
the cushion's stiffness and ten times its damping make mass and seat move as one up to 100 Hz; the substeps are small
enough for that."""
CUSHIONED: dict[str, Value] = {}
"""The load on the cushion of Table 1, as in the paper's simulation."""

CLASS = "EM3"
"""Class of ISO 7096. EM2 and EM4 have the same shape; of the three, the level of EM3 is nearest to the fitted one."""
FRICTION_SHARE = 0.2
"""Friction of the passive seat, 15 N, over the prototype's: it has no gear reducers, and resonates more (Fig. 10)."""
DELAY = 0.002
"""Delay of the actuator, in s: one sample."""
SENSOR_BANDWIDTH = 50.0
"""Bandwidth of the sensors, in Hz: an ADXL203 with 0.1 uF, for which its data sheet gives 50 Hz."""
SINE_AMPLITUDE = 0.005
"""Amplitude for Fig. 10, in m, of the paper's friction test; docs/explanation/calibration.md has 10 mm."""
RESONANCE, BAND = np.array([1.0, 1.2, 1.4, 1.6]), np.array([2.5, 3.0, 3.5, 4.0, 4.5])
"""Frequencies at which Fig. 10 has the passive seat above the uncontrolled one, and below it, in Hz."""


ABOVE_LEAST, BELOW_LEAST = (350.0, 1500.0), (60.0, 350.0)
"""Ranges in which to search the damping, in N s/m: the RMS is least between them, so two dampings give one RMS."""


def ride(scale: float, name: str = CLASS) -> dict[str, Value]:
    """Return the parameters of the excitation.

    Parameters
    ----------
    scale
        Factor of the class's level.
    name
        Name of the class.
    """
    return {"shaker.profile": "random", "shaker.random.class": name, "shaker.random.scale": scale}


def passive_seat(rides: Rides, damping: float, friction: float = FRICTION_SHARE) -> dict[str, Value]:
    """Return the parameters of a passive seat.

    Parameters
    ----------
    rides
        Has the prototype's friction.
    damping
        In N s/m.
    friction
        Friction relative to the prototype's.
    """
    alpha = float(f"{friction * rides.system.start('seat.friction.alpha'):.10g}")
    return {"seat.suspension_damping": damping, "seat.friction.alpha": alpha}


def prototype_seat(lag: float, delay: float = DELAY, bandwidth: float = SENSOR_BANDWIDTH) -> dict[str, Value]:
    """Return the parameters of the prototype's imperfections.

    Parameters
    ----------
    lag, delay
        Time constant and delay of the actuator, in s.
    bandwidth
        Bandwidth of the sensors, in Hz.
    """
    return {"seat.actuator.time_constant": lag, "seat.actuator.delay": delay, "seat.sensor.bandwidth": bandwidth}


# ---- fits: one unknown, one number of the paper ----------------------------------------------------------------------


def solve(measure: Callable[[float], float], target: float, low: float, high: float, digits: int) -> float | None:
    """Solve ``measure(x) == target`` for x.

    Parameters
    ----------
    measure
        Monotonic function.
    target
        Its value.
    low, high
        Range of x.
    digits
        Decimals of the result.

    Returns
    -------
    float or None
        None if there is no solution in the range.
    """
    try:
        return round(brentq(lambda x: measure(x) - target, low, high, xtol=0.3 * 10.0**-digits), digits)
    except ValueError:
        return None


def fit_scale(rides: Rides, name: str = CLASS, seeds: Iterable[int] = SEEDS) -> float | None:
    """Fit the excitation's level to the RMS of the uncontrolled seat.

    Parameters
    ----------
    rides
        Runs the seat.
    name
        Class of the excitation.
    seeds
        Seeds of the rides.

    Returns
    -------
    float or None
        Factor of the class's level; None if none fits.
    """
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
    """Fit the passive seat's damping to its RMS.

    Parameters
    ----------
    rides
        Runs the seat.
    floor
        Parameters of the excitation.
    friction
        Friction relative to the prototype's.
    seeds
        Seeds of the rides.
    between
        Range of the damping, in N s/m.

    Returns
    -------
    float or None
        In N s/m; None if none fits.
    """
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
    """Fit the actuator's time constant to the RMS of the controlled seat.

    Parameters
    ----------
    rides
        Runs the seat.
    floor
        Parameters of the excitation.
    delay
        Delay of the actuator, in s.
    bandwidth
        Bandwidth of the sensors, in Hz.
    seeds
        Seeds of the rides.

    Returns
    -------
    float or None
        In s; None if none fits.
    """
    return solve(
        lambda lag: rides.random({**floor, **prototype_seat(lag, delay, bandwidth)}, seeds=seeds).rms,
        CONTROLLED_RMS,
        0.0,
        0.1,
        4,
    )


def fit_height(rides: Rides, passive: Parameters) -> float | None:
    """Fit the height of a bump (34) to the passive seat's peak at 55 kg; it is in no parameter set.

    Parameters
    ----------
    rides
        Runs the seat.
    passive
        Parameters of the passive seat.

    Returns
    -------
    float or None
        In m; None if none fits.
    """
    return solve(
        lambda height: rides.bump({**control(False), **passive, "shaker.bump.height": height}, 55.0)[0],
        BUMP_PEAKS[55.0]["passive"],
        0.02,
        0.1,
        4,
    )


def calibrate(rides: Rides, seeds: Iterable[int] = SEEDS) -> dict[str, dict[str, Value]]:
    """Fit all three unknowns.

    Parameters
    ----------
    rides
        Runs the seat, with the load of the experiments.
    seeds
        Seeds of the rides.

    Returns
    -------
    dict
        Name to parameter set.
    """
    floor = ride(required(fit_scale(rides, seeds=seeds)))
    damping = required(fit_damping(rides, floor, seeds=seeds))
    lag = required(fit_lag(rides, floor, seeds=seeds))
    return {
        "load": dict(rides.load),
        "passive": passive_seat(rides, damping),
        "prototype": prototype_seat(lag),
        "ride": floor,
    }


def required(value: float | None) -> float:
    """Return a solution.

    Raises
    ------
    SystemExit
        If there is none.
    """
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
    """Return the files of parameter sets.

    Parameters
    ----------
    system
        System whose parameters they are.
    sets
        Name to parameter set.

    Returns
    -------
    dict
        Name to the content of its ``.ssv`` file.
    """
    return {name: parameter_set(system, name, values, DESCRIPTIONS[name], SOURCES) for name, values in sets.items()}


def committed(system: System) -> dict[str, dict[str, Value]]:
    """Return the parameter sets of this project, by name; ``system`` has the parameters."""
    return {name: read_parameters(parameter_sets.path(name), system) for name in parameter_sets.NAMES}


# ---- predictions -----------------------------------------------------------------------------------------------------


class Comparison(NamedTuple):
    """Rides of all seats on the calibrated floor, with one load.

    Attributes
    ----------
    passive, uncontrolled, prototype, ideal
        Metrics of the seat's acceleration.
    """

    passive: Ride
    uncontrolled: Ride
    prototype: Ride
    ideal: Ride

    def reduction(self, which: str) -> float:
        """Return the reduction of a seat's RMS from the passive seat's, in %; ``which`` is the name of a field."""
        return 100.0 * (1.0 - float(getattr(self, which).rms) / self.passive.rms)


def compare(
    rides: Rides, sets: Mapping[str, Parameters], mass: float, seeds: Iterable[int] = SEEDS, **how: str
) -> Comparison:
    """Run the rides of all seats.

    Parameters
    ----------
    rides
        Runs the seat.
    sets
        Name to parameter set.
    mass
        The driver's mass, in kg.
    seeds
        Seeds of the rides.
    how
        Further arguments of :meth:`studies.rides.Rides.random`.
    """
    off, floor, seeds = control(False), sets["ride"], tuple(seeds)
    seats = ({**off, **sets["passive"]}, off, sets["prototype"], {})
    return Comparison(*(rides.random({**floor, **seat}, mass, seeds, **how) for seat in seats))


class Shape(NamedTuple):
    """Differences of transmissibility between a passive and the uncontrolled seat, to compare with Fig. 10.

    Attributes
    ----------
    resonance
        Largest transmissibility of the passive seat, less that of the uncontrolled one, over :data:`RESONANCE`.
    gain
        Transmissibility of the uncontrolled seat, less that of the passive one, over :data:`BAND`.
    """

    resonance: float
    gain: Array

    @classmethod
    def of(cls, rides: Rides, seat: Parameters, amplitude: float = SINE_AMPLITUDE) -> Shape:
        """Return the differences for a passive seat.

        Parameters
        ----------
        rides
            Runs the seats.
        seat
            Parameters of the passive seat.
        amplitude
            Amplitude of the floor's displacement, in m.
        """
        cases = [{**control(False), **case} for case in ({}, seat)]
        free, passive = (rides.transmissibility(case, RESONANCE, amplitude).max() for case in cases)
        below, above = (rides.transmissibility(case, BAND, amplitude) for case in cases)
        return cls(float(passive - free), below - above)


class Alternative(NamedTuple):
    """Other assumptions, under which the 55 kg column fits as well.

    Attributes
    ----------
    name
        Description.
    sets
        Name to parameter set.
    """

    name: str
    sets: Mapping[str, Parameters]


def alternatives(rides: Rides, sets: Mapping[str, Parameters]) -> list[Alternative]:
    """Fit under other assumptions, on few seeds.

    Parameters
    ----------
    rides
        Runs the seats.
    sets
        Name to parameter set, of the present assumptions.
    """
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
