"""Variables of the SeatController FMU.

The dataclasses are the only declaration: FMU descriptions, C headers and documentation are generated from them.
"""

from __future__ import annotations

from dataclasses import dataclass

from fmus.variables import POSITIVE, Terminal, constant, input_, output, parameter
from seat_controller_fmu import parameters as p


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
    """

    force: float = output("N", "Force to the actuator u_sat (6), up positive", nominal=100.0, discrete=True)
    force_demand: float = output("N", "Force demand u (24), before saturation", nominal=100.0, discrete=True)
    motor_torque: float = output("N.m", "Motor torque T for the force (33)", nominal=1.0, discrete=True)
    disturbance_estimate: float = output("N", "Disturbance estimate F_hat (21)", nominal=100.0, discrete=True)
    deflection_rate: float = output("m/s", "Filtered rate v of the deflection", nominal=0.1, discrete=True)
    saturated: bool = output(None, "Whether the force is limited", discrete=True, start=False)


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
