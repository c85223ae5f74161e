"""Variables of the SeatPlant FMU; the README states units and signs.

The dataclasses are the only declaration: FMU descriptions, C headers and documentation are generated from them.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from fmus.variables import POSITIVE, Terminal, input_, output, parameter
from plant_models.driver import parameters as body
from plant_models.random_numbers import MAX_SEED
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
    "end_stop.height",
    "driver.model",
    "driver_force",
)
"""Variables on which the acceleration of the seat depends at rest."""

_REACTION = tuple(name for name in _FORCE_BALANCE if name not in ("seat_mass", "driver.model", "driver_force"))
"""Variables on which the forces of the suspension depend at rest; the acceleration of the floor is none of them, so a
vehicle that is accelerated by the force forms no algebraic loop with the seat."""


MAX_DELAY = 0.2
"""Longest delay of the actuator, in s, see :mod:`plant_models.seat.actuator`."""


class FloorSignals(IntEnum):
    """Floor inputs that are used; the others are derived from them."""

    all = 1
    displacement = 2
    velocity = 3
    acceleration = 4


class DriverModel(IntEnum):
    """Who sits on the seat: one mass on the cushion, a body of four masses, or a driver outside behind a force."""

    lumped = 1
    seated = 2
    external = 3


@dataclass(slots=True)
class Inputs:
    """Inputs of the seat.

    Attributes
    ----------
    floor_displacement, floor_velocity, floor_acceleration
        z_v in m, z_v' in m/s, z_v'' in m/s2, up positive.
    force
        Force u_sat of the actuator on the seat, in N, up positive.
    driver_force
        Force of an external driver on the seat, in N, up positive; not used with a driver inside.
    """

    floor_displacement: float = input_("m", "Cabin floor displacement z_v from equilibrium, up positive", nominal=0.01)
    floor_velocity: float = input_("m/s", "Cabin floor velocity", nominal=0.1)
    floor_acceleration: float = input_("m/s2", "Cabin floor acceleration, without gravity", nominal=1.0)
    force: float = input_("N", "Actuator force u_sat on the seat, up positive", nominal=100.0)
    driver_force: float = input_(
        "N",
        "Force of an external driver on the seat, up positive, without static weight; used with driver.model external",
        nominal=100.0,
        added=True,
    )


@dataclass(slots=True)
class Outputs:
    """Outputs of the seat, up positive.

    Attributes
    ----------
    seat_acceleration, driver_acceleration
        z_s'' and z_b'', in m/s2, without gravity. The driver's is that of pelvis and thighs of a seated body, and that
        of the seat with an external driver, whose motion the seat does not know.
    suspension_deflection, deflection_rate
        z_s - z_v in m and its rate in m/s.
    seat_displacement, driver_displacement
        z_s and z_b, in m, from static equilibrium.
    friction_force
        f_r (35), in N; acts on the seat as -f_r.
    seat_acceleration_measured, suspension_deflection_measured
        Measurements of the two sensors, in m/s2 and m.
    floor_force
        Force of the seat on the cabin floor, minus the forces of the suspension on the seat, in N, without its static
        weight; -(m_s z_s'' + m_b z_b'') with a lumped driver.
    seat_velocity
        z_s', in m/s.
    head_acceleration
        Of head and neck of a seated body, in m/s2; equal to ``driver_acceleration`` with other drivers.
    """

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
    driver_acceleration: float = output(
        "m/s2",
        "Driver acceleration z_b'', without gravity; that of pelvis and thighs of a seated driver, that of the seat "
        "with an external one",
        nominal=1.0,
        dependencies=_FORCE_BALANCE,
    )
    seat_displacement: float = output("m", "Seat displacement z_s from equilibrium", nominal=0.01)
    driver_displacement: float = output("m", "Driver displacement z_b from equilibrium", nominal=0.01)
    friction_force: float = output(
        "N", "Friction force f_r of the suspension, acting on the seat as -f_r", nominal=50.0
    )
    seat_acceleration_measured: float = output(
        "m/s2",
        "Seat acceleration as measured by its sensor",
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
        "Suspension deflection as measured by its sensor",
        nominal=0.01,
        dependencies=[
            "floor_displacement",
            "sensor.deflection_noise",
            "sensor.deflection_bias",
            "sensor.deflection_resolution",
            "sensor.seed",
        ],
    )
    floor_force: float = output(
        "N",
        "Force of the seat on the cabin floor, up positive, without static weight: minus the forces of suspension, "
        "actuator and end stops on the seat",
        nominal=100.0,
        dependencies=_REACTION,
        added=True,
    )
    seat_velocity: float = output("m/s", "Seat velocity z_s'", nominal=0.1, added=True)
    head_acceleration: float = output(
        "m/s2",
        "Acceleration of the head of a seated driver, without gravity; with other drivers that of the driver",
        nominal=1.0,
        dependencies=_FORCE_BALANCE,
        added=True,
    )


@dataclass(slots=True)
class Parameters:
    """Parameters of the seat: masses, springs, dampers, friction, used floor signals, imperfections.

    Each field states unit, range and source in its declaration.
    """

    driver_mass: float = parameter(p.DRIVER_MASS, "Driver mass on the seat", minimum=POSITIVE)
    seat_mass: float = parameter(p.SEAT_MASS, "Seat frame mass", minimum=POSITIVE)
    suspension_stiffness: float = parameter(p.SUSPENSION_STIFFNESS, "Suspension stiffness", minimum=0.0)
    suspension_damping: float = parameter(p.SUSPENSION_DAMPING, "Suspension damping", minimum=0.0)
    cushion_stiffness: float = parameter(p.CUSHION_STIFFNESS, "Cushion stiffness, seat to driver", minimum=0.0)
    cushion_damping: float = parameter(p.CUSHION_DAMPING, "Cushion damping, seat to driver", minimum=0.0)
    friction_alpha: float = parameter(
        p.FRICTION_ALPHA, "Friction force per friction state, 0 for none", name="friction.alpha", minimum=0.0
    )
    friction_gamma: float = parameter(p.FRICTION_GAMMA, "Bouc-Wen gamma", name="friction.gamma", minimum=0.0)
    friction_beta: float = parameter(p.FRICTION_BETA, "Bouc-Wen beta, |beta| < gamma", name="friction.beta")
    friction_amplitude: float = parameter(p.FRICTION_A, "Bouc-Wen A", name="friction.A", minimum=POSITIVE)
    floor_signals: FloorSignals = parameter(
        FloorSignals.all, "Floor inputs that are used after initialisation; the others are derived from them"
    )
    actuator_force_limit: float = parameter(
        p.ACTUATOR_FORCE_LIMIT, "Largest force of the actuator, 0 for none", name="actuator.force_limit", minimum=0.0
    )
    actuator_delay: float = parameter(
        p.ACTUATOR_DELAY,
        "Delay from the force input to the actuator",
        name="actuator.delay",
        minimum=0.0,
        maximum=MAX_DELAY,
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
        "Corner frequency of both sensors' first-order low-pass, 0 for none",
        name="sensor.bandwidth",
        minimum=0.0,
    )
    acceleration_noise: float = parameter(
        p.ACCELERATION_NOISE, "RMS of the acceleration sensor's noise", name="sensor.acceleration_noise", minimum=0.0
    )
    acceleration_bias: float = parameter(
        p.ACCELERATION_BIAS, "Offset of the acceleration sensor", name="sensor.acceleration_bias"
    )
    acceleration_resolution: float = parameter(
        p.ACCELERATION_RESOLUTION,
        "Resolution of the acceleration sensor, 0 for none",
        name="sensor.acceleration_resolution",
        minimum=0.0,
    )
    deflection_noise: float = parameter(
        p.DEFLECTION_NOISE, "RMS of the deflection sensor's noise", name="sensor.deflection_noise", minimum=0.0
    )
    deflection_bias: float = parameter(
        p.DEFLECTION_BIAS, "Offset of the deflection sensor", name="sensor.deflection_bias"
    )
    deflection_resolution: float = parameter(
        p.DEFLECTION_RESOLUTION,
        "Resolution of the deflection sensor, 0 for none",
        name="sensor.deflection_resolution",
        minimum=0.0,
    )
    sensor_seed: int = parameter(
        1,
        "Seed of the sensor noise: the same seed gives the same noise",
        name="sensor.seed",
        minimum=0,
        maximum=MAX_SEED,
    )
    end_stop_travel: float = parameter(
        p.END_STOP_TRAVEL,
        "Deflection from the middle of the travel at which the end stops begin, 0 for none",
        name="end_stop.travel",
        minimum=0.0,
    )
    end_stop_stiffness: float = parameter(
        p.END_STOP_STIFFNESS, "Stiffness of the end stops", name="end_stop.stiffness", minimum=0.0
    )
    end_stop_damping: float = parameter(
        p.END_STOP_DAMPING, "Damping of the end stops; their force never pulls", name="end_stop.damping", minimum=0.0
    )
    end_stop_height: float = parameter(
        p.END_STOP_HEIGHT,
        "Height of static equilibrium above the middle of the travel, which shifts both end stops down by it",
        name="end_stop.height",
        added=True,
    )
    driver_model: DriverModel = parameter(
        DriverModel.lumped,
        "Driver on the seat: one mass on the cushion, a seated body of four masses, or outside behind driver_force",
        name="driver.model",
        added=True,
    )
    contact_stiffness: float = parameter(
        body.CONTACT_STIFFNESS,
        "Stiffness of the contact of a seated driver at 55.2 kg, in place of the cushion's",
        name="driver.contact_stiffness",
        minimum=0.0,
        added=True,
    )
    contact_damping: float = parameter(
        body.CONTACT_DAMPING,
        "Damping of the contact of a seated driver at 55.2 kg, in place of the cushion's",
        name="driver.contact_damping",
        minimum=0.0,
        added=True,
    )


TERMINALS = (
    Terminal(
        "floor",
        "Motion of the cabin floor",
        {"displacement": "floor_displacement", "velocity": "floor_velocity", "acceleration": "floor_acceleration"},
    ),
    Terminal("actuator", "Force of the actuator", {"force": "force"}),
    Terminal(
        "sensors",
        "Measurements of the sensors",
        {"acceleration": "seat_acceleration_measured", "deflection": "suspension_deflection_measured"},
    ),
    Terminal(
        "driver",
        "The contact with an external driver",
        {
            "displacement": "seat_displacement",
            "velocity": "seat_velocity",
            "acceleration": "seat_acceleration",
            "force": "driver_force",
        },
    ),
)
