"""The shaker: displacement, velocity and acceleration of the cabin floor, consistent with one another.

The profile is a function of time (bump, sine, sweep in profiles.py, a recording in replay.py) or seeded noise
(noise.py). A platform may follow the profile with a lag and limits (platform.py). Noise and platform advance in ticks
of 2 ms from time 0, whatever the communication steps. Their state is that at the last tick; between two ticks the
motion is evaluated in closed form.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from fmus.component import CLOCK_TOLERANCE, Component, ParameterError
from fmus.subnormal import flush_subnormal
from plant_models.random_numbers import random_stream
from plant_models.shaker import noise, platform, profiles, replay
from plant_models.shaker.example_recording import EXAMPLE, example
from plant_models.shaker.interface import TERMINALS, Inputs, Outputs, Parameters, Profile
from plant_models.shaker.profiles import TIME_TOLERANCE

TICK = 0.002
"""Hold time of the noise and of the acceleration of the platform, in s."""


class State(NamedTuple):
    """State of the shaker at the begin of a tick.

    Attributes
    ----------
    tick
        Number of the tick, from time 0.
    modes
        Real and imaginary parts of the modes of the noise.
    platform_displacement, platform_velocity
        In m and m/s.
    platform_acceleration
        In m/s2, over the tick.
    """

    tick: int
    modes: Annotated[tuple[float, ...], 2 * noise.MAX_MODES]
    platform_displacement: float
    platform_velocity: float
    platform_acceleration: float


class Coefficients(NamedTuple):
    """Coefficients of the step.

    Attributes
    ----------
    parameters
        Parameters of the profile.
    modes
        Modes of the noise; None for other profiles.
    stream
        Stream of random numbers.
    spline
        Motion of the recording; None for other profiles.
    platform
        Coefficients of the platform; None without a lag.
    """

    parameters: Parameters
    modes: tuple[noise.Mode, ...] | None
    stream: int
    spline: replay.Spline | None
    platform: platform.PlatformCoefficients | None


def prepare(parameters: Parameters) -> Coefficients:
    """Derive the coefficients of the step.

    Parameters
    ----------
    parameters
        Parameters of the shaker, each within its range; ``file_path`` is a whole path.

    Returns
    -------
    Coefficients
        For :func:`initialize` and :func:`advance`.

    Raises
    ------
    ParameterError
        If the fades of the sweep exceed its duration, a platform without a lag has limits, or the recording cannot be
        used.
    """
    p = parameters
    if p.profile == Profile.sweep and 2.0 * p.sweep_fade > p.sweep_duration:
        raise ParameterError(
            f"expected sweep.fade up to half the sweep.duration, got {p.sweep_fade} s of {p.sweep_duration} s"
        )
    platform_coefficients = platform.prepare(p, TICK)
    return Coefficients(
        parameters=p,
        modes=noise.prepare(p.random_class, p.random_scale, TICK) if p.profile == Profile.random else None,
        stream=random_stream(p.random_seed),
        spline=replay.load(p.file_path, p.file_high_pass, p.file_fade) if p.profile == Profile.file else None,
        platform=platform_coefficients,
    )


def _evaluate_profile(time: float, c: Coefficients) -> Outputs:
    """Evaluate a profile that is a function of time, at a time in s."""
    p = c.parameters
    if c.spline is not None:
        return replay.motion(c.spline, time)
    if p.profile == Profile.sine:
        return profiles.sine(time, p.sine_frequency, p.sine_amplitude)
    if p.profile == Profile.sweep:
        return profiles.sweep(time, p)
    return profiles.bump(time, p.bump_height, p.bump_length, p.bump_speed)


def _accelerate_platform(state: State, c: Coefficients) -> State:
    """Set the acceleration of the platform over the tick, from the profile at its begin."""
    if c.platform is None:
        return state
    if c.modes is not None:
        command = noise.motion(state.modes, c.modes, c.stream, state.tick, 0.0)
    else:
        command = _evaluate_profile(state.tick * TICK, c)
    acceleration = platform.acceleration(state.platform_displacement, state.platform_velocity, command, c.platform)
    return state._replace(platform_acceleration=acceleration)


def _platform_motion(state: State, elapsed: float) -> Outputs:
    """Evaluate the motion of the platform at a time in s since the begin of the tick."""
    _, _, displacement, velocity, acceleration = state
    return Outputs(
        floor_displacement=displacement + elapsed * (velocity + 0.5 * elapsed * acceleration),
        floor_velocity=velocity + elapsed * acceleration,
        floor_acceleration=acceleration,
    )


def _advance_tick(state: State, c: Coefficients) -> State:
    """Advance to the next tick."""
    end = _platform_motion(state, TICK)
    modes = state.modes if c.modes is None else noise.advance(state.modes, c.modes, c.stream, state.tick)
    displacement, velocity = flush_subnormal(end.floor_displacement), flush_subnormal(end.floor_velocity)
    advanced = State(state.tick + 1, modes, displacement, velocity, state.platform_acceleration)
    return _accelerate_platform(advanced, c)


def _has_ticks(parameters: Parameters) -> bool:
    """Whether there is noise or a platform with a lag."""
    return parameters.profile == Profile.random or parameters.platform_bandwidth > 0.0


def _tick_motion(time: float, state: State, c: Coefficients) -> Outputs:
    """Evaluate noise or platform at a time in s; before the first tick they are at rest."""
    elapsed = time - state.tick * TICK
    if elapsed < -TIME_TOLERANCE:
        return Outputs()
    elapsed = elapsed if elapsed > TIME_TOLERANCE else 0.0
    if c.platform is not None:
        return _platform_motion(state, elapsed)
    return noise.motion(state.modes, c.modes or (), c.stream, state.tick, elapsed)


def _evaluate_outputs(time: float, state: State, c: Coefficients) -> Outputs:
    """Evaluate the motion of the floor at a time in s."""
    return _tick_motion(time, state, c) if _has_ticks(c.parameters) else _evaluate_profile(time, c)


def initialize(inputs: Inputs, coefficients: Coefficients, time: float) -> tuple[State, Outputs]:
    """Return the state at the start and its outputs; noise and platform are at rest until the first tick.

    Parameters
    ----------
    inputs
        Not used: there are none.
    coefficients
        Coefficients from :func:`prepare`.
    time
        Start time, in s.

    Returns
    -------
    state : State
        At the first tick from the start time on.
    outputs : Outputs
        At the start.
    """
    tick = math.ceil((time - TIME_TOLERANCE) / TICK)
    state = _accelerate_platform(State(tick, (0.0,) * (2 * noise.MAX_MODES), 0.0, 0.0, 0.0), coefficients)
    return state, _evaluate_outputs(time, state, coefficients)


def advance(
    state: State, inputs: Inputs, coefficients: Coefficients, time: float, step_size: float
) -> tuple[State, Outputs]:
    """Advance the motion of the floor over one communication step.

    Parameters
    ----------
    state
        State at the begin of the step.
    inputs
        Not used: there are none.
    coefficients
        Coefficients from :func:`prepare`.
    time
        Begin of the step, in s.
    step_size
        Communication step size, in s.

    Returns
    -------
    state : State
        At the last tick within the step.
    outputs : Outputs
        At the end of the step.
    """
    end = time + step_size
    if _has_ticks(coefficients.parameters):
        last = math.floor((end + TIME_TOLERANCE) / TICK)
        while state.tick < last:
            state = _advance_tick(state, coefficients)
    return state, _evaluate_outputs(end, state, coefficients)


def is_valid_state(state: State, parameters: Parameters, time: float) -> bool:
    """Check that a run can have a state at a time: its tick is near that time.

    Parameters
    ----------
    state
        State of any origin; all its numbers are finite.
    parameters
        Parameters of the shaker.
    time
        Time that the run has reached, in s.

    Returns
    -------
    bool
        Whether a run can have this state.
    """
    return not _has_ticks(parameters) or abs(state.tick * TICK - time) <= CLOCK_TOLERANCE


SHAKER = Component(
    name="Shaker",
    description="Vertical motion of the cabin floor: bump (34), sine, sweep, ISO 7096 random or a file",
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
