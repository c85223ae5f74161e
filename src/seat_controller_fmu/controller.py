"""The sampled controller: rate filter, disturbance observer (21), control law (24), saturation (6), torque (33).

One sample k, with delta the measured deflection, Y_2 the measured seat acceleration and h the sample time:

    v_k   = (tau v_(k-1) + delta_k - delta_(k-1)) / (tau + h),   tau = 1/(2 pi f_c)
    F_k   = F_(k-1) + h L_h [ Y_2 - ( -(k_f/M) delta_k + (u_(k-1) - F_(k-1))/M ) ]                  (21)
    u_k   = K_h [delta_k, v_k]' + F_k                                                               (24)
    u_sat = clip(u_k, -u_lim, u_lim)                                                                (6)
    T     = u_sat sqrt(L^2 - (h_0 + delta_k)^2) / (2 r_g)                                           (33)

starting from u_(-1) = F_(-1) = v_(-1) = 0 and delta_(-1) = delta_0. What depends on parameters alone is computed
beforehand, so a sample costs 10 multiplications, 10 additions and a square root.

Erratum: the paper prints Y_2 = z_s'; the equations hold for the acceleration z_s''.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from fmus.component import CLOCK_TOLERANCE, Component, ParameterError
from fmus.subnormal import flush_subnormal
from seat_controller_fmu import robust
from seat_controller_fmu.fuzzy import MassRange, observer_gain
from seat_controller_fmu.interface import TERMINALS, Constants, Fault, Inputs, Mode, Outputs, Parameters
from seat_controller_fmu.parameters import SAMPLE_TIME
from seat_controller_fmu.robust import RobustCoefficients, RobustState
from seat_controller_fmu.sampling import filtered_rate, rate_filter, samples_before


class State(NamedTuple):
    """State of the controller after a sample.

    Attributes
    ----------
    next_sample
        Number k of the next sample, due at the time k h.
    started
        Whether a sample was taken: before the first one there is no previous deflection.
    deflection
        delta of the last sample, in m.
    rate
        v of the last sample, in m/s.
    demand, force, estimate
        u, u_sat and F_hat of the last sample, in N.
    robust
        State of the mode robust.
    """

    next_sample: int
    started: bool
    deflection: float
    rate: float
    demand: float
    force: float
    estimate: float
    robust: RobustState


class Coefficients(NamedTuple):
    """Factors of the sampled equations, derived from the parameters.

    Attributes
    ----------
    rate_decay, rate_gain
        tau/(tau + h) and 1/(tau + h), in 1 and 1/s.
    observer_acceleration, observer_deflection, observer_force
        h L_h in kg, h L_h k_f/M in N/m, h L_h/M in 1.
    deflection_gain, rate_gain_K
        K_h, in N/m and N.s/m.
    limit
        u_lim, in N.
    link_squared, height, torque_gain
        L^2 in m^2, h_0 in m, 1/(2 r_g).
    enabled, anti_windup
        As the parameters.
    is_robust
        Whether the mode is robust.
    robust
        Coefficients of the mode robust.
    """

    rate_decay: float
    rate_gain: float
    observer_acceleration: float
    observer_deflection: float
    observer_force: float
    deflection_gain: float
    rate_gain_K: float
    limit: float
    link_squared: float
    height: float
    torque_gain: float
    enabled: bool
    anti_windup: bool
    is_robust: bool
    robust: RobustCoefficients


def mass_range(parameters: Parameters) -> MassRange:
    """Return the vertices of the Takagi-Sugeno model.

    Parameters
    ----------
    parameters
        Parameters of the controller.

    Returns
    -------
    MassRange
        M_min and M_max (11), in kg.
    """
    return MassRange(
        parameters.driver_mass_min + parameters.seat_mass, parameters.driver_mass_max + parameters.seat_mass
    )


def observer_gains(parameters: Parameters) -> tuple[float, float]:
    """Return the observer gains at the vertices.

    Parameters
    ----------
    parameters
        Parameters of the controller.

    Returns
    -------
    tuple of float
        L_1 and L_2, in kg/s: as set, or by (23) where they are 0.
    """
    given = (parameters.L1, parameters.L2)
    vertices = mass_range(parameters)
    return tuple(  # type: ignore[return-value]
        gain if gain != 0.0 else observer_gain(mass, parameters.observer_gamma)
        for gain, mass in zip(given, vertices, strict=True)
    )


def prepare(parameters: Parameters) -> Coefficients:
    """Derive the coefficients: gains and model, scheduled over the driver's mass (11)-(14).

    Parameters
    ----------
    parameters
        Parameters of the controller, each within its range.

    Returns
    -------
    Coefficients
        For :func:`step` and :func:`advance`.

    Raises
    ------
    ParameterError
        If the mass range is empty or reversed, or so narrow that its ends are the same total mass (4) when rounded.
    """
    p = parameters
    if not p.driver_mass_min < p.driver_mass_max:
        raise ParameterError(
            "controller: expected driver_mass_min < driver_mass_max, got "
            f"{p.driver_mass_min} kg and {p.driver_mass_max} kg"
        )
    vertices = mass_range(p)
    if not 1.0 / vertices.maximum < 1.0 / vertices.minimum:
        raise ParameterError(
            "controller: expected driver_mass_min < driver_mass_max by more than is lost beside seat_mass, got "
            f"{p.driver_mass_min} kg, {p.driver_mass_max} kg and {p.seat_mass} kg"
        )
    mass = p.driver_mass + p.seat_mass  # (4)
    h_1, h_2 = vertices.memberships(mass)
    L_1, L_2 = observer_gains(p)
    h = SAMPLE_TIME.value
    hL = h * (h_1 * L_1 + h_2 * L_2)
    D_2 = vertices.inverse_mass(mass)
    rate_decay, rate_gain = rate_filter(p.rate_filter_cutoff, h)
    return Coefficients(
        rate_decay=rate_decay,
        rate_gain=rate_gain,
        observer_acceleration=hL,
        observer_deflection=hL * p.suspension_stiffness * D_2,
        observer_force=hL * D_2,
        deflection_gain=h_1 * p.K1_deflection + h_2 * p.K2_deflection,
        rate_gain_K=h_1 * p.K1_rate + h_2 * p.K2_rate,
        limit=p.force_limit,
        link_squared=p.link_length * p.link_length,
        height=p.initial_height,
        torque_gain=1.0 / (2.0 * p.gear_ratio),
        enabled=bool(p.enabled),
        anti_windup=bool(p.anti_windup),
        is_robust=p.mode == Mode.robust,
        robust=robust.prepare(p),
    )


def step(state: State, inputs: Inputs, coefficients: Coefficients) -> tuple[State, Outputs]:
    """Take one sample of the inputs and hold the outputs.

    Parameters
    ----------
    state
        State after the previous sample.
    inputs
        Measurements at the sample.
    coefficients
        Coefficients from :func:`prepare`.

    Returns
    -------
    state : State
        After the sample, with ``next_sample`` increased by one.
    outputs : Outputs
        After the sample.
    """
    c = coefficients
    if c.is_robust:
        return _robust_step(state, inputs, c)
    delta = inputs.suspension_deflection
    previous = state.deflection if state.started else delta
    v = filtered_rate(state.rate, previous, delta, c.rate_decay, c.rate_gain)
    if c.enabled:
        applied = state.force if c.anti_windup else state.demand
        innovation = c.observer_acceleration * inputs.seat_acceleration + c.observer_deflection * delta
        F_hat = state.estimate + innovation - c.observer_force * (applied - state.estimate)  # (21)
        u = c.deflection_gain * delta + c.rate_gain_K * v + F_hat  # (24)
        u_sat = min(max(u, -c.limit), c.limit)  # (6)
    else:
        F_hat = u = u_sat = 0.0
    delta, v, u, u_sat, F_hat = map(flush_subnormal, (delta, v, u, u_sat, F_hat))
    state = State(state.next_sample + 1, True, delta, v, u, u_sat, F_hat, state.robust)
    return state, held_outputs(state, c)


def _robust_step(state: State, inputs: Inputs, c: Coefficients) -> tuple[State, Outputs]:
    """Take one sample of the mode robust. A measurement that is not finite changes the fault alone."""
    given = inputs.suspension_deflection
    finite = math.isfinite(given)
    previous = state.deflection if state.started else given if finite else 0.0
    delta = given if finite else previous
    v = filtered_rate(state.rate, previous, delta, c.rate_decay, c.rate_gain)
    sample = robust.Sample(inputs.seat_acceleration, given, previous, v, state.force, c.enabled)
    after, demand, force = robust.step(state.robust, sample, c.robust)
    estimate = after.estimate if after.active else 0.0
    delta, v, demand, force = map(flush_subnormal, (delta, v, demand, force))
    state = State(state.next_sample + 1, True, delta, v, demand, force, estimate, after)
    return state, held_outputs(state, c)


def held_outputs(state: State, coefficients: Coefficients) -> Outputs:
    """Evaluate the outputs of the last sample, the motor torque (33) with its radicand clamped at 0.

    Parameters
    ----------
    state
        State after the sample.
    coefficients
        Coefficients from :func:`prepare`.

    Returns
    -------
    Outputs
        They hold until the next sample.
    """
    height = coefficients.height + state.deflection
    radicand = coefficients.link_squared - height * height
    estimates, nominal = state.robust.estimator, coefficients.robust.estimator
    torque = state.force * math.sqrt(radicand) * coefficients.torque_gain if radicand > 0.0 else 0.0
    return Outputs(
        force=state.force,
        force_demand=state.demand,
        motor_torque=torque,
        disturbance_estimate=state.estimate,
        deflection_rate=state.rate,
        saturated=state.demand != state.force,
        fault=Fault(state.robust.faults.fault),
        driver_mass_estimate=estimates.mass if coefficients.is_robust else nominal.nominal_mass,
        friction_estimate=estimates.friction if coefficients.is_robust else nominal.nominal_friction,
        driver_mass_trusted=estimates.mass_trusted,
        friction_trusted=estimates.friction_trusted,
    )


def initialize(inputs: Inputs, coefficients: Coefficients, time: float) -> tuple[State, Outputs]:
    """Return the state before the first sample; no sample is taken.

    Parameters
    ----------
    inputs
        Not used.
    coefficients
        Coefficients from :func:`prepare`.
    time
        Start time, in s; the first sample is due at the first multiple of the sample time from there on.

    Returns
    -------
    state : State
        Before the first sample.
    outputs : Outputs
        All 0, except the estimates: these are the nominal values.
    """
    state = State(
        samples_before(time, SAMPLE_TIME.value), False, 0.0, 0.0, 0.0, 0.0, 0.0, robust.start(coefficients.robust)
    )
    return state, held_outputs(state, coefficients)


def advance(
    state: State, inputs: Inputs, coefficients: Coefficients, time: float, step_size: float
) -> tuple[State, Outputs]:
    """Take every sample due in [time, time + step_size), all with the same inputs.

    Parameters
    ----------
    state
        State at ``time``.
    inputs
        Measurements at ``time``.
    coefficients
        Coefficients from :func:`prepare`.
    time
        Begin of the communication step, in s.
    step_size
        Communication step size, in s.

    Returns
    -------
    state : State
        At the end of the step.
    outputs : Outputs
        Those of the last sample, also if none was due in the step.
    """
    end = samples_before(time + step_size, SAMPLE_TIME.value)
    outputs = None
    while state.next_sample < end:
        state, outputs = step(state, inputs, coefficients)
    return state, outputs or held_outputs(state, coefficients)


def warnings(parameters: Parameters) -> list[str]:
    """Warn of a driver's mass outside the range of the gains, where the scheduling is clamped; mode robust has none.

    Parameters
    ----------
    parameters
        Parameters of the controller.

    Returns
    -------
    list of str
        At most one message.
    """
    p = parameters
    if p.mode == Mode.robust or p.driver_mass_min <= p.driver_mass <= p.driver_mass_max:
        return []
    return [
        f"driver_mass {p.driver_mass} kg lies outside [{p.driver_mass_min}, {p.driver_mass_max}] kg: "
        "the gains of the nearer end are used"
    ]


def is_valid_state(state: State, parameters: Parameters, time: float) -> bool:
    """Check that a run can have a state at a time: its next sample is near that time, its delay line fits.

    Parameters
    ----------
    state
        State of any origin; all its numbers are finite.
    parameters
        Parameters of the controller.
    time
        Time that the run has reached, in s.

    Returns
    -------
    bool
        Whether a run can have this state.
    """
    near = abs(state.next_sample * SAMPLE_TIME.value - time) <= CLOCK_TOLERANCE
    return near and robust.is_valid_state(state.robust, parameters)


SEAT_CONTROLLER = Component(
    name="SeatController",
    description="Disturbance observer based Takagi-Sugeno fuzzy controller of an active seat suspension, 500 Hz",
    module=__name__,
    inputs=Inputs,
    outputs=Outputs,
    parameters=Parameters,
    constants=Constants,
    state=State,
    prepare=prepare,
    initialize=initialize,
    advance=advance,
    is_valid_state=is_valid_state,
    warnings=warnings,
    terminals=TERMINALS,
    sample_time=SAMPLE_TIME.value,
)
