"""Variables of the SeatController FMU.

The dataclasses are the only declaration: FMU descriptions, C headers and documentation are generated from them.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from enum import IntEnum

from fmus.variables import POSITIVE, Terminal, constant, input_, output, parameter
from seat_controller_fmu import parameters as p

_later = functools.partial(parameter, added=True)

MAX_DELAY = 0.1
"""Longest delay of the actuator that the mode robust can follow, in s."""


class Mode(IntEnum):
    """Control laws that the controller can run."""

    published = 1
    robust = 2


class Estimator(IntEnum):
    """What the mode robust does with the estimates of friction and mass."""

    off = 1
    monitor = 2
    friction = 3
    friction_and_mass = 4


class Fault(IntEnum):
    """Faults that the mode robust detects and latches, those that leave the deflection trusted first.

    ``force_balance``: the sensors and the force contradict one another. See :mod:`seat_controller_fmu.faults`.
    """

    none = 1
    acceleration_invalid = 2
    acceleration_range = 3
    acceleration_frozen = 4
    acceleration_bias = 5
    force_balance = 6
    deflection_invalid = 7
    deflection_range = 8
    deflection_jump = 9
    deflection_frozen = 10


@dataclass(slots=True)
class Inputs:
    """Inputs of the controller: measurements of the two sensors.

    Attributes
    ----------
    seat_acceleration
        Y_2 = z_s'', in m/s2, up positive.
    suspension_deflection
        delta = z_s - z_v, in m.
    """

    seat_acceleration: float = input_("m/s2", "Measured seat acceleration Y_2 = z_s'', up positive", nominal=1.0)
    suspension_deflection: float = input_("m", "Measured suspension deflection delta = z_s - z_v", nominal=0.01)


@dataclass(slots=True)
class Outputs:
    """Outputs of the controller after its last sample.

    Attributes
    ----------
    force, force_demand
        u_sat (6) and u (24), in N, up positive.
    motor_torque
        T (33), in N.m.
    disturbance_estimate
        F_hat (21), in N.
    deflection_rate
        Filtered rate v of the deflection, in m/s.
    saturated
        Whether the force is limited.
    fault
        Fault latched by the mode robust.
    driver_mass_estimate, friction_estimate
        m_b in kg and F_r in N, estimated by the mode robust.
    driver_mass_trusted, friction_trusted
        Whether the samples since the start carry enough information about them.
    """

    force: float = output("N", "Force to the actuator u_sat (6), up positive", nominal=100.0, discrete=True)
    force_demand: float = output("N", "Force demand u (24), before saturation", nominal=100.0, discrete=True)
    motor_torque: float = output("N.m", "Motor torque T for the force (33)", nominal=1.0, discrete=True)
    disturbance_estimate: float = output("N", "Disturbance estimate F_hat (21)", nominal=100.0, discrete=True)
    deflection_rate: float = output("m/s", "Filtered rate v of the deflection", nominal=0.1, discrete=True)
    saturated: bool = output(None, "Whether the force is limited", discrete=True, start=False)
    fault: Fault = output(
        None,
        "Fault that mode robust has latched; enabled = false clears it",
        discrete=True,
        start=Fault.none,
        added=True,
    )
    driver_mass_estimate: float = output(
        "kg",
        "Driver mass as mode robust estimates it; the parameter without estimate",
        nominal=70.0,
        discrete=True,
        dependencies=["driver_mass"],
        added=True,
    )
    friction_estimate: float = output(
        "N",
        "Friction of the suspension as mode robust estimates it; the parameter without estimate",
        nominal=75.0,
        discrete=True,
        dependencies=["robust.friction"],
        added=True,
    )
    driver_mass_trusted: bool = output(
        None, "Whether enough is known for driver_mass_estimate", discrete=True, start=False, added=True
    )
    friction_trusted: bool = output(
        None, "Whether enough is known for friction_estimate", discrete=True, start=False, added=True
    )


@dataclass(slots=True)
class Parameters:
    """Parameters of the controller: driver's mass, gains, and its nominal model of the seat.

    Each field states unit, range and source in its declaration.
    """

    driver_mass: float = parameter(
        p.DRIVER_MASS, "Driver mass for the scheduling of the gains", tunable=True, minimum=20.0, maximum=250.0
    )
    anti_windup: bool = parameter(
        False, "Feed the observer the saturated force instead of the demand (not in the paper)", tunable=True
    )
    enabled: bool = parameter(
        True, "Whether the controller is active; otherwise force and estimate are 0", tunable=True
    )
    force_limit: float = parameter(p.FORCE_LIMIT, "Force limit", tunable=True, minimum=0.0, maximum=1e9)
    observer_gamma: float = parameter(p.OBSERVERS[1], "Observer constant, below 0", maximum=-1e-15)
    L1: float = parameter(p.OBSERVER_GAIN, "Observer gain at M_min, 0: from observer_gamma", maximum=0.0)
    L2: float = parameter(p.OBSERVER_GAIN, "Observer gain at M_max, 0: from observer_gamma", maximum=0.0)
    rate_filter_cutoff: float = parameter(
        p.RATE_FILTER_CUTOFF, "Cut-off frequency of the deflection rate filter", minimum=0.1, maximum=250.0
    )
    seat_mass: float = parameter(p.SEAT_MASS, "Seat mass in the nominal model", minimum=POSITIVE)
    suspension_stiffness: float = parameter(
        p.SUSPENSION_STIFFNESS, "Suspension stiffness in the nominal model", minimum=POSITIVE
    )
    driver_mass_min: float = parameter(
        p.DRIVER_MASS_MIN, "Lightest driver in the range of the gains", minimum=20.0, maximum=250.0
    )
    driver_mass_max: float = parameter(
        p.DRIVER_MASS_MAX, "Heaviest driver in the range of the gains", minimum=20.0, maximum=250.0
    )
    K1_deflection: float = parameter(p.K_1_DEFLECTION, "Gain on the deflection at M_min", name="K1.deflection")
    K1_rate: float = parameter(p.K_1_RATE, "Gain on the deflection rate at M_min", name="K1.rate")
    K2_deflection: float = parameter(p.K_2_DEFLECTION, "Gain on the deflection at M_max", name="K2.deflection")
    K2_rate: float = parameter(p.K_2_RATE, "Gain on the deflection rate at M_max", name="K2.rate")
    link_length: float = parameter(p.LINK_LENGTH, "Scissor link length", minimum=POSITIVE)
    initial_height: float = parameter(p.INITIAL_HEIGHT, "Hinge height at zero deflection", minimum=POSITIVE)
    gear_ratio: float = parameter(p.GEAR_RATIO, "Gear ratio from motor to link", minimum=POSITIVE)
    mode: Mode = _later(Mode.published, "Control law: the paper's, or one with the same sensors for real seats")
    actuator_time_constant: float = _later(
        p.ACTUATOR_TIME_CONSTANT, "Time constant of the actuator's lag, mode robust", minimum=0.0, maximum=0.2
    )
    actuator_delay: float = _later(
        p.ACTUATOR_DELAY, "Delay of the actuator, rounded to samples, mode robust", minimum=0.0, maximum=MAX_DELAY
    )
    travel: float = _later(
        p.TRAVEL, "Deflection in either direction that is free, 0: not known, mode robust", minimum=0.0, maximum=1.0
    )
    robust_estimator: Estimator = _later(
        Estimator.friction_and_mass,
        "Estimates of friction and mass, and what the law uses of them",
        name="robust.estimator",
    )
    robust_cushion_stiffness: float = _later(
        p.CUSHION_STIFFNESS, "Cushion stiffness in the model", name="robust.cushion_stiffness", minimum=POSITIVE
    )
    robust_cushion_damping: float = _later(
        p.CUSHION_DAMPING, "Cushion damping in the model", name="robust.cushion_damping", minimum=0.0
    )
    robust_observer_rate: float = _later(
        p.OBSERVER_RATE, "Rate of the disturbance observer", name="robust.observer_rate", minimum=1.0, maximum=500.0
    )
    robust_motion_bandwidth: float = _later(
        p.MOTION_BANDWIDTH, "Corner of the motion observer", name="robust.motion_bandwidth", minimum=1.0, maximum=60.0
    )
    robust_friction: float = _later(
        p.FRICTION, "Friction of the suspension, before it is estimated", name="robust.friction", minimum=0.0
    )
    robust_friction_share: float = _later(
        p.FRICTION_SHARE, "Share of the friction fed forward", name="robust.friction_share", minimum=0.0, maximum=1.5
    )
    robust_friction_rate: float = _later(
        p.FRICTION_RATE,
        "Rate at which it is fed forward in full",
        name="robust.friction_rate",
        minimum=1e-4,
        maximum=1.0,
    )
    robust_centring_frequency: float = _later(
        p.CENTRING_FREQUENCY,
        "Frequency of the return to centre",
        name="robust.centring_frequency",
        minimum=0.02,
        maximum=2.0,
    )
    robust_centring_damping: float = _later(
        p.CENTRING_DAMPING,
        "Damping ratio of the return to centre",
        name="robust.centring_damping",
        minimum=0.1,
        maximum=5.0,
    )
    robust_centring_filter: float = _later(
        p.CENTRING_FILTER,
        "Corner of the deflection's low-pass in it",
        name="robust.centring_filter",
        minimum=0.1,
        maximum=50.0,
    )
    robust_bias_rate: float = _later(
        p.BIAS_RATE, "Rate of the integral that finds the bias", name="robust.bias_rate", minimum=0.0, maximum=100.0
    )
    robust_follow_begin: float = _later(
        p.FOLLOW_BEGIN,
        "Envelope over travel at which the seat begins to follow",
        name="robust.follow_begin",
        minimum=0.0,
        maximum=10.0,
    )
    robust_follow_slope: float = _later(
        p.FOLLOW_SLOPE,
        "Slope of the follow term over envelope over travel",
        name="robust.follow_slope",
        minimum=0.0,
        maximum=10.0,
    )
    robust_follow_max: float = _later(
        p.FOLLOW_MAX, "Largest follow term", name="robust.follow_max", minimum=0.0, maximum=5.0
    )
    robust_envelope_frequency: float = _later(
        p.ENVELOPE_FREQUENCY,
        "Frequency at which the envelope takes rates for deflections",
        name="robust.envelope_frequency",
        minimum=0.1,
        maximum=50.0,
    )
    robust_envelope_decay: float = _later(
        p.ENVELOPE_DECAY, "Rate of the envelope's decay", name="robust.envelope_decay", minimum=0.0, maximum=100.0
    )
    robust_overload_begin: float = _later(
        p.OVERLOAD_BEGIN,
        "Envelope over travel at which a damper begins to take over",
        name="robust.overload_begin",
        minimum=0.0,
        maximum=100.0,
    )
    robust_overload_end: float = _later(
        p.OVERLOAD_END,
        "Envelope over travel at which it has taken over",
        name="robust.overload_end",
        minimum=0.0,
        maximum=100.0,
    )
    robust_overload_damping: float = _later(
        p.OVERLOAD_DAMPING, "That damper", name="robust.overload_damping", minimum=0.0, maximum=1e5
    )
    robust_safe_damping: float = _later(
        p.SAFE_DAMPING, "Damper of the safe state", name="robust.safe_damping", minimum=0.0, maximum=1e5
    )
    robust_ramp_time: float = _later(
        p.RAMP_TIME,
        "Time in which the force rises and falls with enabled",
        name="robust.ramp_time",
        minimum=0.002,
        maximum=100.0,
    )
    robust_acceleration_range: float = _later(
        p.ACCELERATION_RANGE, "Range of the accelerometer", name="robust.acceleration_range", minimum=1.0, maximum=1e4
    )
    robust_deflection_range: float = _later(
        p.DEFLECTION_RANGE, "Range of the deflection sensor", name="robust.deflection_range", minimum=1e-3, maximum=10.0
    )


@dataclass(slots=True)
class Constants:
    """Constants that a host can read.

    Attributes
    ----------
    sample_time
        h, in s.
    """

    sample_time: float = constant(p.SAMPLE_TIME, "Sample time of the control law")


TERMINALS = (
    Terminal(
        "sensors",
        "Measurements of the seat's sensors",
        {"acceleration": "seat_acceleration", "deflection": "suspension_deflection"},
    ),
    Terminal("actuator", "Force demand to the actuator", {"force": "force"}),
)
