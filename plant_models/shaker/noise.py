"""Random floor motion of the ISO 7096 classes: seeded white noise through Butterworth filters.

The power spectral density of the acceleration is G = g |H|^2 with

    H(s) = s^n omega_l^m / (prod (s - p_h) prod (s - p_l)),

the n poles p_h of the high-pass and the m poles p_l of the low-pass all different. In partial fractions

    H(s) = sum r_i/(s - p_i),    x_i' = p_i x_i + w,    acceleration = sum r_i x_i,

and as n is 2 at least, velocity and displacement are outputs of the same modes, with r_i/p_i and r_i/p_i^2 instead of
r_i. So nothing is integrated that could drift, and each signal is the exact derivative of the one before it. Poles come
in conjugate pairs: one of each pair is kept, and counts twice.

The noise w is held over ticks, normal with the variance g/(2 tick), so that its density is g sinc^2(f tick): 0.4 % less
than g at 17.8 Hz. Over a tick each mode goes exactly, x <- exp(p tick) x + (exp(p tick) - 1)/p w. The n-th tick's noise
follows from seed and n alone, so a motion does not depend on communication steps. It starts at rest and is stationary
within 1 % after five of the longest time constants, 1.4 s in EM1 to EM5 and EM7.
"""

from __future__ import annotations

import math
from cmath import exp
from typing import NamedTuple

from plant_models.random_numbers import normal
from plant_models.shaker.interface import Outputs, RandomClass

MOST_MODES = 8
"""Pairs of poles in EM7, which has the most."""


class Band(NamedTuple):
    """Spectrum of a class.

    Attributes
    ----------
    high_order, high_corner
        Of the high-pass; the corner in Hz.
    low_order, low_corner
        Of the low-pass.
    level
        g in (m/s2)2/Hz, one-sided.
    """

    high_order: int
    high_corner: float
    low_order: int
    low_corner: float
    level: float


BANDS = {
    RandomClass.EM1: Band(4, 1.5, 4, 2.5, 2.82),
    RandomClass.EM2: Band(4, 1.5, 4, 3.0, 2.72),
    RandomClass.EM3: Band(4, 1.5, 4, 3.0, 1.93),
    RandomClass.EM4: Band(4, 1.5, 4, 3.0, 0.60),
    RandomClass.EM5: Band(4, 1.5, 1, 3.5, 1.11),
    RandomClass.EM6: Band(2, 6.5, 2, 9.0, 0.79),
    RandomClass.EM7: Band(8, 3.0, 8, 3.5, 9.25),
    RandomClass.EM8: Band(4, 3.0, 2, 3.0, 1.45),
    RandomClass.EM9: Band(4, 3.5, 2, 4.0, 2.10),
}
"""ISO 7096."""


class Mode(NamedTuple):
    """One pole, what a tick does to its state, and its share in the three signals."""

    pole: complex
    growth: complex
    push: complex
    displacement: complex
    velocity: complex
    acceleration: complex


def _poles(order: int, corner: float) -> list[complex]:
    """Return a Butterworth filter's poles with Im >= 0, in rad/s, for a corner in Hz."""
    omega = 2.0 * math.pi * corner
    angles = [math.pi * (2 * k + order + 1) / (2 * order) for k in range(order // 2)]
    pairs = [complex(omega * math.cos(angle), omega * math.sin(angle)) for angle in angles]
    return [*pairs, complex(-omega, 0.0)] if order % 2 else pairs


def _inverse(z: complex) -> complex:
    size = z.real * z.real + z.imag * z.imag
    return complex(z.real / size, -z.imag / size)


def _transition(pole: complex, time: float) -> tuple[complex, complex]:
    """Return what a time in s makes of a mode's state and of held noise: exp(p t) and (exp(p t) - 1)/p."""
    growth = exp(pole * time)
    return growth, (growth - 1.0) * _inverse(pole)


def modes(chosen: RandomClass, scale: float, tick: float) -> tuple[Mode, ...]:
    """Derive the modes of a class.

    Parameters
    ----------
    chosen
        Which.
    scale
        Factor on all signals.
    tick
        How long noise is held, in s.
    """
    band = BANDS[chosen]
    poles = [*_poles(band.high_order, band.high_corner), *_poles(band.low_order, band.low_corner)]
    gain = scale * math.sqrt(band.level / (2.0 * tick))
    for _ in range(band.low_order):
        gain = gain * (2.0 * math.pi * band.low_corner)
    return tuple(_mode(i, poles, band.high_order, gain, tick) for i in range(len(poles)))


def _mode(i: int, poles: list[complex], order: int, gain: float, tick: float) -> Mode:
    pole = poles[i]
    residue = complex(gain, 0.0)
    for _ in range(order):
        residue = residue * pole
    for j, other in enumerate(poles):
        if j != i:
            residue = residue * _inverse(pole - other)
        if other.imag > 0.0:
            residue = residue * _inverse(pole - other.conjugate())
    if pole.imag > 0.0:
        residue = residue * 2.0
    velocity = residue * _inverse(pole)
    growth, push = _transition(pole, tick)
    return Mode(pole, growth, push, velocity * _inverse(pole), velocity, residue)


def advanced(state: tuple[float, ...], modes: tuple[Mode, ...], stream: int, tick: int) -> tuple[float, ...]:
    """Move the modes over a tick.

    Parameters
    ----------
    state
        Real and imaginary part of each mode, at the tick's begin.
    modes
        From :func:`modes`.
    stream
        Of random numbers.
    tick
        Which one.
    """
    noise = normal(stream, tick)
    left = list(state)
    for i, mode in enumerate(modes):
        x = mode.growth * complex(state[2 * i], state[2 * i + 1]) + mode.push * noise
        left[2 * i], left[2 * i + 1] = x.real, x.imag
    return tuple(left)


def motion(state: tuple[float, ...], modes: tuple[Mode, ...], stream: int, tick: int, since: float) -> Outputs:
    """Evaluate the motion within a tick, ``since`` seconds after its begin; other parameters as :func:`advanced`."""
    noise = normal(stream, tick) if since > 0.0 else 0.0
    displacement = velocity = acceleration = 0.0
    for i, mode in enumerate(modes):
        x = complex(state[2 * i], state[2 * i + 1])
        if since > 0.0:
            growth, push = _transition(mode.pole, since)
            x = growth * x + push * noise
        displacement += mode.displacement.real * x.real - mode.displacement.imag * x.imag
        velocity += mode.velocity.real * x.real - mode.velocity.imag * x.imag
        acceleration += mode.acceleration.real * x.real - mode.acceleration.imag * x.imag
    return Outputs(displacement, velocity, acceleration)
