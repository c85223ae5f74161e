"""The law of the mode robust. docs/explanation/robust.md derives each term.

One sample, with a the measured seat acceleration, delta the measured deflection, M = m_s + m_b and h the sample time:

    motion     delta^, v, z_v'' : observer of the deflection with the input a - z_v'', poles of 24 Hz;  w = a - z_v''
    actuator   u_a, x_a         : last force and its answered part x, delayed by T_d, lagging by T_a
    driver     a_b = H_c a,   H_c = (c_c s + k_c)/(m_b s^2 + c_c s + k_c)
    observer   F   += (1 - e^(-P h)) [ x_a - k_f delta - m_s a - m_b a_b + M b - F ]
    ahead      u_x  = mu F_r sat((v + T w)/v_0) - beta M v_g/(1/P + T),   T = T_a + T_d
    centring   a*   = -w_0^2 d - 2 zeta w_0 d',   d the low-passed deflection
    law        u    = k_f (delta + T_k v) + F + M a* + u_x
    answered   x    = u_sat - u_x
    bias       b   -= h gamma_b (delta + u_sat/k_f)

beta is scheduled on the envelope A of sqrt(delta^2 + (v/w_p)^2), the amplitude to come. Where A nears the travel in
spite of it, a damper takes over. While the seat is still, b follows a and F leaks. An actuator with a long lag gets its
command through a lead. Faults are detected by :mod:`seat_controller_fmu.faults`.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from fmus.component import ParameterError
from fmus.subnormal import flush_subnormal
from seat_controller_fmu import estimator, faults
from seat_controller_fmu.estimator import EstimatorCoefficients, EstimatorState
from seat_controller_fmu.faults import FaultsCoefficients, FaultsState
from seat_controller_fmu.interface import MAX_DELAY, Estimator, Fault, Parameters
from seat_controller_fmu.parameters import SAMPLE_TIME

MAX_DELAY_SAMPLES = round(MAX_DELAY / SAMPLE_TIME.value)
"""Number of samples of the actuator's delay that the law can follow."""

FOLLOW_FILTER = 4.0
"""Corner frequency of the rate in the follow term, in Hz: the term has a loop of its own, over the frame's mass."""
PREDICTION_TIME = 0.001
"""Time in s, beyond the actuator's, by which the spring's force is predicted: half a sample."""
LEAD_FLOOR, LEAD_SHARE = 0.003, 0.4
"""Time constant that a lead leaves of the actuator's lag: at least this, in s, and this share."""
BIAS_BOUND = 0.2
"""Largest bias of the accelerometer that is corrected, in m/s2: 20 mg."""
START_RATE, START_TIME = 2.0, 2.0
"""Rate in 1/s at which the bias follows the acceleration after the start, and the time in s in which it falls."""
STILL_RATE, STILL_RANGE = 0.009, 0.0072
"""The seat is still below this mean rate in m/s, and moves above it by this range."""
STILL_FILTER = 1.0
"""Corner frequency of the mean, in Hz."""
STILL_TIME, STILL_LEAK = 0.3, 20.0
"""While the seat is still: time constant of the bias in s, and rate of the leak of the disturbance estimate in 1/s."""
OVERLOAD_STIFFNESS = 1500.0
"""Part of the spring that is cancelled during an overload, in N/m."""
FADE_TIME = 0.1
"""Time in which force and safe damper fade after a fault, in s."""

DelayLine = Annotated[tuple[float, ...], 2 * MAX_DELAY_SAMPLES, "line_length"]


class RobustState(NamedTuple):
    """State of the law.

    Attributes
    ----------
    active
        Whether the law runs; otherwise it begins anew with the next sample.
    level
        Share of the law's force that is let through.
    held
        Last force without a fault, in N.
    safety
        Share of the damper of the safe state that is let through.
    position, rate
        delta^ and v, in m and m/s.
    floor
        Observed acceleration of the floor, with the accelerometer's bias, in m/s2.
    applied, answered
        u_a and x_a, in N.
    part
        x of the last sample, in N.
    cushion_1, cushion_2
        State of the driver's filter, in m/s2.
    estimate
        F, in N.
    bias
        b, in m/s2.
    start
        Share of the way from b to a that b goes in a sample after the start.
    envelope
        A, in m.
    followed
        v_g, in m/s.
    slow
        d, in m.
    speed
        Mean of abs(v), in m/s.
    lagging
        State of the lead, in N.
    estimator, faults
        Of the estimator and of the detection of faults.
    place
        Index of the oldest pair in the delay line.
    line_length
        Number of values in use in ``line``.
    line
        x and force of each delayed sample, in N.
    """

    active: bool
    level: float
    held: float
    safety: float
    position: float
    rate: float
    floor: float
    applied: float
    answered: float
    part: float
    cushion_1: float
    cushion_2: float
    estimate: float
    bias: float
    start: float
    envelope: float
    followed: float
    slow: float
    speed: float
    lagging: float
    estimator: EstimatorState
    faults: FaultsState
    place: int
    line_length: int
    line: DelayLine


class SeatModel(NamedTuple):
    """Model of the seat with its driver.

    Attributes
    ----------
    mass
        M, in kg.
    b_0, b_1, b_2, a_1, a_2
        Coefficients of the filter H_c, by Tustin's rule.
    """

    mass: float
    b_0: float
    b_1: float
    b_2: float
    a_1: float
    a_2: float


class RobustCoefficients(NamedTuple):
    """Coefficients of the law.

    Attributes
    ----------
    h, half_h
        h and h/2, in s.
    motion_1, motion_2, motion_3
        Gains of the motion observer, in 1, 1/s and 1/s2.
    applied_gain, answered_gain
        Shares that the lags of u_a and x_a take in a sample.
    delay
        T_d in samples.
    k_f, m_s, limit
        In N/m, kg, N.
    cushion_damping, cushion_stiffness, inertia
        c_c 2/h and k_c in N/m, (2/h)^2 in 1/s2.
    nominal
        Model with the driver of the parameters.
    observer_gain
        1 - e^(-P h).
    envelope_keep, rate_to_deflection
        Factor on A a sample; 1/w_p in s.
    follow_begin, follow_slope, follow_min, follow_max, follow_gain, follow_filter
        beta as a function of A, in m and 1/m; 1/(1/P + T) in 1/s; share that the low-pass of v_g takes.
    lead_time, per_friction_rate, friction_share
        T in s, 1/v_0 in s/m, mu.
    rate_gain
        k_f T_k, in N.s/m.
    centring_stiffness, centring_damping, centring_filter
        w_0^2 and 2 zeta w_0 w_l, in 1/s2; share that the low-pass of d takes.
    overload_begin, overload_slope, overload_damping, overload_stiffness
        Share of the damper as a function of A, in m and 1/m; the damper in N.s/m, N/m.
    has_lead, lead_direct, lead_lagging, lead_gain
        The lead (1 + T_a s)/(1 + l s) as a direct part and one through a lag.
    bias_gain, per_k_f, bias_bound, start_rate, start_keep
        h gamma_b in 1/s2, 1/k_f in m/N, bound in m/s2, first share of a sample and its factor a sample.
    still_begin, still_slope, still_filter, still_bias, still_leak
        Stillness as a function of the mean rate, in m/s and s/m; shares of a sample.
    ramp, fade
        Steps of the level a sample.
    safe_damping
        c_s, in N.s/m.
    adapts_friction, adapts_mass, estimates
        What the law uses of the estimates, and whether there are any.
    estimator, faults
        Of the estimator and of the detection of faults.
    """

    h: float
    half_h: float
    motion_1: float
    motion_2: float
    motion_3: float
    applied_gain: float
    answered_gain: float
    delay: int
    k_f: float
    m_s: float
    limit: float
    cushion_damping: float
    cushion_stiffness: float
    inertia: float
    nominal: SeatModel
    observer_gain: float
    envelope_keep: float
    rate_to_deflection: float
    follow_begin: float
    follow_slope: float
    follow_min: float
    follow_max: float
    follow_gain: float
    follow_filter: float
    lead_time: float
    per_friction_rate: float
    friction_share: float
    rate_gain: float
    centring_stiffness: float
    centring_damping: float
    centring_filter: float
    overload_begin: float
    overload_slope: float
    overload_damping: float
    overload_stiffness: float
    has_lead: bool
    lead_direct: float
    lead_lagging: float
    lead_gain: float
    bias_gain: float
    per_k_f: float
    bias_bound: float
    start_rate: float
    start_keep: float
    still_begin: float
    still_slope: float
    still_filter: float
    still_bias: float
    still_leak: float
    ramp: float
    fade: float
    safe_damping: float
    adapts_friction: bool
    adapts_mass: bool
    estimates: bool
    estimator: EstimatorCoefficients
    faults: FaultsCoefficients


class Sample(NamedTuple):
    """What the law gets at a sample.

    Attributes
    ----------
    acceleration, deflection
        Measurements, in m/s2 and m.
    deflection_before
        Measured at the sample before, in m.
    rate
        Filtered rate of the deflection, from it alone, in m/s.
    force
        Force of the last sample, in N.
    enabled
        Whether the controller is active.
    """

    acceleration: float
    deflection: float
    deflection_before: float
    rate: float
    force: float
    enabled: bool


# ---- coefficients ----------------------------------------------------------------------------------------------------


def _lag_gain(angle: float) -> float:
    """Return the share of a step that a first-order lag takes in a sample; the angle is h over its time constant."""
    return 1.0 - math.exp(-angle)


def _seat_model(
    driver_mass: float, m_s: float, cushion_damping: float, cushion_stiffness: float, inertia: float
) -> SeatModel:
    """Return the model with a driver: H_c by Tustin's rule; the arguments are those of the coefficients."""
    moved = driver_mass * inertia
    scale = 1.0 / (moved + cushion_damping + cushion_stiffness)
    return SeatModel(
        mass=driver_mass + m_s,
        b_0=(cushion_damping + cushion_stiffness) * scale,
        b_1=2.0 * cushion_stiffness * scale,
        b_2=(cushion_stiffness - cushion_damping) * scale,
        a_1=2.0 * (cushion_stiffness - moved) * scale,
        a_2=(moved - cushion_damping + cushion_stiffness) * scale,
    )


def _delay_in_samples(parameters: Parameters) -> int:
    """Return the actuator's delay in samples, rounded."""
    return math.floor(parameters.actuator_delay / SAMPLE_TIME.value + 0.5)


def _check(p: Parameters) -> None:
    """Check the parameters that hang on each other."""
    w_0 = 2.0 * math.pi * p.robust_centring_frequency
    if not p.robust_bias_rate < 2.0 * p.robust_centring_damping * w_0 * w_0 * w_0:
        raise ParameterError(
            "controller: expected robust.bias_rate below 2 robust.centring_damping (2 pi robust.centring_frequency)^3, "
            f"where the centring is stable, got {p.robust_bias_rate} 1/s3, {p.robust_centring_damping} and "
            f"{p.robust_centring_frequency} Hz"
        )
    if not p.robust_overload_begin < p.robust_overload_end:
        raise ParameterError(
            "controller: expected robust.overload_begin < robust.overload_end, got "
            f"{p.robust_overload_begin} and {p.robust_overload_end}"
        )
    if not p.travel <= p.robust_deflection_range:
        raise ParameterError(
            "controller: expected travel <= robust.deflection_range, got "
            f"{p.travel} m and {p.robust_deflection_range} m"
        )


def prepare(parameters: Parameters) -> RobustCoefficients:
    """Derive the coefficients of the law from the parameters.

    Parameters
    ----------
    parameters
        Parameters of the controller, each within its range.

    Returns
    -------
    RobustCoefficients
        For :func:`step`.

    Raises
    ------
    ParameterError
        If parameters contradict one another.
    """
    p = parameters
    _check(p)
    h = SAMPLE_TIME.value
    motion = 2.0 * math.pi * p.robust_motion_bandwidth
    cushion_damping = p.robust_cushion_damping * 2.0 / h
    inertia = 4.0 / (h * h)
    lag = p.actuator_time_constant
    shortest = max(LEAD_SHARE * lag, LEAD_FLOOR)
    left = min(lag, shortest)  # time constant of actuator and lead
    late = left + p.actuator_delay
    lead_direct = lag / shortest
    w_0 = 2.0 * math.pi * p.robust_centring_frequency
    w_l = 2.0 * math.pi * p.robust_centring_filter
    per_travel = 1.0 / p.travel if p.travel > 0.0 else 0.0
    adapts_mass = p.robust_estimator == Estimator.friction_and_mass
    return RobustCoefficients(
        h=h,
        half_h=0.5 * h,
        motion_1=2.0 * motion * h,
        motion_2=2.0 * motion * motion * h,
        motion_3=motion * motion * motion * h,
        applied_gain=_lag_gain(h / lag) if lag > 0.0 else 1.0,
        answered_gain=_lag_gain(h / left) if left > 0.0 else 1.0,
        delay=_delay_in_samples(p),
        k_f=p.suspension_stiffness,
        m_s=p.seat_mass,
        limit=p.force_limit,
        cushion_damping=cushion_damping,
        cushion_stiffness=p.robust_cushion_stiffness,
        inertia=inertia,
        nominal=_seat_model(p.driver_mass, p.seat_mass, cushion_damping, p.robust_cushion_stiffness, inertia),
        observer_gain=_lag_gain(p.robust_observer_rate * h),
        envelope_keep=1.0 - h * p.robust_envelope_decay,
        rate_to_deflection=1.0 / (2.0 * math.pi * p.robust_envelope_frequency),
        follow_begin=p.robust_follow_begin * p.travel,
        follow_slope=p.robust_follow_slope * per_travel,
        follow_min=0.0,
        follow_max=p.robust_follow_max,
        follow_gain=1.0 / (1.0 / p.robust_observer_rate + late),
        follow_filter=_lag_gain(2.0 * math.pi * FOLLOW_FILTER * h),
        lead_time=late,
        per_friction_rate=1.0 / p.robust_friction_rate,
        friction_share=p.robust_friction_share,
        rate_gain=p.suspension_stiffness * (late + PREDICTION_TIME),
        centring_stiffness=w_0 * w_0,
        centring_damping=2.0 * p.robust_centring_damping * w_0 * w_l,
        centring_filter=_lag_gain(w_l * h),
        overload_begin=p.robust_overload_begin * p.travel,
        overload_slope=per_travel / (p.robust_overload_end - p.robust_overload_begin),
        overload_damping=p.robust_overload_damping,
        overload_stiffness=OVERLOAD_STIFFNESS,
        has_lead=lag > shortest,
        lead_direct=lead_direct,
        lead_lagging=1.0 - lead_direct,
        lead_gain=_lag_gain(h / shortest),
        bias_gain=h * p.robust_bias_rate,
        per_k_f=1.0 / p.suspension_stiffness,
        bias_bound=BIAS_BOUND,
        start_rate=START_RATE * h,
        start_keep=1.0 - h / START_TIME,
        still_begin=STILL_RATE,
        still_slope=1.0 / STILL_RANGE,
        still_filter=_lag_gain(2.0 * math.pi * STILL_FILTER * h),
        still_bias=h / STILL_TIME,
        still_leak=h * STILL_LEAK,
        ramp=h / p.robust_ramp_time,
        fade=h / FADE_TIME,
        safe_damping=p.robust_safe_damping,
        adapts_friction=adapts_mass or p.robust_estimator == Estimator.friction,
        adapts_mass=adapts_mass,
        estimates=p.robust_estimator != Estimator.off,
        estimator=estimator.prepare(p),
        faults=faults.prepare(p),
    )


# ---- state -----------------------------------------------------------------------------------------------------------

_AT_REST = (0.0,) * 19
_EMPTY_LINE = (0.0,) * (2 * MAX_DELAY_SAMPLES)


def start(c: RobustCoefficients) -> RobustState:
    """Return the state before the first sample.

    Parameters
    ----------
    c
        Coefficients from :func:`prepare`.

    Returns
    -------
    RobustState
        Without force, information or fault.
    """
    return RobustState(False, *_AT_REST, estimator.start(c.estimator), FaultsState(), 0, 2 * c.delay, _EMPTY_LINE)


def is_valid_state(state: RobustState, parameters: Parameters) -> bool:
    """Check that a run can have a state: its delay line is that of the parameters, its fault exists.

    Parameters
    ----------
    state
        State of any origin; all its numbers are finite.
    parameters
        Parameters of the controller.

    Returns
    -------
    bool
        Whether a run can have this state.
    """
    delay = _delay_in_samples(parameters)
    place = 0 <= state.place < max(delay, 1)
    return state.line_length == 2 * delay and place and state.faults.fault in list(Fault)


def _begin(s: RobustState, m: Sample, c: RobustCoefficients) -> RobustState:
    """Return the state of rest under the present measurements without force; estimates, level and faults stay.

    Friction holds the spring then, so the law asks for no force at first.
    """
    n = c.nominal
    cushion_2 = (n.b_2 - n.a_2) * m.acceleration
    return start(c)._replace(
        active=True,
        level=s.level,
        position=m.deflection,
        slow=m.deflection,
        floor=m.acceleration,
        cushion_1=(n.b_1 - n.a_1) * m.acceleration + cushion_2,
        cushion_2=cushion_2,
        estimate=-c.k_f * m.deflection,
        start=c.start_rate,
        estimator=s.estimator,
        faults=s.faults,
    )


# ---- a sample --------------------------------------------------------------------------------------------------------


def _clip(x: float, low: float, high: float) -> float:
    return low if x < low else high if x > high else x


def _moved(share: float, up: bool, step: float) -> float:
    """Move a share towards 1 or 0 by a step, within these."""
    return _clip(share + step if up else share - step, 0.0, 1.0)


def _model_actuator(s: RobustState, force: float, c: RobustCoefficients) -> RobustState:
    """Advance the modelled actuator by a sample; its command was the last sample's."""
    part, target = s.part, force
    if c.delay > 0:
        i = 2 * s.place
        part, target = s.line[i : i + 2]
        line = (*s.line[:i], s.part, force, *s.line[i + 2 :])
        s = s._replace(line=line, place=s.place + 1 if s.place + 1 < c.delay else 0)
    return s._replace(
        answered=s.answered + c.answered_gain * (part - s.answered),
        applied=s.applied + c.applied_gain * (target - s.applied),
    )


class _Prediction(NamedTuple):
    """Predicted motion of the deflection: change of the rate in m/s, position in m."""

    change: float
    position: float


def _predict_motion(s: RobustState, acceleration: float, c: RobustCoefficients) -> _Prediction:
    change = c.h * (acceleration - s.floor)
    return _Prediction(change, s.position + c.h * s.rate + c.half_h * change)


def _run_law(
    s: RobustState, m: Sample, predicted: _Prediction, c: RobustCoefficients
) -> tuple[RobustState, float, float]:
    """Run the law for a sample; returns the state, the force demand and the force in N."""
    delta, a = m.deflection, m.acceleration
    n = c.nominal
    if c.adapts_mass and s.estimator.mass_trusted:
        n = _seat_model(s.estimator.mass, c.m_s, c.cushion_damping, c.cushion_stiffness, c.inertia)

    # motion of the deflection
    surprise = delta - predicted.position
    position = predicted.position + c.motion_1 * surprise
    v = s.rate + predicted.change + c.motion_2 * surprise
    floor = s.floor - c.motion_3 * surprise
    w = a - floor

    # disturbance observer
    before = s.applied
    s = _model_actuator(s, m.force, c)
    a_b = n.b_0 * a + s.cushion_1
    cushion_1 = n.b_1 * a - n.a_1 * a_b + s.cushion_2
    cushion_2 = n.b_2 * a - n.a_2 * a_b
    spring = c.k_f * delta
    free_force = n.mass * s.bias - spring - c.m_s * a - (n.mass - c.m_s) * a_b
    F = s.estimate + c.observer_gain * (s.answered + free_force - s.estimate)

    # force that the observer does not answer for: friction ahead, follow term
    ahead = c.rate_to_deflection * v
    A = max(math.sqrt(delta * delta + ahead * ahead), c.envelope_keep * s.envelope)
    still = 1.0 - _clip((s.speed - c.still_begin) * c.still_slope, 0.0, 1.0)
    speed = s.speed + c.still_filter * (abs(v) - s.speed)
    friction = s.estimator.friction if c.adapts_friction else c.estimator.nominal_friction
    direction = _clip((v + c.lead_time * w) * c.per_friction_rate, -1.0, 1.0)
    beta = _clip((A - c.follow_begin) * c.follow_slope, c.follow_min, c.follow_max)
    v_g = s.followed + c.follow_filter * (v - s.followed)
    u_x = c.friction_share * friction * (1.0 - still) * direction - beta * c.follow_gain * n.mass * v_g

    # law
    gap = delta - s.slow
    d = s.slow + c.centring_filter * gap
    centring = n.mass * (c.centring_stiffness * d + c.centring_damping * gap)
    u = spring + c.rate_gain * v + F - centring + u_x
    overload = _clip((A - c.overload_begin) * c.overload_slope, 0.0, 1.0)
    if overload > 0.0:
        u = u + overload * (c.overload_stiffness * delta - c.overload_damping * v - u)
        u_x = (1.0 - overload) * u_x
    commanded, lagging = u, s.lagging
    if c.has_lead:
        lagging = s.lagging + c.lead_gain * (u - s.lagging)
        commanded = c.lead_direct * u + c.lead_lagging * lagging
    level = _moved(s.level, m.enabled, c.ramp)
    demand = level * commanded
    force = _clip(demand, -c.limit, c.limit)
    part = u + (force - commanded) - level * u_x

    # bias
    error = a - s.bias
    moving = s.bias - c.bias_gain * (delta + force * c.per_k_f) + s.start * error
    resting = s.bias + c.still_bias * error
    bias = _clip(moving + still * (resting - moving), -c.bias_bound, c.bias_bound)
    F = F - still * c.still_leak * F

    estimates = estimator.slide(s.estimator, v)
    sliding = estimates.sliding_direction
    if c.estimates and sliding != 0.0 and s.faults.is_clear_of_stops:
        late = 0.5 * (before + s.applied)  # as late as sensors with a low-pass of 100 Hz
        estimates = estimator.step(estimates, late - spring - c.m_s * a, a_b, c.estimator)
    found = faults.check_balance(
        s.faults,
        s.applied + free_force,
        estimates.friction,
        sliding,
        not abs(bias) < c.bias_bound,
        c.faults,
    )
    s = s._replace(
        level=level,
        safety=0.0,
        estimator=estimates,
        faults=found,
        held=flush_subnormal(force),
        position=flush_subnormal(position),
        rate=flush_subnormal(v),
        floor=flush_subnormal(floor),
        applied=flush_subnormal(s.applied),
        answered=flush_subnormal(s.answered),
        part=flush_subnormal(part),
        cushion_1=flush_subnormal(cushion_1),
        cushion_2=flush_subnormal(cushion_2),
        estimate=flush_subnormal(F),
        bias=flush_subnormal(bias),
        start=flush_subnormal(c.start_keep * s.start),
        envelope=flush_subnormal(A),
        followed=flush_subnormal(v_g),
        slow=flush_subnormal(d),
        speed=flush_subnormal(speed),
        lagging=flush_subnormal(lagging),
    )
    return s, demand, force


def _run_safe(s: RobustState, m: Sample, c: RobustCoefficients) -> tuple[RobustState, float, float]:
    """Let the last force fade after a fault, and a damper take its place where the deflection is trusted."""
    level = 1.0 if s.active else s.level  # of the held force, which has the former level in it
    level = _moved(level, False, c.fade)
    safety = _moved(s.safety, m.enabled and s.faults.deflection_is_trusted, c.fade)
    demand = level * s.held - safety * c.safe_damping * m.rate
    s = s._replace(active=False, level=level, safety=safety)
    return s, demand, _clip(demand, -c.limit, c.limit)


def step(state: RobustState, sample: Sample, c: RobustCoefficients) -> tuple[RobustState, float, float]:
    """Take a sample: check the sensors, then run the law or the safe state.

    Parameters
    ----------
    state
        State after the previous sample.
    sample
        Measurements at the sample.
    c
        Coefficients from :func:`prepare`.

    Returns
    -------
    state : RobustState
        After the sample.
    demand, force : float
        Force demand and force, in N.
    """
    s = state
    off = not sample.enabled and not s.level > 0.0 and not s.safety > 0.0
    if off:  # the way to acknowledge a fault
        s = s._replace(active=False, faults=FaultsState())
    found = faults.check_signals(
        s.faults, sample.acceleration, sample.deflection, sample.deflection_before, sample.rate, c.faults
    )
    s = s._replace(faults=found)
    demand = force = 0.0
    predicted = _Prediction(0.0, 0.0)
    if not off and found.fault == Fault.none:
        s = s if s.active else _begin(s, sample, c)
        predicted = _predict_motion(s, sample.acceleration, c)
        s = s._replace(faults=faults.check_prediction(s.faults, sample.deflection - predicted.position))
    if s.faults.fault != Fault.none:
        s, demand, force = _run_safe(s, sample, c)
    elif not off:
        s, demand, force = _run_law(s, sample, predicted, c)
    if not c.estimates:
        nominal = c.estimator
        s = s._replace(estimator=s.estimator._replace(mass=nominal.nominal_mass, friction=nominal.nominal_friction))
    return s, demand, force
