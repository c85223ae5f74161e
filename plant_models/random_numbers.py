"""Reproducible random numbers: the n-th number of a seed follows from the seed and n alone.

The bits come from splitmix64. Its n-th number does not need the numbers before it, so no state is kept between calls.
The polar method makes normal numbers from the bits. Only integers, + - * / and the square root are used; their results
are the same on all machines, in Python and in C. The logarithm of a C library may differ between machines.
"""

from __future__ import annotations

import math

MAX_SEED = 2**31 - 1
"""Largest seed; the smallest is 0. FMI 2 stores integers with 32 bits."""

_ALL_BITS = 2**64 - 1
_STRIDE = 0x9E3779B97F4A7C15
_LN_2 = 0.6931471805599453
_SQRT_HALF = 0.7071067811865476
_SERIES = tuple(1.0 / n for n in range(23, 0, -2))


def _mix(bits: int) -> int:
    """Apply the output function of splitmix64 to 64 bits."""
    bits = ((bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9) & _ALL_BITS
    bits = ((bits ^ (bits >> 27)) * 0x94D049BB133111EB) & _ALL_BITS
    return bits ^ (bits >> 31)


def random_bits(stream: int, index: int) -> int:
    """Return 64 random bits of a stream.

    Parameters
    ----------
    stream
        Stream from :func:`random_stream`.
    index
        Index of the number in the stream; may be negative.

    Returns
    -------
    int
        From 0 to 2^64 - 1.

    Examples
    --------
    >>> hex(random_bits(0, 0))
    '0xe220a8397b1dcdaf'
    """
    return _mix((stream + (index + 1) * _STRIDE) & _ALL_BITS)


def random_stream(seed: int, number: int = 0) -> int:
    """Return a stream of a seed; streams of different seeds or numbers are independent.

    Parameters
    ----------
    seed
        From 0 to :data:`MAX_SEED`.
    number
        Number of the stream, from 0.

    Returns
    -------
    int
        Stream for :func:`random_bits` and :func:`random_normal`.
    """
    return random_bits(random_bits(0, seed), number)


def _logarithm(x: float) -> float:
    """Return the natural logarithm of a positive number, accurate to a few units in the last place."""
    mantissa, exponent = math.frexp(x)
    if mantissa < _SQRT_HALF:
        mantissa, exponent = 2.0 * mantissa, exponent - 1
    z = (mantissa - 1.0) / (mantissa + 1.0)  # ln m = 2 artanh z
    square = z * z
    series = 0.0
    for coefficient in _SERIES:
        series = series * square + coefficient
    return exponent * _LN_2 + 2.0 * z * series


def random_normal(stream: int, index: int) -> float:
    """Return a normally distributed number of a stream: mean 0, standard deviation 1.

    Parameters
    ----------
    stream
        Stream from :func:`random_stream`.
    index
        Index of the number in the stream; may be negative.

    Returns
    -------
    float
        Within [-9.2, 9.2].

    Examples
    --------
    >>> random_normal(random_stream(1), 5) == random_normal(random_stream(1), 5)
    True
    """
    bits = random_bits(stream, index)
    while True:
        u = ((bits >> 32) + 0.5) * 2.0**-31 - 1.0
        v = ((bits & 0xFFFFFFFF) + 0.5) * 2.0**-31 - 1.0
        s = u * u + v * v
        if s < 1.0:
            return u * math.sqrt(-2.0 * _logarithm(s) / s)
        bits = random_bits(bits, 0)
