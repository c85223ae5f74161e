"""The SeatController FMU's variables: the one declaration."""

from __future__ import annotations

from dataclasses import dataclass

from fmus.variables import POSITIVE, Terminal, constant, input_, output, parameter
from seat_controller_fmu import parameters as p


@dataclass(slots=True)
class Inputs:
    """The two cheap sensors."""

    seat_acceleration: float = input_("m/s2", "Measured seat acceleration Y_2 = z_s'', up positive", nominal=1.0)
    suspension_deflection: float = input_("m", "Measured suspension deflection delta = z_s - z_v", nominal=0.01)


@dataclass(slots=True)
class Outputs:
    """What the controller computed from its last sample."""

    force: float = output("N", "Force to the actuator u_sat (6), up positive", nominal=100.0, discrete=True)
    force_demand: float = output("N", "Force demand u (24), before saturation", nominal=100.0, discrete=True)
    motor_torque: float = output("N.m", "Motor torque T for the force (33)", nominal=1.0, discrete=True)
    disturbance_estimate: float = output("N", "Disturbance estimate F_hat (21)", nominal=100.0, discrete=True)
    deflection_rate: float = output("m/s", "Filtered rate v of the deflection", nominal=0.1, discrete=True)
    saturated: bool = output(None, "Whether the force is limited", discrete=True, start=False)


@dataclass(slots=True)
class Parameters:
    """Who sits on the seat, the gains, and what the controller knows about the seat."""

    driver_mass: float = parameter(
        p.DRIVER_MASS, "Driver mass the controller schedules on", tunable=True, minimum=20.0, maximum=250.0
    )
    anti_windup: bool = parameter(
        False, "Feed the observer the saturated force instead of the demand (not in the paper)", tunable=True
    )
    enabled: bool = parameter(True, "Whether the controller acts; if not, force and estimate are 0", tunable=True)
    force_limit: float = parameter(p.FORCE_LIMIT, "Force limit", tunable=True, minimum=0.0, maximum=1e9)
    observer_gamma: float = parameter(p.OBSERVERS[1], "Observer constant, below 0", maximum=-1e-15)
    L1: float = parameter(p.OBSERVER_GAIN, "Observer gain at M_min, 0: from observer_gamma", maximum=0.0)
    L2: float = parameter(p.OBSERVER_GAIN, "Observer gain at M_max, 0: from observer_gamma", maximum=0.0)
    rate_filter_cutoff: float = parameter(
        p.RATE_FILTER_CUTOFF, "Cut-off frequency of the deflection rate filter", minimum=0.1, maximum=250.0
    )
    seat_mass: float = parameter(p.SEAT_MASS, "Seat mass the controller assumes", minimum=POSITIVE)
    suspension_stiffness: float = parameter(
        p.SUSPENSION_STIFFNESS, "Suspension stiffness the controller assumes", minimum=POSITIVE
    )
    driver_mass_min: float = parameter(
        p.DRIVER_MASS_MIN, "Lightest driver the gains are made for", minimum=20.0, maximum=250.0
    )
    driver_mass_max: float = parameter(
        p.DRIVER_MASS_MAX, "Heaviest driver the gains are made for", minimum=20.0, maximum=250.0
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
    """What a host may want to read."""

    sample_time: float = constant(p.SAMPLE_TIME, "Sample time of the control law")


TERMINALS = (
    Terminal(
        "sensors",
        "What the seat's sensors report",
        {"acceleration": "seat_acceleration", "deflection": "suspension_deflection"},
    ),
    Terminal("actuator", "What the actuator is to do", {"force": "force"}),
)
