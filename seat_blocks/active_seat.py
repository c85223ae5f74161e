"""Controller and seat in one block, in the order of a sequential master.

Over a communication step from t on

    the controller takes the samples that are due, with the measurements of the seat at t;
    the seat integrates to the end of the step with the force of the last sample.

This is what a master does in the order controller, seat, so the results are the same. With ``inner_step_size`` h_i the
step has parts, and this happens in each. They end on the controller's samples, at multiples of n h with the largest n
for which n h <= h_i, and at least 1. The floor is extrapolated from the begin of the step on, as
:mod:`plant_models.seat.floor` says, whatever the parts.

What the controller knows of the driver's mass, the actuator and the stops is that of the seat, unless its own parameter
says otherwise: a value above 0. The seat's value is limited to the range of the controller's parameter.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

from fmus.component import Component
from fmus.variables import variables_of
from plant_models.seat import seat
from plant_models.seat.interface import Outputs as SeatOutputs
from plant_models.seat.interface import Parameters as SeatParameters
from seat_blocks.interface import (
    FLOOR,
    REACTION,
    ActiveConstants,
    ActiveOutputs,
    ActiveParameters,
    Inputs,
    measurements,
    seat_inputs,
    seat_signals,
)
from seat_blocks.parts import end_of_part, prepare_seat
from seat_controller_fmu import controller
from seat_controller_fmu.interface import Inputs as ControllerInputs
from seat_controller_fmu.interface import Outputs as ControllerOutputs
from seat_controller_fmu.interface import Parameters as ControllerParameters
from seat_controller_fmu.parameters import SAMPLE_TIME
from seat_controller_fmu.sampling import SAMPLE_TOLERANCE

MASS_TOLERANCE = 0.2
"""Largest difference of the driver's mass that the controller assumes, as a share of it, without a warning."""

_RANGES = {
    v.field: (v.minimum, v.maximum)
    for v in variables_of(ControllerParameters)
    if v.minimum is not None and v.maximum is not None
}
"""Minimum and maximum of the controller's parameters that have both."""


class State(NamedTuple):
    """State of the block.

    Attributes
    ----------
    controller
        State of the controller.
    acceleration, deflection
        Measurements of the seat at the end of the last step, in m/s2 and m.
    seat
        State of the seat.
    """

    controller: controller.State
    acceleration: float
    deflection: float
    seat: seat.State


class Coefficients(NamedTuple):
    """Coefficients of the block.

    Attributes
    ----------
    controller, seat
        Those of the parts.
    interval
        Time between exchanges, in s; 0 for one in each communication step.
    """

    controller: controller.Coefficients
    seat: seat.Coefficients
    interval: float


def free_travel(travel: float, height: float) -> float:
    """Return the shorter way to an end stop from static equilibrium.

    Parameters
    ----------
    travel
        Travel each way from the middle, in m; 0 for no stops.
    height
        Height of static equilibrium above the middle, in m.

    Returns
    -------
    float
        In m; 0 for no stops.

    Examples
    --------
    >>> free_travel(0.04, -0.01), free_travel(0.0, -0.01)
    (0.03, 0.0)
    """
    return max(0.0, travel - abs(height))


def _known(name: str, own: float, of_seat: float) -> float:
    """Return what the controller assumes: its own parameter above 0, otherwise the seat's, within the range."""
    low, high = _RANGES[name]
    return min(max(own if own > 0.0 else of_seat, low), high)


def controller_parameters(own: ControllerParameters, of_seat: SeatParameters) -> ControllerParameters:
    """Return the parameters of the controller with what it knows of the seat.

    Parameters
    ----------
    own
        Its own parameters, with 0 for what it knows of the seat.
    of_seat
        Parameters of the seat.

    Returns
    -------
    seat_controller_fmu.interface.Parameters
        Each within its range.
    """
    travel = free_travel(of_seat.end_stop_travel, of_seat.end_stop_height)
    return replace(
        own,
        driver_mass=_known("driver_mass", own.driver_mass, of_seat.driver_mass),
        actuator_time_constant=_known(
            "actuator_time_constant", own.actuator_time_constant, of_seat.actuator_time_constant
        ),
        actuator_delay=_known("actuator_delay", own.actuator_delay, of_seat.actuator_delay),
        travel=_known("travel", own.travel, travel),
    )


def prepare(parameters: ActiveParameters) -> Coefficients:
    """Derive the coefficients of both parts and the time between exchanges.

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
        As by the controller and the seat.
    """
    p = parameters
    samples = max(1.0, math.floor(p.inner_step_size / SAMPLE_TIME.value + SAMPLE_TOLERANCE))
    return Coefficients(
        controller.prepare(controller_parameters(p.controller, p.seat)),
        prepare_seat(p.seat),
        samples * SAMPLE_TIME.value if p.inner_step_size > 0.0 else 0.0,
    )


def _outputs(of_seat: SeatOutputs, held: ControllerOutputs) -> ActiveOutputs:
    return ActiveOutputs(seat_signals(of_seat), measurements(of_seat), held)


def initialize(inputs: Inputs, coefficients: Coefficients, time: float) -> tuple[State, ActiveOutputs]:
    """Return the state at the start: the controller before its first sample, the seat at rest.

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
    outputs : ActiveOutputs
        At the start.
    """
    controller_state, held = controller.initialize(ControllerInputs(), coefficients.controller, time)
    at_rest = seat_inputs(inputs)
    at_rest.force = held.force
    seat_state, outputs = seat.initialize(at_rest, coefficients.seat, time)
    measured = (outputs.seat_acceleration_measured, outputs.suspension_deflection_measured)
    return State(controller_state, *measured, seat_state), _outputs(outputs, held)


def advance(
    state: State, inputs: Inputs, coefficients: Coefficients, time: float, step_size: float
) -> tuple[State, ActiveOutputs]:
    """Take samples and integrate over a communication step, part by part.

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
    outputs : ActiveOutputs
        At the end of the step; those of the controller are of its last sample.
    """
    c = coefficients
    controller_state, acceleration, deflection, seat_state = state
    seat_state, motion = seat.begin_step(seat_state, seat_inputs(inputs), c.seat, step_size)
    begin = 0.0
    while True:
        end = end_of_part(time, begin, step_size, c.interval)
        measured = ControllerInputs(acceleration, deflection)
        controller_state, held = controller.advance(controller_state, measured, c.controller, time + begin, end - begin)
        seat_state, outputs = seat.advance_on_floor(
            seat_state, motion.from_time(begin), held.force, c.seat, time + begin, end - begin
        )
        acceleration, deflection = outputs.seat_acceleration_measured, outputs.suspension_deflection_measured
        begin = end
        if not begin < step_size:
            break
    return State(controller_state, acceleration, deflection, seat_state), _outputs(outputs, held)


def warnings(parameters: ActiveParameters) -> list[str]:
    """Warn of a driver's mass that the controller assumes and that is far from the seat's, and as the controller does.

    Parameters
    ----------
    parameters
        Parameters of the block.

    Returns
    -------
    list of str
        At most one message.
    """
    assumed, true = parameters.controller.driver_mass, parameters.seat.driver_mass
    if assumed > 0.0 and abs(assumed - true) > MASS_TOLERANCE * true:
        return [
            f"controller.driver_mass {assumed} kg is not seat.driver_mass {true} kg: the gains are those of another "
            "driver; 0 is the seat's"
        ]
    return list(controller.warnings(controller_parameters(parameters.controller, parameters.seat)))


def is_valid_state(state: State, parameters: ActiveParameters, time: float) -> bool:
    """Check that a run can have a state: both parts can.

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
    of_controller = controller_parameters(parameters.controller, parameters.seat)
    return controller.is_valid_state(state.controller, of_controller, time) and seat.is_valid_state(
        state.seat, parameters.seat, time
    )


ACTIVE_SEAT = Component(
    name="ActiveSeat",
    description="Active seat in one block: SeatController and SeatPlant, exchanging values as by a sequential master",
    module=__name__,
    inputs=Inputs,
    outputs=ActiveOutputs,
    parameters=ActiveParameters,
    constants=ActiveConstants,
    state=State,
    prepare=prepare,
    initialize=initialize,
    advance=advance,
    is_valid_state=is_valid_state,
    warnings=warnings,
    terminals=(FLOOR, REACTION),
)
"""Controller and seat in one block."""
