"""The SeatPlant FMU's variables: the one declaration (contract of units and signs in the README)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from fmus.variables import POSITIVE, Terminal, input_, output, parameter
from plant_models import parameters as p

_FORCE_BALANCE = (
    "floor_displacement",
    "floor_velocity",
    "force",
    "seat_mass",
    "suspension_stiffness",
    "suspension_damping",
)
"""What the seat's acceleration depends on while everything is at rest."""


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
        dependencies=_FORCE_BALANCE,
    )
    suspension_deflection_measured: float = output(
        "m", "Suspension deflection as its sensor reports it", nominal=0.01, dependencies=["floor_displacement"]
    )


@dataclass(slots=True)
class Parameters:
    """The seat's masses, springs, dampers and friction, and what it hears of the floor."""

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
