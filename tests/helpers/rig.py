"""Seat and controller FMUs under a floor that is given as samples, with extra samples of delay before the actuator."""

from __future__ import annotations

import tempfile
from collections import deque
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from cosim.fmi.description import ModelDescription
from cosim.fmi.instance import Experiment, Instance
from cosim.fmi.versions import instantiate
from seat_controller_fmu.parameters import SAMPLE_TIME

STEP_SIZE = SAMPLE_TIME.value

Array = np.ndarray[Any, Any]

LINEAR = {"seat.friction.alpha": 0.0, "controller.force_limit": 1e9}
"""No friction and no limit: the loop that theory speaks of."""


class Floor(NamedTuple):
    """Displacement, velocity and acceleration of the floor at t = k h, in m, m/s, m/s2."""

    displacement: Array
    velocity: Array
    acceleration: Array


class Motion(NamedTuple):
    """What the seat did at t = k h: driver's acceleration in m/s2, deflection in m.

    And force and fault of sample k, where they are known.
    """

    acceleration: Array
    deflection: Array
    force: Array | None = None
    fault: Array | None = None


def bump(duration: float, height: float = 0.07, length: float = 0.8, speed: float = 1.0) -> Floor:
    """Sample the paper's bump (34)."""
    t = np.arange(round(duration / STEP_SIZE)) * STEP_SIZE
    omega, inside = 2 * np.pi * speed / length, t < length / speed - 1e-9
    half = 0.5 * height * inside
    return Floor(half * (1 - np.cos(omega * t)), half * omega * np.sin(omega * t), half * omega**2 * np.cos(omega * t))


def noise(duration: float, rms: float, band: tuple[float, float], seed: int) -> Floor:
    """Make band-limited Gaussian noise of the floor's acceleration, consistent in all three signals, starting at rest.

    Parameters
    ----------
    duration, rms, band, seed
        In s, in m/s2, in Hz, and of the random numbers.
    """
    count = round(duration / STEP_SIZE)
    f = np.fft.rfftfreq(count, STEP_SIZE)
    inside = (f >= band[0]) & (f <= band[1])
    random = np.random.default_rng(seed)
    spectrum = np.where(inside, random.standard_normal(len(f)) + 1j * random.standard_normal(len(f)), 0.0)
    acceleration = np.fft.irfft(spectrum, count)
    spectrum *= rms / acceleration.std()
    omega = np.where(inside, 2 * np.pi * f, 1.0)
    return Floor(*(np.fft.irfft(part, count) for part in (-spectrum / omega**2, spectrum / (1j * omega), spectrum)))


class Rig:
    """Loaded FMUs of seat and controller; a context manager.

    Parameters
    ----------
    fmus
        Folder of ``SeatPlant.fmu`` and ``SeatController.fmu``, of FMI 2.0.
    """

    def __init__(self, fmus: Path) -> None:
        self._stack = ExitStack()
        self._instances: dict[str, Instance] = {}
        self._references: dict[str, int] = {}
        for name, fmu in (("seat", "SeatPlant"), ("controller", "SeatController")):
            folder = Path(self._stack.enter_context(tempfile.TemporaryDirectory()))
            model = ModelDescription.read(fmus / f"{fmu}.fmu")
            model.extract(folder)
            instance = instantiate(name, model, folder)
            self._stack.callback(instance.free)
            self._instances[name] = instance
            self._references |= {f"{name}.{v.name}": v.valueReference for v in model.description.modelVariables}

    def __enter__(self) -> Rig:
        return self

    def __exit__(self, *exception: object) -> None:
        self._stack.close()

    def run(
        self,
        floor: Floor,
        parameters: Mapping[str, float],
        delay: int = 0,
        spoil: Callable[[int, float, float], tuple[float, float]] = lambda k, a, delta: (a, delta),
        between: Callable[[int, Instance], None] = lambda k, controller: None,
    ) -> Motion:
        """Run once.

        Parameters
        ----------
        floor
            Its length is the run's.
        parameters
            ``seat.…`` and ``controller.…``; the others start from their defaults.
        delay
            Extra samples between the controller's force and the seat.
        spoil
            Function from sample and measurements, in m/s2 and m, to what the controller gets of them.
        between
            Called with the sample and the controller before its step.
        """
        for name, instance in self._instances.items():
            own = {key.partition(".")[2]: value for key, value in parameters.items() if key.startswith(f"{name}.")}
            instance.enter_initialization(Experiment(0.0, len(floor.displacement) * STEP_SIZE), own)
            instance.exit_initialization()
        seat, controller = self._instances["seat"].fmu, self._instances["controller"].fmu
        port = self._references
        inputs = [
            port[f"seat.{name}"] for name in ("floor_displacement", "floor_velocity", "floor_acceleration", "force")
        ]
        sensors = [port["seat.seat_acceleration_measured"], port["seat.suspension_deflection_measured"]]
        measured = [port["controller.seat_acceleration"], port["controller.suspension_deflection"]]
        seen = [port["seat.driver_acceleration"], port["seat.suspension_deflection"]]
        queue = deque([0.0] * delay)
        rows = []
        for k, motion in enumerate(zip(*(signal.tolist() for signal in floor), strict=True)):
            moved = seat.getReal(seen)
            controller.setReal(measured, spoil(k, *seat.getReal(sensors)))
            between(k, self._instances["controller"])
            controller.doStep(k * STEP_SIZE, STEP_SIZE)
            force = controller.getReal([port["controller.force"]])[0]
            rows.append([*moved, force, controller.getInteger([port["controller.fault"]])[0]])
            queue.append(force)
            seat.setReal(inputs, [*motion, queue.popleft()])
            seat.doStep(k * STEP_SIZE, STEP_SIZE)
        return Motion(*np.array(rows).T)


def driver(mass: float) -> dict[str, float]:
    """Seat a driver of the given mass in kg, and tell the controller."""
    return {"seat.driver_mass": mass, "controller.driver_mass": mass}


def settles(motion: Motion) -> bool:
    """Judge whether a loop that was kicked comes to rest: the last quarter is quieter than the one before.

    A loop that has run into the force limit, far beyond 100 m/s2, is quiet in its way and does not count.
    """
    third, last = np.split(motion.acceleration, 4)[2:]
    return bool(np.abs(last).max() < 100.0 and np.mean(last**2) < np.mean(third**2))
