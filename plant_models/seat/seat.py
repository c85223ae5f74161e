"""The seat: two masses on a suspension with Bouc-Wen friction (1)-(2), (35)-(36).

    m_s z_s'' = -k_f (z_s - z_v) - c_f (z_s' - z_v') + k_c (z_b - z_s) + c_c (z_b' - z_s') - f_r + u_sat        (1)
    m_b z_b'' = -k_c (z_b - z_s) - c_c (z_b' - z_s')                                                            (2)
    f_r       = alpha z_d                                                                                       (35)

with c_f = 0 for the active prototype, which has no damper. Displacements are absolute, from static equilibrium, up
positive. The friction state z_d of (36) is solved in closed form, see friction.py.

Beyond a travel x_e either way, end stops push back with max(0, k_e (|y| - x_e) + c_e d|y|/dt). y = x + x_m is the
deflection x from the middle of the travel; static equilibrium lies x_m above the middle. The maximum makes the stops
behave like rubber: they never pull. Actuator and sensors have modules of their own. All these imperfections are absent
by default.

Over a step the force of the actuator is held, and the floor is extrapolated by its velocity and acceleration. So the
floor jumps a little, by its jerk times h^3/6, when the next step brings its true position. The friction follows the
deflection within a step only. If it followed the jumps as well, each would unload it for an instant; the error in the
driver's acceleration would be up to nine times as large (measured on the paper's bump, Observer 1). A floor that is
derived from one signal does not jump, see floor.py.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from fmus.component import Component, ParameterError
from fmus.subnormal import flush_subnormal
from plant_models.seat import actuator, floor, friction, sensors
from plant_models.seat.actuator import ActuatorCoefficients, ActuatorState
from plant_models.seat.floor import FloorHistory, FloorMotion
from plant_models.seat.friction import FrictionCoefficients
from plant_models.seat.interface import TERMINALS, FloorSignals, Inputs, Outputs, Parameters
from plant_models.seat.sensors import SensorCoefficients

MAX_SUBSTEP = 0.5e-3
"""Longest Runge-Kutta substep, in s: a quarter of the 2 ms sample."""

SUBSTEPS_PER_RADIAN = 2.0
"""Substeps per radian of the fastest motion; explicit RK4 is stable down to 0.36 and within 1e-4 of exact at 2."""

MIN_SUBSTEP = 1e-5
"""Parameters that need a substep below this, in s, are refused: a step would take too long."""


class Masses(NamedTuple):
    """Mechanical state: two masses and the friction between seat and floor.

    Attributes
    ----------
    seat_displacement, driver_displacement
        z_s and z_b, in m, up positive.
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


class FilteredSignals(NamedTuple):
    """Sensor signals after the low-pass; without a low-pass they keep their initial values.

    Attributes
    ----------
    acceleration
        z_s'', in m/s2.
    deflection
        z_s - z_v, in m.
    """

    acceleration: float
    deflection: float


class State(NamedTuple):
    """State of the seat.

    Attributes
    ----------
    masses
        Mechanical state.
    floor
        State of a derived floor.
    filtered
        State of the low-pass of the sensors.
    actuator
        State of the actuator.
    """

    masses: Masses
    floor: FloorHistory = FloorHistory()
    filtered: FilteredSignals = FilteredSignals(0.0, 0.0)
    actuator: ActuatorState = actuator.AT_REST


class Coefficients(NamedTuple):
    """Coefficients of the step, in the symbols of (1), (2) and (35).

    Attributes
    ----------
    per_m_s, per_m_b
        1/m_s and 1/m_b, in 1/kg.
    k_f, c_f, k_c, c_c
        Suspension and cushion: stiffnesses in N/m, dampings in N.s/m.
    alpha
        Friction force per friction state, in N/m.
    friction
        Coefficients of the friction.
    substep
        Longest Runge-Kutta substep, in s.
    floor_signals
        Used floor inputs, see :class:`~plant_models.seat.interface.FloorSignals`.
    x_e, x_m, k_e, c_e
        End stops: travel in m, infinite where there are none, height of static equilibrium above the middle of the
        travel in m, stiffness in N/m, damping in N.s/m.
    actuator
        Coefficients of the actuator.
    bandwidth
        Corner frequency of the sensors' low-pass, in rad/s; 0 for none.
    accelerometer, deflection_sensor
        Coefficients of the two sensors.
    """

    per_m_s: float
    per_m_b: float
    k_f: float
    c_f: float
    k_c: float
    c_c: float
    alpha: float
    friction: FrictionCoefficients
    substep: float
    floor_signals: int
    x_e: float
    x_m: float
    k_e: float
    c_e: float
    actuator: ActuatorCoefficients
    bandwidth: float
    accelerometer: SensorCoefficients
    deflection_sensor: SensorCoefficients


# ---- mechanics -------------------------------------------------------------------------------------------------------


def _contact_side(deflection: float, c: Coefficients) -> float:
    """Return which end stop is in contact: 1 for the upper, -1 for the lower, 0 for none."""
    position = deflection + c.x_m
    return 0.0 if abs(position) <= c.x_e else math.copysign(1.0, position)


def _end_stop_force(deflection: float, rate: float, side: float, c: Coefficients) -> float:
    """Return the force of an end stop on the seat in N, up positive."""
    depth = side * (deflection + c.x_m) - c.x_e
    return -side * max(0.0, c.k_e * depth + c.c_e * side * rate)


def _suspension_force(deflection: float, rate: float, z_d: float, c: Coefficients) -> float:
    """Return the force of spring, damper and friction on the seat in N, up positive."""
    return -c.k_f * deflection - c.c_f * rate - c.alpha * z_d


def _seat_acceleration(
    deflection: float,
    rate: float,
    cushion_deflection: float,
    cushion_rate: float,
    z_d: float,
    force: float,
    c: Coefficients,
) -> float:
    """Solve (1) for z_s'' in m/s2, without end stops."""
    suspension = _suspension_force(deflection, rate, z_d, c)
    return (suspension + c.k_c * cushion_deflection + c.c_c * cushion_rate + force) * c.per_m_s


def _driver_acceleration(cushion_deflection: float, cushion_rate: float, c: Coefficients) -> float:
    """Solve (2) for z_b'' in m/s2."""
    return (-c.k_c * cushion_deflection - c.c_c * cushion_rate) * c.per_m_b


def _substep(
    masses: Masses, motion: FloorMotion, tau: float, h: float, forces: tuple[float, float], side: float, c: Coefficients
) -> Masses:
    """Take one step of classical Runge-Kutta over the four mechanical states, friction in closed form at every stage.

    ``tau`` is the time since the begin of the step and ``h`` the length of the substep, both in s. ``forces`` are those
    at the ends of the substep, in N, linear in between. ``side`` is the end stop that is in contact over the substep.
    """
    z_s, v_s, z_b, v_b, z_d = masses
    x_0 = z_s - motion.displacement_at(tau)

    def slope(z_s: float, v_s: float, z_b: float, v_b: float, tau: float, force: float) -> tuple[float, float]:
        x = z_s - motion.displacement_at(tau)
        v = v_s - motion.velocity_at(tau)
        z_d_stage = friction.after_slip(z_d, x - x_0, c.friction)
        cushion_deflection, cushion_rate = z_b - z_s, v_b - v_s
        acceleration = _seat_acceleration(x, v, cushion_deflection, cushion_rate, z_d_stage, force, c)
        if side != 0.0:
            acceleration += _end_stop_force(x, v, side, c) * c.per_m_s
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
    x_end = z_s_end - motion.displacement_at(tau + h)
    z_d_end = friction.through_reversal(
        z_d,
        (x_0, v_s - motion.velocity_at(tau)),
        (x_end, v_s_end - motion.velocity_at(tau + h)),
        h,
        c.friction,
    )
    return Masses(*map(flush_subnormal, (z_s_end, v_s_end, z_b_end, v_b_end, z_d_end)))


def _evaluate_outputs(masses: Masses, motion: FloorMotion, force: float, tau: float, c: Coefficients) -> Outputs:
    """Evaluate the outputs, without measurements, ``tau`` seconds after the begin of the step."""
    z_s, v_s, z_b, v_b, z_d = masses
    deflection = z_s - motion.displacement_at(tau)
    rate = v_s - motion.velocity_at(tau)
    cushion_deflection, cushion_rate = z_b - z_s, v_b - v_s
    acceleration = _seat_acceleration(deflection, rate, cushion_deflection, cushion_rate, z_d, force, c)
    floor_force = -_suspension_force(deflection, rate, z_d, c) - force
    if side := _contact_side(deflection, c):
        end_stop = _end_stop_force(deflection, rate, side, c)
        acceleration += end_stop * c.per_m_s
        floor_force -= end_stop
    return Outputs(
        seat_acceleration=acceleration,
        suspension_deflection=deflection,
        deflection_rate=rate,
        driver_acceleration=_driver_acceleration(cushion_deflection, cushion_rate, c),
        seat_displacement=z_s,
        driver_displacement=z_b,
        friction_force=c.alpha * z_d,  # (35)
        floor_force=floor_force,
    )


def _add_measurements(outputs: Outputs, filtered: FilteredSignals, c: Coefficients, time: float) -> Outputs:
    """Add the measurements of the two sensors to the outputs."""
    if c.bandwidth > 0.0:
        acceleration, deflection = filtered
    else:
        acceleration, deflection = outputs.seat_acceleration, outputs.suspension_deflection
    outputs.seat_acceleration_measured = sensors.measure(acceleration, c.accelerometer, time)
    outputs.suspension_deflection_measured = sensors.measure(deflection, c.deflection_sensor, time)
    return outputs


def _filter_signals(filtered: FilteredSignals, begin: Outputs, end: Outputs, angle: float) -> FilteredSignals:
    """Advance the low-pass of the sensors over a substep, from the outputs at its begin to those at its end."""
    return FilteredSignals(
        sensors.low_pass(filtered.acceleration, begin.seat_acceleration, end.seat_acceleration, angle),
        sensors.low_pass(filtered.deflection, begin.suspension_deflection, end.suspension_deflection, angle),
    )


def _time_to_contact(begin: Outputs, side: float, motion: FloorMotion, c: Coefficients) -> float:
    """Return the time in s until the contact with an end stop begins or ends, infinite for never.

    Deflection, rate and acceleration are those at the begin of the substep; the acceleration is taken as constant.
    """
    sign = side or math.copysign(1.0, begin.deflection_rate)
    depth = sign * (begin.suspension_deflection + c.x_m) - c.x_e
    rate = sign * begin.deflection_rate
    square = rate * rate - 2.0 * depth * sign * (begin.seat_acceleration - motion.acceleration)
    if square < 0.0:
        return math.inf
    divisor = rate + math.copysign(math.sqrt(square), rate)
    time = -2.0 * depth / divisor if divisor != 0.0 else 0.0
    return time if time > 0.0 else math.inf


def _substep_with_contact(
    masses: Masses, motion: FloorMotion, tau: float, h: float, forces: tuple[float, float], c: Coefficients
) -> Masses:
    """Take a substep, in two parts if a contact with an end stop begins or ends in it, where the damping jumps."""
    if c.x_e == math.inf:
        return _substep(masses, motion, tau, h, forces, 0.0, c)
    first, last = forces
    begin = _evaluate_outputs(masses, motion, first, tau, c)
    side = _contact_side(begin.suspension_deflection, c)
    part = _time_to_contact(begin, side, motion, c)
    if part >= h:
        return _substep(masses, motion, tau, h, forces, side, c)
    middle = first + (last - first) * (part / h)
    masses = _substep(masses, motion, tau, part, (first, middle), side, c)
    side = 0.0 if side else math.copysign(1.0, begin.deflection_rate)
    return _substep(masses, motion, tau + part, h - part, (middle, last), side, c)


def _substep_count(time: float, c: Coefficients) -> int:
    """Return the number of substeps over a time in s, at least 1."""
    return max(1, math.ceil(time / c.substep - 1e-6))


def _integrate_span(state: State, motion: FloorMotion, begin: float, end: float, c: Coefficients) -> State:
    """Integrate over a span of the step, in s since its begin, in which the target of the actuator is constant."""
    masses, history, filtered, actuator_state = state
    count = _substep_count(end - begin, c)
    h = (end - begin) / count
    lag = actuator.prepare_lag(c.actuator, h)
    target = actuator_state.target
    force = actuator_state.force if lag else target
    for index in range(count):
        tau, force_before, masses_before = begin + index * h, force, masses
        first, last, force = actuator.apply_lag(force, target, lag)
        masses = _substep_with_contact(masses, motion, tau, h, (first, last), c)
        if c.bandwidth > 0.0:
            before = _evaluate_outputs(masses_before, motion, force_before, tau, c)
            after = _evaluate_outputs(masses, motion, force, tau + h, c)
            filtered = _filter_signals(filtered, before, after, c.bandwidth * h)
    return State(masses, history, filtered, actuator_state._replace(force=force))


def _integrate_spans(state: State, motion: FloorMotion, time: float, step_size: float, c: Coefficients) -> State:
    """Integrate over a step, span by span between the changes that leave the delay line of the actuator."""
    begin = 0.0
    while begin < step_size:
        actuator_state, end = actuator.release_due(state.actuator, time, begin, step_size)
        state = _integrate_span(state._replace(actuator=actuator_state), motion, begin, end, c)
        begin = end
    return state


# ---- the component ---------------------------------------------------------------------------------------------------


def _max_substep(p: Parameters) -> float:
    """Return the longest substep in s for the fastest motion of these parameters; refuse one that is too short."""
    # the largest slope of the friction: unloading at the plateau, d zeta/dy = A 2 gamma/(gamma + beta)
    slope = 2.0 * p.friction_amplitude * p.friction_gamma / (p.friction_gamma + p.friction_beta)
    stiffness = p.suspension_stiffness + p.cushion_stiffness + p.friction_alpha * slope
    damping = p.suspension_damping + p.cushion_damping
    if p.end_stop_travel > 0.0:
        stiffness, damping = stiffness + p.end_stop_stiffness, damping + p.end_stop_damping
    lightest = min(p.seat_mass, p.driver_mass)
    fastest = math.sqrt(stiffness / lightest) + damping / lightest
    substep = min(MAX_SUBSTEP, 1.0 / (SUBSTEPS_PER_RADIAN * fastest)) if fastest > 0.0 else MAX_SUBSTEP
    if not substep >= MIN_SUBSTEP:
        raise ParameterError(
            f"seat: expected a fastest motion below {1.0 / (SUBSTEPS_PER_RADIAN * MIN_SUBSTEP):g} rad/s, "
            f"got {fastest:g} rad/s from stiffness {stiffness:g} N/m and damping {damping:g} N.s/m on {lightest:g} kg"
        )
    return substep


def prepare(parameters: Parameters) -> Coefficients:
    """Derive the coefficients of the step.

    Parameters
    ----------
    parameters
        Parameters of the seat, each within its range.

    Returns
    -------
    Coefficients
        For :func:`initialize` and :func:`advance`.

    Raises
    ------
    ParameterError
        If the friction has no plateau, end stops have no stiffness, static equilibrium is not between them, or the seat
        is so stiff that a step would take too long.
    """
    p = parameters
    if p.end_stop_travel > 0.0 and not p.end_stop_stiffness > 0.0:
        raise ParameterError(
            f"end stops: expected end_stop.stiffness > 0 where end_stop.travel > 0, got end_stop.stiffness = "
            f"{p.end_stop_stiffness} N/m, end_stop.travel = {p.end_stop_travel} m"
        )
    if p.end_stop_travel > 0.0 and not abs(p.end_stop_height) < p.end_stop_travel:
        raise ParameterError(
            f"end stops: expected |end_stop.height| < end_stop.travel (static equilibrium is between the stops), got "
            f"end_stop.height = {p.end_stop_height} m, end_stop.travel = {p.end_stop_travel} m"
        )
    friction_coefficients = friction.prepare(p.friction_gamma, p.friction_beta, p.friction_amplitude)
    return Coefficients(
        per_m_s=1.0 / p.seat_mass,
        per_m_b=1.0 / p.driver_mass,
        k_f=p.suspension_stiffness,
        c_f=p.suspension_damping,
        k_c=p.cushion_stiffness,
        c_c=p.cushion_damping,
        alpha=p.friction_alpha,
        friction=friction_coefficients,
        substep=_max_substep(p),
        floor_signals=p.floor_signals,
        x_e=p.end_stop_travel if p.end_stop_travel > 0.0 else math.inf,
        x_m=p.end_stop_height,
        k_e=p.end_stop_stiffness,
        c_e=p.end_stop_damping,
        actuator=actuator.prepare(p.actuator_force_limit, p.actuator_delay, p.actuator_time_constant),
        bandwidth=2.0 * math.pi * p.sensor_bandwidth,
        accelerometer=sensors.prepare(
            p.acceleration_noise, p.acceleration_bias, p.acceleration_resolution, p.sensor_seed, 1
        ),
        deflection_sensor=sensors.prepare(
            p.deflection_noise, p.deflection_bias, p.deflection_resolution, p.sensor_seed, 2
        ),
    )


def initialize(inputs: Inputs, coefficients: Coefficients, time: float) -> tuple[State, Outputs]:
    """Return the state of rest in static equilibrium and its outputs.

    Parameters
    ----------
    inputs
        Floor and force at the start. A derived floor starts from this motion, whichever signal is used later.
    coefficients
        Coefficients from :func:`prepare`.
    time
        Start time, in s; only the noise of the sensors depends on it.

    Returns
    -------
    state : State
        At the start.
    outputs : Outputs
        At the start.
    """
    c, rest, motion = coefficients, Masses(0.0, 0.0, 0.0, 0.0, 0.0), floor.motion_from_inputs(inputs)
    actuator_state = actuator.initialize(inputs.force, c.actuator)
    outputs = _evaluate_outputs(rest, motion, actuator_state.force, 0.0, c)
    filtered = FilteredSignals(outputs.seat_acceleration, outputs.suspension_deflection)
    state = State(rest, FloorHistory(*motion), filtered, actuator_state)
    return state, _add_measurements(outputs, filtered, c, time)


def begin_step(state: State, inputs: Inputs, coefficients: Coefficients, step_size: float) -> tuple[State, FloorMotion]:
    """Extrapolate the floor over a communication step, as described in :mod:`plant_models.seat.floor`.

    Parameters
    ----------
    state
        State at the begin of the step.
    inputs
        Floor at the begin of the step; the force is not used.
    coefficients
        Coefficients from :func:`prepare`.
    step_size
        Communication step size, in s.

    Returns
    -------
    state : State
        With the history of the floor at the end of the step.
    motion : FloorMotion
        Of the floor over the step.
    """
    if coefficients.floor_signals == FloorSignals.all:
        return state, floor.motion_from_inputs(inputs)
    motion, history = floor.derive_motion(state.floor, inputs, coefficients.floor_signals, step_size)
    return state._replace(floor=history), motion


def advance_on_floor(
    state: State, motion: FloorMotion, force: float, coefficients: Coefficients, time: float, step_size: float
) -> tuple[State, Outputs]:
    """Integrate (1)-(2) over a communication step, or a part of one, on a floor of known motion.

    Parameters
    ----------
    state
        State at the begin, from :func:`begin_step`.
    motion
        Motion of the floor from the begin on.
    force
        Force input, in N, held.
    coefficients
        Coefficients from :func:`prepare`.
    time
        Begin, in s; only the delay of the actuator and the noise of the sensors depend on it.
    step_size
        Duration, in s.

    Returns
    -------
    state : State
        At the end.
    outputs : Outputs
        At the end.
    """
    c = coefficients
    actuator_state = actuator.command(state.actuator, force, c.actuator, time)
    state = _integrate_spans(state._replace(actuator=actuator_state), motion, time, step_size, c)
    outputs = _evaluate_outputs(state.masses, motion, state.actuator.force, step_size, c)
    return state, _add_measurements(outputs, state.filtered, c, time + step_size)


def advance(
    state: State, inputs: Inputs, coefficients: Coefficients, time: float, step_size: float
) -> tuple[State, Outputs]:
    """Integrate (1)-(2) over one communication step.

    Parameters
    ----------
    state
        State at the begin of the step.
    inputs
        Floor and force at the begin of the step. The force is held; the floor is extrapolated as described in
        :mod:`plant_models.seat.floor`.
    coefficients
        Coefficients from :func:`prepare`.
    time
        Begin of the step, in s; only the delay of the actuator and the noise of the sensors depend on it.
    step_size
        Communication step size, in s.

    Returns
    -------
    state : State
        At the end of the step.
    outputs : Outputs
        At the end of the step, with the extrapolated floor.
    """
    state, motion = begin_step(state, inputs, coefficients, step_size)
    return advance_on_floor(state, motion, inputs.force, coefficients, time, step_size)


def is_valid_state(state: State, parameters: Parameters, time: float) -> bool:
    """Check that a run can have a state: the delay line holds complete pairs and not more than its capacity.

    Parameters
    ----------
    state
        State of any origin; all its numbers are finite.
    parameters
        Not used.
    time
        Not used.

    Returns
    -------
    bool
        Whether a run can have this state.
    """
    return actuator.is_valid_state(state.actuator)


SEAT_PLANT = Component(
    name="SeatPlant",
    description="Seat and driver as two masses on a suspension with Bouc-Wen friction, equations (1)-(2), (35)-(36)",
    module=__name__,
    inputs=Inputs,
    outputs=Outputs,
    parameters=Parameters,
    state=State,
    prepare=prepare,
    initialize=initialize,
    advance=advance,
    is_valid_state=is_valid_state,
    terminals=TERMINALS,
)
