"""The nominal seat, for which gains are designed and certified: the plant's default parameters, with any driver."""

from __future__ import annotations

from plant_models.seat import friction
from plant_models.seat.interface import Parameters


def nominal_seat(driver_mass: float) -> Parameters:
    """Return the seat's default parameters, with a driver's mass in kg."""
    return Parameters(driver_mass=driver_mass)


def friction_force() -> float:
    """Return the plateau of the nominal seat's friction force (35)-(36), in N."""
    seat = Parameters()
    return (
        seat.friction_alpha * friction.prepare(seat.friction_gamma, seat.friction_beta, seat.friction_amplitude).plateau
    )
