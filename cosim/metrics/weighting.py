"""Frequency weighting Wk of ISO 2631-1: how a seated person feels vertical vibration."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from scipy import fft

from cosim.errors import SignalError
from cosim.metrics.samples import Samples, positive, samples, settled

# Hz and 1, ISO 2631-1:1997 annex A and ISO 8041-1
_F1, _F2, _Q1 = 0.4, 100.0, math.sqrt(0.5)  # band limits
_F3, _F4, _Q4 = 12.5, 12.5, 0.63  # acceleration-velocity transition
_F5, _Q5, _F6, _Q6 = 2.37, 0.91, 3.35, 0.91  # upward step

_HIGHEST = 80.0  # Hz, to which ISO 2631-1 evaluates
_FORGOTTEN = 20.0 / (2.0 * math.pi * _F1 * _Q1)  # s: 20 time constants of the slowest pole pair, e^-20 = 2e-9


def wk(frequency: npt.ArrayLike) -> npt.NDArray[np.complex128]:
    r"""Evaluate the frequency response of the weighting Wk.

    .. math::
        H = \frac{(s/\omega_1)^2}{D_1} \frac{1}{D_2} \frac{1 + s/\omega_3}{D_4}
            \frac{D_5}{D_6} \left(\frac{\omega_5}{\omega_6}\right)^2, \quad
        D_i = 1 + \frac{s}{Q_i \omega_i} + \left(\frac{s}{\omega_i}\right)^2

    Band limits, acceleration-velocity transition and upward step, as of ISO 2631-1:1997, annex A, with the
    parameters that ISO 8041-1 repeats.

    Parameters
    ----------
    frequency
        In Hz, any shape.

    Returns
    -------
    ndarray of complex
        Weighted over unweighted acceleration.

    Examples
    --------
    >>> print(np.abs(wk([1.0, 6.3, 63.0])).round(3))
    [0.482 1.054 0.186]
    """
    s = 1j * np.asarray(frequency, dtype=np.float64)

    def quadratic(corner: float, quality: float) -> npt.NDArray[np.complex128]:
        return 1.0 + s / (quality * corner) + (s / corner) ** 2

    band = (s / _F1) ** 2 / (quadratic(_F1, _Q1) * quadratic(_F2, _Q1))
    transition = (1.0 + s / _F3) / quadratic(_F4, _Q4)
    step = quadratic(_F5, _Q5) / quadratic(_F6, _Q6) * (_F5 / _F6) ** 2
    return np.asarray(band * transition * step)


def weighted(acceleration: npt.ArrayLike, rate: float, settle: float = 0.0) -> Samples:
    """Weight a vertical acceleration with Wk.

    The spectrum of the signal, padded with zeros until the filter has forgotten it, is multiplied by :func:`wk`
    itself: sines of 0.4-80 Hz come out within 1e-6 at 500 Hz (4e-3 at the least rate, 160 Hz). A recursive filter
    made by the bilinear transform would be 2 % low at 40 Hz and 14 % at 80 Hz. Cutting the response off at half the
    sampling rate is not quite causal: before a one-sample impulse 0.5 % of the answer's peak shows at 500 Hz.

    The signal counts as zero before its first sample, so a constant offset (gravity) leaves a transient; after 4 s
    less than 0.1 % of it is left.

    Parameters
    ----------
    acceleration
        In m/s2, shape (samples,).
    rate
        Sampling rate in Hz.
    settle
        What to leave out of the *weighted* signal at its beginning, in s.

    Returns
    -------
    ndarray
        In m/s2, shape (samples - settle * rate,).

    Raises
    ------
    SignalError
        If the rate is below twice 80 Hz, up to which ISO 2631-1 evaluates; for no samples or wrong ones.
    """
    if positive("rate", rate, "Hz") < 2.0 * _HIGHEST:
        raise SignalError(f"rate: expected at least {2 * _HIGHEST:g} Hz, as Wk reaches to 80 Hz, got {rate:g} Hz")
    signal = samples("acceleration", acceleration)
    length = fft.next_fast_len(signal.size + math.ceil(_FORGOTTEN * rate), real=True)
    spectrum = fft.rfft(signal, length) * wk(fft.rfftfreq(length, 1.0 / rate))
    answer = np.asarray(fft.irfft(spectrum, length)[: signal.size], dtype=np.float64)
    return settled(answer, rate, settle, name="acceleration")
