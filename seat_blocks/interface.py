"""Variables of ActiveSeat, PassiveSeat and SemiActiveSeat.

What their parts declare is taken over; only what a block has beside its parts is declared here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fmus.variables import Terminal, group, output, parameter, same_as, variables_of
from plant_models.seat import interface as seat
from seat_blocks import parameters as p
from seat_controller_fmu import interface as controller

_FLOOR = ("floor_displacement", "floor_velocity", "floor_acceleration")

_NOT_IN_BLOCKS = ("force", "actuator.force_limit", "driver_force", "driver.model")
"""Forces that a block has not, or that are zero at the start, and what decides on them."""


def _of_seat(name: str) -> Any:
    """Declare an output of the seat; at the start no force acts on it, and nothing depends on one."""
    (declared,) = [variable for variable in variables_of(seat.Outputs) if variable.field == name]
    knowns = [known for known in declared.dependencies if known not in _NOT_IN_BLOCKS]
    return same_as(seat.Outputs, name, dependencies=[known if known in _FLOOR else f"seat.{known}" for known in knowns])


@dataclass(slots=True)
class Inputs:
    """Inputs of all blocks: the motion of the cabin floor.

    Attributes
    ----------
    floor_displacement, floor_velocity, floor_acceleration
        z_v in m, z_v' in m/s, z_v'' in m/s2, up positive.
    """

    floor_displacement: float = same_as(seat.Inputs, "floor_displacement")
    floor_velocity: float = same_as(seat.Inputs, "floor_velocity")
    floor_acceleration: float = same_as(seat.Inputs, "floor_acceleration")


@dataclass(slots=True)
class SeatSignals:
    """Outputs that all blocks have, see :class:`plant_models.seat.interface.Outputs`.

    Attributes
    ----------
    driver_acceleration, seat_acceleration
        z_b'' and z_s'', in m/s2, up positive, without gravity.
    suspension_deflection, deflection_rate
        z_s - z_v in m and its rate in m/s.
    floor_force
        Force of the seat on the cabin floor, in N, without static weight.
    seat_displacement, driver_displacement
        z_s and z_b, in m, from static equilibrium.
    friction_force
        f_r (35), in N; acts on the seat as -f_r.
    head_acceleration
        Of the driver's head, in m/s2; that of the driver where it is one mass.
    """

    driver_acceleration: float = _of_seat("driver_acceleration")
    seat_acceleration: float = _of_seat("seat_acceleration")
    suspension_deflection: float = _of_seat("suspension_deflection")
    floor_force: float = _of_seat("floor_force")
    deflection_rate: float = _of_seat("deflection_rate")
    seat_displacement: float = _of_seat("seat_displacement")
    driver_displacement: float = _of_seat("driver_displacement")
    friction_force: float = _of_seat("friction_force")
    head_acceleration: float = _of_seat("head_acceleration")


@dataclass(slots=True)
class Measurements:
    """Outputs of the blocks that measure, see :class:`plant_models.seat.interface.Outputs`.

    Attributes
    ----------
    seat_acceleration_measured, suspension_deflection_measured
        Measurements of the two sensors, in m/s2 and m: what the law takes next.
    """

    seat_acceleration_measured: float = _of_seat("seat_acceleration_measured")
    suspension_deflection_measured: float = _of_seat("suspension_deflection_measured")


def measurements(outputs: seat.Outputs) -> Measurements:
    """Return the measurements of a block's seat.

    Parameters
    ----------
    outputs
        Outputs of the seat.

    Returns
    -------
    Measurements
        The same values.
    """
    return Measurements(outputs.seat_acceleration_measured, outputs.suspension_deflection_measured)


def seat_signals(outputs: seat.Outputs) -> SeatSignals:
    """Return what a block gives of the outputs of its seat.

    Parameters
    ----------
    outputs
        Outputs of the seat.

    Returns
    -------
    SeatSignals
        The same values.
    """
    return SeatSignals(
        outputs.driver_acceleration,
        outputs.seat_acceleration,
        outputs.suspension_deflection,
        outputs.floor_force,
        outputs.deflection_rate,
        outputs.seat_displacement,
        outputs.driver_displacement,
        outputs.friction_force,
        outputs.head_acceleration,
    )


def seat_inputs(inputs: Inputs) -> seat.Inputs:
    """Return the inputs of a seat without a force of an actuator or of an external driver.

    Parameters
    ----------
    inputs
        Inputs of a block.

    Returns
    -------
    plant_models.seat.interface.Inputs
        The same floor.
    """
    return seat.Inputs(inputs.floor_displacement, inputs.floor_velocity, inputs.floor_acceleration)


FLOOR = next(terminal for terminal in seat.TERMINALS if terminal.name == "floor")
REACTION = Terminal("reaction", "Reaction on the cabin floor", {"force": "floor_force"})

_ACTUATOR = ("actuator_force_limit", "actuator_delay", "actuator_time_constant")
_SENSORS = (
    "sensor_bandwidth",
    "acceleration_noise",
    "acceleration_bias",
    "acceleration_resolution",
    "deflection_noise",
    "deflection_bias",
    "deflection_resolution",
    "sensor_seed",
)


# ---- active ----------------------------------------------------------------------------------------------------------


@dataclass(slots=True)
class ActiveOutputs:
    """Outputs of ActiveSeat, from both parts.

    Attributes
    ----------
    seat
        Those that all blocks have.
    measured
        Measurements of the seat.
    controller
        Those of the controller after its last sample; the rate of the deflection is that of the seat.
    """

    seat: SeatSignals = group(SeatSignals)
    measured: Measurements = group(Measurements)
    controller: controller.Outputs = group(
        controller.Outputs,
        without=["deflection_rate"],
        dependencies={
            "driver_mass": ["controller.driver_mass", "seat.driver_mass"],
            "robust.friction": ["controller.robust.friction"],
        },
    )


@dataclass(slots=True)
class ActiveParameters:
    """Parameters of ActiveSeat, those of both parts behind a prefix.

    Attributes
    ----------
    inner_step_size
        Longest time between two exchanges of controller and seat, in s; 0 for one in each communication step.
    controller
        Parameters of the controller. What it knows of driver, actuator and stops is that of the seat where it is 0.
    seat
        Parameters of the seat.
    """

    inner_step_size: float = parameter(
        p.INNER_STEP_SIZE, "Longest time between exchanges of controller and seat", minimum=0.0, maximum=1.0
    )
    controller: controller.Parameters = group(
        controller.Parameters,
        "controller",
        starts={
            "driver_mass": p.KNOWN_MASS,
            "actuator_time_constant": p.KNOWN_TIME_CONSTANT,
            "actuator_delay": p.KNOWN_DELAY,
            "travel": p.KNOWN_TRAVEL,
        },
        minimums={"driver_mass": 0.0},
    )
    seat: seat.Parameters = group(seat.Parameters, "seat")


@dataclass(slots=True)
class ActiveConstants:
    """Constants of ActiveSeat that a host can read.

    Attributes
    ----------
    controller
        Those of the controller.
    """

    controller: controller.Constants = group(controller.Constants, "controller")


# ---- passive ---------------------------------------------------------------------------------------------------------


@dataclass(slots=True)
class PassiveOutputs:
    """Outputs of PassiveSeat, under the names of ActiveSeat.

    Attributes
    ----------
    seat
        Those that all blocks have.
    force
        Force of an actuator, which there is none of: 0 N.
    """

    seat: SeatSignals = group(SeatSignals)
    force: float = output("N", "Force of an actuator: always 0, there is none", nominal=100.0)


@dataclass(slots=True)
class PassiveParameters:
    """Parameters of PassiveSeat, those of the seat behind a prefix.

    Attributes
    ----------
    seat
        Parameters of the seat, with the damping and the friction of a passive one; no actuator, no sensors.
    """

    seat: seat.Parameters = group(
        seat.Parameters,
        "seat",
        without=[*_ACTUATOR, *_SENSORS],
        starts={"suspension_damping": p.PASSIVE_DAMPING, "friction_alpha": p.PASSIVE_FRICTION},
    )


# ---- semi-active -----------------------------------------------------------------------------------------------------


_DAMPED = {"seat.suspension_damping": ["damper.minimum"]}
"""The damper at the start is open."""


@dataclass(slots=True)
class SemiActiveOutputs:
    """Outputs of SemiActiveSeat, from seat and damper.

    Attributes
    ----------
    seat
        Those that all blocks have.
    measured
        Measurements of the seat.
    force
        Force of the damper on the seat, -c (z_s' - z_v'), in N, up positive.
    damping
        Coefficient c of the damper, in N.s/m.
    velocity_estimate
        Velocity of the seat as the law estimates it, in m/s.
    """

    seat: SeatSignals = group(SeatSignals, dependencies=_DAMPED)
    measured: Measurements = group(Measurements, dependencies=_DAMPED)
    force: float = output(
        "N",
        "Force of the damper on the seat, up positive",
        nominal=100.0,
        dependencies=["floor_velocity", "damper.minimum"],
    )
    damping: float = output("N.s/m", "Coefficient c of the damper", nominal=1000.0, dependencies=["damper.minimum"])
    velocity_estimate: float = output("m/s", "Velocity of the seat as the law estimates it", nominal=0.1)


@dataclass(slots=True)
class DamperParameters:
    """Parameters of the damper and its law.

    Each field states unit, range and source in its declaration.
    """

    minimum: float = parameter(p.MINIMUM_DAMPING, "Least damping", minimum=0.0, maximum=1e5)
    maximum: float = parameter(p.MAXIMUM_DAMPING, "Greatest damping", minimum=0.0, maximum=1e5)
    skyhook: float = parameter(
        p.SKYHOOK_DAMPING, "Damping between seat and inertial frame that the law imitates", minimum=0.0, maximum=1e6
    )
    time_constant: float = parameter(
        p.DAMPER_TIME_CONSTANT, "Time constant of the damper's first-order lag", minimum=0.0, maximum=10.0
    )
    velocity_corner: float = parameter(
        p.VELOCITY_CORNER, "Corner of the leaky integrator of the acceleration", minimum=0.0, maximum=50.0
    )
    rate_filter_cutoff: float = parameter(
        p.RATE_CUTOFF, "Cut-off frequency of the deflection rate filter", minimum=0.1, maximum=250.0
    )


@dataclass(slots=True)
class SemiActiveParameters:
    """Parameters of SemiActiveSeat, of seat and damper.

    Attributes
    ----------
    damper
        Parameters of the damper and its law.
    seat
        Parameters of the seat, with the friction of a passive one; no other damper, no actuator.
    """

    damper: DamperParameters = group(DamperParameters, "damper")
    seat: seat.Parameters = group(
        seat.Parameters,
        "seat",
        without=["suspension_damping", *_ACTUATOR],
        starts={"friction_alpha": p.PASSIVE_FRICTION},
    )


@dataclass(slots=True)
class SemiActiveConstants:
    """Constants of SemiActiveSeat that a host can read.

    Attributes
    ----------
    sample_time
        Sample time of the law, in s.
    """

    sample_time: float = same_as(controller.Constants, "sample_time")
