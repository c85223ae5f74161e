"""Frequency weighting Wk of ISO 2631-1 for vertical vibration of seated persons."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
import numpy.typing as npt
from scipy import fft

from cosim.errors import SignalError
from cosim.metrics.samples import Samples, check_positive, check_samples, trim

# Hz and 1, ISO 2631-1:1997 annex A and ISO 8041-1
_F1, _F2, _Q1 = 0.4, 100.0, math.sqrt(0.5)  # band limits
_F3, _F4, _Q4 = 12.5, 12.5, 0.63  # acceleration-velocity transition
_F5, _Q5, _F6, _Q6 = 2.37, 0.91, 3.35, 0.91  # upward step

_HIGHEST = 80.0
"""Upper end of the frequency range of ISO 2631-1, in Hz."""

_PADDING = 20.0 / (2.0 * math.pi * _F1 * _Q1)
"""Duration after which the response has decayed, in s: 20 time constants of the slowest pole pair, e^-20 = 2e-9."""


def wk(frequency: npt.ArrayLike) -> npt.NDArray[np.complex128]:
    r"""Evaluate the frequency response of the weighting Wk.

    .. math::
        H = \frac{(s/\omega_1)^2}{D_1} \frac{1}{D_2} \frac{1 + s/\omega_3}{D_4}
            \frac{D_5}{D_6} \left(\frac{\omega_5}{\omega_6}\right)^2, \quad
        D_i = 1 + \frac{s}{Q_i \omega_i} + \left(\frac{s}{\omega_i}\right)^2

    The factors are band limits, acceleration-velocity transition and upward step of ISO 2631-1:1997, annex A, with the
    parameters of ISO 8041-1.

    Parameters
    ----------
    frequency
        Frequencies in Hz, any shape.

    Returns
    -------
    ndarray of complex
        Ratio of weighted to unweighted acceleration, in the shape of ``frequency``.

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


@lru_cache(maxsize=4)
def _response(length: int, rate: float) -> npt.NDArray[np.complex128]:
    """Return :func:`wk` at the lines of a spectrum; signals of one length, as of a sweep, share it."""
    found = wk(fft.rfftfreq(length, 1.0 / rate))
    found.flags.writeable = False
    return found


def weighted(acceleration: npt.ArrayLike, rate: float, warm_up: float = 0.0) -> Samples:
    """Weight a vertical acceleration with Wk.

    The spectrum of the zero-padded signal is multiplied by :func:`wk` itself. Sines of 0.4-80 Hz are weighted within
    1e-6 at 500 Hz (4e-3 at the lowest rate, 160 Hz). A recursive filter from the bilinear transform would be 2 % low at
    40 Hz and 14 % at 80 Hz. As the response is cut off at half the sampling rate, it is not quite causal: at 500 Hz,
    0.5 % of the peak of the impulse response precedes the impulse.

    The signal is zero before its first sample, so a constant offset (gravity) gives a transient. After 4 s less than
    0.1 % of it remains.

    Parameters
    ----------
    acceleration
        Acceleration in m/s2, shape (samples,).
    rate
        Sampling rate in Hz.
    warm_up
        Duration to remove at the beginning of the *weighted* signal, in s.

    Returns
    -------
    ndarray
        Weighted acceleration in m/s2, shape (samples - warm_up * rate,).

    Raises
    ------
    SignalError
        If the rate is below twice 80 Hz, the upper end of the frequency range of ISO 2631-1; if the samples are
        invalid; if no samples remain.
    """
    if check_positive("rate", rate, "Hz") < 2.0 * _HIGHEST:
        raise SignalError(f"rate: expected at least {2 * _HIGHEST:g} Hz, as Wk reaches to 80 Hz, got {rate:g} Hz")
    signal = check_samples("acceleration", acceleration)
    length = fft.next_fast_len(signal.size + math.ceil(_PADDING * rate), real=True)
    spectrum = fft.rfft(signal, length) * _response(length, float(rate))
    response = np.asarray(fft.irfft(spectrum, length)[: signal.size], dtype=np.float64)
    return trim(response, rate, warm_up, name="acceleration")
