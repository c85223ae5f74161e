"""The floor over a communication step: from all three signals, or derived from the one that is used.

With all three signals the floor is their second-order Taylor series about the begin of the step. With one signal, it is
the parabola that the last samples of this signal determine:

    displacement    through the last three displacements
    velocity        through the last two velocities; its displacement is their trapezoidal sum
    acceleration    with the last acceleration; velocity and displacement integrate the line from sample to sample

The distance between samples may vary. Only samples are used; the first one starts from the motion at initialisation.
So a floor that starts away from zero, or moving, does not jump.

A derived floor is continuous. Where a new sample deviates from the extrapolation, the floor moves from its present
displacement to where the new parabola ends, and the friction follows all of this motion. A jump would be lost on the
friction, which follows the deflection within a step only; in pre-sliding 1 um is worth 2 N. (Measured on the paper's
bump, from displacements: 2.7 times the error in the driver's acceleration.)
"""

from __future__ import annotations

from typing import NamedTuple

from plant_models.motion import Motion
from plant_models.seat.interface import FloorSignals, Inputs

MIN_INTERVAL = 1e-5
"""A sample that follows the last one sooner, in s, is ignored: its differences are mostly rounding errors."""


FloorMotion = Motion
"""Motion z_v, z_v', z_v'' of the floor over one step."""


class FloorHistory(NamedTuple):
    """State of a derived floor.

    Attributes
    ----------
    displacement, velocity, acceleration
        Motion at the last sample, given or derived, in m, m/s, m/s2.
    age
        Time since the last sample, in s; 0 before the first one.
    interval
        Time between the last two samples, in s; 0 where there is one only.
    end_displacement
        Displacement at the end of the last step, in m.
    """

    displacement: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0
    age: float = 0.0
    interval: float = 0.0
    end_displacement: float = 0.0


def motion_from_inputs(inputs: Inputs) -> FloorMotion:
    """Return the motion that the three floor inputs describe.

    Parameters
    ----------
    inputs
        Inputs at the begin of the step.

    Returns
    -------
    FloorMotion
        With the three signals as they are.
    """
    return FloorMotion(inputs.floor_displacement, inputs.floor_velocity, inputs.floor_acceleration)


def _first_sample(history: FloorHistory, inputs: Inputs, signals: int) -> FloorMotion:
    """Replace the used signal in the motion at initialisation by its first sample."""
    if signals == FloorSignals.displacement:
        return FloorMotion(inputs.floor_displacement, history.velocity, history.acceleration)
    if signals == FloorSignals.velocity:
        return FloorMotion(history.displacement, inputs.floor_velocity, history.acceleration)
    return FloorMotion(history.displacement, history.velocity, inputs.floor_acceleration)


def _next_sample(history: FloorHistory, inputs: Inputs, signals: int) -> FloorMotion:
    """Derive the motion at a new sample."""
    z, v, a, age, interval, _ = history
    if signals == FloorSignals.displacement:
        displacement = inputs.floor_displacement
        slope = (displacement - z) / age
        slope_before = v - 0.5 * a * interval
        acceleration = 2.0 * (slope - slope_before) / (age + interval) if interval > 0.0 else 0.0
        return FloorMotion(displacement, slope + 0.5 * age * acceleration, acceleration)
    if signals == FloorSignals.velocity:
        velocity = inputs.floor_velocity
        return FloorMotion(z + 0.5 * age * (v + velocity), velocity, (velocity - v) / age)
    acceleration = inputs.floor_acceleration
    displacement = z + age * (v + age * (2.0 * a + acceleration) / 6.0)
    return FloorMotion(displacement, v + 0.5 * age * (a + acceleration), acceleration)


def derive_motion(
    history: FloorHistory, inputs: Inputs, signals: int, step_size: float
) -> tuple[FloorMotion, FloorHistory]:
    """Derive the motion over a step from the one signal that is used.

    Parameters
    ----------
    history
        At the begin of the step.
    inputs
        Inputs at the begin of the step; the two floor signals that are not used are ignored.
    signals
        The used signal, see :class:`~plant_models.seat.interface.FloorSignals`; not ``all``.
    step_size
        Communication step size, in s.

    Returns
    -------
    motion : FloorMotion
        Over the step.
    history : FloorHistory
        At the end of the step.
    """
    age, interval, start = history.age, history.interval, history.end_displacement
    node = FloorMotion(*history[:3])
    if age == 0.0:
        sampled = node = _first_sample(history, inputs, signals)
        start = sampled.displacement
    elif age >= MIN_INTERVAL:
        sampled = node = _next_sample(history, inputs, signals)
        interval = age
    else:
        sampled = node.from_time(age)
    # the correction takes as long as the deviation took to arise: in a short step after a long one it would be a jump
    correction = (sampled.displacement - start) / max(step_size, age)
    motion = FloorMotion(start, sampled.velocity + correction, sampled.acceleration)
    age = step_size if sampled is node else age + step_size
    return motion, FloorHistory(*node, age, interval, motion.displacement_at(step_size))
