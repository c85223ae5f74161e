"""Rides for the study of the mode robust: worlds with real actuators and sensors, controllers, metrics of a ride."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from cosim.engine.session import Session
from cosim.fmi.values import Value
from cosim.metrics import end_stops, peak, ride, rms, seat_factor
from cosim.system import System
from plant_models.seat.parameters import FRICTION_ALPHA
from seat_controller_fmu.parameters import SAMPLE_TIME
from seat_cosim.scenarios import control, driver_mass, gains, mode, read_parameter_sets, seat_suspension

Parameters = Mapping[str, Value]

RATE = 1.0 / SAMPLE_TIME.value
WARM_UP = 10.0
"""Time of a ride that is not evaluated, in s."""

DRIVER, DEFLECTION = "seat.driver_acceleration", "seat.suspension_deflection"
FORCE, FAULT, FLOOR = "controller.force", "controller.fault", "shaker.floor_acceleration"
MASS_ESTIMATE, FRICTION_ESTIMATE = "controller.driver_mass_estimate", "controller.friction_estimate"

TOLD_MASS = 75.0
"""Driver's mass in kg that the mode robust assumes before it has an estimate, whoever sits there."""


class World(NamedTuple):
    """Imperfections of a seat.

    Attributes
    ----------
    lag, delay
        Time constant and delay of the actuator, in s.
    travel
        Deflection at which the end stops begin, in m.
    bias, offset
        Of the accelerometer in m/s2, of the deflection sensor in m.
    friction
        Factor on the friction.
    scale
        Factor on the motion of the floor.
    noise
        Factor on the noise of both sensors: 0.02 m/s2 and 0.05 mm RMS.
    """

    lag: float = 0.005
    delay: float = 0.0
    travel: float = 0.040
    bias: float = 0.05
    offset: float = 0.0
    friction: float = 1.0
    scale: float = 1.0
    noise: float = 1.0

    def parameters(self) -> dict[str, Value]:
        """Return the parameters of seat and shaker, as ``component.variable``."""
        return {
            "seat.actuator.time_constant": self.lag,
            "seat.actuator.delay": self.delay,
            "seat.end_stop.travel": self.travel,
            "seat.end_stop.stiffness": 1e5,
            "seat.end_stop.damping": 1e3,
            "seat.sensor.bandwidth": 100.0,
            "seat.sensor.acceleration_bias": self.bias,
            "seat.sensor.acceleration_noise": 0.02 * self.noise,
            "seat.sensor.deflection_bias": self.offset,
            "seat.sensor.deflection_noise": 5e-5 * self.noise,
            "seat.friction.alpha": self.friction * FRICTION_ALPHA.value,
            "shaker.random.scale": self.scale,
        }


HARSH = World()
"""A real actuator, real sensors and 40 mm of travel."""


class RideMetrics(NamedTuple):
    """Metrics of a ride.

    Attributes
    ----------
    seat, seat_vdv
        SEAT by RMS and by VDV.
    vdv
        VDV of the driver, in m/s^1.75.
    peak
        Largest magnitude of the driver's acceleration, in m/s2.
    hits
        Number of contacts with the end stops.
    mean
        Mean deflection, in m.
    largest
        Largest magnitude of the deflection in the whole ride, in m.
    force
        RMS of the force, in N.
    fault
        Number of the fault at the end, 1 for none.
    mass, friction
        Estimates 10 s after the start, in kg and N.
    """

    seat: float
    seat_vdv: float
    vdv: float
    peak: float
    hits: int
    mean: float
    largest: float
    force: float
    fault: int
    mass: float
    friction: float


def metrics(signals: Mapping[str, Any], travel: float) -> RideMetrics:
    """Compute the metrics of a ride.

    Parameters
    ----------
    signals
        Signal to its samples; those of another controller than SeatController may be missing.
    travel
        Deflection at which the end stops begin, in m.

    Returns
    -------
    RideMetrics
        After the warm-up.
    """
    skipped = round(WARM_UP * RATE)
    driver, floor = ride(signals[DRIVER], RATE, WARM_UP), ride(signals[FLOOR], RATE, WARM_UP)
    factor = seat_factor(driver, floor)
    deflection = np.asarray(signals[DEFLECTION])

    def after(name: str) -> float:
        return float(signals[name][skipped]) if name in signals else float("nan")

    return RideMetrics(
        seat=factor.rms,
        seat_vdv=factor.vdv,
        vdv=driver.vdv,
        peak=peak(signals[DRIVER][skipped:]),
        hits=end_stops(deflection, RATE, travel, WARM_UP).hits,
        mean=float(deflection[skipped:].mean()),
        largest=peak(deflection),
        force=rms(signals[FORCE][skipped:]) if FORCE in signals else 0.0,
        fault=int(signals[FAULT][-1]) if FAULT in signals else 1,
        mass=after(MASS_ESTIMATE),
        friction=after(FRICTION_ESTIMATE),
    )


class Controller(NamedTuple):
    """A controller, or another seat.

    Attributes
    ----------
    parameters
        As ``component.variable``.
    told
        Whether it gets the driver's mass.
    is_robust
        Whether its mode is robust: it gets actuator and travel.
    is_passive
        Whether it is the passive seat, whose friction is a share of the active one's.
    fmu
        FMU that replaces the controller, None for none.
    """

    parameters: Parameters
    told: bool = True
    is_robust: bool = False
    is_passive: bool = False
    fmu: Path | None = None


def controllers(fmus: Path) -> dict[str, Controller]:
    """Return the controllers of this project, by name.

    Parameters
    ----------
    fmus
        Folder of the FMUs.
    """
    passive = read_parameter_sets(["passive"], seat_suspension(fmus))
    robust = {"controller.driver_mass": TOLD_MASS}
    return {
        "published": Controller({}),
        "anti-windup": Controller({"controller.anti_windup": True}),
        "recommended": Controller(gains("recommended")),
        "robust": Controller({**robust, "controller.robust.estimator": "off"}, told=False, is_robust=True),
        "robust, estimator": Controller(robust, told=False, is_robust=True),
        "passive": Controller({**control(False), **passive}, is_passive=True),
    }


def ride_parameters(controller: Controller, world: World, mass: float) -> dict[str, Value]:
    """Return the parameters of a ride.

    Parameters
    ----------
    controller
        Who controls.
    world
        In which world.
    mass
        The driver's mass, in kg.
    """
    found = {**world.parameters(), **controller.parameters}
    found |= driver_mass(mass) if controller.told and controller.fmu is None else {"seat.driver_mass": mass}
    if controller.is_robust:
        found = mode("robust", found) | found
    if controller.is_passive:
        share = float(controller.parameters["seat.friction.alpha"])
        found |= {"seat.friction.alpha": world.friction * share, "seat.actuator.time_constant": 0.0}
    return found


class RobustRides:
    """The seat suspension with one controller, loaded; a context manager.

    Parameters
    ----------
    fmus
        Folder of the FMUs.
    controller
        Who controls.
    """

    def __init__(self, fmus: Path, controller: Controller) -> None:
        self.controller = controller
        self._system: System = seat_suspension(fmus)
        if controller.fmu is not None:
            self._system.replace("controller", controller.fmu)
        self._record = [DRIVER, DEFLECTION, FORCE, FLOOR]
        if controller.is_robust:
            self._record += [FAULT, MASS_ESTIMATE, FRICTION_ESTIMATE]
        self._stack = ExitStack()

    def __enter__(self) -> RobustRides:
        self._session: Session = self._stack.enter_context(self._system.open())
        return self

    def __exit__(self, *exception: object) -> None:
        self._stack.close()

    def run(self, excitation: Parameters, world: World, mass: float, duration: float) -> dict[str, np.ndarray]:
        """Run once.

        Parameters
        ----------
        excitation
            Parameters of the shaker, as ``component.variable``.
        world
            In which world.
        mass
            The driver's mass, in kg.
        duration
            In s.

        Returns
        -------
        dict
            Signal to its samples.

        Raises
        ------
        CosimError
            If the run does not reach its end.
        """
        parameters = {**ride_parameters(self.controller, world, mass), **excitation}
        result = self._session.run(duration, parameters=parameters, record=self._record)
        if result.error is not None:
            raise result.error
        return {name: result[name] for name in self._record}

    def random(self, name: str, seed: int, world: World, mass: float, duration: float) -> RideMetrics:
        """Ride over the random motion of a class.

        Parameters
        ----------
        name
            Class of ISO 7096.
        seed
            Of the excitation.
        world
            In which world.
        mass
            The driver's mass, in kg.
        duration
            In s, warm-up included.
        """
        excitation = {"shaker.profile": "random", "shaker.random.class": name, "shaker.random.seed": seed}
        return metrics(self.run(excitation, world, mass, duration), world.travel)

    def sine(self, frequency: float, amplitude: float, world: World, mass: float, duration: float = 20.0) -> float:
        """Ride over a sine; returns the peak acceleration of the driver after the warm-up, in m/s2.

        Parameters
        ----------
        frequency, amplitude
            Of the floor's displacement, in Hz and m.
        world
            In which world.
        mass
            The driver's mass, in kg.
        duration
            In s, warm-up included.
        """
        excitation = {
            "shaker.profile": "sine",
            "shaker.sine.frequency": frequency,
            "shaker.sine.amplitude": amplitude,
        }
        return peak(self.run(excitation, world, mass, duration)[DRIVER][round(WARM_UP * RATE) :])

    def bump(self, world: World, mass: float) -> float:
        """Ride over the paper's bump, met at the start; returns the peak acceleration of the driver, in m/s2.

        Parameters
        ----------
        world
            In which world.
        mass
            The driver's mass, in kg.
        """
        return peak(self.run({"shaker.profile": "bump"}, world, mass, 3.0)[DRIVER])
