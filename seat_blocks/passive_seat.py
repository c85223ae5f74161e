"""A passive seat in one block: the equations of :mod:`plant_models.seat.seat` without a force of an actuator.

Its damping and its friction are those of the parameter set ``passive``: a well-tuned passive seat beside the prototype.
"""

from __future__ import annotations

from fmus.component import Component
from plant_models.seat import seat
from seat_blocks.interface import (
    FLOOR,
    REACTION,
    Inputs,
    PassiveOutputs,
    PassiveParameters,
    seat_inputs,
    seat_signals,
)
from seat_blocks.parts import prepare_seat


def prepare(parameters: PassiveParameters) -> seat.Coefficients:
    """Derive the coefficients of the seat.

    Parameters
    ----------
    parameters
        Parameters of the block, each within its range.

    Returns
    -------
    plant_models.seat.seat.Coefficients
        For :func:`initialize` and :func:`advance`.

    Raises
    ------
    ParameterError
        As by the seat.
    """
    return prepare_seat(parameters.seat)


def initialize(inputs: Inputs, coefficients: seat.Coefficients, time: float) -> tuple[seat.State, PassiveOutputs]:
    """Return the seat at rest.

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
    state : plant_models.seat.seat.State
        At the start.
    outputs : PassiveOutputs
        At the start.
    """
    state, outputs = seat.initialize(seat_inputs(inputs), coefficients, time)
    return state, PassiveOutputs(seat_signals(outputs))


def advance(
    state: seat.State, inputs: Inputs, coefficients: seat.Coefficients, time: float, step_size: float
) -> tuple[seat.State, PassiveOutputs]:
    """Integrate over a communication step.

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
    state : plant_models.seat.seat.State
        At the end of the step.
    outputs : PassiveOutputs
        At the end of the step.
    """
    state, outputs = seat.advance(state, seat_inputs(inputs), coefficients, time, step_size)
    return state, PassiveOutputs(seat_signals(outputs))


def is_valid_state(state: seat.State, parameters: PassiveParameters, time: float) -> bool:
    """Check that a run can have a state, as the seat does.

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
    return seat.is_valid_state(state, parameters.seat, time)


PASSIVE_SEAT = Component(
    name="PassiveSeat",
    description="Passive seat in one block: the seat of SeatPlant with a damper, without actuator",
    module=__name__,
    inputs=Inputs,
    outputs=PassiveOutputs,
    parameters=PassiveParameters,
    state=seat.State,
    prepare=prepare,
    initialize=initialize,
    advance=advance,
    is_valid_state=is_valid_state,
    terminals=(FLOOR, REACTION),
)
"""The seat with a passive damper."""
