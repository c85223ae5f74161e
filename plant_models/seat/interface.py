"""The SeatPlant FMU's variables: the one declaration (contract of units and signs in the README)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from fmus.variables import POSITIVE, Terminal, input_, output, parameter
from plant_models.random_numbers import MOST_SEED
from plant_models.seat import parameters as p

_FORCE_BALANCE = (
    "floor_displacement",
    "floor_velocity",
    "force",
    "seat_mass",
    "suspension_stiffness",
    "suspension_damping",
    "actuator.force_limit",
    "end_stop.travel",
    "end_stop.stiffness",
    "end_stop.damping",
)
"""What the seat's acceleration depends on while everything is at rest."""


LONGEST_DELAY = 0.2
"""In s; what the actuator's delay line holds, see :mod:`plant_models.seat.actuator`."""


class FloorSignals(IntEnum):
    """Which of the floor's inputs are alive; the others are derived."""

    all = 1
    displacement = 2
    velocity = 3
    acceleration = 4


@dataclass(slots=True)
class Inputs:
    """What the floor and the actuator do to the seat."""

    floor_displacement: float = input_("m", "Cabin floor displacement z_v from equilibrium, up positive", nominal=0.01)
    floor_velocity: float = input_("m/s", "Cabin floor velocity", nominal=0.1)
    floor_acceleration: float = input_("m/s2", "Cabin floor acceleration, without gravity", nominal=1.0)
    force: float = input_("N", "Actuator force u_sat on the seat, up positive", nominal=100.0)


@dataclass(slots=True)
class Outputs:
    """What the seat does, and what its sensors report."""

    seat_acceleration: float = output(
        "m/s2",
        "Seat acceleration z_s'', without gravity",
        nominal=1.0,
        dependencies=_FORCE_BALANCE,
    )
    suspension_deflection: float = output(
        "m", "Suspension deflection z_s - z_v", nominal=0.01, dependencies=["floor_displacement"]
    )
    deflection_rate: float = output("m/s", "Rate of the deflection", nominal=0.1, dependencies=["floor_velocity"])
    driver_acceleration: float = output("m/s2", "Driver acceleration z_b'', without gravity", nominal=1.0)
    seat_displacement: float = output("m", "Seat displacement z_s from equilibrium", nominal=0.01)
    driver_displacement: float = output("m", "Driver displacement z_b from equilibrium", nominal=0.01)
    friction_force: float = output(
        "N", "Friction force f_r of the suspension, acting on the seat as -f_r", nominal=50.0
    )
    seat_acceleration_measured: float = output(
        "m/s2",
        "Seat acceleration as its sensor reports it",
        nominal=1.0,
        dependencies=[
            *_FORCE_BALANCE,
            "sensor.acceleration_noise",
            "sensor.acceleration_bias",
            "sensor.acceleration_resolution",
            "sensor.seed",
        ],
    )
    suspension_deflection_measured: float = output(
        "m",
        "Suspension deflection as its sensor reports it",
        nominal=0.01,
        dependencies=[
            "floor_displacement",
            "sensor.deflection_noise",
            "sensor.deflection_bias",
            "sensor.deflection_resolution",
            "sensor.seed",
        ],
    )


@dataclass(slots=True)
class Parameters:
    """The seat's masses, springs, dampers and friction, what it hears of the floor, and its imperfections."""

    driver_mass: float = parameter(p.DRIVER_MASS, "Driver mass on the seat", minimum=POSITIVE)
    seat_mass: float = parameter(p.SEAT_MASS, "Seat frame mass", minimum=POSITIVE)
    suspension_stiffness: float = parameter(p.SUSPENSION_STIFFNESS, "Suspension stiffness", minimum=0.0)
    suspension_damping: float = parameter(p.SUSPENSION_DAMPING, "Suspension damping", minimum=0.0)
    cushion_stiffness: float = parameter(p.CUSHION_STIFFNESS, "Cushion stiffness, seat to driver", minimum=0.0)
    cushion_damping: float = parameter(p.CUSHION_DAMPING, "Cushion damping, seat to driver", minimum=0.0)
    friction_alpha: float = parameter(
        p.FRICTION_ALPHA, "Friction force per state, 0 for none", name="friction.alpha", minimum=0.0
    )
    friction_gamma: float = parameter(p.FRICTION_GAMMA, "Bouc-Wen gamma", name="friction.gamma", minimum=0.0)
    friction_beta: float = parameter(p.FRICTION_BETA, "Bouc-Wen beta, |beta| < gamma", name="friction.beta")
    friction_amplitude: float = parameter(p.FRICTION_A, "Bouc-Wen A", name="friction.A", minimum=POSITIVE)
    floor_signals: FloorSignals = parameter(
        FloorSignals.all, "Which floor inputs are alive after initialisation; the others are derived"
    )
    actuator_force_limit: float = parameter(
        p.ACTUATOR_FORCE_LIMIT, "Largest force of the actuator, 0 for none", name="actuator.force_limit", minimum=0.0
    )
    actuator_delay: float = parameter(
        p.ACTUATOR_DELAY, "Time from force to actuator", name="actuator.delay", minimum=0.0, maximum=LONGEST_DELAY
    )
    actuator_time_constant: float = parameter(
        p.ACTUATOR_TIME_CONSTANT,
        "Time constant of the actuator's first-order lag",
        name="actuator.time_constant",
        minimum=0.0,
        maximum=10.0,
    )
    sensor_bandwidth: float = parameter(
        p.SENSOR_BANDWIDTH,
        "Corner of both sensors' first-order low-pass, 0 for none",
        name="sensor.bandwidth",
        minimum=0.0,
    )
    acceleration_noise: float = parameter(
        p.ACCELERATION_NOISE, "Noise of the acceleration, rms", name="sensor.acceleration_noise", minimum=0.0
    )
    acceleration_bias: float = parameter(
        p.ACCELERATION_BIAS, "Offset of the acceleration", name="sensor.acceleration_bias"
    )
    acceleration_resolution: float = parameter(
        p.ACCELERATION_RESOLUTION,
        "Smallest step of the acceleration, 0 for none",
        name="sensor.acceleration_resolution",
        minimum=0.0,
    )
    deflection_noise: float = parameter(
        p.DEFLECTION_NOISE, "Noise of the deflection, rms", name="sensor.deflection_noise", minimum=0.0
    )
    deflection_bias: float = parameter(p.DEFLECTION_BIAS, "Offset of the deflection", name="sensor.deflection_bias")
    deflection_resolution: float = parameter(
        p.DEFLECTION_RESOLUTION,
        "Smallest step of the deflection, 0 for none",
        name="sensor.deflection_resolution",
        minimum=0.0,
    )
    sensor_seed: int = parameter(
        1, "Which noise: same seed, same samples", name="sensor.seed", minimum=0, maximum=MOST_SEED
    )
    end_stop_travel: float = parameter(
        p.END_STOP_TRAVEL,
        "Deflection each way at which the end stops begin, 0 for none",
        name="end_stop.travel",
        minimum=0.0,
    )
    end_stop_stiffness: float = parameter(
        p.END_STOP_STIFFNESS, "Stiffness of the end stops", name="end_stop.stiffness", minimum=0.0
    )
    end_stop_damping: float = parameter(
        p.END_STOP_DAMPING, "Damping of the end stops, which never pull", name="end_stop.damping", minimum=0.0
    )


TERMINALS = (
    Terminal(
        "floor",
        "Motion of the cabin floor",
        {"displacement": "floor_displacement", "velocity": "floor_velocity", "acceleration": "floor_acceleration"},
    ),
    Terminal("actuator", "What the actuator does", {"force": "force"}),
    Terminal(
        "sensors",
        "What the sensors report",
        {"acceleration": "seat_acceleration_measured", "deflection": "suspension_deflection_measured"},
    ),
)
