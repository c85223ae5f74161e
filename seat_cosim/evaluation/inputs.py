"""Test inputs: what the standards demand of the floor's motion, and whether the samples of a ride conform to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from cosim.errors import SignalError
from cosim.metrics import psd
from cosim.metrics.samples import trim
from plant_models.shaker.interface import RandomClass
from plant_models.shaker.noise import SPECTRA

RESOLUTION = 0.25
"""Distance of the lines in Hz at which a spectrum is compared with its target; the window is Hann's."""

MAX_PSD_ERROR = 0.10
"""Largest deviation of a line from its target, as a share of the target's peak."""

MAX_RMS_ERROR = 0.05
"""Largest deviation of the RMS within the class's band, as a share of the target's."""


@dataclass(frozen=True)
class TestInput:
    """A class of machines: its input, and what a seat must achieve on it.

    Attributes
    ----------
    standard
        Standard of the class.
    low, high
        Band in Hz in which the RMS is taken and the spectrum compared.
    rms
        RMS in the band, in m/s2.
    seeds
        Seeds of the Shaker whose motion conforms over 180 s after 10 s, by ``python -m studies.conforming_inputs``; the
        first conforms best.
    seat_limit
        Largest SEAT by a_w; None where no limit is known.
    damping_limit
        Largest transmissibility at the suspension's resonance; None where no limit is known.
    """

    __test__ = False  # its name is no test's

    standard: str
    low: float
    high: float
    rms: float
    seeds: tuple[int, ...]
    seat_limit: float | None = None
    damping_limit: float | None = None


_EM, _IT, _AG = "ISO 7096", "EN 13490", "ISO 5007"

INPUTS = {
    "EM1": TestInput(_EM, 0.89, 11.22, 1.71, (47, 16, 39), 1.1, 1.5),
    "EM2": TestInput(_EM, 0.89, 11.22, 2.05, (39, 54, 11), 0.9, 1.5),
    "EM3": TestInput(_EM, 0.89, 11.22, 1.73, (39, 54, 11), 1.0, 1.5),
    "EM4": TestInput(_EM, 0.89, 11.22, 0.96, (39, 54, 11), 1.1, 1.5),
    "EM5": TestInput(_EM, 0.89, 17.78, 1.94, (423, 411, 372), 0.7, 2.0),
    "EM6": TestInput(_EM, 0.89, 17.78, 1.65, (2758, 92, 301), 0.7, 1.5),
    "EM7": TestInput(_EM, 0.89, 11.22, 2.26, (39, 120, 197), 0.6, 2.0),
    "EM8": TestInput(_EM, 0.89, 17.78, 1.05, (40, 9, 33), 0.8, 2.0),
    "EM9": TestInput(_EM, 0.89, 17.78, 1.63, (47, 33, 40), 0.9, 2.0),
    "IT1": TestInput(_IT, 0.89, 17.78, 1.58, (76, 69, 66)),
    "IT2": TestInput(_IT, 0.89, 17.78, 1.05, (40, 9, 33)),
    "IT3": TestInput(_IT, 0.89, 11.22, 0.96, (39, 54, 11)),
    "IT4": TestInput(_IT, 0.89, 17.78, 1.59, (39, 54, 11)),
    "AG1": TestInput(_AG, 0.89, 11.22, 2.26, (39, 120, 197)),
    "AG2": TestInput(_AG, 0.89, 11.22, 1.94, (3663, 805, 473)),
    "AG3": TestInput(_AG, 0.89, 11.22, 1.74, (952, 2741, 1932)),
}
"""Name of a class to its input.

Bands and RMS are those of the HVLab toolbox that gives the spectra, see :mod:`plant_models.shaker.noise`. The limits of
SEAT and of damping are those of ISO 7096 as *recalled*, not read in the standard.
"""


def target_density(name: str, frequency: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return the power spectral density that a class demands.

    Parameters
    ----------
    name
        Name of the class.
    frequency
        Frequencies above 0, in Hz, any shape.

    Returns
    -------
    ndarray
        Density in (m/s2)2/Hz, in the shape of ``frequency``.
    """
    order, corner, low_order, low_corner, level = SPECTRA[RandomClass[name]]
    f = np.asarray(frequency, dtype=np.float64)
    high = 1.0 + (corner / f) ** (2 * order)
    low = 1.0 + (f / low_corner) ** (2 * low_order)
    return np.asarray(level / (high * low))


def target_peak(name: str) -> float:
    """Return the largest density that a class demands, in (m/s2)2/Hz.

    Parameters
    ----------
    name
        Name of the class.
    """
    known = INPUTS[name]
    return float(target_density(name, np.arange(known.low, known.high, 0.01)).max())


@dataclass(frozen=True)
class InputConformity:
    """Deviations of a floor's motion from its class.

    Attributes
    ----------
    rms, target_rms
        RMS of the acceleration in the class's band, and what the class demands, in m/s2.
    psd_error
        Largest deviation of a line from its target, as a share of the target's peak, with its sign.
    frequency
        Frequency of that line, in Hz.
    spectrum
        Frequencies in Hz and densities in (m/s2)2/Hz of all lines in the band.
    """

    rms: float
    target_rms: float
    psd_error: float
    frequency: float
    spectrum: tuple[tuple[float, float], ...] = ()

    @property
    def rms_error(self) -> float:
        """Deviation of the RMS, as a share of the target's, with its sign."""
        return self.rms / self.target_rms - 1.0

    @property
    def words(self) -> str:
        """Both deviations as words."""
        return f"RMS {self.rms_error:+.1%}, PSD {self.psd_error:+.1%} at {self.frequency:g} Hz".replace("-", "−")

    @property
    def share(self) -> float:
        """Larger of both deviations, each as a share of what is allowed; up to 1 the input conforms."""
        return max(abs(self.rms_error) / MAX_RMS_ERROR, abs(self.psd_error) / MAX_PSD_ERROR)


def _band_rms(samples: npt.NDArray[np.float64], rate: float, band: TestInput) -> float:
    """Return the RMS in a band by Parseval's theorem, to which all samples contribute alike."""
    power = np.abs(np.fft.rfft(samples)) ** 2
    frequency = np.fft.rfftfreq(samples.size, 1.0 / rate)
    inside = (frequency >= band.low) & (frequency <= band.high)
    return float(np.sqrt(2.0 * power[inside].sum())) / samples.size


def conformity(
    name: str, acceleration: npt.NDArray[Any], rate: float, warm_up: float = 0.0, resolution: float = RESOLUTION
) -> InputConformity | None:
    """Compare the acceleration of a floor with its class.

    Parameters
    ----------
    name
        Name of the class.
    acceleration
        Acceleration of the floor in m/s2, shape (samples,).
    rate
        Sampling rate in Hz.
    warm_up
        Duration to remove at the beginning, in s.
    resolution
        Distance of the spectrum's lines, in Hz.

    Returns
    -------
    InputConformity or None
        None for a class that is not known, and for a ride too short for a spectrum.
    """
    if (known := INPUTS.get(name)) is None:
        return None
    try:
        spectrum = psd(acceleration, rate, resolution, warm_up)
    except SignalError:
        return None
    lines = (spectrum.frequency >= known.low) & (spectrum.frequency <= known.high)
    frequency = spectrum.frequency[lines]
    error = (spectrum.density[lines] - target_density(name, frequency)) / target_peak(name)
    worst = int(np.abs(error).argmax())
    return InputConformity(
        _band_rms(trim(acceleration, rate, warm_up), rate, known),
        known.rms,
        float(error[worst]),
        float(frequency[worst]),
        tuple(zip(frequency.tolist(), spectrum.density[lines].tolist(), strict=True)),
    )
