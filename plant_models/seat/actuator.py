"""The actuator: force limit, delay and first-order lag, in this order.

The force that is asked for is constant between communication steps. So the delay is a line of changes, each with the
time of its arrival, and shifts by any time exactly, whatever the step sizes. The line has a limited number of places:
it takes a change only when the one before is a share of 1/128 of the delay old (1.6 ms at 0.2 s), and the latest force
waits until then. So nothing is lost or moved where the force changes every 2 ms, as a controller does; at shorter steps
a change may be late by that share.

The lag is T_a f' = target - f. In a substep, its exponential is replaced by the straight line of the same impulse and
the same first moment: a free mass ends with exactly the velocity and displacement that the exponential gives it, at any
length of the substep.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from fmus.subnormal import flush_subnormal

PLACES = 128
"""Changes in the delay line."""

SAME_INSTANT = 1e-9
"""Times closer than this, in s, are one instant: communication points carry rounding errors."""

Line = Annotated[tuple[float, ...], 2 * PLACES, "line_length"]


class State(NamedTuple):
    """State of the actuator.

    Attributes
    ----------
    commanded
        Latest force that entered the delay, in N.
    target
        Latest force that left it, in N.
    force
        On the seat, in N.
    line_length
        How many numbers of the line are in use.
    line
        Arrival in s and force in N of one change after the other, then zeros.
    """

    commanded: float
    target: float
    force: float
    line_length: int
    line: Line


AT_REST = State(0.0, 0.0, 0.0, 0, (0.0,) * (2 * PLACES))
"""An actuator that was never asked for a force."""


def is_valid_state(state: State) -> bool:
    """Whether the delay line holds pairs, no more than there is room for."""
    return state.line_length % 2 == 0 and 0 <= state.line_length <= 2 * PLACES


class Actuator(NamedTuple):
    """What the actuator does to a force; the limit may be infinite, everything else zero."""

    limit: float
    delay: float
    time_constant: float

    def limited(self, force: float) -> float:
        """Clip a force, in N."""
        return min(max(force, -self.limit), self.limit)


def actuator(force_limit: float, delay: float, time_constant: float) -> Actuator:
    """Prepare an actuator; a limit of 0 is none."""
    return Actuator(force_limit if force_limit > 0.0 else math.inf, delay, time_constant)


def settled(force: float, a: Actuator) -> State:
    """Start with a force, in N, that has always been asked for."""
    force = a.limited(force)
    return AT_REST._replace(commanded=force, target=force, force=force)


def commanded(state: State, force: float, a: Actuator, time: float) -> State:
    """Ask for a force from a time on.

    Parameters
    ----------
    state
        At that time.
    force
        In N.
    a
        The actuator.
    time
        In s.
    """
    force = a.limited(force)
    if a.delay == 0.0:
        return state._replace(commanded=force, target=force)
    length, arrival = state.line_length, time + a.delay
    early = length > 0 and arrival - state.line[length - 2] < a.delay / PLACES - SAME_INSTANT
    if force == state.commanded or early or length == 2 * PLACES:
        return state
    line = (*state.line[:length], arrival, force, *state.line[length + 2 :])
    return state._replace(commanded=force, line_length=length + 2, line=line)


def arrived(state: State, time: float, begin: float, step_size: float) -> tuple[State, float]:
    """Let the changes that are due leave the delay.

    Parameters
    ----------
    state
        Before.
    time
        When the communication step begins, in s.
    begin
        What of the step is over, in s.
    step_size
        Of the communication step, in s.

    Returns
    -------
    tuple of State and float
        After; and how far into the step its target holds, in s: until the next change, or the end.
    """
    length, line, target = state.line_length, state.line, state.target
    due = 0
    while due < length and line[due] - time < begin + SAME_INSTANT:
        target = line[due + 1]
        due += 2
    if due > 0:
        line = (*line[due:], *(0.0,) * due)
        state = state._replace(target=target, line_length=length - due, line=line)
    if due < length and line[0] - time < step_size - SAME_INSTANT:
        return state, line[0] - time
    return state, step_size


class Substep(NamedTuple):
    """What a lag makes of the deviation from its target: at both ends of the straight line, and what is left of it."""

    first: float
    last: float
    left: float


def lag(a: Actuator, h: float) -> Substep | None:
    """Prepare substeps of a length, in s; None without a lag."""
    if a.time_constant == 0.0:
        return None
    x = h / a.time_constant
    faded = math.expm1(-x)
    impulse = -faded / x  # of exp(-x s) over s from 0 to 1
    moment = (x + faded) / (x * x)  # of exp(-x s) (1 - s)
    first = 6.0 * moment - 2.0 * impulse
    return Substep(first, 2.0 * impulse - first, 1.0 + faded)


def lagged(force: float, target: float, substep: Substep | None) -> tuple[float, float, float]:
    """Move the force over a substep; returns the straight line's ends and the force after it, in N."""
    if substep is None:
        return target, target, target
    deviation = force - target
    first, last = target + deviation * substep.first, target + deviation * substep.last
    return first, last, flush_subnormal(target + deviation * substep.left)
