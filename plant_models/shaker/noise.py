"""Random floor motion of classes of machines: seeded white noise through Butterworth filters.

The power spectral density of the acceleration is G = g |H|^2 with

    H(s) = s^n omega_l^m / (prod (s - p_h) prod (s - p_l)),

the n poles p_h of the high-pass and the m poles p_l of the low-pass all different. In partial fractions

    H(s) = sum r_i/(s - p_i),    x_i' = p_i x_i + w,    acceleration = sum r_i x_i,

and as n is 2 at least, velocity and displacement are outputs of the same modes, with r_i/p_i and r_i/p_i^2 instead of
r_i. So nothing is integrated that could drift, and each signal is the exact derivative of the one before it. Poles come
in conjugate pairs: one of each pair is kept, with twice its residue.

The noise w is held over ticks, normal with the variance g/(2 tick), so that its density is g sinc^2(f tick): 0.4 % less
than g at 17.8 Hz. Over a tick each mode advances exactly, x <- exp(p tick) x + (exp(p tick) - 1)/p w. The noise of tick
n follows from seed and n alone, so the motion does not depend on the communication steps. It starts at rest and is
stationary within 1 % after five of the longest time constants, 1.4 s in EM1 to EM5 and EM7, 2.1 s in AG3.
"""

from __future__ import annotations

import math
from cmath import exp
from typing import NamedTuple

from plant_models.random_numbers import random_normal
from plant_models.shaker.interface import Outputs, RandomClass

MAX_MODES = 8
"""Number of pole pairs in EM7 and AG1 to AG3, which have the most."""


class Spectrum(NamedTuple):
    """Spectrum of the acceleration of a class: Butterworth high-pass and low-pass.

    Attributes
    ----------
    high_order, high_corner
        Order n and corner frequency in Hz of the high-pass.
    low_order, low_corner
        Order m and corner frequency in Hz of the low-pass.
    level
        g, in (m/s2)2/Hz, one-sided.
    """

    high_order: int
    high_corner: float
    low_order: int
    low_corner: float
    level: float


SPECTRA = {
    RandomClass.EM1: Spectrum(4, 1.5, 4, 2.5, 2.82),
    RandomClass.EM2: Spectrum(4, 1.5, 4, 3.0, 2.72),
    RandomClass.EM3: Spectrum(4, 1.5, 4, 3.0, 1.93),
    RandomClass.EM4: Spectrum(4, 1.5, 4, 3.0, 0.60),
    RandomClass.EM5: Spectrum(4, 1.5, 1, 3.5, 1.11),
    RandomClass.EM6: Spectrum(2, 6.5, 2, 9.0, 0.79),
    RandomClass.EM7: Spectrum(8, 3.0, 8, 3.5, 9.25),
    RandomClass.EM8: Spectrum(4, 3.0, 2, 3.0, 1.45),
    RandomClass.EM9: Spectrum(4, 3.5, 2, 4.0, 2.10),
    RandomClass.IT1: Spectrum(4, 4.5, 2, 5.0, 1.66),
    RandomClass.IT2: Spectrum(4, 3.0, 2, 3.0, 1.45),
    RandomClass.IT3: Spectrum(4, 1.5, 4, 3.0, 0.60),
    RandomClass.IT4: Spectrum(4, 1.5, 4, 3.0, 1.64),
    RandomClass.AG1: Spectrum(8, 3.0, 8, 3.5, 9.25),
    RandomClass.AG2: Spectrum(8, 2.1, 8, 2.6, 7.22),
    RandomClass.AG3: Spectrum(8, 1.95, 8, 2.45, 5.85),
}
"""Spectra of the classes in ISO 7096 (EM), EN 13490:2001 (IT) and ISO 5007:2003 (AG).

The constants are those of the HVLab Human Response to Vibration Toolbox (hvtestspectrum, issue 1.1, 2009), not read in
the standards. Integrated over their bands, all give the RMS that its other function (hvtestsignal) scales them to.
"""


class Mode(NamedTuple):
    """One mode of the noise filter.

    Attributes
    ----------
    pole
        p, in rad/s.
    transition, input_gain
        exp(p tick) and (exp(p tick) - 1)/p: factors on state and noise over a tick.
    displacement, velocity, acceleration
        Factors on the state in the three output signals.
    """

    pole: complex
    transition: complex
    input_gain: complex
    displacement: complex
    velocity: complex
    acceleration: complex


def _butterworth_poles(order: int, corner: float) -> list[complex]:
    """Return the poles of a Butterworth filter with Im >= 0, in rad/s, for a corner frequency in Hz."""
    omega = 2.0 * math.pi * corner
    angles = [math.pi * (2 * k + order + 1) / (2 * order) for k in range(order // 2)]
    pairs = [complex(omega * math.cos(angle), omega * math.sin(angle)) for angle in angles]
    return [*pairs, complex(-omega, 0.0)] if order % 2 else pairs


def _inverse(z: complex) -> complex:
    size = z.real * z.real + z.imag * z.imag
    return complex(z.real / size, -z.imag / size)


def _discretize(pole: complex, time: float) -> tuple[complex, complex]:
    """Return exp(p t) and (exp(p t) - 1)/p: factors on the state of a mode and on held noise over a time in s."""
    transition = exp(pole * time)
    return transition, (transition - 1.0) * _inverse(pole)


def _prepare_mode(i: int, poles: list[complex], order: int, gain: float, tick: float) -> Mode:
    """Derive a mode from its residue at the i-th pole; ``order`` is that of the high-pass."""
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
    transition, input_gain = _discretize(pole, tick)
    return Mode(pole, transition, input_gain, velocity * _inverse(pole), velocity, residue)


def prepare(random_class: RandomClass, scale: float, tick: float) -> tuple[Mode, ...]:
    """Derive the modes of a class.

    Parameters
    ----------
    random_class
        Class of machines.
    scale
        Factor on all signals.
    tick
        Hold time of the noise, in s.

    Returns
    -------
    tuple of Mode
        One mode for each pole with Im >= 0.
    """
    spectrum = SPECTRA[random_class]
    poles = _butterworth_poles(spectrum.high_order, spectrum.high_corner)
    poles += _butterworth_poles(spectrum.low_order, spectrum.low_corner)
    gain = scale * math.sqrt(spectrum.level / (2.0 * tick))
    for _ in range(spectrum.low_order):
        gain = gain * (2.0 * math.pi * spectrum.low_corner)
    return tuple(_prepare_mode(i, poles, spectrum.high_order, gain, tick) for i in range(len(poles)))


def advance(state: tuple[float, ...], modes: tuple[Mode, ...], stream: int, tick: int) -> tuple[float, ...]:
    """Advance the modes over a tick.

    Parameters
    ----------
    state
        Real and imaginary part of each mode at the begin of the tick, then zeros.
    modes
        Modes from :func:`prepare`.
    stream
        Stream of random numbers.
    tick
        Number of the tick.

    Returns
    -------
    tuple of float
        State at the end of the tick, of the same length.
    """
    noise = random_normal(stream, tick)
    after = list(state)
    for i, mode in enumerate(modes):
        x = mode.transition * complex(state[2 * i], state[2 * i + 1]) + mode.input_gain * noise
        after[2 * i], after[2 * i + 1] = x.real, x.imag
    return tuple(after)


def motion(state: tuple[float, ...], modes: tuple[Mode, ...], stream: int, tick: int, elapsed: float) -> Outputs:
    """Evaluate the motion within a tick.

    Parameters
    ----------
    state, modes, stream, tick
        As of :func:`advance`.
    elapsed
        Time since the begin of the tick, in s.

    Returns
    -------
    Outputs
        Motion of the floor.
    """
    noise = random_normal(stream, tick) if elapsed > 0.0 else 0.0
    displacement = velocity = acceleration = 0.0
    for i, mode in enumerate(modes):
        x = complex(state[2 * i], state[2 * i + 1])
        if elapsed > 0.0:
            transition, input_gain = _discretize(mode.pole, elapsed)
            x = transition * x + input_gain * noise
        displacement += mode.displacement.real * x.real - mode.displacement.imag * x.imag
        velocity += mode.velocity.real * x.real - mode.velocity.imag * x.imag
        acceleration += mode.acceleration.real * x.real - mode.acceleration.imag * x.imag
    return Outputs(displacement, velocity, acceleration)
