"""The seat: two masses on a suspension with Bouc-Wen friction (1)-(2), (35)-(36).

    m_s z_s'' = -k_f (z_s - z_v) - c_f (z_s' - z_v') + k_c (z_b - z_s) + c_c (z_b' - z_s') - f_r + u_sat        (1)
    m_b z_b'' = -k_c (z_b - z_s) - c_c (z_b' - z_s')                                                            (2)

with c_f = 0 for the active prototype, whose damper is removed. Displacements are absolute, from static equilibrium, up
positive.

Over a step the actuator's force is held and the floor is extrapolated by its velocity and acceleration, so that the
floor jumps a little (by its jerk times h^3/6) when the next step brings its true position. The friction follows the
deflection within a step only: let it follow the jumps as well, and each would unload it for an instant, which is up to
nine times the error in the driver's acceleration (measured on the paper's bump, Observer 1). A floor that is derived
from one signal does not jump, see :mod:`plant_models.floor`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from fmus.component import Component, ParameterError, flushed
from plant_models.floor import Floor, History, derived, given
from plant_models.friction import BoucWen, bouc_wen, friction_state
from plant_models.seat_interface import TERMINALS, FloorSignals, Inputs, Outputs, Parameters

LONGEST_SUBSTEP = 0.5e-3
"""Upper bound of the Runge-Kutta substep, in s: a quarter of the 2 ms sample."""

SUBSTEPS_PER_RADIAN = 2.0
"""Substeps per radian of the fastest motion; explicit RK4 is stable down to 0.36 and within 1e-4 of exact at 2."""

SHORTEST_SUBSTEP = 1e-5
"""Parameters that would need a substep below this, in s, are refused: a step would take too long."""


class Masses(NamedTuple):
    """What moves: two masses and the friction between them and the floor.

    Attributes
    ----------
    seat_displacement, driver_displacement
        z_s and z_b, in m.
    seat_velocity, driver_velocity
        z_s' and z_b', in m/s.
    friction
        z_d of (36), in m.
    """

    seat_displacement: float
    seat_velocity: float
    driver_displacement: float
    driver_velocity: float
    friction: float


class State(NamedTuple):
    """State of the seat: the fields of :class:`Masses`, then those of :class:`~plant_models.floor.History`."""

    seat_displacement: float
    seat_velocity: float
    driver_displacement: float
    driver_velocity: float
    friction: float
    floor_displacement: float = 0.0
    floor_velocity: float = 0.0
    floor_acceleration: float = 0.0
    floor_age: float = 0.0
    floor_interval: float = 0.0
    floor_reached: float = 0.0

    @property
    def masses(self) -> Masses:
        """What moves."""
        return Masses(*self[:5])

    @property
    def history(self) -> History:
        """What a derived floor remembers."""
        return History(*self[5:])


class Coefficients(NamedTuple):
    """Parameters as the step needs them, in the symbols of (1), (2) and (35); ``per_m_s`` is 1/m_s."""

    per_m_s: float
    per_m_b: float
    k_f: float
    c_f: float
    k_c: float
    c_c: float
    alpha: float
    friction: BoucWen
    substep: float
    floor_signals: int


def prepare(parameters: Parameters) -> Coefficients:
    """Derive the step's coefficients.

    Raises
    ------
    ParameterError
        If the friction has no plateau, or the seat is so stiff that a step would take too long.
    """
    p = parameters
    friction = bouc_wen(p.friction_gamma, p.friction_beta, p.friction_amplitude)
    # the steepest friction can get: unloading at the plateau, d zeta/dy = A 2 gamma/(gamma + beta)
    slope = 2.0 * p.friction_amplitude * p.friction_gamma / (p.friction_gamma + p.friction_beta)
    stiffness = p.suspension_stiffness + p.cushion_stiffness + p.friction_alpha * slope
    damping = p.suspension_damping + p.cushion_damping
    lightest = min(p.seat_mass, p.driver_mass)
    fastest = math.sqrt(stiffness / lightest) + damping / lightest
    substep = min(LONGEST_SUBSTEP, 1.0 / (SUBSTEPS_PER_RADIAN * fastest)) if fastest > 0.0 else LONGEST_SUBSTEP
    if not substep >= SHORTEST_SUBSTEP:
        raise ParameterError(
            f"seat: expected a fastest motion below {1.0 / (SUBSTEPS_PER_RADIAN * SHORTEST_SUBSTEP):g} rad/s, "
            f"got {fastest:g} rad/s from stiffness {stiffness:g} N/m and damping {damping:g} N.s/m on {lightest:g} kg"
        )
    return Coefficients(
        per_m_s=1.0 / p.seat_mass,
        per_m_b=1.0 / p.driver_mass,
        k_f=p.suspension_stiffness,
        c_f=p.suspension_damping,
        k_c=p.cushion_stiffness,
        c_c=p.cushion_damping,
        alpha=p.friction_alpha,
        friction=friction,
        substep=substep,
        floor_signals=p.floor_signals,
    )


def _seat_acceleration(
    deflection: float, rate: float, stretch: float, stretch_rate: float, friction: float, force: float, c: Coefficients
) -> float:
    """Solve (1) for z_s''; stretch is z_b - z_s, friction is z_d."""
    suspension = -c.k_f * deflection - c.c_f * rate - c.alpha * friction
    return (suspension + c.k_c * stretch + c.c_c * stretch_rate + force) * c.per_m_s


def _driver_acceleration(stretch: float, stretch_rate: float, c: Coefficients) -> float:
    """Solve (2) for z_b''."""
    return (-c.k_c * stretch - c.c_c * stretch_rate) * c.per_m_b


def _turned(friction: float, start: tuple[float, float], end: tuple[float, float], h: float, c: BoucWen) -> float:
    """Move the friction from one (deflection, rate) to the next, by way of the turning point if the rate changes sign.

    The rate is taken as linear over the substep, so the turning point divides it in the ratio of the two rates.
    """
    (x_0, v_0), (x_1, v_1) = start, end
    if v_0 * v_1 < 0.0:
        share = v_0 / (v_0 - v_1)
        turning = 0.5 * (x_0 + x_1 + h * (v_0 * share - v_1 * (1.0 - share)) * 0.5)
        friction = friction_state(friction, turning - x_0, c)
        x_0 = turning
    return friction_state(friction, x_1 - x_0, c)


def _substep(masses: Masses, floor: Floor, tau: float, h: float, force: float, c: Coefficients) -> Masses:
    """One step of classical Runge-Kutta over the four mechanical states, friction in closed form at every stage.

    ``tau`` is the time since the floor was given, ``h`` the substep's length, both in s.
    """
    z_s, v_s, z_b, v_b, z_d = masses
    x_0 = z_s - floor.displacement_at(tau)

    def slope(z_s: float, v_s: float, z_b: float, v_b: float, tau: float) -> tuple[float, float]:
        x = z_s - floor.displacement_at(tau)
        v = v_s - floor.velocity_at(tau)
        friction = friction_state(z_d, x - x_0, c.friction)
        stretch, stretch_rate = z_b - z_s, v_b - v_s
        return (
            _seat_acceleration(x, v, stretch, stretch_rate, friction, force, c),
            _driver_acceleration(stretch, stretch_rate, c),
        )

    half = 0.5 * h
    a_s1, a_b1 = slope(z_s, v_s, z_b, v_b, tau)
    v_s2, v_b2 = v_s + half * a_s1, v_b + half * a_b1
    a_s2, a_b2 = slope(z_s + half * v_s, v_s2, z_b + half * v_b, v_b2, tau + half)
    v_s3, v_b3 = v_s + half * a_s2, v_b + half * a_b2
    a_s3, a_b3 = slope(z_s + half * v_s2, v_s3, z_b + half * v_b2, v_b3, tau + half)
    v_s4, v_b4 = v_s + h * a_s3, v_b + h * a_b3
    a_s4, a_b4 = slope(z_s + h * v_s3, v_s4, z_b + h * v_b3, v_b4, tau + h)
    sixth = h / 6.0
    z_s_end = z_s + sixth * (v_s + 2.0 * (v_s2 + v_s3) + v_s4)
    z_b_end = z_b + sixth * (v_b + 2.0 * (v_b2 + v_b3) + v_b4)
    v_s_end = v_s + sixth * (a_s1 + 2.0 * (a_s2 + a_s3) + a_s4)
    v_b_end = v_b + sixth * (a_b1 + 2.0 * (a_b2 + a_b3) + a_b4)
    x_end = z_s_end - floor.displacement_at(tau + h)
    z_d_end = _turned(
        z_d,
        (x_0, v_s - floor.velocity_at(tau)),
        (x_end, v_s_end - floor.velocity_at(tau + h)),
        h,
        c.friction,
    )
    return Masses(*map(flushed, (z_s_end, v_s_end, z_b_end, v_b_end, z_d_end)))


def _outputs(masses: Masses, floor: Floor, tau: float, force: float, c: Coefficients) -> Outputs:
    """Evaluate the outputs, ``tau`` seconds after the floor was given, the force still acting."""
    z_s, v_s, z_b, v_b, z_d = masses
    deflection = z_s - floor.displacement_at(tau)
    rate = v_s - floor.velocity_at(tau)
    stretch, stretch_rate = z_b - z_s, v_b - v_s
    acceleration = _seat_acceleration(deflection, rate, stretch, stretch_rate, z_d, force, c)
    return Outputs(
        seat_acceleration=acceleration,
        suspension_deflection=deflection,
        deflection_rate=rate,
        driver_acceleration=_driver_acceleration(stretch, stretch_rate, c),
        seat_displacement=z_s,
        driver_displacement=z_b,
        friction_force=c.alpha * z_d,  # (35)
        seat_acceleration_measured=acceleration,
        suspension_deflection_measured=deflection,
    )


def initial(inputs: Inputs, coefficients: Coefficients, time: float) -> tuple[State, Outputs]:
    """Start at rest in static equilibrium.

    Parameters
    ----------
    inputs
        Floor and force at the start; a derived floor starts from this motion, whichever signal is alive later.
    coefficients
        From :func:`prepare`.
    time
        In s; the seat does not depend on it.
    """
    rest, floor = Masses(0.0, 0.0, 0.0, 0.0, 0.0), given(inputs)
    return State(*rest, *floor), _outputs(rest, floor, 0.0, inputs.force, coefficients)


def advance(
    state: State, inputs: Inputs, coefficients: Coefficients, time: float, step_size: float
) -> tuple[State, Outputs]:
    """Integrate (1)-(2) over one communication step.

    Parameters
    ----------
    state
        At the step's begin.
    inputs
        Floor and force at the step's begin; the force is held, the floor goes on as :mod:`plant_models.floor` says.
    coefficients
        From :func:`prepare`.
    time, step_size
        Begin and length of the step, in s; the seat does not depend on ``time``.

    Returns
    -------
    tuple of State and Outputs
        At the step's end, with the extrapolated floor.
    """
    c, masses, history = coefficients, state.masses, state.history
    if c.floor_signals == FloorSignals.all:
        floor = given(inputs)
    else:
        floor, history = derived(history, inputs, c.floor_signals, step_size)
    count = max(1, math.ceil(step_size / c.substep - 1e-6))
    h = step_size / count
    for index in range(count):
        masses = _substep(masses, floor, index * h, h, inputs.force, c)
    return State(*masses, *history), _outputs(masses, floor, step_size, inputs.force, c)


SEAT_PLANT = Component(
    name="SeatPlant",
    description="Seat and driver as two masses on a suspension with Bouc-Wen friction, equations (1)-(2), (35)-(36)",
    module=__name__,
    inputs=Inputs,
    outputs=Outputs,
    parameters=Parameters,
    state=State,
    prepare=prepare,
    initial=initial,
    advance=advance,
    terminals=TERMINALS,
)
