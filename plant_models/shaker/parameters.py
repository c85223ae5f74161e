"""Default values of the excitation, each with unit, symbol and source (equation numbers are those of the paper [1])."""

from __future__ import annotations

from fmus.variables import Quantity

BUMP_HEIGHT = Quantity(0.07, "m", "a", "equation 34")
BUMP_LENGTH = Quantity(0.8, "m", "l", "equation 34")
BUMP_SPEED = Quantity(1.0, "m/s", "v_0", "equation 34")

SINE_FREQUENCY = Quantity(3.0, "Hz", "f", "middle of the 2-4 Hz that shake drivers most, section 3.1")
SINE_AMPLITUDE = Quantity(0.006, "m", "A", "assumed")

_SWEEP = "assumed: the band in which drivers are shaken"

SWEEP_START_FREQUENCY = Quantity(0.5, "Hz", "f_0", _SWEEP)
SWEEP_STOP_FREQUENCY = Quantity(20.0, "Hz", "f_1", _SWEEP)
SWEEP_DURATION = Quantity(60.0, "s", "T", "assumed")
SWEEP_ACCELERATION = Quantity(1.0, "m/s2", "a", "assumed")
SWEEP_DISPLACEMENT = Quantity(0.001, "m", "A", "assumed")
SWEEP_FADE = Quantity(2.0, "s", "T_f", "assumed: a period of the lowest frequency")

RANDOM_SCALE = Quantity(1.0, "1", "s", "ISO 7096")

FILE_HIGH_PASS = Quantity(0.1, "Hz", "f_c", "assumed: a tenth of the lowest frequency that shakes a driver")
FILE_FADE = Quantity(0.5, "s", "T_f", "assumed")

_EXACT = "an ideal rig"

PLATFORM_BANDWIDTH = Quantity(0.0, "Hz", "f_p", _EXACT)
PLATFORM_DAMPING = Quantity(0.7, "1", "zeta_p", "assumed")
PLATFORM_STROKE = Quantity(0.0, "m", "z_max", _EXACT)
PLATFORM_VELOCITY = Quantity(0.0, "m/s", "v_max", _EXACT)
PLATFORM_ACCELERATION = Quantity(0.0, "m/s2", "a_max", _EXACT)
