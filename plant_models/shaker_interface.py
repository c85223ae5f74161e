"""The Shaker FMU's variables: the one declaration."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from fmus.variables import POSITIVE, Terminal, output, parameter
from plant_models import parameters as p


class Profile(IntEnum):
    """What the floor does."""

    bump = 1
    sine = 2


_MOTION = ("profile", "bump.height", "bump.length", "bump.speed", "sine.frequency", "sine.amplitude")


@dataclass(slots=True)
class Inputs:
    """None: the shaker moves by time alone."""


@dataclass(slots=True)
class Outputs:
    """The cabin floor's motion."""

    floor_displacement: float = output(
        "m", "Cabin floor displacement z_v, up positive", nominal=0.01, dependencies=_MOTION
    )
    floor_velocity: float = output("m/s", "Cabin floor velocity", nominal=0.1, dependencies=_MOTION)
    floor_acceleration: float = output(
        "m/s2", "Cabin floor acceleration, its right limit at a jump", nominal=1.0, dependencies=_MOTION
    )


@dataclass(slots=True)
class Parameters:
    """Which profile, and the shape of each."""

    profile: Profile = parameter(Profile.bump, "Excitation profile")
    bump_height: float = parameter(p.BUMP_HEIGHT, "Height of the bump (34)", name="bump.height")
    bump_length: float = parameter(p.BUMP_LENGTH, "Length of the bump (34)", name="bump.length", minimum=POSITIVE)
    bump_speed: float = parameter(p.BUMP_SPEED, "Speed over the bump (34)", name="bump.speed", minimum=POSITIVE)
    sine_frequency: float = parameter(
        p.SINE_FREQUENCY, "Frequency of the sine z_v = A sin(2 pi f t)", name="sine.frequency", minimum=0.0
    )
    sine_amplitude: float = parameter(p.SINE_AMPLITUDE, "Displacement amplitude of the sine", name="sine.amplitude")


TERMINALS = (
    Terminal(
        "floor",
        "Motion of the cabin floor",
        {"displacement": "floor_displacement", "velocity": "floor_velocity", "acceleration": "floor_acceleration"},
    ),
)
