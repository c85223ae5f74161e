"""Sampled signals as the metrics take them: checked once, with one error that names the signal.

A sample stands for the time until the next one: N samples at a rate of r Hz last N / r seconds.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from cosim.errors import SignalError

Samples = npt.NDArray[np.float64]


def positive(name: str, value: float, unit: str, *, zero: bool = False) -> float:
    """Check a number.

    Parameters
    ----------
    name, unit
        For the error.
    value
        The number.
    zero
        Whether 0 will do.

    Raises
    ------
    SignalError
        If it is negative, not finite, or 0 where that will not do.
    """
    number = float(value)
    if math.isfinite(number) and (number > 0.0 or (zero and number == 0.0)):
        return number
    bound = "of at least" if zero else "above"
    raise SignalError(f"{name}: expected a finite number {bound} 0 {unit}, got {value:g} {unit}")


def samples(name: str, values: npt.ArrayLike) -> Samples:
    """Check one signal.

    Parameters
    ----------
    name
        For the error.
    values
        Shape (samples,).

    Raises
    ------
    SignalError
        If these are not finite real numbers in one dimension, or none at all.
    """
    array = np.asarray(values)
    if array.ndim != 1 or array.size == 0:
        raise SignalError(f"{name}: expected samples in one dimension, got an array of shape {array.shape}")
    if array.dtype.kind not in "biuf":
        raise SignalError(f"{name}: expected real numbers, got {array.dtype}")
    array = array.astype(np.float64, copy=False)
    wrong = np.flatnonzero(~np.isfinite(array))
    if wrong.size:
        raise SignalError(f"{name}: expected finite numbers, got {array[wrong[0]]} at sample {wrong[0]}")
    return array


def together(**signals: npt.ArrayLike) -> list[Samples]:
    """Check signals that belong together, by name.

    Raises
    ------
    SignalError
        As :func:`samples`, and if their lengths differ.
    """
    arrays = {name: samples(name, values) for name, values in signals.items()}
    if len({array.size for array in arrays.values()}) > 1:
        found = ", ".join(f"{name} {array.size}" for name, array in arrays.items())
        raise SignalError(f"expected signals of one length, got {found} samples")
    return list(arrays.values())


def settled(signal: npt.ArrayLike, rate: float, settle: float, *, name: str = "signal", at_least: int = 1) -> Samples:
    """Leave out a leading transient.

    Parameters
    ----------
    signal
        Shape (samples,).
    rate
        Sampling rate in Hz.
    settle
        What to leave out, in s; rounded to whole samples.
    name
        For the error.
    at_least
        How many samples have to be left.

    Raises
    ------
    SignalError
        As :func:`samples`, for a rate or time that is none, and if too little is left.
    """
    checked = samples(name, signal)
    start = round(positive("settle", settle, "s", zero=True) * positive("rate", rate, "Hz"))
    left = checked[start:]
    if left.size < at_least:
        raise SignalError(
            f"{name}: expected at least {at_least / rate:g} s of samples at {rate:g} Hz after {settle:g} s to settle, "
            f"got {left.size / rate:g} s"
        )
    return left
