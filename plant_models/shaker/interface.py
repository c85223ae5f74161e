"""Variables of the Shaker FMU.

The dataclasses are the only declaration: FMU descriptions, C headers and documentation are generated from them.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from fmus.variables import POSITIVE, Terminal, file_parameter, output, parameter
from plant_models.random_numbers import MAX_SEED
from plant_models.shaker import parameters as p
from plant_models.shaker.example_recording import EXAMPLE


class Profile(IntEnum):
    """Excitation profiles of the shaker."""

    bump = 1
    sine = 2
    sweep = 3
    random = 4
    file = 5


class SweepMode(IntEnum):
    """Signal of constant amplitude in a sweep."""

    acceleration = 1
    displacement = 2


class RandomClass(IntEnum):
    """Classes of machines: earth-moving (EM, ISO 7096), industrial trucks (IT, EN 13490), tractors (AG, ISO 5007)."""

    EM1 = 1
    EM2 = 2
    EM3 = 3
    EM4 = 4
    EM5 = 5
    EM6 = 6
    EM7 = 7
    EM8 = 8
    EM9 = 9
    IT1 = 10
    IT2 = 11
    IT3 = 12
    IT4 = 13
    AG1 = 14
    AG2 = 15
    AG3 = 16


@dataclass(slots=True)
class Inputs:
    """Inputs of the shaker: none, the motion depends on time alone."""


_INITIAL_DEPENDENCIES = (
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
"""Parameters on which the motion of the floor depends at the start; the random motion starts at rest."""


@dataclass(slots=True)
class Outputs:
    """Motion of the cabin floor, up positive.

    Attributes
    ----------
    floor_displacement, floor_velocity, floor_acceleration
        z_v in m, z_v' in m/s, z_v'' in m/s2.
    """

    floor_displacement: float = output(
        "m", "Cabin floor displacement z_v, up positive", nominal=0.01, dependencies=_INITIAL_DEPENDENCIES
    )
    floor_velocity: float = output("m/s", "Cabin floor velocity", nominal=0.1, dependencies=_INITIAL_DEPENDENCIES)
    floor_acceleration: float = output(
        "m/s2", "Cabin floor acceleration, its right limit at a jump", nominal=1.0, dependencies=_INITIAL_DEPENDENCIES
    )


@dataclass(slots=True)
class Parameters:
    """Parameters of the shaker: choice of the profile, shape of each profile, platform.

    Each field states unit, range and source in its declaration.
    """

    profile: Profile = parameter(Profile.bump, "Excitation profile")
    bump_height: float = parameter(p.BUMP_HEIGHT, "Height of the bump (34)", name="bump.height")
    bump_length: float = parameter(p.BUMP_LENGTH, "Length of the bump (34)", name="bump.length", minimum=POSITIVE)
    bump_speed: float = parameter(p.BUMP_SPEED, "Speed over the bump (34)", name="bump.speed", minimum=POSITIVE)
    sine_frequency: float = parameter(
        p.SINE_FREQUENCY, "Frequency of the sine z_v = A sin(2 pi f t)", name="sine.frequency", minimum=0.0
    )
    sine_amplitude: float = parameter(p.SINE_AMPLITUDE, "Displacement amplitude of the sine", name="sine.amplitude")
    sweep_mode: SweepMode = parameter(
        SweepMode.acceleration, "Signal of constant amplitude in the logarithmic sweep", name="sweep.mode"
    )
    sweep_start_frequency: float = parameter(
        p.SWEEP_START_FREQUENCY,
        "Frequency at the begin of the sweep",
        name="sweep.start_frequency",
        minimum=0.01,
        maximum=250.0,
    )
    sweep_stop_frequency: float = parameter(
        p.SWEEP_STOP_FREQUENCY,
        "Frequency at the end of the sweep, above or below that at its begin",
        name="sweep.stop_frequency",
        minimum=0.01,
        maximum=250.0,
    )
    sweep_duration: float = parameter(
        p.SWEEP_DURATION, "Duration of the sweep; the floor is at rest after it", name="sweep.duration", minimum=0.1
    )
    sweep_acceleration: float = parameter(
        p.SWEEP_ACCELERATION, "Amplitude of a sweep of constant acceleration", name="sweep.acceleration", minimum=0.0
    )
    sweep_displacement: float = parameter(
        p.SWEEP_DISPLACEMENT, "Amplitude of a sweep of constant displacement", name="sweep.displacement", minimum=0.0
    )
    sweep_fade: float = parameter(
        p.SWEEP_FADE,
        "Duration of fade-in and fade-out of the sweep, within its duration",
        name="sweep.fade",
        minimum=0.01,
    )
    random_class: RandomClass = parameter(
        RandomClass.EM1,
        "Class of the random motion, which starts at rest: EM of ISO 7096, IT of EN 13490, AG of ISO 5007",
        name="random.class",
    )
    random_scale: float = parameter(
        p.RANDOM_SCALE, "Factor on the amplitudes of the class, not on its spectrum", name="random.scale", minimum=0.0
    )
    random_seed: int = parameter(
        1,
        "Seed of the random motion: the same seed gives the same motion",
        name="random.seed",
        minimum=0,
        maximum=MAX_SEED,
    )
    file_path: str = file_parameter(
        EXAMPLE,
        "CSV file of the recorded motion: columns time in s and acceleration in m/s2 or displacement in m",
        name="file.path",
    )
    file_high_pass: float = parameter(
        p.FILE_HIGH_PASS,
        "Corner frequency below which a recorded acceleration is removed as drift, 0: none",
        name="file.high_pass",
        minimum=0.0,
        maximum=5.0,
    )
    file_fade: float = parameter(
        p.FILE_FADE, "Duration of fade-in and fade-out of a recorded acceleration", name="file.fade", minimum=0.01
    )
    platform_bandwidth: float = parameter(
        p.PLATFORM_BANDWIDTH,
        "Natural frequency of the second-order lag of the platform behind the profile, 0: no lag",
        name="platform.bandwidth",
        minimum=0.0,
        maximum=50.0,
    )
    platform_damping: float = parameter(
        p.PLATFORM_DAMPING,
        "Damping ratio of the lag of the platform",
        name="platform.damping",
        minimum=0.1,
        maximum=10.0,
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
