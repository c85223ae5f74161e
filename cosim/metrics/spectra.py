"""Power spectral densities and transmissibilities of sampled signals."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy

from cosim.errors import SignalError
from cosim.metrics.samples import Samples, check_equal_length, check_positive, trim

_WINDOW = "hann"


@dataclass(frozen=True)
class Spectrum:
    """A one-sided power spectral density.

    Attributes
    ----------
    frequency
        Frequencies of the lines in Hz, from 0, evenly spaced; shape (lines,).
    density
        Density in the signal's unit squared per Hz, shape (lines,).
    averages
        Number of independent segments with the same variance as the overlapping ones.
    """

    frequency: Samples
    density: Samples
    averages: float

    @property
    def resolution(self) -> float:
        """Distance of the lines in Hz; the noise bandwidth of the Hann window is 1.5 times as wide."""
        return float(self.frequency[1])

    @property
    def error(self) -> float:
        """Relative standard error of each line, 1 / sqrt(averages), for a Gaussian signal."""
        return 1.0 / math.sqrt(self.averages)

    def rms(self, low: float = 0.0, high: float = math.inf) -> float:
        """Calculate the RMS in a frequency band, the root of the integral of the density.

        Parameters
        ----------
        low, high
            Limits of the band in Hz. A line covers half the resolution on either side and counts by its share inside.

        Returns
        -------
        float
            In the signal's unit.

        Raises
        ------
        SignalError
            If ``low`` is not below ``high``.
        """
        if not low < high:
            raise SignalError(f"band: expected low < high, got {low:g} and {high:g} Hz")
        half = self.resolution / 2.0
        inside = np.minimum(self.frequency + half, high) - np.maximum(self.frequency - half, low)
        share = np.clip(inside / self.resolution, 0.0, 1.0)
        return math.sqrt(float(share @ self.density) * self.resolution)


def psd(signal: npt.ArrayLike, rate: float, resolution: float = 0.25, warm_up: float = 0.0) -> Spectrum:
    """Estimate the one-sided power spectral density by Welch's method.

    With a Hann window, segments that overlap by half, and the mean of each segment removed. The sum of the lines times
    the resolution is the signal's variance, without components slower than the resolution.

    Parameters
    ----------
    signal
        The samples, shape (samples,).
    rate
        Sampling rate in Hz.
    resolution
        Distance of the lines in Hz; rounded so that a segment has a whole number of samples.
    warm_up
        Duration to remove at the beginning, in s.

    Returns
    -------
    Spectrum
        The density.

    Raises
    ------
    SignalError
        If less than one segment of 1 / resolution remains, or the samples are invalid.
    """
    length = _segment(rate, resolution)
    x = trim(signal, rate, warm_up, at_least=length)
    frequency, density = scipy.signal.welch(x, rate, _WINDOW, length)
    return Spectrum(frequency, density, _averages(x.size, length))


@dataclass(frozen=True)
class Transmissibility:
    """A transmissibility over frequency, estimated from spectra.

    Attributes
    ----------
    frequency
        Frequencies of the lines in Hz, without 0; shape (lines,).
    ratio
        Complex ratio of response to excitation, shape (lines,); NaN without excitation.
    coherence
        Share of the response's power that is linearly related to the excitation, 0 to 1, shape (lines,); low for noise,
        for nonlinearity, and without excitation.
    averages
        Number of independent segments with the same variance as the overlapping ones.
    """

    frequency: Samples
    ratio: npt.NDArray[np.complex128]
    coherence: Samples
    averages: float

    @property
    def gain(self) -> Samples:
        """Magnitude of the ratio, shape (lines,)."""
        return np.abs(self.ratio)

    @property
    def error(self) -> Samples:
        """Relative standard error of the gain, and standard error of the phase in rad; shape (lines,).

        sqrt((1 - coherence) / (2 coherence averages)), after Bendat and Piersol. 95 % of the estimates are within twice
        that. It is valid where it is small, and infinite where the coherence is 0.
        """
        with np.errstate(divide="ignore"):
            return np.asarray(np.sqrt((1.0 - self.coherence) / (2.0 * self.coherence * self.averages)))


def transmissibility(
    excitation: npt.ArrayLike, response: npt.ArrayLike, rate: float, resolution: float = 0.25, warm_up: float = 0.0
) -> Transmissibility:
    """Estimate a transmissibility from broad-band signals.

    The estimator is H1 = G_xy / G_xx of excitation x and response y. Noise of the response averages out; noise of a
    *measured* excitation reduces the estimate. The coherence is abs(G_xy)^2 / (G_xx G_yy). The spectra are estimated as
    in :func:`psd`.

    Parameters
    ----------
    excitation, response
        The signals, in the same unit, each of shape (samples,).
    rate
        Sampling rate in Hz.
    resolution
        Distance of the lines in Hz. A resonance must be several lines wide.
    warm_up
        Duration to remove at the beginning, in s.

    Returns
    -------
    Transmissibility
        Without the line at 0 Hz.

    Raises
    ------
    SignalError
        If less than two segments of 1 / resolution remain (the coherence of one segment is always 1), the excitation is
        constant, the lengths differ, or the samples are invalid.
    """
    length = _segment(rate, resolution)
    x, y = (
        trim(values, rate, warm_up, name=name, at_least=2 * length)
        for name, values in check_equal_length(excitation=excitation, response=response).items()
    )
    if np.ptp(x) == 0.0:
        raise SignalError(f"excitation: expected a signal that changes, got {x[0]:g} throughout")
    frequency, xx = scipy.signal.welch(x, rate, _WINDOW, length)
    yy = scipy.signal.welch(y, rate, _WINDOW, length)[1]
    xy = scipy.signal.csd(x, y, rate, _WINDOW, length)[1]
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = xy / xx
        coherence = np.abs(xy) ** 2 / (xx * yy)
    # rounding may give a few bits above 1; NaN where there is no power
    coherence = np.clip(np.nan_to_num(coherence, nan=0.0), 0.0, 1.0)
    return Transmissibility(frequency[1:], ratio[1:], coherence[1:], _averages(x.size, length))


@dataclass(frozen=True)
class Sine:
    """A sine that was fitted to a signal.

    Attributes
    ----------
    frequency
        Frequency f in Hz.
    amplitude
        Complex amplitude: the sine is the real part of amplitude * exp(2 pi i f t), with t = 0 at the first sample.
    offset
        Constant part of the signal.
    residual
        RMS of the difference between the signal and sine plus offset.
    """

    frequency: float
    amplitude: complex
    offset: float
    residual: float

    @property
    def rms(self) -> float:
        """RMS of the signal without the offset."""
        return math.hypot(abs(self.amplitude) / math.sqrt(2.0), self.residual)

    @property
    def distortion(self) -> float:
        """Ratio of the residual to the RMS of the sine; infinite for an amplitude of 0."""
        return self.residual / (abs(self.amplitude) / math.sqrt(2.0)) if self.amplitude else math.inf


def fit_sine(signal: npt.ArrayLike, rate: float, frequency: float, warm_up: float = 0.0) -> Sine:
    """Fit a sine and an offset by least squares to the last whole periods of a signal.

    Parameters
    ----------
    signal
        The samples, shape (samples,).
    rate
        Sampling rate in Hz; need not be a multiple of the frequency.
    frequency
        Frequency of the sine in Hz.
    warm_up
        Duration to remove at the beginning, in s. A transient that lasts longer increases the distortion.

    Returns
    -------
    Sine
        Its phase refers to the first sample of the whole signal.

    Raises
    ------
    SignalError
        If less than one period remains, the frequency is not below half the rate, or the samples are invalid.
    """
    if not check_positive("frequency", frequency, "Hz") < check_positive("rate", rate, "Hz") / 2.0:
        raise SignalError(f"frequency: expected below half the sampling rate, {rate / 2:g} Hz, got {frequency:g} Hz")
    period = rate / frequency
    remaining = trim(signal, rate, warm_up, at_least=max(4, math.ceil(period)))
    x = remaining[-round(math.floor(remaining.size / period) * period) :]
    total = np.asarray(signal).size
    angle = 2.0 * np.pi * frequency / rate * np.arange(total - x.size, total)
    basis = np.column_stack((np.cos(angle), np.sin(angle), np.ones_like(angle)))
    cosine, sine, offset = (float(value) for value in np.linalg.lstsq(basis, x, rcond=None)[0])
    residual = float(np.sqrt(np.mean((x - basis @ (cosine, sine, offset)) ** 2)))
    return Sine(frequency, complex(cosine, -sine), offset, residual)


@dataclass(frozen=True)
class SineTransmissibility:
    """A transmissibility in steady state at one frequency and amplitude.

    Attributes
    ----------
    excitation, response
        The fitted sines. A distortion of the response indicates a transient, or a nonlinear seat (friction, saturation)
        whose transmissibility depends on the amplitude.
    """

    excitation: Sine
    response: Sine

    @property
    def ratio(self) -> complex:
        """Complex ratio of response to excitation."""
        return self.response.amplitude / self.excitation.amplitude

    @property
    def gain(self) -> float:
        """Magnitude of the ratio, without harmonics."""
        return abs(self.ratio)

    @property
    def rms_ratio(self) -> float:
        """Ratio of the RMS of the response to that of the excitation, with harmonics.

        At the resonance of a seat with an inert mass, this is T of the damping test of ISO 10326-1.
        """
        return self.response.rms / self.excitation.rms


def sine_transmissibility(
    excitation: npt.ArrayLike, response: npt.ArrayLike, rate: float, frequency: float, warm_up: float = 0.0
) -> SineTransmissibility:
    """Determine the transmissibility of a sine in steady state.

    Parameters
    ----------
    excitation, response
        The signals, in the same unit, each of shape (samples,).
    rate
        Sampling rate in Hz.
    frequency
        Frequency of the sine in Hz.
    warm_up
        Duration to remove at the beginning, in s.

    Returns
    -------
    SineTransmissibility
        The fitted sines of both signals.

    Raises
    ------
    SignalError
        If a sine cannot be fitted, see :func:`fit_sine`, the lengths differ, or the excitation has no such sine.
    """
    x, y = (
        fit_sine(values, rate, frequency, warm_up)
        for values in check_equal_length(excitation=excitation, response=response).values()
    )
    # rounding may give an amplitude of 1e-12 of the largest sample where there is no such sine
    if abs(x.amplitude) <= 1e-12 * float(np.max(np.abs(excitation))):
        raise SignalError(f"excitation: expected a sine of {frequency:g} Hz, got none")
    return SineTransmissibility(x, y)


def _segment(rate: float, resolution: float) -> int:
    """Return a segment's length in samples."""
    length = round(check_positive("rate", rate, "Hz") / check_positive("resolution", resolution, "Hz"))
    if length < 4:
        raise SignalError(f"resolution: expected at most a quarter of the rate, {rate / 4:g} Hz, got {resolution:g}")
    return length


def _averages(total: int, length: int) -> float:
    """Return the number of independent segments with the same variance as overlapping ones, after Welch (1967)."""
    step = length - length // 2
    count = (total - length) // step + 1
    window = scipy.signal.get_window(_WINDOW, length)
    shared = float(window[step:] @ window[:-step] / (window @ window)) ** 2
    return count / (1.0 + 2.0 * (1.0 - 1.0 / count) * shared)
