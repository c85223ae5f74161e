"""The seat: two masses on a suspension with Bouc-Wen friction (1)-(2), (35)-(36).

    m_s z_s'' = -k_f (z_s - z_v) - c_f (z_s' - z_v') + k_c (z_b - z_s) + c_c (z_b' - z_s') - f_r + u_sat        (1)
    m_b z_b'' = -k_c (z_b - z_s) - c_c (z_b' - z_s')                                                            (2)

with c_f = 0 for the active prototype, whose damper is removed. Displacements are absolute, from static equilibrium, up
positive.

Beyond a travel x_e of the deflection x, end stops push back with max(0, k_e (|x| - x_e) + c_e d|x|/dt): like rubber,
they never pull. Actuator and sensors have modules of their own; all these imperfections are absent by default.

Over a step the actuator's force is held and the floor is extrapolated by its velocity and acceleration, so that the
floor jumps a little (by its jerk times h^3/6) when the next step brings its true position. The friction follows the
deflection within a step only: let it follow the jumps as well, and each would unload it for an instant, which is up to
nine times the error in the driver's acceleration (measured on the paper's bump, Observer 1). A floor that is derived
from one signal does not jump, see :mod:`plant_models.seat.floor`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from fmus.component import Component, ParameterError
from fmus.subnormal import flush_subnormal
from plant_models.random_numbers import random_stream
from plant_models.seat import actuator as act
from plant_models.seat.actuator import Actuator, actuator
from plant_models.seat.floor import Floor, History, derived, given
from plant_models.seat.friction import BoucWen, bouc_wen, friction_state, friction_through_reversal
from plant_models.seat.interface import TERMINALS, FloorSignals, Inputs, Outputs, Parameters
from plant_models.seat.sensors import Sensor, low_passed, reading

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


class Sensed(NamedTuple):
    """What has passed the sensors' low-pass: acceleration in m/s2, deflection in m; as it was at first without one."""

    acceleration: float
    deflection: float


class State(NamedTuple):
    """State of the seat: what moves, and what floor, sensors and actuator remember."""

    masses: Masses
    floor: History = History()
    sensed: Sensed = Sensed(0.0, 0.0)
    actuator: act.State = act.AT_REST


class Coefficients(NamedTuple):
    """Parameters as the step needs them, in the symbols of (1), (2) and (35).

    ``per_m_s`` is 1/m_s; x_e is infinite where there are no end stops; ``bandwidth`` is the sensors', in rad/s.
    """

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
    x_e: float
    k_e: float
    c_e: float
    actuator: Actuator
    bandwidth: float
    accelerometer: Sensor
    deflection_sensor: Sensor


def prepare(parameters: Parameters) -> Coefficients:
    """Derive the step's coefficients.

    Raises
    ------
    ParameterError
        If the friction has no plateau, end stops no stiffness, or the seat is so stiff that a step would take too long.
    """
    p = parameters
    stops = p.end_stop_travel > 0.0
    if stops and not p.end_stop_stiffness > 0.0:
        raise ParameterError(
            f"end stops: expected end_stop.stiffness > 0 where end_stop.travel > 0, got end_stop.stiffness = "
            f"{p.end_stop_stiffness} N/m, end_stop.travel = {p.end_stop_travel} m"
        )
    friction = bouc_wen(p.friction_gamma, p.friction_beta, p.friction_amplitude)
    # the steepest friction can get: unloading at the plateau, d zeta/dy = A 2 gamma/(gamma + beta)
    slope = 2.0 * p.friction_amplitude * p.friction_gamma / (p.friction_gamma + p.friction_beta)
    stiffness = p.suspension_stiffness + p.cushion_stiffness + p.friction_alpha * slope
    damping = p.suspension_damping + p.cushion_damping
    if stops:
        stiffness, damping = stiffness + p.end_stop_stiffness, damping + p.end_stop_damping
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
        x_e=p.end_stop_travel if stops else math.inf,
        k_e=p.end_stop_stiffness,
        c_e=p.end_stop_damping,
        actuator=actuator(p.actuator_force_limit, p.actuator_delay, p.actuator_time_constant),
        bandwidth=2.0 * math.pi * p.sensor_bandwidth,
        accelerometer=Sensor(
            p.acceleration_noise, p.acceleration_bias, p.acceleration_resolution, random_stream(p.sensor_seed, 1)
        ),
        deflection_sensor=Sensor(
            p.deflection_noise, p.deflection_bias, p.deflection_resolution, random_stream(p.sensor_seed, 2)
        ),
    )


def _contact_side(deflection: float, c: Coefficients) -> float:
    """Tell which end stop is touched: 1 the upper, -1 the lower, 0 none."""
    return 0.0 if abs(deflection) <= c.x_e else math.copysign(1.0, deflection)


def _seat_acceleration(
    deflection: float,
    rate: float,
    cushion_deflection: float,
    cushion_rate: float,
    z_d: float,
    force: float,
    c: Coefficients,
) -> float:
    """Solve (1) for z_s'', end stops aside."""
    suspension = -c.k_f * deflection - c.c_f * rate - c.alpha * z_d
    return (suspension + c.k_c * cushion_deflection + c.c_c * cushion_rate + force) * c.per_m_s


def _end_stop(deflection: float, rate: float, side: float, c: Coefficients) -> float:
    """Evaluate an end stop's part of z_s''."""
    return -side * max(0.0, c.k_e * (side * deflection - c.x_e) + c.c_e * side * rate) * c.per_m_s


def _driver_acceleration(cushion_deflection: float, cushion_rate: float, c: Coefficients) -> float:
    """Solve (2) for z_b''."""
    return (-c.k_c * cushion_deflection - c.c_c * cushion_rate) * c.per_m_b


def _substep(
    masses: Masses, floor: Floor, tau: float, h: float, forces: tuple[float, float], side: float, c: Coefficients
) -> Masses:
    """One step of classical Runge-Kutta over the four mechanical states, friction in closed form at every stage.

    ``tau`` is the time since the floor was given, ``h`` the substep's length, both in s; ``forces`` are those at its
    ends in N, straight in between; ``side`` is the end stop that is touched all the while.
    """
    z_s, v_s, z_b, v_b, z_d = masses
    x_0 = z_s - floor.displacement_at(tau)

    def slope(z_s: float, v_s: float, z_b: float, v_b: float, tau: float, force: float) -> tuple[float, float]:
        x = z_s - floor.displacement_at(tau)
        v = v_s - floor.velocity_at(tau)
        friction = friction_state(z_d, x - x_0, c.friction)
        cushion_deflection, cushion_rate = z_b - z_s, v_b - v_s
        acceleration = _seat_acceleration(x, v, cushion_deflection, cushion_rate, friction, force, c)
        if side != 0.0:
            acceleration += _end_stop(x, v, side, c)
        return acceleration, _driver_acceleration(cushion_deflection, cushion_rate, c)

    half = 0.5 * h
    first, last = forces
    middle = 0.5 * (first + last)
    a_s1, a_b1 = slope(z_s, v_s, z_b, v_b, tau, first)
    v_s2, v_b2 = v_s + half * a_s1, v_b + half * a_b1
    a_s2, a_b2 = slope(z_s + half * v_s, v_s2, z_b + half * v_b, v_b2, tau + half, middle)
    v_s3, v_b3 = v_s + half * a_s2, v_b + half * a_b2
    a_s3, a_b3 = slope(z_s + half * v_s2, v_s3, z_b + half * v_b2, v_b3, tau + half, middle)
    v_s4, v_b4 = v_s + h * a_s3, v_b + h * a_b3
    a_s4, a_b4 = slope(z_s + h * v_s3, v_s4, z_b + h * v_b3, v_b4, tau + h, last)
    sixth = h / 6.0
    z_s_end = z_s + sixth * (v_s + 2.0 * (v_s2 + v_s3) + v_s4)
    z_b_end = z_b + sixth * (v_b + 2.0 * (v_b2 + v_b3) + v_b4)
    v_s_end = v_s + sixth * (a_s1 + 2.0 * (a_s2 + a_s3) + a_s4)
    v_b_end = v_b + sixth * (a_b1 + 2.0 * (a_b2 + a_b3) + a_b4)
    x_end = z_s_end - floor.displacement_at(tau + h)
    z_d_end = friction_through_reversal(
        z_d,
        (x_0, v_s - floor.velocity_at(tau)),
        (x_end, v_s_end - floor.velocity_at(tau + h)),
        h,
        c.friction,
    )
    return Masses(*map(flush_subnormal, (z_s_end, v_s_end, z_b_end, v_b_end, z_d_end)))


def _outputs(masses: Masses, floor: Floor, tau: float, force: float, c: Coefficients) -> Outputs:
    """Evaluate the outputs, ``tau`` seconds after the floor was given, the force still acting."""
    z_s, v_s, z_b, v_b, z_d = masses
    deflection = z_s - floor.displacement_at(tau)
    rate = v_s - floor.velocity_at(tau)
    cushion_deflection, cushion_rate = z_b - z_s, v_b - v_s
    acceleration = _seat_acceleration(deflection, rate, cushion_deflection, cushion_rate, z_d, force, c)
    if side := _contact_side(deflection, c):
        acceleration += _end_stop(deflection, rate, side, c)
    return Outputs(
        seat_acceleration=acceleration,
        suspension_deflection=deflection,
        deflection_rate=rate,
        driver_acceleration=_driver_acceleration(cushion_deflection, cushion_rate, c),
        seat_displacement=z_s,
        driver_displacement=z_b,
        friction_force=c.alpha * z_d,  # (35)
    )


def _report(outputs: Outputs, sensed: Sensed, c: Coefficients, time: float) -> Outputs:
    """Add what the sensors make of the truth, or of what has passed their low-pass."""
    if c.bandwidth > 0.0:
        acceleration, deflection = sensed
    else:
        acceleration, deflection = outputs.seat_acceleration, outputs.suspension_deflection
    outputs.seat_acceleration_measured = reading(acceleration, c.accelerometer, time)
    outputs.suspension_deflection_measured = reading(deflection, c.deflection_sensor, time)
    return outputs


def _sensed(sensed: Sensed, begin: Outputs, end: Outputs, angle: float) -> Sensed:
    """Move the sensors' low-pass over a substep, from the outputs at its begin to those at its end."""
    return Sensed(
        low_passed(sensed.acceleration, begin.seat_acceleration, end.seat_acceleration, angle),
        low_passed(sensed.deflection, begin.suspension_deflection, end.suspension_deflection, angle),
    )


def _until_contact(begin: Outputs, side: float, floor: Floor, c: Coefficients) -> float:
    """Tell when an end stop is met or left, in s, as deflection, rate and acceleration show; infinity for never."""
    sign = side or math.copysign(1.0, begin.deflection_rate)
    depth = sign * begin.suspension_deflection - c.x_e
    rate = sign * begin.deflection_rate
    square = rate * rate - 2.0 * depth * sign * (begin.seat_acceleration - floor.acceleration)
    if square < 0.0:
        return math.inf
    divisor = rate + math.copysign(math.sqrt(square), rate)
    time = -2.0 * depth / divisor if divisor != 0.0 else 0.0
    return time if time > 0.0 else math.inf


def _substep_with_contact(
    masses: Masses, floor: Floor, tau: float, h: float, forces: tuple[float, float], c: Coefficients
) -> Masses:
    """Take a substep, in two parts where an end stop is met or left on the way: its damper's force jumps there."""
    if c.x_e == math.inf:
        return _substep(masses, floor, tau, h, forces, 0.0, c)
    first, last = forces
    begin = _outputs(masses, floor, tau, first, c)
    side = _contact_side(begin.suspension_deflection, c)
    part = _until_contact(begin, side, floor, c)
    if part >= h:
        return _substep(masses, floor, tau, h, forces, side, c)
    middle = first + (last - first) * (part / h)
    masses = _substep(masses, floor, tau, part, (first, middle), side, c)
    side = 0.0 if side else math.copysign(1.0, begin.deflection_rate)
    return _substep(masses, floor, tau + part, h - part, (middle, last), side, c)


def _integrate_span(
    masses: Masses, sensed: Sensed, actuator: act.State, floor: Floor, span: tuple[float, float], c: Coefficients
) -> tuple[Masses, Sensed, act.State]:
    """Integrate over a span, in s since the step's begin, in which the actuator's target holds."""
    begin, end = span
    count = max(1, math.ceil((end - begin) / c.substep - 1e-6))
    h = (end - begin) / count
    lag = act.lag(c.actuator, h)
    force, target = actuator.force, actuator.target
    for index in range(count):
        tau = begin + index * h
        before = force if lag else target
        first, last, force = act.lagged(force, target, lag)
        moved = _substep_with_contact(masses, floor, tau, h, (first, last), c)
        if c.bandwidth > 0.0:
            ends = _outputs(masses, floor, tau, before, c), _outputs(moved, floor, tau + h, force, c)
            sensed = _sensed(sensed, *ends, c.bandwidth * h)
        masses = moved
    return masses, sensed, actuator._replace(force=force)


def initial(inputs: Inputs, coefficients: Coefficients, time: float) -> tuple[State, Outputs]:
    """Start at rest in static equilibrium.

    Parameters
    ----------
    inputs
        Floor and force at the start; a derived floor starts from this motion, whichever signal is alive later.
    coefficients
        From :func:`prepare`.
    time
        In s; only the sensors' noise depends on it.
    """
    c, rest, floor = coefficients, Masses(0.0, 0.0, 0.0, 0.0, 0.0), given(inputs)
    actuator = act.settled(inputs.force, c.actuator)
    outputs = _outputs(rest, floor, 0.0, actuator.force, c)
    sensed = Sensed(outputs.seat_acceleration, outputs.suspension_deflection)
    return State(rest, History(*floor), sensed, actuator), _report(outputs, sensed, c, time)


def advance(
    state: State, inputs: Inputs, coefficients: Coefficients, time: float, step_size: float
) -> tuple[State, Outputs]:
    """Integrate (1)-(2) over one communication step.

    Parameters
    ----------
    state
        At the step's begin.
    inputs
        Floor and force at the step's begin; the force is held, the floor goes on as :mod:`plant_models.seat.floor`
        says.
    coefficients
        From :func:`prepare`.
    time, step_size
        Begin and length of the step, in s; only the actuator's delay and the sensors' noise depend on ``time``.

    Returns
    -------
    tuple of State and Outputs
        At the step's end, with the extrapolated floor.
    """
    c, (masses, history, sensed, actuator) = coefficients, state
    if c.floor_signals == FloorSignals.all:
        floor = given(inputs)
    else:
        floor, history = derived(history, inputs, c.floor_signals, step_size)
    actuator = act.commanded(actuator, inputs.force, c.actuator, time)
    begin = 0.0
    while begin < step_size:
        actuator, end = act.arrived(actuator, time, begin, step_size)
        masses, sensed, actuator = _integrate_span(masses, sensed, actuator, floor, (begin, end), c)
        begin = end
    outputs = _outputs(masses, floor, step_size, actuator.force, c)
    return State(masses, history, sensed, actuator), _report(outputs, sensed, c, time + step_size)


def is_valid_state(state: State, parameters: Parameters, time: float) -> bool:
    """Whether the state can be one of a run: the delay line holds pairs, no more than there is room for."""
    return act.is_valid_state(state.actuator)


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
    is_valid_state=is_valid_state,
    terminals=TERMINALS,
)
