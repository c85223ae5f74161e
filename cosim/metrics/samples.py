"""Checks of sampled signals and numbers; errors name the signal.

A sample holds until the next one: N samples at a rate of r Hz last N / r seconds.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from cosim.errors import SignalError

Samples = npt.NDArray[np.float64]
"""Samples of a signal, shape (samples,)."""


def check_positive(name: str, value: float, unit: str, *, zero: bool = False) -> float:
    """Check that a number is finite and positive.

    Parameters
    ----------
    name, unit
        Name and unit of the number in messages.
    value
        The number.
    zero
        Whether 0 is allowed.

    Returns
    -------
    float
        The number.

    Raises
    ------
    SignalError
        If the number is negative, not finite, or 0 where that is not allowed.
    """
    number = float(value)
    if math.isfinite(number) and (number > 0.0 or (zero and number == 0.0)):
        return number
    bound = "of at least" if zero else "above"
    raise SignalError(f"{name}: expected a finite number {bound} 0 {unit}, got {value:g} {unit}")


def check_samples(name: str, values: npt.ArrayLike) -> Samples:
    """Check a signal and convert it to an array of floats.

    Parameters
    ----------
    name
        Name of the signal in messages.
    values
        The samples, shape (samples,).

    Returns
    -------
    ndarray
        The samples, shape (samples,); not a copy where the values are such an array already.

    Raises
    ------
    SignalError
        If the values are not finite real numbers in one dimension, or there are none.
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


def check_equal_length(**signals: npt.ArrayLike) -> dict[str, Samples]:
    """Check several signals of one length.

    Parameters
    ----------
    **signals
        Name of each signal in messages, to its samples of shape (samples,).

    Returns
    -------
    dict of ndarray
        Name of each signal to its samples, shape (samples,).

    Raises
    ------
    SignalError
        If a signal is invalid, see :func:`check_samples`, or the lengths differ.
    """
    arrays = {name: check_samples(name, values) for name, values in signals.items()}
    if len({array.size for array in arrays.values()}) > 1:
        found = ", ".join(f"{name} {array.size}" for name, array in arrays.items())
        raise SignalError(f"expected signals of one length, got {found} samples")
    return arrays


def trim(signal: npt.ArrayLike, rate: float, warm_up: float, *, name: str = "signal", at_least: int = 1) -> Samples:
    """Remove the warm-up from the beginning of a signal.

    Parameters
    ----------
    signal
        The samples, shape (samples,).
    rate
        Sampling rate in Hz.
    warm_up
        Duration to remove in s; rounded to whole samples.
    name
        Name of the signal in messages.
    at_least
        How many samples must remain.

    Returns
    -------
    ndarray
        The remaining samples, shape (samples - warm_up * rate,).

    Raises
    ------
    SignalError
        If the signal is invalid, see :func:`check_samples`, the rate is not positive, the warm-up is negative, or too
        few samples remain.
    """
    checked = check_samples(name, signal)
    start = round(check_positive("warm_up", warm_up, "s", zero=True) * check_positive("rate", rate, "Hz"))
    remaining = checked[start:]
    if remaining.size < at_least:
        raise SignalError(
            f"{name}: expected at least {at_least / rate:g} s of samples at {rate:g} Hz after {warm_up:g} s of "
            f"warm-up, got {remaining.size / rate:g} s"
        )
    return remaining
