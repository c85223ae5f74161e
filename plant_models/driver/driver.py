"""The seated driver on a seat whose motion is given: the body of :mod:`plant_models.driver.body` as a component.

Over a step the seat is extrapolated by its velocity and acceleration, as the seat does with the floor. The driver
starts unstrained on the seat and moves with it.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from fmus.component import Component, ParameterError
from plant_models import runge_kutta
from plant_models.driver import body as bodies
from plant_models.driver.body import Body
from plant_models.driver.interface import TERMINALS, Inputs, Outputs, Parameters
from plant_models.motion import Motion
from plant_models.runge_kutta import Numbers


class State(NamedTuple):
    """State of the driver: pelvis and thighs, lower torso, chest and upper torso, head and neck.

    Attributes
    ----------
    displacements
        In m, up positive.
    velocities
        In m/s.
    """

    displacements: Annotated[tuple[float, ...], 4]
    velocities: Annotated[tuple[float, ...], 4]


class Coefficients(NamedTuple):
    """Coefficients of the step.

    Attributes
    ----------
    body
        Of the body.
    substep
        Longest Runge-Kutta substep, in s.
    """

    body: Body
    substep: float


def prepare(parameters: Parameters) -> Coefficients:
    """Derive the coefficients of the step.

    Parameters
    ----------
    parameters
        Parameters of the driver, each within its range.

    Returns
    -------
    Coefficients
        For :func:`initialize` and :func:`advance`.

    Raises
    ------
    ParameterError
        If the contact is so stiff that a step would take too long.
    """
    p = parameters
    body = bodies.prepare(p.driver_mass, p.contact_stiffness, p.contact_damping)
    fastest = bodies.fastest(body)
    substep = runge_kutta.max_substep(fastest)
    if not substep >= runge_kutta.MIN_SUBSTEP:
        limit = 1.0 / (runge_kutta.SUBSTEPS_PER_RADIAN * runge_kutta.MIN_SUBSTEP)
        raise ParameterError(
            f"driver: expected a fastest motion below {limit:g} rad/s, got {fastest:g} rad/s from contact_stiffness = "
            f"{p.contact_stiffness:g} N/m, contact_damping = {p.contact_damping:g} N.s/m"
        )
    return Coefficients(body, substep)


def _contact(z: Numbers, v: Numbers, seat: Motion, tau: float, body: Body) -> float:
    """Return the force on the seat in N, ``tau`` seconds after the begin of the step."""
    return bodies.contact_force(z[0] - seat.displacement_at(tau), v[0] - seat.velocity_at(tau), body)


def _evaluate_outputs(state: State, seat: Motion, tau: float, body: Body) -> Outputs:
    """Evaluate the outputs ``tau`` seconds after the begin of the step."""
    z, v = state
    contact = _contact(z, v, seat, tau, body)
    a = bodies.accelerations(z, v, contact, body)
    return Outputs(contact, a[0], a[3], z[0], z[3])


def initialize(inputs: Inputs, coefficients: Coefficients, time: float) -> tuple[State, Outputs]:
    """Return the state of a driver who sits unstrained on the seat and moves with it.

    Parameters
    ----------
    inputs
        Motion of the seat at the start.
    coefficients
        Coefficients from :func:`prepare`.
    time
        Not used.

    Returns
    -------
    state : State
        At the start.
    outputs : Outputs
        At the start.
    """
    seat = Motion(inputs.seat_displacement, inputs.seat_velocity, inputs.seat_acceleration)
    state = State((seat.displacement,) * 4, (seat.velocity,) * 4)
    return state, _evaluate_outputs(state, seat, 0.0, coefficients.body)


def advance(
    state: State, inputs: Inputs, coefficients: Coefficients, time: float, step_size: float
) -> tuple[State, Outputs]:
    """Integrate the equations of the body over one communication step.

    Parameters
    ----------
    state
        State at the begin of the step.
    inputs
        Motion of the seat at the begin of the step, extrapolated over it.
    coefficients
        Coefficients from :func:`prepare`.
    time
        Not used.
    step_size
        Communication step size, in s.

    Returns
    -------
    state : State
        At the end of the step.
    outputs : Outputs
        At the end of the step, with the extrapolated seat.
    """
    body = coefficients.body
    seat = Motion(inputs.seat_displacement, inputs.seat_velocity, inputs.seat_acceleration)
    count = runge_kutta.substep_count(step_size, coefficients.substep)
    h = step_size / count
    z, v = state
    for index in range(count):
        tau = index * h

        def slope(z: Numbers, v: Numbers, share: float, tau: float = tau) -> Numbers:
            return bodies.accelerations(z, v, _contact(z, v, seat, tau + share * h, body), body)

        z, v = runge_kutta.step(z, v, h, slope)
    state = State(z, v)
    return state, _evaluate_outputs(state, seat, step_size, body)


SEATED_DRIVER = Component(
    name="SeatedDriver",
    description="Seated driver as a body of four masses (Boileau and Rakheja 1998) on a seat with a given motion",
    module=__name__,
    inputs=Inputs,
    outputs=Outputs,
    parameters=Parameters,
    state=State,
    prepare=prepare,
    initialize=initialize,
    advance=advance,
    terminals=TERMINALS,
)
