"""The shaker: the cabin floor's displacement, velocity and acceleration as functions of time."""

from __future__ import annotations

import math
from typing import NamedTuple

from fmus.component import Component
from plant_models.shaker_interface import TERMINALS, Inputs, Outputs, Parameters, Profile

SAME_INSTANT = 1e-9
"""Times closer than this, in s, are one instant: communication points carry rounding errors."""


class State(NamedTuple):
    """None yet: the profiles so far are functions of time."""


def bump(time: float, height: float, length: float, speed: float) -> Outputs:
    """Evaluate the bump (34), z_v = a/2 (1 - cos(2 pi v_0 t/l)) for 0 <= t <= l/v_0, and its derivatives.

    Parameters
    ----------
    time
        Since the wheel met the bump, in s.
    height, length, speed
        a in m, l in m, v_0 in m/s.

    Returns
    -------
    Outputs
        Right limits: the acceleration jumps at both ends of the bump.
    """
    if not -SAME_INSTANT <= time < length / speed - SAME_INSTANT:
        return Outputs()
    omega = 2.0 * math.pi * speed / length
    half = 0.5 * height
    return Outputs(
        floor_displacement=half * (1.0 - math.cos(omega * time)),
        floor_velocity=half * omega * math.sin(omega * time),
        floor_acceleration=half * omega * omega * math.cos(omega * time),
    )


def sine(time: float, frequency: float, amplitude: float) -> Outputs:
    """Evaluate z_v = A sin(2 pi f t) and its derivatives.

    Parameters
    ----------
    time
        In s.
    frequency, amplitude
        f in Hz, A in m.
    """
    omega = 2.0 * math.pi * frequency
    return Outputs(
        floor_displacement=amplitude * math.sin(omega * time),
        floor_velocity=amplitude * omega * math.cos(omega * time),
        floor_acceleration=-amplitude * omega * omega * math.sin(omega * time),
    )


def floor_motion(time: float, parameters: Parameters) -> Outputs:
    """Evaluate the chosen profile at a time, in s."""
    p = parameters
    if p.profile == Profile.sine:
        return sine(time, p.sine_frequency, p.sine_amplitude)
    return bump(time, p.bump_height, p.bump_length, p.bump_speed)


def initial(inputs: Inputs, coefficients: Parameters, time: float) -> tuple[State, Outputs]:
    """Evaluate the floor at the start time, in s."""
    return State(), floor_motion(time, coefficients)


def advance(
    state: State, inputs: Inputs, coefficients: Parameters, time: float, step_size: float
) -> tuple[State, Outputs]:
    """Move the floor to ``time + step_size``, both in s."""
    return state, floor_motion(time + step_size, coefficients)


SHAKER = Component(
    name="Shaker",
    description="Vertical motion of the cabin floor: a bump (34) or a sine",
    module=__name__,
    inputs=Inputs,
    outputs=Outputs,
    parameters=Parameters,
    state=State,
    prepare=lambda parameters: parameters,
    initial=initial,
    advance=advance,
    terminals=TERMINALS,
)
