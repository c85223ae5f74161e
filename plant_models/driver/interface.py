"""Variables of the SeatedDriver FMU.

The dataclasses are the only declaration: FMU descriptions, C headers and documentation are generated from them.
"""

from __future__ import annotations

from dataclasses import dataclass

from fmus.variables import Terminal, input_, output, parameter
from plant_models.driver import parameters as p


@dataclass(slots=True)
class Inputs:
    """Motion of the seat at the contact, up positive.

    Attributes
    ----------
    seat_displacement, seat_velocity, seat_acceleration
        z_s in m, z_s' in m/s, z_s'' in m/s2.
    """

    seat_displacement: float = input_("m", "Displacement z_s of the seat under the driver, up positive", nominal=0.01)
    seat_velocity: float = input_("m/s", "Velocity of the seat", nominal=0.1)
    seat_acceleration: float = input_(
        "m/s2", "Acceleration of the seat, without gravity; 0 holds the velocity over a step", nominal=1.0
    )


@dataclass(slots=True)
class Outputs:
    """Outputs of the driver, up positive.

    Attributes
    ----------
    contact_force
        Force of the driver on the seat, in N, without static weight.
    driver_acceleration, head_acceleration
        Of pelvis and thighs, and of head and neck, in m/s2, without gravity.
    driver_displacement, head_displacement
        Of the same two, in m.
    """

    contact_force: float = output(
        "N", "Force of the driver on the seat, up positive, without static weight", nominal=100.0
    )
    driver_acceleration: float = output("m/s2", "Acceleration of pelvis and thighs, without gravity", nominal=1.0)
    head_acceleration: float = output("m/s2", "Acceleration of head and neck, without gravity", nominal=1.0)
    driver_displacement: float = output(
        "m", "Displacement of pelvis and thighs", nominal=0.01, dependencies=["seat_displacement"]
    )
    head_displacement: float = output(
        "m", "Displacement of head and neck", nominal=0.01, dependencies=["seat_displacement"]
    )


@dataclass(slots=True)
class Parameters:
    """Parameters of the driver.

    Each field states unit, range and source in its declaration.
    """

    driver_mass: float = parameter(
        p.DRIVER_MASS, "Driver mass on the seat, which scales the published body", minimum=20.0, maximum=250.0
    )
    contact_stiffness: float = parameter(
        p.CONTACT_STIFFNESS, "Stiffness of the contact at 55.2 kg, softer on a cushion", minimum=0.0
    )
    contact_damping: float = parameter(
        p.CONTACT_DAMPING, "Damping of the contact at 55.2 kg, smaller on a cushion", minimum=0.0
    )


TERMINALS = (
    Terminal(
        "driver",
        "The contact with the seat",
        {
            "displacement": "seat_displacement",
            "velocity": "seat_velocity",
            "acceleration": "seat_acceleration",
            "force": "contact_force",
        },
    ),
)
