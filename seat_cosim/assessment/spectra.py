"""Spectra and transmissibility of recordings that may have gaps: averages over the parts between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cosim.metrics import Spectrum, psd, transmissibility
from cosim.metrics.spectra import Transmissibility
from cosim.recordings import Recording

FINEST = 0.25
"""Distance of the lines of a spectrum of a long recording, in Hz."""

MIN_SEGMENTS = 4.0
"""Lengths of a segment that the longest part holds at least, where the resolution is chosen for it."""

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class RideSpectra:
    """Spectra of a recording.

    Attributes
    ----------
    densities
        Channel to its power spectral density in (m/s2)2/Hz.
    transmissibility
        From floor to seat; None where one of them is missing.
    left_out
        Time in parts that are too short for the resolution, in s.
    """

    densities: dict[str, Spectrum]
    transmissibility: Transmissibility | None
    left_out: float


def resolution_for(recording: Recording) -> float:
    """Choose the resolution of spectra: :data:`FINEST`, or coarser where the recording is short.

    Parameters
    ----------
    recording
        The recording.

    Returns
    -------
    float
        Distance of the lines in Hz.
    """
    longest = max(part.size for part in recording.parts) / recording.rate
    return max(FINEST, MIN_SEGMENTS / longest)


def ride_spectra(recording: Recording, resolution: float) -> RideSpectra:
    """Estimate the spectra of all channels, and the transmissibility from floor to seat.

    Each part contributes by its number of averages.

    Parameters
    ----------
    recording
        The recording.
    resolution
        Distance of the lines in Hz.

    Returns
    -------
    RideSpectra
        The spectra.

    Raises
    ------
    SignalError
        If no part is as long as two segments, or a channel is constant.
    """
    rate, needed = recording.rate, 2 * round(recording.rate / resolution)
    longest = max(part.size for part in recording.parts)
    used = [part for part in recording.parts if part.size >= min(needed, longest)]
    left_out = sum(part.size for part in recording.parts) - sum(part.size for part in used)
    densities = {
        key: _mean_spectrum([psd(part.values[key], rate, resolution) for part in used]) for key in recording.channels
    }
    both = {"floor", "seat"} <= set(recording.channels)
    ratio = None
    if both:
        parts = [(part.values["floor"], part.values["seat"]) for part in used]
        ratio = _mean_transmissibility(parts, rate, resolution)
    return RideSpectra(densities, ratio, left_out / rate)


def _mean_spectrum(spectra: list[Spectrum]) -> Spectrum:
    weights = np.array([each.averages for each in spectra])
    density = np.average([each.density for each in spectra], axis=0, weights=weights)
    return Spectrum(spectra[0].frequency, density, float(weights.sum()))


def _mean_transmissibility(parts: list[tuple[Floats, Floats]], rate: float, resolution: float) -> Transmissibility:
    """Average power and cross spectra over parts, and estimate H1 and coherence from the averages."""
    estimates = [transmissibility(x, y, rate, resolution) for x, y in parts]
    if len(estimates) == 1:
        return estimates[0]
    xx, yy = np.zeros_like(estimates[0].coherence), np.zeros_like(estimates[0].coherence)
    xy = np.zeros_like(estimates[0].ratio)
    for (x, y), estimate in zip(parts, estimates, strict=True):
        power = estimate.averages * psd(x, rate, resolution).density[1:]
        xx += power
        yy += estimate.averages * psd(y, rate, resolution).density[1:]
        xy += power * estimate.ratio
    with np.errstate(divide="ignore", invalid="ignore"):
        coherence = np.clip(np.nan_to_num(np.abs(xy) ** 2 / (xx * yy)), 0.0, 1.0)
        ratio = xy / xx
    return Transmissibility(estimates[0].frequency, ratio, coherence, sum(each.averages for each in estimates))
