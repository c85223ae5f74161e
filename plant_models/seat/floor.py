"""The floor over a step: given by three signals, or derived from the one that is alive.

With all three signals the floor is their second-order Taylor series about the step's begin. With one, it is the
parabola that this signal's last samples allow:

    displacement    through the last three displacements
    velocity        through the last two velocities; its displacement is their trapezoidal sum
    acceleration    with the last acceleration; velocity and displacement integrate the line from sample to sample

Samples may come at any distance. Of the past only samples count: the first one starts from the motion at
initialisation, so a floor that is not at zero, or already moving, is no jump.

A derived floor is continuous. Where a new sample finds it off its course, it does not jump but goes from where it is to
where the parabola leads, and the friction feels all of its way. (A jump would be lost on the friction, which follows
the deflection within a step only; in pre-sliding 1 um counts 2 N. Measured on the paper's bump from displacements: 2.7
times the error in the driver's acceleration.)
"""

from __future__ import annotations

from typing import NamedTuple

from plant_models.seat.interface import FloorSignals, Inputs

SHORTEST_INTERVAL = 1e-5
"""A sample that comes sooner after the last one, in s, is left out: differences would show little but rounding."""


class Floor(NamedTuple):
    """The floor over one step: second-order Taylor series about the step's begin, in m, m/s, m/s2."""

    displacement: float
    velocity: float
    acceleration: float

    def displacement_at(self, tau: float) -> float:
        """Return z_v in m, ``tau`` seconds after the step's begin."""
        return self.displacement + tau * (self.velocity + 0.5 * tau * self.acceleration)

    def velocity_at(self, tau: float) -> float:
        """Return z_v' in m/s, ``tau`` seconds after the step's begin."""
        return self.velocity + tau * self.acceleration


class History(NamedTuple):
    """What a derived floor remembers.

    Attributes
    ----------
    displacement, velocity, acceleration
        Motion at the last sample, as given or derived, in m, m/s, m/s2.
    age
        Time since that sample, in s; 0 before the first one.
    interval
        Time between that sample and the one before, in s; 0 where there is none.
    reached
        Where the last step has left the floor, in m.
    """

    displacement: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0
    age: float = 0.0
    interval: float = 0.0
    reached: float = 0.0


def given(inputs: Inputs) -> Floor:
    """Take all three signals as they are."""
    return Floor(inputs.floor_displacement, inputs.floor_velocity, inputs.floor_acceleration)


def _first(history: History, inputs: Inputs, signals: int) -> Floor:
    """Start from the motion at initialisation, with the sample in place of its own part of it."""
    if signals == FloorSignals.displacement:
        return Floor(inputs.floor_displacement, history.velocity, history.acceleration)
    if signals == FloorSignals.velocity:
        return Floor(history.displacement, inputs.floor_velocity, history.acceleration)
    return Floor(history.displacement, history.velocity, inputs.floor_acceleration)


def _sampled(history: History, inputs: Inputs, signals: int) -> Floor:
    """Derive the motion at a new sample."""
    z, v, a, age, interval, _ = history
    if signals == FloorSignals.displacement:
        displacement = inputs.floor_displacement
        slope = (displacement - z) / age
        slope_before = v - 0.5 * a * interval
        acceleration = 2.0 * (slope - slope_before) / (age + interval) if interval > 0.0 else 0.0
        return Floor(displacement, slope + 0.5 * age * acceleration, acceleration)
    if signals == FloorSignals.velocity:
        velocity = inputs.floor_velocity
        return Floor(z + 0.5 * age * (v + velocity), velocity, (velocity - v) / age)
    acceleration = inputs.floor_acceleration
    return Floor(z + age * (v + age * (2.0 * a + acceleration) / 6.0), v + 0.5 * age * (a + acceleration), acceleration)


def derived(history: History, inputs: Inputs, signals: int, step_size: float) -> tuple[Floor, History]:
    """Derive the floor over a step from the one signal that is alive.

    Parameters
    ----------
    history
        At the step's begin.
    inputs
        Only the living signal's is looked at.
    signals
        Which is alive, see :class:`~plant_models.seat.interface.FloorSignals`; not all.
    step_size
        In s.

    Returns
    -------
    tuple of Floor and History
        The floor over the step; the history at its end.
    """
    age, interval, reached = history.age, history.interval, history.reached
    node = Floor(*history[:3])
    if age == 0.0:
        motion = node = _first(history, inputs, signals)
        reached = motion.displacement
    elif age >= SHORTEST_INTERVAL:
        motion = node = _sampled(history, inputs, signals)
        interval = age
    else:
        motion = Floor(node.displacement_at(age), node.velocity_at(age), node.acceleration)
    # never faster than the error arose: a short step after a long one would be a jump
    correction = (motion.displacement - reached) / max(step_size, age)
    floor = Floor(reached, motion.velocity + correction, motion.acceleration)
    age = step_size if motion is node else age + step_size
    return floor, History(*node, age, interval, floor.displacement_at(step_size))
