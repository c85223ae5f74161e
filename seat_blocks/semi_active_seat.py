"""A semi-active seat in one block: the seat with a continuously variable damper and skyhook logic.

The law of :mod:`seat_blocks.skyhook` gives a damping c_k at each sample. The damper follows with a first-order lag,

    T_c c' + c = c_k,

and c is the suspension damping c_f of (1), inside the integrator of the seat: a damper takes energy out whatever the
step, which a force held over a step would not. Over each part of a step between samples the mean of c acts.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

from fmus.component import Component, ParameterError
from plant_models.seat import actuator, seat
from plant_models.seat.actuator import ActuatorCoefficients
from plant_models.seat.interface import Outputs as SeatOutputs
from seat_blocks import skyhook
from seat_blocks.interface import (
    FLOOR,
    REACTION,
    Inputs,
    SemiActiveConstants,
    SemiActiveOutputs,
    SemiActiveParameters,
    measurements,
    seat_inputs,
    seat_signals,
)
from seat_blocks.parts import end_of_part, prepare_seat
from seat_blocks.skyhook import SkyhookCoefficients, SkyhookState
from seat_controller_fmu.parameters import SAMPLE_TIME


class State(NamedTuple):
    """State of the block.

    Attributes
    ----------
    law
        State of the law.
    acceleration, deflection
        Measurements of the seat at the end of the last step, in m/s2 and m.
    damping
        c of the damper, in N.s/m.
    seat
        State of the seat.
    """

    law: SkyhookState
    acceleration: float
    deflection: float
    damping: float
    seat: seat.State


class Coefficients(NamedTuple):
    """Coefficients of the block.

    Attributes
    ----------
    law, seat
        Those of the parts; the damping of the seat is the greatest.
    damper
        Lag of the damper.
    """

    law: SkyhookCoefficients
    damper: ActuatorCoefficients
    seat: seat.Coefficients


def prepare(parameters: SemiActiveParameters) -> Coefficients:
    """Derive the coefficients of law, damper and seat.

    Parameters
    ----------
    parameters
        Parameters of the block, each within its range.

    Returns
    -------
    Coefficients
        For :func:`initialize` and :func:`advance`.

    Raises
    ------
    ParameterError
        If the greatest damping is less than the least one, or as by the seat.
    """
    p = parameters
    if not p.damper.minimum <= p.damper.maximum:
        raise ParameterError(
            f"damper: expected damper.minimum <= damper.maximum, got {p.damper.minimum} and {p.damper.maximum} N.s/m"
        )
    return Coefficients(
        skyhook.prepare(p.damper),
        actuator.prepare(0.0, 0.0, p.damper.time_constant),
        prepare_seat(replace(p.seat, suspension_damping=p.damper.maximum)),
    )


def _outputs(of_seat: SeatOutputs, damping: float, velocity: float) -> SemiActiveOutputs:
    force = -damping * of_seat.deflection_rate
    return SemiActiveOutputs(seat_signals(of_seat), measurements(of_seat), force, damping, velocity)


def initialize(inputs: Inputs, coefficients: Coefficients, time: float) -> tuple[State, SemiActiveOutputs]:
    """Return the state at the start: the seat at rest, the damper open.

    Parameters
    ----------
    inputs
        Floor at the start.
    coefficients
        Coefficients from :func:`prepare`.
    time
        Start time, in s.

    Returns
    -------
    state : State
        At the start.
    outputs : SemiActiveOutputs
        At the start.
    """
    c = coefficients
    law = skyhook.start(c.law, time)
    seat_state, outputs = seat.initialize(seat_inputs(inputs), c.seat._replace(c_f=law.damping), time)
    measured = (outputs.seat_acceleration_measured, outputs.suspension_deflection_measured)
    return State(law, *measured, law.damping, seat_state), _outputs(outputs, law.damping, law.velocity)


def advance(
    state: State, inputs: Inputs, coefficients: Coefficients, time: float, step_size: float
) -> tuple[State, SemiActiveOutputs]:
    """Take samples and integrate over a communication step, from sample to sample.

    Parameters
    ----------
    state
        State at ``time``.
    inputs
        Floor at ``time``.
    coefficients
        Coefficients from :func:`prepare`.
    time
        Begin of the step, in s.
    step_size
        Communication step size, in s.

    Returns
    -------
    state : State
        At the end of the step.
    outputs : SemiActiveOutputs
        At the end of the step.
    """
    c = coefficients
    law, acceleration, deflection, damping, seat_state = state
    seat_state, motion = seat.begin_step(seat_state, seat_inputs(inputs), c.seat, step_size)
    begin = 0.0
    while True:
        end = end_of_part(time, begin, step_size, SAMPLE_TIME.value)
        law = skyhook.advance(law, acceleration, deflection, c.law, time + begin, end - begin)
        lag = actuator.prepare_lag(c.damper, end - begin)
        first, last, damping = actuator.apply_lag(damping, law.damping, lag)
        mean = 0.5 * (first + last)
        seat_state, outputs = seat.advance_on_floor(
            seat_state, motion.from_time(begin), 0.0, c.seat._replace(c_f=mean), time + begin, end - begin
        )
        acceleration, deflection = outputs.seat_acceleration_measured, outputs.suspension_deflection_measured
        begin = end
        if not begin < step_size:
            break
    return State(law, acceleration, deflection, damping, seat_state), _outputs(outputs, mean, law.velocity)


def is_valid_state(state: State, parameters: SemiActiveParameters, time: float) -> bool:
    """Check that a run can have a state: both parts can, and the damper has a damping of its range.

    Parameters
    ----------
    state
        State of any origin; all its numbers are finite.
    parameters
        Parameters of the block.
    time
        Time that the run has reached, in s.

    Returns
    -------
    bool
        Whether a run can have this state.
    """
    return (
        skyhook.is_valid_state(state.law, time)
        and state.damping >= 0.0
        and state.law.damping >= 0.0
        and seat.is_valid_state(state.seat, parameters.seat, time)
    )


SEMI_ACTIVE_SEAT = Component(
    name="SemiActiveSeat",
    description="Semi-active seat in one block: the seat of SeatPlant with a variable damper and skyhook logic",
    module=__name__,
    inputs=Inputs,
    outputs=SemiActiveOutputs,
    parameters=SemiActiveParameters,
    constants=SemiActiveConstants,
    state=State,
    prepare=prepare,
    initialize=initialize,
    advance=advance,
    is_valid_state=is_valid_state,
    terminals=(FLOOR, REACTION),
)
"""The seat with a variable damper."""
