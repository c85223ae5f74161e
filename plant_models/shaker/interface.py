"""The Shaker FMU's variables: the one declaration."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from fmus.variables import POSITIVE, Terminal, file_name, output, parameter
from plant_models.random_numbers import MOST_SEED
from plant_models.shaker import parameters as p
from plant_models.shaker.example_recording import EXAMPLE


class Profile(IntEnum):
    """What the floor does."""

    bump = 1
    sine = 2
    sweep = 3
    random = 4
    file = 5


class SweepMode(IntEnum):
    """Which amplitude a sweep keeps."""

    acceleration = 1
    displacement = 2


class RandomClass(IntEnum):
    """Classes of earth-moving machinery in ISO 7096."""

    EM1 = 1
    EM2 = 2
    EM3 = 3
    EM4 = 4
    EM5 = 5
    EM6 = 6
    EM7 = 7
    EM8 = 8
    EM9 = 9


@dataclass(slots=True)
class Inputs:
    """None: the shaker moves by time alone."""


_AT_THE_START = (
    "profile",
    "bump.height",
    "bump.length",
    "bump.speed",
    "sine.frequency",
    "sine.amplitude",
    "sweep.mode",
    "sweep.start_frequency",
    "sweep.stop_frequency",
    "sweep.duration",
    "sweep.acceleration",
    "sweep.displacement",
    "sweep.fade",
    "file.path",
    "file.high_pass",
    "file.fade",
    "platform.bandwidth",
    "platform.damping",
    "platform.stroke",
    "platform.velocity_limit",
    "platform.acceleration_limit",
)
"""What the floor depends on at the start; noise starts at rest."""


@dataclass(slots=True)
class Outputs:
    """The cabin floor's motion."""

    floor_displacement: float = output(
        "m", "Cabin floor displacement z_v, up positive", nominal=0.01, dependencies=_AT_THE_START
    )
    floor_velocity: float = output("m/s", "Cabin floor velocity", nominal=0.1, dependencies=_AT_THE_START)
    floor_acceleration: float = output(
        "m/s2", "Cabin floor acceleration, its right limit at a jump", nominal=1.0, dependencies=_AT_THE_START
    )


@dataclass(slots=True)
class Parameters:
    """Which profile, the shape of each, and the platform that follows it."""

    profile: Profile = parameter(Profile.bump, "Excitation profile")
    bump_height: float = parameter(p.BUMP_HEIGHT, "Height of the bump (34)", name="bump.height")
    bump_length: float = parameter(p.BUMP_LENGTH, "Length of the bump (34)", name="bump.length", minimum=POSITIVE)
    bump_speed: float = parameter(p.BUMP_SPEED, "Speed over the bump (34)", name="bump.speed", minimum=POSITIVE)
    sine_frequency: float = parameter(
        p.SINE_FREQUENCY, "Frequency of the sine z_v = A sin(2 pi f t)", name="sine.frequency", minimum=0.0
    )
    sine_amplitude: float = parameter(p.SINE_AMPLITUDE, "Displacement amplitude of the sine", name="sine.amplitude")
    sweep_mode: SweepMode = parameter(
        SweepMode.acceleration, "Which amplitude the logarithmic sweep keeps", name="sweep.mode"
    )
    sweep_start_frequency: float = parameter(
        p.SWEEP_START_FREQUENCY,
        "Frequency at the sweep's begin",
        name="sweep.start_frequency",
        minimum=0.01,
        maximum=250.0,
    )
    sweep_stop_frequency: float = parameter(
        p.SWEEP_STOP_FREQUENCY,
        "Frequency at the sweep's end, above or below that at its begin",
        name="sweep.stop_frequency",
        minimum=0.01,
        maximum=250.0,
    )
    sweep_duration: float = parameter(
        p.SWEEP_DURATION, "Length of the sweep; the floor rests after it", name="sweep.duration", minimum=0.1
    )
    sweep_acceleration: float = parameter(
        p.SWEEP_ACCELERATION, "Amplitude of a sweep of constant acceleration", name="sweep.acceleration", minimum=0.0
    )
    sweep_displacement: float = parameter(
        p.SWEEP_DISPLACEMENT, "Amplitude of a sweep of constant displacement", name="sweep.displacement", minimum=0.0
    )
    sweep_fade: float = parameter(
        p.SWEEP_FADE, "Length of the sweep's fade-in and fade-out, within its duration", name="sweep.fade", minimum=0.01
    )
    random_class: RandomClass = parameter(
        RandomClass.EM1, "ISO 7096 class of the random motion, which starts at rest", name="random.class"
    )
    random_scale: float = parameter(
        p.RANDOM_SCALE, "Factor on the class's amplitudes, not on its spectrum", name="random.scale", minimum=0.0
    )
    random_seed: int = parameter(
        1,
        "Seed of the random motion: the same seed gives the same motion",
        name="random.seed",
        minimum=0,
        maximum=MOST_SEED,
    )
    file_path: str = file_name(
        EXAMPLE,
        "CSV file of the recorded motion: columns time in s and acceleration in m/s2 or displacement in m",
        name="file.path",
    )
    file_high_pass: float = parameter(
        p.FILE_HIGH_PASS,
        "Corner frequency below which a recorded acceleration is taken for drift, 0: none",
        name="file.high_pass",
        minimum=0.0,
        maximum=5.0,
    )
    file_fade: float = parameter(
        p.FILE_FADE, "Length of the fade-in and fade-out of a recorded acceleration", name="file.fade", minimum=0.01
    )
    platform_bandwidth: float = parameter(
        p.PLATFORM_BANDWIDTH,
        "Natural frequency of the second-order lag with which a platform follows the profile, 0: it follows exactly",
        name="platform.bandwidth",
        minimum=0.0,
        maximum=50.0,
    )
    platform_damping: float = parameter(
        p.PLATFORM_DAMPING, "Damping ratio of the platform's lag", name="platform.damping", minimum=0.1, maximum=10.0
    )
    platform_stroke: float = parameter(
        p.PLATFORM_STROKE, "Largest displacement of the platform, 0: no limit", name="platform.stroke", minimum=0.0
    )
    platform_velocity_limit: float = parameter(
        p.PLATFORM_VELOCITY,
        "Largest velocity of the platform, 0: no limit",
        name="platform.velocity_limit",
        minimum=0.0,
    )
    platform_acceleration_limit: float = parameter(
        p.PLATFORM_ACCELERATION,
        "Largest acceleration of the platform, 0: no limit",
        name="platform.acceleration_limit",
        minimum=0.0,
    )


TERMINALS = (
    Terminal(
        "floor",
        "Motion of the cabin floor",
        {"displacement": "floor_displacement", "velocity": "floor_velocity", "acceleration": "floor_acceleration"},
    ),
)
