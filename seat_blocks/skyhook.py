"""The law of a variable damper: as a damper between seat and inertial frame, as far as one between seat and floor can.

One sample k, with a the measured acceleration of the seat, delta the measured deflection and h the sample time:

    w_k = (w_(k-1) + h (a_k + a_(k-1))/2) / (1 + 2 pi f_l h)          velocity of the seat, by a leaky integrator
    v_k = (tau v_(k-1) + delta_k - delta_(k-1)) / (tau + h)           rate of the deflection, tau = 1/(2 pi f_c)
    c_k = clip(c_sky w_k/v_k, c_min, c_max) where w_k v_k > 0, else c_min

The force that is wanted on the seat is -c_sky w. A damper gives -c v: where w and v have the same sign it can give it,
within its range; where they have not, it would have to push energy in, and is opened instead.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from fmus.component import CLOCK_TOLERANCE
from fmus.subnormal import flush_subnormal
from seat_blocks.interface import DamperParameters
from seat_controller_fmu.parameters import SAMPLE_TIME
from seat_controller_fmu.sampling import filtered_rate, rate_filter, samples_before


class SkyhookState(NamedTuple):
    """State of the law after a sample.

    Attributes
    ----------
    next_sample
        Number k of the next sample, due at the time k h.
    started
        Whether a sample was taken: before the first one there are no previous measurements.
    acceleration, deflection
        a in m/s2 and delta in m of the last sample.
    velocity, rate
        w and v of the last sample, in m/s.
    damping
        c of the last sample, in N.s/m.
    """

    next_sample: int
    started: bool
    acceleration: float
    deflection: float
    velocity: float
    rate: float
    damping: float


class SkyhookCoefficients(NamedTuple):
    """Factors of the law.

    Attributes
    ----------
    c_min, c_max, c_sky
        In N.s/m.
    half_step
        h/2, in s.
    leak
        1 + 2 pi f_l h.
    rate_decay, rate_gain
        Of the rate filter, in 1 and 1/s.
    """

    c_min: float
    c_max: float
    c_sky: float
    half_step: float
    leak: float
    rate_decay: float
    rate_gain: float


def prepare(parameters: DamperParameters) -> SkyhookCoefficients:
    """Derive the factors of the law.

    Parameters
    ----------
    parameters
        Parameters of the damper.

    Returns
    -------
    SkyhookCoefficients
        For :func:`advance`.
    """
    p, h = parameters, SAMPLE_TIME.value
    return SkyhookCoefficients(
        p.minimum,
        p.maximum,
        p.skyhook,
        0.5 * h,
        1.0 + 2.0 * math.pi * p.velocity_corner * h,
        *rate_filter(p.rate_filter_cutoff, h),
    )


def start(coefficients: SkyhookCoefficients, time: float) -> SkyhookState:
    """Return the state before the first sample, with an open damper.

    Parameters
    ----------
    coefficients
        From :func:`prepare`.
    time
        Start time, in s.

    Returns
    -------
    SkyhookState
        Before the first sample.
    """
    return SkyhookState(samples_before(time, SAMPLE_TIME.value), False, 0.0, 0.0, 0.0, 0.0, coefficients.c_min)


def sample(state: SkyhookState, acceleration: float, deflection: float, c: SkyhookCoefficients) -> SkyhookState:
    """Take one sample of both measurements.

    Parameters
    ----------
    state
        State after the previous sample.
    acceleration, deflection
        Measurements, in m/s2 and m.
    c
        From :func:`prepare`.

    Returns
    -------
    SkyhookState
        After the sample.
    """
    a_before, delta_before = (state.acceleration, state.deflection) if state.started else (acceleration, deflection)
    w = (state.velocity + c.half_step * (acceleration + a_before)) / c.leak
    v = filtered_rate(state.rate, delta_before, deflection, c.rate_decay, c.rate_gain)
    w, v = flush_subnormal(w), flush_subnormal(v)
    damping = min(max(c.c_sky * w / v, c.c_min), c.c_max) if w * v > 0.0 else c.c_min
    return SkyhookState(
        state.next_sample + 1, True, flush_subnormal(acceleration), flush_subnormal(deflection), w, v, damping
    )


def advance(
    state: SkyhookState,
    acceleration: float,
    deflection: float,
    coefficients: SkyhookCoefficients,
    time: float,
    duration: float,
) -> SkyhookState:
    """Take every sample due in [time, time + duration), all with the same measurements.

    Parameters
    ----------
    state
        State at ``time``.
    acceleration, deflection
        Measurements at ``time``, in m/s2 and m.
    coefficients
        From :func:`prepare`.
    time, duration
        In s.

    Returns
    -------
    SkyhookState
        After the last sample.
    """
    end = samples_before(time + duration, SAMPLE_TIME.value)
    while state.next_sample < end:
        state = sample(state, acceleration, deflection, coefficients)
    return state


def is_valid_state(state: SkyhookState, time: float) -> bool:
    """Check that a run can have a state at a time: its next sample is near that time.

    Parameters
    ----------
    state
        State of any origin; all its numbers are finite.
    time
        Time that the run has reached, in s.

    Returns
    -------
    bool
        Whether a run can have this state.
    """
    return abs(state.next_sample * SAMPLE_TIME.value - time) <= CLOCK_TOLERANCE
