"""Variables of the TruckCab FMU.

The dataclasses are the only declaration: FMU descriptions, C headers and documentation are generated from them.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from fmus.variables import POSITIVE, Terminal, file_parameter, input_, output, parameter
from plant_models.random_numbers import MAX_SEED
from plant_models.truck import parameters as p
from plant_models.truck.example_road import EXAMPLE

MAX_LENGTH = 100.0
"""Largest length of a part of the truck, in m."""


class Profile(IntEnum):
    """Profiles of the road."""

    iso8608 = 1
    bump = 2
    pothole = 3
    kerb = 4
    file = 5


class RoadClass(IntEnum):
    """Classes of roads in ISO 8608, from very good to very poor."""

    A = 1
    B = 2
    C = 3
    D = 4
    E = 5


_FORCE_BALANCE = ("seat_force", "cab.mass", "cab.pitch_inertia", "seat.position")
"""Variables on which the acceleration of the floor depends at rest; the road is flat at the start."""


@dataclass(slots=True)
class Inputs:
    """Inputs of the truck.

    Attributes
    ----------
    seat_force
        Force F of the seat on the cab floor beyond its static one, in N, up positive; held over a step.
    """

    seat_force: float = input_(
        "N", "Force F of the seat on the cab floor beyond the static one, up positive", nominal=100.0
    )


@dataclass(slots=True)
class Outputs:
    """Outputs of the truck, up positive, from static equilibrium on a flat road.

    Attributes
    ----------
    floor_displacement, floor_velocity, floor_acceleration
        Motion of the cab floor at the seat: z_v in m, z_v' in m/s, z_v'' in m/s2.
    road_elevation
        Elevation r_1 of the road under the front axle, in m.
    chassis_acceleration
        z_s'' at the chassis' centre of gravity, in m/s2.
    cab_pitch
        theta_c, in rad, nose down positive.
    front_tyre_force, rear_tyre_force
        Forces of the road on the axles beyond the static ones, in N.
    """

    floor_displacement: float = output("m", "Cab floor displacement z_v at the seat, up positive", nominal=0.01)
    floor_velocity: float = output("m/s", "Cab floor velocity at the seat", nominal=0.1)
    floor_acceleration: float = output(
        "m/s2", "Cab floor acceleration at the seat", nominal=1.0, dependencies=_FORCE_BALANCE
    )
    road_elevation: float = output("m", "Elevation of the road under the front axle", nominal=0.01)
    chassis_acceleration: float = output(
        "m/s2", "Vertical acceleration z_s'' of the chassis at its centre of gravity", nominal=1.0
    )
    cab_pitch: float = output("rad", "Pitch theta_c of the cab, nose down positive", nominal=0.01)
    front_tyre_force: float = output(
        "N", "Force of the road on the front axle beyond the static one, up positive", nominal=10_000.0
    )
    rear_tyre_force: float = output(
        "N", "Force of the road on the rear axle beyond the static one, up positive", nominal=10_000.0
    )


@dataclass(slots=True)
class Parameters:
    """Parameters of the truck: speed and road, cab, chassis, axles, seat.

    Stiffness and damping are those of both sides together. Each field states unit, range and source in its declaration.
    """

    speed: float = parameter(p.SPEED, "Speed of the truck", minimum=POSITIVE, maximum=100.0)
    road_profile: Profile = parameter(Profile.iso8608, "Profile of the road", name="road.profile")
    road_class: RoadClass = parameter(
        RoadClass.C,
        "Class of the random road in ISO 8608: Gd(0.1 cycle/m) = 16, 64, 256, 1024, 4096 cm3, waviness 2",
        name="road.class",
    )
    road_seed: int = parameter(
        1,
        "Seed of the random road: the same seed gives the same road",
        name="road.seed",
        minimum=0,
        maximum=MAX_SEED,
    )
    road_fade: float = parameter(
        p.ROAD_FADE,
        "Distance over which a random road or a road from a file rises from flat",
        name="road.fade",
        minimum=0.01,
        maximum=10_000.0,
    )
    road_file: str = file_parameter(
        EXAMPLE, "CSV file of the road: columns distance in m and elevation in m", name="road.file"
    )
    obstacle_height: float = parameter(
        p.OBSTACLE_HEIGHT,
        "Height of bump or kerb, depth of the pothole",
        name="obstacle.height",
        minimum=0.0,
        maximum=1.0,
    )
    obstacle_length: float = parameter(
        p.OBSTACLE_LENGTH,
        "Length of bump or pothole, of the ramp of the kerb",
        name="obstacle.length",
        minimum=0.01,
        maximum=1_000.0,
    )
    obstacle_position: float = parameter(
        p.OBSTACLE_POSITION,
        "Distance of the obstacle's begin ahead of the front axle at the start",
        name="obstacle.position",
        minimum=0.0,
        maximum=1_000_000.0,
    )
    cab_mass: float = parameter(p.CAB_MASS, "Mass of the cab", name="cab.mass", minimum=POSITIVE)
    cab_pitch_inertia: float = parameter(
        p.CAB_PITCH_INERTIA, "Pitch inertia of the cab", name="cab.pitch_inertia", minimum=POSITIVE
    )
    cab_position: float = parameter(
        p.CAB_POSITION,
        "Distance of the cab's centre of gravity behind the front axle",
        name="cab.position",
        minimum=-MAX_LENGTH,
        maximum=MAX_LENGTH,
    )
    cab_front_mount: float = parameter(
        p.CAB_FRONT_MOUNT,
        "Distance of the front mounts ahead of the cab's centre of gravity",
        name="cab.front_mount",
        minimum=0.0,
        maximum=MAX_LENGTH,
    )
    cab_rear_mount: float = parameter(
        p.CAB_REAR_MOUNT,
        "Distance of the rear mounts behind the cab's centre of gravity",
        name="cab.rear_mount",
        minimum=0.0,
        maximum=MAX_LENGTH,
    )
    cab_front_stiffness: float = parameter(
        p.CAB_FRONT_STIFFNESS, "Stiffness of the front cab mounts", name="cab.front_stiffness", minimum=0.0
    )
    cab_rear_stiffness: float = parameter(
        p.CAB_REAR_STIFFNESS, "Stiffness of the rear cab mounts", name="cab.rear_stiffness", minimum=0.0
    )
    cab_front_damping: float = parameter(
        p.CAB_FRONT_DAMPING, "Damping of the front cab mounts", name="cab.front_damping", minimum=0.0
    )
    cab_rear_damping: float = parameter(
        p.CAB_REAR_DAMPING, "Damping of the rear cab mounts", name="cab.rear_damping", minimum=0.0
    )
    chassis_mass: float = parameter(
        p.CHASSIS_MASS, "Mass of chassis, body and load, without cab and axles", name="chassis.mass", minimum=POSITIVE
    )
    chassis_pitch_inertia: float = parameter(
        p.CHASSIS_PITCH_INERTIA, "Pitch inertia of the chassis", name="chassis.pitch_inertia", minimum=POSITIVE
    )
    chassis_position: float = parameter(
        p.CHASSIS_POSITION,
        "Distance of the chassis' centre of gravity behind the front axle, up to the wheelbase",
        name="chassis.position",
        minimum=0.0,
        maximum=MAX_LENGTH,
    )
    wheelbase: float = parameter(
        p.WHEELBASE, "Distance of the axles", name="chassis.wheelbase", minimum=POSITIVE, maximum=MAX_LENGTH
    )
    front_stiffness: float = parameter(
        p.FRONT_STIFFNESS, "Stiffness of the front suspension", name="suspension.front_stiffness", minimum=0.0
    )
    rear_stiffness: float = parameter(
        p.REAR_STIFFNESS, "Stiffness of the rear suspension", name="suspension.rear_stiffness", minimum=0.0
    )
    front_damping: float = parameter(
        p.FRONT_DAMPING, "Damping of the front suspension", name="suspension.front_damping", minimum=0.0
    )
    rear_damping: float = parameter(
        p.REAR_DAMPING, "Damping of the rear suspension", name="suspension.rear_damping", minimum=0.0
    )
    front_axle_mass: float = parameter(
        p.FRONT_AXLE_MASS, "Unsprung mass of the front axle", name="axle.front_mass", minimum=POSITIVE
    )
    rear_axle_mass: float = parameter(
        p.REAR_AXLE_MASS, "Unsprung mass of the rear axle", name="axle.rear_mass", minimum=POSITIVE
    )
    front_tyre_stiffness: float = parameter(
        p.FRONT_TYRE_STIFFNESS, "Stiffness of the front tyres", name="tyre.front_stiffness", minimum=0.0
    )
    rear_tyre_stiffness: float = parameter(
        p.REAR_TYRE_STIFFNESS, "Stiffness of the rear tyres", name="tyre.rear_stiffness", minimum=0.0
    )
    seat_position: float = parameter(
        p.SEAT_POSITION,
        "Distance of the driver's seat ahead of the cab's centre of gravity",
        name="seat.position",
        minimum=-MAX_LENGTH,
        maximum=MAX_LENGTH,
    )


TERMINALS = (
    Terminal(
        "floor",
        "Motion of the cab floor at the seat",
        {"displacement": "floor_displacement", "velocity": "floor_velocity", "acceleration": "floor_acceleration"},
    ),
)
