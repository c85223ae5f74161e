"""The nominal seat, for which gains are designed and certified: the plant's default parameters, with any driver."""

from __future__ import annotations

from plant_models.driver import body as bodies
from plant_models.seat import friction
from plant_models.seat.interface import Parameters
from seat_controller_fmu.design.sampled_loop import DriverBody


def nominal_seat(driver_mass: float) -> Parameters:
    """Return the seat's default parameters, with a driver's mass in kg."""
    return Parameters(driver_mass=driver_mass)


def seated_body(driver_mass: float) -> DriverBody:
    """Return the seated driver of the seat's default parameters, with a driver's mass in kg."""
    seat = nominal_seat(driver_mass)
    body = bodies.prepare(driver_mass, seat.contact_stiffness, seat.contact_damping)
    return DriverBody(body.masses, body.k, body.c)


def friction_force() -> float:
    """Return the plateau of the nominal seat's friction force (35)-(36), in N."""
    seat = Parameters()
    return (
        seat.friction_alpha * friction.prepare(seat.friction_gamma, seat.friction_beta, seat.friction_amplitude).plateau
    )
