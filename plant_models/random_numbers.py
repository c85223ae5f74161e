"""Random numbers that are the same everywhere: the n-th number of a seed follows from seed and n alone.

Bits come from splitmix64, whose n-th number needs none of those before it, so nothing has to be kept between calls.
Normal numbers come from them by the polar method. Only integers, + - * / and the square root are used, which give the
same on all machines, in Python and in C; a library's logarithm might not.
"""

from __future__ import annotations

import math

MOST_SEED = 2**31 - 1
"""Seeds reach from 0 to here: what FMI 2 takes as an integer."""

_ALL_BITS = 2**64 - 1
_STRIDE = 0x9E3779B97F4A7C15
_LN_2 = 0.6931471805599453
_SQRT_HALF = 0.7071067811865476
_SERIES = tuple(1.0 / n for n in range(23, 0, -2))


def _mixed(bits: int) -> int:
    """Scatter 64 bits: the output function of splitmix64."""
    bits = ((bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9) & _ALL_BITS
    bits = ((bits ^ (bits >> 27)) * 0x94D049BB133111EB) & _ALL_BITS
    return bits ^ (bits >> 31)


def random_bits(stream: int, index: int) -> int:
    """Return the 64 bits at a place of a stream.

    Parameters
    ----------
    stream
        From :func:`random_stream`.
    index
        Place, of either sign.

    Examples
    --------
    >>> hex(random_bits(0, 0))
    '0xe220a8397b1dcdaf'
    """
    return _mixed((stream + (index + 1) * _STRIDE) & _ALL_BITS)


def random_stream(seed: int, number: int = 0) -> int:
    """Return one of the streams of a seed; streams of different seeds or numbers have nothing in common.

    Parameters
    ----------
    seed
        From 0 to :data:`MOST_SEED`.
    number
        Which stream, from 0.
    """
    return random_bits(random_bits(0, seed), number)


def _logarithm(x: float) -> float:
    """Natural logarithm of a positive number, within a few units of the last place."""
    mantissa, exponent = math.frexp(x)
    if mantissa < _SQRT_HALF:
        mantissa, exponent = 2.0 * mantissa, exponent - 1
    z = (mantissa - 1.0) / (mantissa + 1.0)  # ln m = 2 artanh z
    square = z * z
    series = 0.0
    for coefficient in _SERIES:
        series = series * square + coefficient
    return exponent * _LN_2 + 2.0 * z * series


def normal(stream: int, index: int) -> float:
    """Return the normal number at a place of a stream: mean 0, standard deviation 1, up to 9.2 either way.

    Parameters
    ----------
    stream
        From :func:`random_stream`.
    index
        Place, of either sign.
    """
    bits = random_bits(stream, index)
    while True:
        u = ((bits >> 32) + 0.5) * 2.0**-31 - 1.0
        v = ((bits & 0xFFFFFFFF) + 0.5) * 2.0**-31 - 1.0
        s = u * u + v * v
        if s < 1.0:
            return u * math.sqrt(-2.0 * _logarithm(s) / s)
        bits = random_bits(bits, 0)
