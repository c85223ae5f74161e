"""Spectral densities and transmissibilities of sampled signals."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import signal as dsp

from cosim.errors import SignalError
from cosim.metrics.samples import Samples, positive, settled, together

_WINDOW = "hann"


@dataclass(frozen=True)
class Spectrum:
    """A one-sided power spectral density.

    Attributes
    ----------
    frequency
        In Hz, from 0, evenly spaced.
    density
        In the signal's unit squared per Hz.
    averages
        How many independent segments the overlapping ones are worth.
    """

    frequency: Samples
    density: Samples
    averages: float

    @property
    def resolution(self) -> float:
        """Distance of the lines in Hz; the Hann window sees 1.5 times as wide."""
        return float(self.frequency[1])

    @property
    def error(self) -> float:
        """Standard error of each line over its value, 1 / sqrt(averages), for a Gaussian signal."""
        return 1.0 / math.sqrt(self.averages)

    def rms(self, low: float = 0.0, high: float = math.inf) -> float:
        """Integrate over a band: its RMS, in the signal's unit.

        Parameters
        ----------
        low, high
            In Hz. A line stands for half a resolution either side of it and counts by the share inside.

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


def psd(signal: npt.ArrayLike, rate: float, resolution: float = 0.25, settle: float = 0.0) -> Spectrum:
    """Estimate the one-sided power spectral density by Welch's method.

    Hann window, half overlapping segments, each without its mean: the lines times the resolution add up to the
    signal's variance, without what changes more slowly than the resolution.

    Parameters
    ----------
    signal
        Shape (samples,).
    rate
        Sampling rate in Hz.
    resolution
        Distance of the lines in Hz; rounded so that a segment has whole samples.
    settle
        What to leave out at the beginning, in s.

    Raises
    ------
    SignalError
        If less than one segment, 1 / resolution, is left; for wrong samples.
    """
    length = _segment(rate, resolution)
    x = settled(signal, rate, settle, at_least=length)
    frequency, density = dsp.welch(x, rate, _WINDOW, length)
    return Spectrum(frequency, density, _averages(x.size, length))


@dataclass(frozen=True)
class Transmissibility:
    """A transmissibility over frequency, estimated from spectra.

    Attributes
    ----------
    frequency
        In Hz, without 0.
    ratio
        Complex, response over excitation; NaN where there was no excitation at all.
    coherence
        0 to 1: which part of the response's power the excitation explains; low for noise, for nonlinearity, and
        where there was no excitation.
    averages
        How many independent segments the overlapping ones are worth.
    """

    frequency: Samples
    ratio: npt.NDArray[np.complex128]
    coherence: Samples
    averages: float

    @property
    def gain(self) -> Samples:
        """Its magnitude."""
        return np.abs(self.ratio)

    @property
    def error(self) -> Samples:
        """Standard error of the gain over the gain, and of the phase in rad.

        sqrt((1 - coherence) / (2 coherence averages)), Bendat and Piersol: 95 % of estimates lie within twice that.
        It holds where it is small; infinite where nothing is coherent.
        """
        with np.errstate(divide="ignore"):
            return np.asarray(np.sqrt((1.0 - self.coherence) / (2.0 * self.coherence * self.averages)))


def transmissibility(
    excitation: npt.ArrayLike, response: npt.ArrayLike, rate: float, resolution: float = 0.25, settle: float = 0.0
) -> Transmissibility:
    """Estimate a transmissibility from broad-band signals.

    H1 = G_xy / G_xx with x the excitation, y the response: noise of the response averages out; noise of a *measured*
    excitation would make it too small. coherence = abs(G_xy)^2 / (G_xx G_yy). Spectra as in :func:`psd`.

    Parameters
    ----------
    excitation, response
        In the same unit, each of shape (samples,).
    rate
        Sampling rate in Hz.
    resolution
        Distance of the lines in Hz. A resonance needs several lines over its width.
    settle
        What to leave out at the beginning, in s.

    Raises
    ------
    SignalError
        If less than two segments, 2 / resolution, are left: the coherence of one segment is 1 whatever the signals;
        if the excitation is constant; if lengths differ; for wrong samples.
    """
    length = _segment(rate, resolution)
    x, y = (
        settled(values, rate, settle, name=name, at_least=2 * length)
        for name, values in zip(
            ("excitation", "response"), together(excitation=excitation, response=response), strict=True
        )
    )
    if np.ptp(x) == 0.0:
        raise SignalError(f"excitation: expected a signal that changes, got {x[0]:g} throughout")
    frequency, xx = dsp.welch(x, rate, _WINDOW, length)
    yy = dsp.welch(y, rate, _WINDOW, length)[1]
    xy = dsp.csd(x, y, rate, _WINDOW, length)[1]
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = xy / xx
        coherence = np.abs(xy) ** 2 / (xx * yy)
    # rounding may lift it a few bits above 1; nothing explains nothing
    coherence = np.clip(np.nan_to_num(coherence, nan=0.0), 0.0, 1.0)
    return Transmissibility(frequency[1:], ratio[1:], coherence[1:], _averages(x.size, length))


@dataclass(frozen=True)
class Sine:
    """A signal seen as a sine.

    Attributes
    ----------
    frequency
        In Hz.
    amplitude
        Complex: the sine is the real part of amplitude * exp(2 pi i f t), t = 0 at the signal's first sample.
    offset
        The mean beside it.
    residual
        RMS of what is neither.
    """

    frequency: float
    amplitude: complex
    offset: float
    residual: float

    @property
    def rms(self) -> float:
        """RMS of sine and residual, without the offset."""
        return math.hypot(abs(self.amplitude) / math.sqrt(2.0), self.residual)

    @property
    def distortion(self) -> float:
        """Residual over the sine's RMS; infinite if there is no sine."""
        return self.residual / (abs(self.amplitude) / math.sqrt(2.0)) if self.amplitude else math.inf


def fit_sine(signal: npt.ArrayLike, rate: float, frequency: float, settle: float = 0.0) -> Sine:
    """Fit sine and offset by least squares over the last whole periods.

    Parameters
    ----------
    signal
        Shape (samples,).
    rate
        Sampling rate in Hz; need not be a multiple of the frequency.
    frequency
        In Hz.
    settle
        What to leave out at the beginning, in s; what of it is left raises the distortion.

    Raises
    ------
    SignalError
        If less than one period is left; if the frequency is not below half the rate; for wrong samples.
    """
    if not positive("frequency", frequency, "Hz") < positive("rate", rate, "Hz") / 2.0:
        raise SignalError(f"frequency: expected below half the sampling rate, {rate / 2:g} Hz, got {frequency:g} Hz")
    period = rate / frequency
    left = settled(signal, rate, settle, at_least=max(4, math.ceil(period)))
    x = left[-round(math.floor(left.size / period) * period) :]
    total = np.asarray(signal).size
    angle = 2.0 * np.pi * frequency / rate * np.arange(total - x.size, total)
    basis = np.column_stack((np.cos(angle), np.sin(angle), np.ones_like(angle)))
    cosine, sine, offset = (float(value) for value in np.linalg.lstsq(basis, x, rcond=None)[0])
    residual = float(np.sqrt(np.mean((x - basis @ (cosine, sine, offset)) ** 2)))
    return Sine(frequency, complex(cosine, -sine), offset, residual)


@dataclass(frozen=True)
class SineTransmissibility:
    """A transmissibility at one frequency and amplitude, from steady state.

    Attributes
    ----------
    excitation, response
        The sines fitted. The response's distortion says how much of it is no sine: a transient that has not settled,
        or a nonlinear seat (friction, saturation), whose transmissibility then depends on the amplitude.
    """

    excitation: Sine
    response: Sine

    @property
    def ratio(self) -> complex:
        """Complex, response over excitation."""
        return self.response.amplitude / self.excitation.amplitude

    @property
    def gain(self) -> float:
        """Its magnitude: what the excitation's frequency alone does."""
        return abs(self.ratio)

    @property
    def rms_ratio(self) -> float:
        """RMS of the response over that of the excitation, harmonics and all.

        At the resonance of a seat that carries an inert mass this is T of the damping test of ISO 10326-1.
        """
        return self.response.rms / self.excitation.rms


def sine_transmissibility(
    excitation: npt.ArrayLike, response: npt.ArrayLike, rate: float, frequency: float, settle: float = 0.0
) -> SineTransmissibility:
    """Find the transmissibility of a sine in steady state.

    Parameters
    ----------
    excitation, response
        In the same unit, each of shape (samples,).
    rate
        Sampling rate in Hz.
    frequency
        In Hz.
    settle
        What to leave out at the beginning, in s.

    Raises
    ------
    SignalError
        As :func:`fit_sine`; if lengths differ; if there is no such sine in the excitation.
    """
    x, y = (fit_sine(values, rate, frequency, settle) for values in together(excitation=excitation, response=response))
    # 1e-12 of the largest sample: what rounding alone may leave of none
    if abs(x.amplitude) <= 1e-12 * float(np.max(np.abs(excitation))):
        raise SignalError(f"excitation: expected a sine of {frequency:g} Hz, got none")
    return SineTransmissibility(x, y)


def _segment(rate: float, resolution: float) -> int:
    """Return a segment's length in samples."""
    length = round(positive("rate", rate, "Hz") / positive("resolution", resolution, "Hz"))
    if length < 4:
        raise SignalError(f"resolution: expected at most a quarter of the rate, {rate / 4:g} Hz, got {resolution:g}")
    return length


def _averages(total: int, length: int) -> float:
    """Count the independent segments that overlapping ones are worth, after Welch (1967)."""
    step = length - length // 2
    count = (total - length) // step + 1
    window = dsp.get_window(_WINDOW, length)
    shared = float(window[step:] @ window[:-step] / (window @ window)) ** 2
    return count / (1.0 + 2.0 * (1.0 - 1.0 / count) * shared)
