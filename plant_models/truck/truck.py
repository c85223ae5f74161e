"""The truck: the motion of the cab floor of a two-axle heavy truck, which drives over a road at constant speed.

The front axle is at the begin of the road at the start time. Over a step the force of the seat changes linearly from
the input of the step before to that of this one: in a master that steps the seat before the truck these are the forces
at begin and end of the step, and the energy that leaves the seat reaches the cab. Road and vehicle have modules of
their own.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from fmus.component import CLOCK_TOLERANCE, Component
from plant_models.truck import road, vehicle
from plant_models.truck.example_road import EXAMPLE, example
from plant_models.truck.interface import TERMINALS, Inputs, Outputs, Parameters, Profile
from plant_models.truck.road import BEFORE, CELLS_PER_METRE, Road, Track

_REST = (0.0,) * vehicle.DEGREES


class State(NamedTuple):
    """State of the truck.

    Attributes
    ----------
    start
        Time at which the front axle is at the begin of the road, in s.
    seat_force
        Force of the seat at the end of the last step, in N.
    front, rear
        Road under the axles.
    displacements, velocities
        Degrees of freedom in the order of :mod:`plant_models.truck.vehicle`, in m and rad, and their rates.
    """

    start: float
    seat_force: float
    front: Track
    rear: Track
    displacements: Annotated[tuple[float, ...], vehicle.DEGREES]
    velocities: Annotated[tuple[float, ...], vehicle.DEGREES]


class Coefficients(NamedTuple):
    """Coefficients of the step.

    Attributes
    ----------
    speed, wheelbase
        v in m/s, L in m.
    road
        Coefficients of the road.
    vehicle
        Coefficients of the vehicle.
    """

    speed: float
    wheelbase: float
    road: Road
    vehicle: vehicle.Coefficients


def prepare(parameters: Parameters) -> Coefficients:
    """Derive the coefficients of the step.

    Parameters
    ----------
    parameters
        Parameters of the truck, each within its range; ``road_file`` is a whole path.

    Returns
    -------
    Coefficients
        For :func:`initialize` and :func:`advance`.

    Raises
    ------
    ParameterError
        If the chassis' centre of gravity is not between the axles, the truck is so stiff that a step would take too
        long, or the file of the road cannot be used.
    """
    coefficients = vehicle.prepare(parameters)
    return Coefficients(parameters.speed, parameters.wheelbase, road.prepare(parameters), coefficients)


def _drive(
    tracks: tuple[Track, Track], elapsed: float, c: Coefficients
) -> tuple[tuple[Track, Track], tuple[float, float]]:
    """Advance both axles to a time in s since the start; return their cells and the elevations under them in m."""
    distance = c.speed * elapsed
    behind = distance - c.wheelbase
    front = road.advance(tracks[0], distance, c.road)
    rear = road.advance(tracks[1], behind, c.road)
    elevations = road.elevation(front, distance, c.road), road.elevation(rear, behind, c.road)
    return (front, rear), elevations


def initialize(inputs: Inputs, coefficients: Coefficients, time: float) -> tuple[State, Outputs]:
    """Return the state of rest in static equilibrium and its outputs.

    Parameters
    ----------
    inputs
        Force of the seat at the start; the floor accelerates by it at once.
    coefficients
        Coefficients from :func:`prepare`.
    time
        Start time, in s.

    Returns
    -------
    state : State
        At the start, with the front axle at the begin of the road.
    outputs : Outputs
        At the start.
    """
    state = State(time, inputs.seat_force, BEFORE, BEFORE, _REST, _REST)
    return state, vehicle.outputs(_REST, _REST, (0.0, 0.0), inputs.seat_force, coefficients.vehicle)


def advance(
    state: State, inputs: Inputs, coefficients: Coefficients, time: float, step_size: float
) -> tuple[State, Outputs]:
    """Integrate the equations of motion over one communication step.

    Parameters
    ----------
    state
        State at the begin of the step.
    inputs
        Force of the seat, which is reached at the end of the step.
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
    outputs : Outputs
        At the end of the step.
    """
    c, force = coefficients, inputs.seat_force
    before, change = state.seat_force, force - state.seat_force
    elapsed = time - state.start
    z, v = state.displacements, state.velocities
    count = max(1, math.ceil(step_size / c.vehicle.substep - 1e-6))
    h = step_size / count
    tracks, first = _drive((state.front, state.rear), elapsed, c)
    for index in range(count):
        tracks, middle = _drive(tracks, elapsed + (index + 0.5) * h, c)
        tracks, last = _drive(tracks, elapsed + (index + 1.0) * h, c)
        forces = (
            before + change * (index / count),
            before + change * ((index + 0.5) / count),
            before + change * ((index + 1.0) / count),
        )
        z, v = vehicle.substep(z, v, h, (first, middle, last), forces, c.vehicle)
        first = last
    return State(state.start, force, *tracks, z, v), vehicle.outputs(z, v, first, force, c.vehicle)


def _is_valid_track(track: Track, distance: float, tolerance: float, parameters: Parameters) -> bool:
    """Check that an axle can be in a cell where it has driven a distance in m, give or take a tolerance in m."""
    if track.cell == BEFORE.cell or parameters.road_profile != Profile.iso8608:
        return track == BEFORE and (distance - tolerance <= 0.0 or parameters.road_profile != Profile.iso8608)
    cells, margin = distance * CELLS_PER_METRE, tolerance * CELLS_PER_METRE + 1.0
    return track.cell >= 0 and cells - margin <= track.cell <= cells + margin


def is_valid_state(state: State, parameters: Parameters, time: float) -> bool:
    """Check that a run can have a state: it has started, and the axles are in the cells that the truck has reached.

    Parameters
    ----------
    state
        State of any origin; all its numbers are finite.
    parameters
        Parameters of the truck.
    time
        Time that the run has reached, in s.

    Returns
    -------
    bool
        Whether a run can have this state.
    """
    elapsed = time - state.start
    distance, tolerance = parameters.speed * elapsed, parameters.speed * CLOCK_TOLERANCE
    return (
        elapsed >= -CLOCK_TOLERANCE
        and _is_valid_track(state.front, distance, tolerance, parameters)
        and _is_valid_track(state.rear, distance - parameters.wheelbase, tolerance, parameters)
    )


TRUCK_CAB = Component(
    name="TruckCab",
    description="Cab floor of a two-axle heavy truck on an ISO 8608 road, a single obstacle or a road from a file",
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
    resources=lambda: {EXAMPLE: example()},
)
