"""The actuator: force limit, delay and first-order lag, in this order.

The force input is constant over a communication step. The delay line is a queue of force changes, each with its time of
arrival, so it delays by any time exactly, at any step size. The line has a limited capacity. It accepts a change only
if the change before is at least 1/128 of the delay old (1.6 ms at a delay of 0.2 s); until then the latest force waits
at the input. Forces that change every 2 ms, as the controller's do, are delayed exactly; at shorter communication steps
a change can be late by 1/128 of the delay.

The lag is T_a f' = target - f. Over a substep its exponential is replaced by the straight line that has the same
impulse and the same first moment. A free mass then ends the substep with the velocity and the displacement that the
exponential gives it, whatever the length of the substep.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from fmus.subnormal import flush_subnormal

DELAY_LINE_CAPACITY = 128
"""Number of force changes in the delay line."""

TIME_TOLERANCE = 1e-9
"""Times closer than this, in s, are equal: communication points carry rounding errors."""

DelayLine = Annotated[tuple[float, ...], 2 * DELAY_LINE_CAPACITY, "line_length"]


class ActuatorState(NamedTuple):
    """State of the actuator.

    Attributes
    ----------
    commanded
        Latest force that entered the delay line, in N.
    target
        Latest force that left the delay line, in N.
    force
        Force on the seat, in N, up positive.
    line_length
        Number of values in use in ``line``.
    line
        Time of arrival in s and force in N of each change in the delay line, then zeros.
    """

    commanded: float
    target: float
    force: float
    line_length: int
    line: DelayLine


AT_REST = ActuatorState(0.0, 0.0, 0.0, 0, (0.0,) * (2 * DELAY_LINE_CAPACITY))
"""State of an actuator that has received no force yet."""


class ActuatorCoefficients(NamedTuple):
    """Coefficients of the actuator.

    Attributes
    ----------
    limit
        Largest magnitude of the force, in N; may be infinite.
    delay
        T_d, in s.
    time_constant
        T_a of the lag, in s.
    """

    limit: float
    delay: float
    time_constant: float


def prepare(force_limit: float, delay: float, time_constant: float) -> ActuatorCoefficients:
    """Derive the coefficients from the parameters.

    Parameters
    ----------
    force_limit
        Largest magnitude of the force, in N; 0 for no limit.
    delay
        T_d, in s; 0 for none.
    time_constant
        T_a of the lag, in s; 0 for none.

    Returns
    -------
    ActuatorCoefficients
        The same, with an infinite limit where there is none.
    """
    return ActuatorCoefficients(force_limit if force_limit > 0.0 else math.inf, delay, time_constant)


def is_valid_state(state: ActuatorState) -> bool:
    """Check that the delay line holds complete pairs and not more than its capacity.

    Parameters
    ----------
    state
        State of any origin.

    Returns
    -------
    bool
        Whether a run can have this state.
    """
    return state.line_length % 2 == 0 and 0 <= state.line_length <= 2 * DELAY_LINE_CAPACITY


def clip_force(force: float, c: ActuatorCoefficients) -> float:
    """Limit a force to [-limit, limit].

    Parameters
    ----------
    force
        In N.
    c
        Coefficients of the actuator.

    Returns
    -------
    float
        In N.
    """
    return min(max(force, -c.limit), c.limit)


def initialize(force: float, c: ActuatorCoefficients) -> ActuatorState:
    """Return the steady state at a constant force.

    Parameters
    ----------
    force
        Force input before the start, in N.
    c
        Coefficients of the actuator.

    Returns
    -------
    ActuatorState
        With an empty delay line; the clipped force acts on the seat.
    """
    force = clip_force(force, c)
    return AT_REST._replace(commanded=force, target=force, force=force)


def command(state: ActuatorState, force: float, c: ActuatorCoefficients, time: float) -> ActuatorState:
    """Set the force input from a time on.

    Parameters
    ----------
    state
        State at ``time``.
    force
        In N.
    c
        Coefficients of the actuator.
    time
        In s.

    Returns
    -------
    ActuatorState
        With the clipped force as target, or in the delay line.
    """
    force = clip_force(force, c)
    if c.delay == 0.0:
        return state._replace(commanded=force, target=force)
    return _enqueue(state, force, c, time)


def _enqueue(state: ActuatorState, force: float, c: ActuatorCoefficients, time: float) -> ActuatorState:
    """Append a change of force to the delay line; the state stays if it is no change, too early or the line is full."""
    length, arrival = state.line_length, time + c.delay
    early = length > 0 and arrival - state.line[length - 2] < c.delay / DELAY_LINE_CAPACITY - TIME_TOLERANCE
    if force == state.commanded or early or length == 2 * DELAY_LINE_CAPACITY:
        return state
    line = (*state.line[:length], arrival, force, *state.line[length + 2 :])
    return state._replace(commanded=force, line_length=length + 2, line=line)


def release_due(state: ActuatorState, time: float, begin: float, step_size: float) -> tuple[ActuatorState, float]:
    """Take the changes that are due out of the delay line.

    Parameters
    ----------
    state
        State before.
    time
        Begin of the communication step, in s.
    begin
        Time since the begin of the step, in s.
    step_size
        Communication step size, in s.

    Returns
    -------
    state : ActuatorState
        With the force of the last due change as target.
    end : float
        Time since the begin of the step, in s, until which this target holds: the next change or the end of the step.
    """
    length, line, target = state.line_length, state.line, state.target
    due = 0
    while due < length and line[due] - time < begin + TIME_TOLERANCE:
        target = line[due + 1]
        due += 2
    if due > 0:
        line = (*line[due:], *(0.0,) * due)
        state = state._replace(target=target, line_length=length - due, line=line)
    if due < length and line[0] - time < step_size - TIME_TOLERANCE:
        return state, line[0] - time
    return state, step_size


class Lag(NamedTuple):
    """Effect of the lag over a substep, as factors on the deviation of the force from its target.

    Attributes
    ----------
    first, last
        Deviation at both ends of the straight line.
    remaining
        Deviation after the substep.
    """

    first: float
    last: float
    remaining: float


def prepare_lag(c: ActuatorCoefficients, h: float) -> Lag | None:
    """Derive the effect of the lag over a substep.

    Parameters
    ----------
    c
        Coefficients of the actuator.
    h
        Length of the substep, in s.

    Returns
    -------
    Lag or None
        None without a lag.
    """
    if c.time_constant == 0.0:
        return None
    x = h / c.time_constant
    decay = math.expm1(-x)
    impulse = -decay / x  # of exp(-x s) over s from 0 to 1
    moment = (x + decay) / (x * x)  # of exp(-x s) (1 - s)
    first = 6.0 * moment - 2.0 * impulse
    return Lag(first, 2.0 * impulse - first, 1.0 + decay)


def apply_lag(force: float, target: float, lag: Lag | None) -> tuple[float, float, float]:
    """Advance the force over a substep.

    Parameters
    ----------
    force
        Force on the seat before, in N; not used without a lag.
    target
        Force that left the delay line, in N.
    lag
        From :func:`prepare_lag`.

    Returns
    -------
    first, last : float
        Ends of the straight line over the substep, in N.
    force : float
        Force on the seat after, in N.
    """
    if lag is None:
        return target, target, target
    deviation = force - target
    first, last = target + deviation * lag.first, target + deviation * lag.last
    return first, last, flush_subnormal(target + deviation * lag.remaining)
