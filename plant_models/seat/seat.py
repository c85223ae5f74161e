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

The driver is one mass on the cushion (2), the default, or a seated body of four masses, whose contact takes the place
of the cushion in (1) and whose equations are those of :mod:`plant_models.driver.body`, or somebody outside, whose force
on the seat is an input that is held over a step. In the state, z_b is the pelvis of a seated body.

Over a step the force of the actuator is held, and the floor is extrapolated by its velocity and acceleration. So the
floor jumps a little, by its jerk times h^3/6, when the next step brings its true position. The friction follows the
deflection within a step only. If it followed the jumps as well, each would unload it for an instant; the error in the
driver's acceleration would be up to nine times as large (measured on the paper's bump, Observer 1). A floor that is
derived from one signal does not jump, see floor.py.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from fmus.component import Component, ParameterError
from fmus.subnormal import flush_subnormal
from plant_models import runge_kutta
from plant_models.driver import body as bodies
from plant_models.driver.body import Body
from plant_models.runge_kutta import Numbers
from plant_models.seat import actuator, floor, friction, sensors
from plant_models.seat.actuator import ActuatorCoefficients, ActuatorState
from plant_models.seat.floor import FloorHistory, FloorMotion
from plant_models.seat.friction import FrictionCoefficients
from plant_models.seat.interface import TERMINALS, DriverModel, FloorSignals, Inputs, Outputs, Parameters
from plant_models.seat.sensors import SensorCoefficients


class Masses(NamedTuple):
    """Mechanical state: seat, driver and the friction between seat and floor.

    Attributes
    ----------
    seat_displacement, driver_displacement
        z_s and z_b, in m, up positive.
    seat_velocity, driver_velocity
        z_s' and z_b', in m/s.
    friction
        z_d of (36), in m.
    upper_displacements, upper_velocities
        Of the masses of a seated body above its pelvis, in m and m/s; 0 with other drivers.
    """

    seat_displacement: float
    seat_velocity: float
    driver_displacement: float
    driver_velocity: float
    friction: float
    upper_displacements: Annotated[tuple[float, ...], 3] = (0.0, 0.0, 0.0)
    upper_velocities: Annotated[tuple[float, ...], 3] = (0.0, 0.0, 0.0)


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
        Suspension, and cushion or contact of a seated driver: stiffnesses in N/m, dampings in N.s/m; no contact with an
        external driver.
    driver_model
        Driver, see :class:`~plant_models.seat.interface.DriverModel`.
    body
        Coefficients of a seated driver.
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
    driver_model: int
    body: Body
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


def _slope(
    z_s: float,
    v_s: float,
    z_b: float,
    v_b: float,
    tau: float,
    force: float,
    begin: tuple[float, float],
    motion: FloorMotion,
    side: float,
    c: Coefficients,
) -> tuple[float, float]:
    """Return z_s'' and z_b'' of a lumped driver in m/s2 at a stage, ``tau`` seconds after the begin of the step.

    ``begin`` has the friction state and the deflection at the begin of the substep, in m.
    """
    z_d, x_0 = begin
    x = z_s - motion.displacement_at(tau)
    v = v_s - motion.velocity_at(tau)
    z_d_stage = friction.after_slip(z_d, x - x_0, c.friction)
    cushion_deflection, cushion_rate = z_b - z_s, v_b - v_s
    acceleration = _seat_acceleration(x, v, cushion_deflection, cushion_rate, z_d_stage, force, c)
    if side != 0.0:
        acceleration += _end_stop_force(x, v, side, c) * c.per_m_s
    return acceleration, _driver_acceleration(cushion_deflection, cushion_rate, c)


def _friction_after(
    masses: Masses, z_s: float, v_s: float, motion: FloorMotion, tau: float, h: float, c: Coefficients
) -> float:
    """Return z_d in m after a substep that ends with a displacement and a velocity of the seat."""
    return friction.through_reversal(
        masses.friction,
        (masses.seat_displacement - motion.displacement_at(tau), masses.seat_velocity - motion.velocity_at(tau)),
        (z_s - motion.displacement_at(tau + h), v_s - motion.velocity_at(tau + h)),
        h,
        c.friction,
    )


def _substep(
    masses: Masses, motion: FloorMotion, tau: float, h: float, forces: tuple[float, float], side: float, c: Coefficients
) -> Masses:
    """Take one step of classical Runge-Kutta over the mechanical states, friction in closed form at every stage.

    ``tau`` is the time since the begin of the step and ``h`` the length of the substep, both in s. ``forces`` are those
    at the ends of the substep, in N, linear in between. ``side`` is the end stop that is in contact over the substep.
    """
    if c.driver_model == DriverModel.seated:
        return _seated_substep(masses, motion, tau, h, forces, side, c)
    z_s, v_s, z_b, v_b, z_d = masses[:5]
    begin = z_d, z_s - motion.displacement_at(tau)
    half = 0.5 * h
    first, last = forces
    middle = 0.5 * (first + last)
    a_s1, a_b1 = _slope(z_s, v_s, z_b, v_b, tau, first, begin, motion, side, c)
    v_s2, v_b2 = v_s + half * a_s1, v_b + half * a_b1
    z_s2, z_b2 = z_s + half * v_s, z_b + half * v_b
    a_s2, a_b2 = _slope(z_s2, v_s2, z_b2, v_b2, tau + half, middle, begin, motion, side, c)
    v_s3, v_b3 = v_s + half * a_s2, v_b + half * a_b2
    z_s3, z_b3 = z_s + half * v_s2, z_b + half * v_b2
    a_s3, a_b3 = _slope(z_s3, v_s3, z_b3, v_b3, tau + half, middle, begin, motion, side, c)
    v_s4, v_b4 = v_s + h * a_s3, v_b + h * a_b3
    a_s4, a_b4 = _slope(z_s + h * v_s3, v_s4, z_b + h * v_b3, v_b4, tau + h, last, begin, motion, side, c)
    sixth = h / 6.0
    z_s_end = z_s + sixth * (v_s + 2.0 * (v_s2 + v_s3) + v_s4)
    z_b_end = z_b + sixth * (v_b + 2.0 * (v_b2 + v_b3) + v_b4)
    v_s_end = v_s + sixth * (a_s1 + 2.0 * (a_s2 + a_s3) + a_s4)
    v_b_end = v_b + sixth * (a_b1 + 2.0 * (a_b2 + a_b3) + a_b4)
    z_d_end = _friction_after(masses, z_s_end, v_s_end, motion, tau, h, c)
    return Masses(
        flush_subnormal(z_s_end),
        flush_subnormal(v_s_end),
        flush_subnormal(z_b_end),
        flush_subnormal(v_b_end),
        flush_subnormal(z_d_end),
        masses.upper_displacements,
        masses.upper_velocities,
    )


def _body_accelerations(z: Numbers, v: Numbers, c: Coefficients) -> Numbers:
    """Return the accelerations of a seated body in m/s2, from those of the seat and the body in m and m/s."""
    contact = bodies.contact_force(z[1] - z[0], v[1] - v[0], c.body)
    return bodies.accelerations(z[1:], v[1:], contact, c.body)


def _seated_substep(
    masses: Masses, motion: FloorMotion, tau: float, h: float, forces: tuple[float, float], side: float, c: Coefficients
) -> Masses:
    """Take a substep with a seated driver; as :func:`_substep`."""
    first, last = forces
    begin = masses.friction, masses.seat_displacement - motion.displacement_at(tau)

    def slope(z: Numbers, v: Numbers, share: float) -> Numbers:
        force = first + share * (last - first)
        seat, _ = _slope(z[0], v[0], z[1], v[1], tau + share * h, force, begin, motion, side, c)
        return (seat, *_body_accelerations(z, v, c))

    z = (masses.seat_displacement, masses.driver_displacement, *masses.upper_displacements)
    v = (masses.seat_velocity, masses.driver_velocity, *masses.upper_velocities)
    z, v = runge_kutta.step(z, v, h, slope)
    z_d = flush_subnormal(_friction_after(masses, z[0], v[0], motion, tau, h, c))
    return Masses(z[0], v[0], z[1], v[1], z_d, z[2:], v[2:])


def _driver_accelerations(masses: Masses, seat_acceleration: float, c: Coefficients) -> tuple[float, float]:
    """Return the accelerations of driver and head in m/s2."""
    z_s, v_s, z_b, v_b = masses[:4]
    if c.driver_model == DriverModel.seated:
        body = _body_accelerations((z_s, z_b, *masses.upper_displacements), (v_s, v_b, *masses.upper_velocities), c)
        return body[0], body[3]
    if c.driver_model == DriverModel.external:
        return seat_acceleration, seat_acceleration
    driver = _driver_acceleration(z_b - z_s, v_b - v_s, c)
    return driver, driver


def _evaluate_outputs(
    masses: Masses, motion: FloorMotion, force: float, push: float, tau: float, c: Coefficients
) -> Outputs:
    """Evaluate the outputs, without measurements, ``tau`` seconds after the begin of the step.

    ``force`` is that of the actuator and ``push`` that of an external driver, in N.
    """
    z_s, v_s, z_b, v_b, z_d = masses[:5]
    deflection = z_s - motion.displacement_at(tau)
    rate = v_s - motion.velocity_at(tau)
    cushion_deflection, cushion_rate = z_b - z_s, v_b - v_s
    acceleration = _seat_acceleration(deflection, rate, cushion_deflection, cushion_rate, z_d, force + push, c)
    floor_force = -_suspension_force(deflection, rate, z_d, c) - force
    if side := _contact_side(deflection, c):
        end_stop = _end_stop_force(deflection, rate, side, c)
        acceleration += end_stop * c.per_m_s
        floor_force -= end_stop
    driver, head = _driver_accelerations(masses, acceleration, c)
    return Outputs(
        seat_acceleration=acceleration,
        suspension_deflection=deflection,
        deflection_rate=rate,
        driver_acceleration=driver,
        seat_displacement=z_s,
        driver_displacement=z_s if c.driver_model == DriverModel.external else z_b,
        friction_force=c.alpha * z_d,  # (35)
        floor_force=floor_force,
        seat_velocity=v_s,
        head_acceleration=head,
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
    begin = _evaluate_outputs(masses, motion, first, 0.0, tau, c)
    side = _contact_side(begin.suspension_deflection, c)
    part = _time_to_contact(begin, side, motion, c)
    if part >= h:
        return _substep(masses, motion, tau, h, forces, side, c)
    middle = first + (last - first) * (part / h)
    masses = _substep(masses, motion, tau, part, (first, middle), side, c)
    side = 0.0 if side else math.copysign(1.0, begin.deflection_rate)
    return _substep(masses, motion, tau + part, h - part, (middle, last), side, c)


def _integrate_span(state: State, motion: FloorMotion, push: float, begin: float, end: float, c: Coefficients) -> State:
    """Integrate over a span of the step, in s since its begin, in which the target of the actuator is constant.

    ``push`` is the force of an external driver in N.
    """
    masses, history, filtered, actuator_state = state
    count = runge_kutta.substep_count(end - begin, c.substep)
    h = (end - begin) / count
    lag = actuator.prepare_lag(c.actuator, h)
    target = actuator_state.target
    force = actuator_state.force if lag else target
    for index in range(count):
        tau, force_before, masses_before = begin + index * h, force, masses
        first, last, force = actuator.apply_lag(force, target, lag)
        masses = _substep_with_contact(masses, motion, tau, h, (first + push, last + push), c)
        if c.bandwidth > 0.0:
            before = _evaluate_outputs(masses_before, motion, force_before, push, tau, c)
            after = _evaluate_outputs(masses, motion, force, push, tau + h, c)
            filtered = _filter_signals(filtered, before, after, c.bandwidth * h)
    return State(masses, history, filtered, actuator_state._replace(force=force))


def _integrate_spans(
    state: State, motion: FloorMotion, push: float, time: float, step_size: float, c: Coefficients
) -> State:
    """Integrate over a step, span by span between the changes that leave the delay line of the actuator."""
    begin = 0.0
    while begin < step_size:
        actuator_state, end = actuator.release_due(state.actuator, time, begin, step_size)
        state = _integrate_span(state._replace(actuator=actuator_state), motion, push, begin, end, c)
        begin = end
    return state


# ---- the component ---------------------------------------------------------------------------------------------------


def _contact(p: Parameters, body: Body) -> tuple[float, float]:
    """Return stiffness in N/m and damping in N.s/m between seat and driver, for (1)."""
    if p.driver_model == DriverModel.seated:
        return body.k[0], body.c[0]
    return (0.0, 0.0) if p.driver_model == DriverModel.external else (p.cushion_stiffness, p.cushion_damping)


def _max_substep(p: Parameters, body: Body) -> float:
    """Return the longest substep in s for the fastest motion of these parameters; refuse one that is too short."""
    # the largest slope of the friction: unloading at the plateau, d zeta/dy = A 2 gamma/(gamma + beta)
    slope = 2.0 * p.friction_amplitude * p.friction_gamma / (p.friction_gamma + p.friction_beta)
    k_c, c_c = _contact(p, body)
    stiffness = p.suspension_stiffness + k_c + p.friction_alpha * slope
    damping = p.suspension_damping + c_c
    if p.end_stop_travel > 0.0:
        stiffness, damping = stiffness + p.end_stop_stiffness, damping + p.end_stop_damping
    lightest = min(p.seat_mass, p.driver_mass) if p.driver_model == DriverModel.lumped else p.seat_mass
    fastest = math.sqrt(stiffness / lightest) + damping / lightest
    if p.driver_model == DriverModel.seated:
        fastest = max(fastest, bodies.fastest(body))
    substep = runge_kutta.max_substep(fastest)
    if not substep >= runge_kutta.MIN_SUBSTEP:
        limit = 1.0 / (runge_kutta.SUBSTEPS_PER_RADIAN * runge_kutta.MIN_SUBSTEP)
        raise ParameterError(
            f"seat: expected a fastest motion below {limit:g} rad/s, "
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
    body = bodies.prepare(p.driver_mass, p.contact_stiffness, p.contact_damping)
    k_c, c_c = _contact(p, body)
    friction_coefficients = friction.prepare(p.friction_gamma, p.friction_beta, p.friction_amplitude)
    return Coefficients(
        per_m_s=1.0 / p.seat_mass,
        per_m_b=1.0 / p.driver_mass,
        k_f=p.suspension_stiffness,
        c_f=p.suspension_damping,
        k_c=k_c,
        c_c=c_c,
        driver_model=p.driver_model,
        body=body,
        alpha=p.friction_alpha,
        friction=friction_coefficients,
        substep=_max_substep(p, body),
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


def _push(driver_force: float, c: Coefficients) -> float:
    """Return the force of an external driver in N, 0 with a driver inside."""
    return driver_force if c.driver_model == DriverModel.external else 0.0


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
    outputs = _evaluate_outputs(rest, motion, actuator_state.force, _push(inputs.driver_force, c), 0.0, c)
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
        Floor at the begin of the step; the forces are not used.
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
    state: State,
    motion: FloorMotion,
    force: float,
    coefficients: Coefficients,
    time: float,
    step_size: float,
    driver_force: float = 0.0,
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
    driver_force
        Force of an external driver, in N, held; not used with a driver inside.

    Returns
    -------
    state : State
        At the end.
    outputs : Outputs
        At the end.
    """
    c = coefficients
    actuator_state = actuator.command(state.actuator, force, c.actuator, time)
    push = _push(driver_force, c)
    state = _integrate_spans(state._replace(actuator=actuator_state), motion, push, time, step_size, c)
    outputs = _evaluate_outputs(state.masses, motion, state.actuator.force, push, step_size, c)
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
        Floor and forces at the begin of the step. The forces are held; the floor is extrapolated as described in
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
    return advance_on_floor(state, motion, inputs.force, coefficients, time, step_size, inputs.driver_force)


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
