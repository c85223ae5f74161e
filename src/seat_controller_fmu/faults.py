"""Detection of sensor faults. The first fault is latched.

A measurement is not finite, beyond its range, or the same to the bit for 90 ms while the other sensor says that the
seat moves. The deflection jumps, further than the seat can move in a sample or than the observed motion predicts. Or
the two sensors and the force contradict each other: the balance of forces

    u - k_f delta - m_s a_s - m_b a_b + M b

is the friction if all are right: F_r sgn v while the seat slides, between -F_r and F_r otherwise. What exceeds that,
and what an unknown mass can explain, is integrated.

An impact on an end stop is no fault. The accelerometer may then be beyond its range for 100 ms, and the balance of
forces and the prediction are not judged until 0.3 s after the seat was last near a stop, or after the start.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from seat_controller_fmu.interface import Fault, Parameters
from seat_controller_fmu.parameters import SAMPLE_TIME

IMPACT_SAMPLES = 50.0
"""Samples that the acceleration may be beyond its range around an impact."""
FROZEN_SAMPLES = 45.0
"""Samples after which a measurement that does not change by a bit is frozen, if the seat moves."""
FROZEN_PATH = 0.008
"""Way of the deflection in m from which on a constant acceleration is frozen."""
FROZEN_RATE = 0.03
"""Rate in m/s from which no friction stops the seat within a sample: a deflection that stands still then is frozen."""
JUMP_RATE = 3.0
"""Rate in m/s that the deflection does not reach."""
LARGEST_SURPRISE = 0.8e-3
"""Largest distance in m of the deflection from the observed motion's prediction; 0.35 mm with healthy sensors."""
NEAR_STOP = 0.95
"""Share of the travel from which on an end stop is near."""
SETTLING_SAMPLES = 150.0
"""Samples after which the seat has settled from an impact."""
ESTIMATOR_SAMPLES = 50.0
"""Samples after which the estimator takes part again."""
BALANCE_TIME = 0.02
"""Time constant of the low-pass of the balance, in s: what an untold delay of the actuator does is shorter."""
BALANCE_MARGIN, BALANCE_MASS = 30.0, 45.0
"""How far the balance may be off: a constant in N, and an unknown mass in kg."""
FRICTION_BEYOND, FRICTION_UNKNOWN = 1.2, 0.25
"""Share of the friction that is allowed besides: around 0, and around the friction while the seat slides."""
IMBALANCE_LIMIT, IMBALANCE_RATE = 3.0, 4.0
"""Largest leaky integral of the excess in N.s, and the rate of its leak in 1/s."""
BIASED_SAMPLES = 1000.0
"""Samples after which a bias at its bound is a fault: 2 s."""


class FaultsState(NamedTuple):
    """State of the detection.

    Attributes
    ----------
    fault
        The latched one, see :class:`~seat_controller_fmu.interface.Fault`.
    acceleration
        Of the last sample, in m/s2.
    beyond_range
        Samples since the acceleration is beyond its range.
    same_acceleration, same_deflection
        Samples since they have not changed by a bit.
    path
        Way of the deflection since the acceleration has not changed, in m.
    rate_before
        Filtered rate before the deflection stood still, in m/s.
    clear
        Samples since an end stop was near, at most :data:`SETTLING_SAMPLES`.
    balance, low_passed
        Low-passed balance of forces in N, and acceleration in m/s2.
    imbalance
        Leaky integral of its excess, in N.s.
    biased
        Samples since the bias is at its bound.
    """

    fault: int = Fault.none.value
    acceleration: float = 0.0
    beyond_range: float = 0.0
    same_acceleration: float = 0.0
    same_deflection: float = 0.0
    path: float = 0.0
    rate_before: float = 0.0
    clear: float = 0.0
    balance: float = 0.0
    low_passed: float = 0.0
    imbalance: float = 0.0
    biased: float = 0.0

    @property
    def is_clear_of_stops(self) -> bool:
        """Whether no end stop was near for a time after which the estimator takes part."""
        return self.clear >= ESTIMATOR_SAMPLES

    @property
    def deflection_is_trusted(self) -> bool:
        """Whether the deflection can be trusted in spite of the fault."""
        return self.fault < Fault.deflection_invalid


class FaultsCoefficients(NamedTuple):
    """Coefficients of the detection.

    Attributes
    ----------
    sample_time
        h, in s.
    balance_gain
        Of the low-pass of the balance a sample.
    imbalance_decay
        Factor on the integral a sample.
    acceleration_range, deflection_range
        In m/s2 and m.
    knows_stops
        Whether the travel is known.
    near_stop
        Deflection from which on an end stop is near, in m.
    """

    sample_time: float
    balance_gain: float
    imbalance_decay: float
    acceleration_range: float
    deflection_range: float
    knows_stops: bool
    near_stop: float


def prepare(parameters: Parameters) -> FaultsCoefficients:
    """Derive the coefficients of the detection from the parameters.

    Parameters
    ----------
    parameters
        Parameters of the controller.

    Returns
    -------
    FaultsCoefficients
        For the checks.
    """
    h = SAMPLE_TIME.value
    return FaultsCoefficients(
        sample_time=h,
        balance_gain=h / BALANCE_TIME,
        imbalance_decay=1.0 - IMBALANCE_RATE * h,
        acceleration_range=parameters.robust_acceleration_range,
        deflection_range=parameters.robust_deflection_range,
        knows_stops=parameters.travel > 0.0,
        near_stop=NEAR_STOP * parameters.travel,
    )


def _latched(fault: int, *findings: tuple[bool, Fault]) -> int:
    """Return the latched fault: the old one, or the first of the findings."""
    if fault != Fault.none:
        return fault
    return next((kind.value for found, kind in findings if found), Fault.none.value)


def _counted(samples: float, holds: bool) -> float:
    """Count a sample in which something holds, from 0 on."""
    return samples + 1.0 if holds else 0.0


def check_signals(
    state: FaultsState,
    acceleration: float,
    deflection: float,
    deflection_before: float,
    rate: float,
    c: FaultsCoefficients,
) -> FaultsState:
    """Check the measurements of a sample against those before.

    Parameters
    ----------
    state
        State after the previous sample.
    acceleration
        Measured seat acceleration, in m/s2.
    deflection, deflection_before
        Measured deflection at this sample and the one before, in m.
    rate
        Filtered rate of the deflection, in m/s.
    c
        Coefficients from :func:`prepare`.

    Returns
    -------
    FaultsState
        With the fault latched, if there is one.
    """
    near = c.knows_stops and abs(deflection) > c.near_stop
    clear = 0.0 if near else min(state.clear + 1.0, SETTLING_SAMPLES)
    beyond_range = _counted(state.beyond_range, abs(acceleration) > c.acceleration_range)
    allowed = IMPACT_SAMPLES if clear < SETTLING_SAMPLES or not c.knows_stops else 0.0
    still = deflection == deflection_before
    rate_before = state.rate_before if still else rate
    same_deflection = _counted(state.same_deflection, still)
    constant = acceleration == state.acceleration
    same_acceleration = _counted(state.same_acceleration, constant)
    path = state.path + abs(deflection - deflection_before) if constant else 0.0
    fault = _latched(
        state.fault,
        (not math.isfinite(acceleration), Fault.acceleration_invalid),
        (not math.isfinite(deflection), Fault.deflection_invalid),
        (abs(deflection) > c.deflection_range, Fault.deflection_range),
        (abs(deflection - deflection_before) > JUMP_RATE * c.sample_time, Fault.deflection_jump),
        (beyond_range > allowed, Fault.acceleration_range),
        (same_acceleration > FROZEN_SAMPLES and path > FROZEN_PATH, Fault.acceleration_frozen),
        (same_deflection > FROZEN_SAMPLES and abs(rate_before) > FROZEN_RATE, Fault.deflection_frozen),
    )
    return state._replace(
        fault=fault,
        acceleration=acceleration,
        beyond_range=beyond_range,
        same_acceleration=same_acceleration,
        same_deflection=same_deflection,
        path=path,
        rate_before=rate_before,
        clear=clear,
    )


def check_prediction(state: FaultsState, surprise: float) -> FaultsState:
    """Check the deflection against the observed motion.

    Parameters
    ----------
    state
        State from :func:`check_signals` of this sample.
    surprise
        Distance of the deflection from the prediction, in m.

    Returns
    -------
    FaultsState
        With the fault latched, if there is one.
    """
    jumps = state.clear >= SETTLING_SAMPLES and abs(surprise) > LARGEST_SURPRISE and state.beyond_range == 0.0
    return state._replace(fault=_latched(state.fault, (jumps, Fault.deflection_jump)))


def check_balance(
    state: FaultsState,
    balance: float,
    friction: float,
    direction: float,
    bias_at_bound: bool,
    c: FaultsCoefficients,
) -> FaultsState:
    """Check the balance of forces and the estimated bias.

    Parameters
    ----------
    state
        State from :func:`check_signals` of this sample.
    balance
        Balance of forces, in N.
    friction
        Estimated friction, in N.
    direction
        Of sliding: -1, 1, or 0 if the seat does not slide.
    bias_at_bound
        Whether the estimate of the accelerometer's bias is at its bound.
    c
        Coefficients from :func:`prepare`.

    Returns
    -------
    FaultsState
        With the fault latched, if there is one.
    """
    low_passed = state.low_passed + c.balance_gain * (state.acceleration - state.low_passed)
    smooth = state.balance + c.balance_gain * (balance - state.balance)
    unknown = FRICTION_UNKNOWN * friction if direction != 0.0 else FRICTION_BEYOND * friction
    allowed = BALANCE_MARGIN + unknown + BALANCE_MASS * abs(low_passed)
    excess = abs(smooth - direction * friction) - allowed
    kept = c.imbalance_decay * state.imbalance
    settled = state.clear >= SETTLING_SAMPLES
    imbalance = (kept + c.sample_time * excess if excess > 0.0 else kept) if settled else 0.0
    biased = _counted(state.biased, bias_at_bound)
    frozen = state.same_deflection > FROZEN_SAMPLES
    fault = _latched(
        state.fault,
        (imbalance > IMBALANCE_LIMIT, Fault.deflection_frozen if frozen else Fault.force_balance),
        (biased > BIASED_SAMPLES, Fault.acceleration_bias),
    )
    return state._replace(fault=fault, balance=smooth, low_passed=low_passed, imbalance=imbalance, biased=biased)
