"""The shaker: the cabin floor's displacement, velocity and acceleration, consistent with one another.

The profile is a function of time (bump, sine, sweep in profiles.py, a recording in replay.py) or seeded noise
(noise.py); a platform may follow it with a lag and limits (platform.py). Noise and platform go in ticks of 2 ms from
time 0, whatever the communication steps: their state is that at the last tick, and what lies between two ticks is
evaluated in closed form.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from fmus.component import FARTHEST_TICK, Component, ParameterError
from fmus.subnormal import flush_subnormal
from plant_models.random_numbers import random_stream
from plant_models.shaker import noise, platform, replay
from plant_models.shaker.example_recording import EXAMPLE, example
from plant_models.shaker.interface import TERMINALS, Inputs, Outputs, Parameters, Profile
from plant_models.shaker.profiles import SAME_INSTANT, bump, sine, sweep

TICK = 0.002
"""In s: what noise and the platform's acceleration are held for."""


class State(NamedTuple):
    """State of the shaker, all of it at the tick's begin.

    Attributes
    ----------
    tick
        Number of the tick, from time 0.
    modes
        Real and imaginary parts of the noise's modes.
    platform_displacement, platform_velocity
        In m and m/s.
    platform_acceleration
        In m/s2, over the tick.
    """

    tick: int
    modes: Annotated[tuple[float, ...], 2 * noise.MOST_MODES]
    platform_displacement: float
    platform_velocity: float
    platform_acceleration: float


class Coefficients(NamedTuple):
    """What is prepared for the steps; ``modes``, ``curve`` and ``platform`` are None where they are not needed."""

    parameters: Parameters
    modes: tuple[noise.Mode, ...] | None
    stream: int
    curve: replay.Curve | None
    platform: platform.Platform | None


def prepare(parameters: Parameters) -> Coefficients:
    """Derive the coefficients.

    Raises
    ------
    ParameterError
        If the sweep's fades do not fit in, a platform that follows exactly has limits, or there is something wrong with
        the recording.
    """
    p = parameters
    if p.profile == Profile.sweep and 2.0 * p.sweep_fade > p.sweep_duration:
        raise ParameterError(
            f"expected sweep.fade up to half the sweep.duration, got {p.sweep_fade} s of {p.sweep_duration} s"
        )
    follower = platform.platform(p, TICK)
    return Coefficients(
        parameters=p,
        modes=noise.modes(p.random_class, p.random_scale, TICK) if p.profile == Profile.random else None,
        stream=random_stream(p.random_seed),
        curve=replay.load(p.file_path, p.file_high_pass, p.file_fade) if p.profile == Profile.file else None,
        platform=follower,
    )


def _profile(time: float, c: Coefficients) -> Outputs:
    """Evaluate a profile that is a function of time, in s."""
    p = c.parameters
    if c.curve is not None:
        return replay.motion(c.curve, time)
    if p.profile == Profile.sine:
        return sine(time, p.sine_frequency, p.sine_amplitude)
    if p.profile == Profile.sweep:
        return sweep(time, p)
    return bump(time, p.bump_height, p.bump_length, p.bump_speed)


def _accelerated(state: State, c: Coefficients) -> State:
    """Let the platform follow the profile at the tick's begin."""
    if c.platform is None:
        return state
    command = (
        _profile(state.tick * TICK, c)
        if c.modes is None
        else noise.motion(state.modes, c.modes, c.stream, state.tick, 0.0)
    )
    acceleration = platform.acceleration(state.platform_displacement, state.platform_velocity, command, c.platform)
    return state._replace(platform_acceleration=acceleration)


def _platform(state: State, since: float) -> Outputs:
    """Evaluate the platform, ``since`` seconds after the tick's begin."""
    _, _, displacement, velocity, acceleration = state
    return Outputs(
        floor_displacement=displacement + since * (velocity + 0.5 * since * acceleration),
        floor_velocity=velocity + since * acceleration,
        floor_acceleration=acceleration,
    )


def _next(state: State, c: Coefficients) -> State:
    """Go to the next tick."""
    floor = _platform(state, TICK)
    modes = state.modes if c.modes is None else noise.advanced(state.modes, c.modes, c.stream, state.tick)
    displacement, velocity = flush_subnormal(floor.floor_displacement), flush_subnormal(floor.floor_velocity)
    moved = State(state.tick + 1, modes, displacement, velocity, state.platform_acceleration)
    return _accelerated(moved, c)


def _floor(state: State, c: Coefficients, time: float) -> Outputs:
    """Evaluate the floor at a time in s, not before the state's tick unless that is the first."""
    if c.modes is None and c.platform is None:
        return _profile(time, c)
    since = time - state.tick * TICK
    if since < -SAME_INSTANT:
        return Outputs()
    since = since if since > SAME_INSTANT else 0.0
    if c.platform is not None:
        return _platform(state, since)
    return noise.motion(state.modes, c.modes or (), c.stream, state.tick, since)


def initial(inputs: Inputs, coefficients: Coefficients, time: float) -> tuple[State, Outputs]:
    """Evaluate the floor at the start time, in s; noise and platform are at rest until the first tick."""
    tick = math.ceil((time - SAME_INSTANT) / TICK)
    state = _accelerated(State(tick, (0.0,) * (2 * noise.MOST_MODES), 0.0, 0.0, 0.0), coefficients)
    return state, _floor(state, coefficients, time)


def advance(
    state: State, inputs: Inputs, coefficients: Coefficients, time: float, step_size: float
) -> tuple[State, Outputs]:
    """Move the floor to ``time + step_size``, both in s."""
    end = time + step_size
    if coefficients.modes is not None or coefficients.platform is not None:
        last = math.floor((end + SAME_INSTANT) / TICK)
        while state.tick < last:
            state = _next(state, coefficients)
    return state, _floor(state, coefficients, end)


def is_valid_state(state: State, parameters: Parameters, time: float) -> bool:
    """Whether the state can be one of a run that has reached ``time``, in s: noise and platform are at its tick."""
    ticking = parameters.profile == Profile.random or parameters.platform_bandwidth > 0.0
    return not ticking or abs(state.tick * TICK - time) <= FARTHEST_TICK


SHAKER = Component(
    name="Shaker",
    description="Vertical motion of the cabin floor: bump (34), sine, sweep, ISO 7096 random or a file",
    module=__name__,
    inputs=Inputs,
    outputs=Outputs,
    parameters=Parameters,
    state=State,
    prepare=prepare,
    initial=initial,
    advance=advance,
    is_valid_state=is_valid_state,
    terminals=TERMINALS,
    resources=lambda: {EXAMPLE: example()},
)
