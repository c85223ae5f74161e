"""Figures of an assessment: the ride over time, spectra, transmissibility."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from cosim.metrics import running_rms, weighted
from cosim.recordings import Recording
from seat_cosim.assessment.numbers import Assessment
from seat_cosim.assessment.tables import shown_channels
from seat_cosim.plotting import Curve, Panel, draw

RIDE, SPECTRA, TRANSMISSIBILITY = "ride", "spectra", "transmissibility"
"""Names of the figures, without suffix."""

_WIDTH = 5.5
"""Width of the figures in inches: their text can be read on a phone."""

SUFFIXES = (".svg", ".png")

_MOST_POINTS = 2000
"""Number of points of a curve; of more samples, smallest and largest values are drawn."""

_STYLES: dict[str, dict[str, Any]] = {
    "floor": {"color": "0.6", "zorder": 2.0, "linewidth": 0.8},
    "seat": {"color": "C0", "zorder": 2.5, "linewidth": 0.8},
}
_BAND = (0.5, 80.0)
"""Frequencies in Hz that ISO 2631-1 evaluates."""

_SEAT_BAND = (0.5, 25.0)
"""Frequencies in Hz in which a seat's transmissibility is drawn."""

Floats = npt.NDArray[np.float64]


def draw_figures(folder: Path, assessment: Assessment) -> dict[str, list[Path]]:
    """Draw all figures of an assessment.

    Parameters
    ----------
    folder
        Folder of the files; it exists.
    assessment
        The assessment.

    Returns
    -------
    dict
        Name of a figure to its files, SVG first.
    """
    drawn = {RIDE: (_ride(assessment), "Time (s)", False), SPECTRA: (_spectra(assessment), "Frequency (Hz)", True)}
    if assessment.spectra.transmissibility is not None:
        drawn[TRANSMISSIBILITY] = (_transmissibility(assessment), "Frequency (Hz)", False)
    titles = {
        RIDE: "Acceleration, and its weighted running RMS over 1 s",
        SPECTRA: "Power spectral density of the acceleration",
        TRANSMISSIBILITY: "Transmissibility from floor to seat (H1)",
    }
    files = {}
    for name, (panels, label, log) in drawn.items():
        files[name] = [folder / f"{name}{suffix}" for suffix in SUFFIXES]
        draw(files[name][0], titles[name], panels, label, log=log, width=_WIDTH, copies=files[name][1:])
    return files


def _ride(assessment: Assessment) -> list[Panel]:
    recording = assessment.recording
    begin, end = recording.parts[0].begin, recording.parts[-1].begin + recording.parts[-1].size / recording.rate
    axis = np.array([begin, end])
    raw, running = [], []
    for key in shown_channels(assessment):
        style = _STYLES[key]
        raw.append(Curve(key, *_curve(recording, key, style, is_running=False)))
        running.append(Curve(key, *_curve(recording, key, {**style, "linewidth": 1.2}, is_running=True)))
    return [
        Panel("acceleration (m/s²)", axis, raw, {}, legend=True),
        Panel("weighted (m/s²)", axis, running, {}, legend=True),
    ]


def _curve(recording: Recording, key: str, style: dict[str, Any], *, is_running: bool) -> tuple[Floats, Any, Floats]:
    """Return values, style and times of a curve, with a break at each gap."""
    times: list[Floats] = []
    values: list[Floats] = []
    most = max(100, _MOST_POINTS // len(recording.parts))
    for part in recording.parts:
        samples = part.values[key]
        if is_running:
            samples = running_rms(weighted(samples, recording.rate), recording.rate)
        delay = part.size - len(samples)  # a running value belongs to the end of its window
        time = part.begin + (delay + np.arange(len(samples))) / recording.rate
        thin_time, thin = thinned(time, samples, most)
        times += [thin_time, thin_time[-1:]]
        values += [thin, np.full(1, np.nan)]
    return np.concatenate(values), style, np.concatenate(times)


def thinned(time: Floats, values: Floats, most: int) -> tuple[Floats, Floats]:
    """Return the smallest and largest values of equal spans, so that a curve of many samples looks the same.

    Parameters
    ----------
    time, values
        Samples, shape (samples,).
    most
        Number of points above which they are thinned out.

    Returns
    -------
    tuple of ndarray
        Times and values.
    """
    span = -(-2 * len(values) // most)
    if span <= 2:
        return time, values
    count = len(values) // span
    blocks = values[: count * span].reshape(count, span)
    low, high = blocks.argmin(axis=1), blocks.argmax(axis=1)
    starts = np.arange(count) * span
    at = np.unique(np.concatenate([starts + low, starts + high, [len(values) - 1]]))
    return time[at], values[at]


def _spectra(assessment: Assessment) -> list[Panel]:
    curves = []
    for key in shown_channels(assessment):
        spectrum = assessment.spectra.densities[key]
        inside = (spectrum.frequency >= _BAND[0]) & (spectrum.frequency <= _BAND[1]) & (spectrum.density > 0.0)
        style = {**_STYLES[key], "linewidth": 1.2}
        curves.append(Curve(key, spectrum.density[inside], style, spectrum.frequency[inside]))
    largest = max(float(curve.values.max(initial=1e-12)) for curve in curves)
    limits = (1e-6 * largest, 2.0 * largest)
    return [Panel("PSD ((m/s²)²/Hz)", np.array(_BAND), curves, {}, limits=limits, legend=True)]


def _transmissibility(assessment: Assessment) -> list[Panel]:
    found = assessment.spectra.transmissibility
    assert found is not None
    inside = (found.frequency >= _SEAT_BAND[0]) & (found.frequency <= _SEAT_BAND[1])
    frequency, axis = found.frequency[inside], np.array(_SEAT_BAND)
    gain = Curve("seat / floor", found.gain[inside], {"color": "C0"}, frequency)
    coherence = Curve("coherence", found.coherence[inside], {"color": "C1"}, frequency)
    return [
        Panel("gain (1)", axis, [gain], {"1: as the floor": 1.0}),
        Panel("coherence (1)", axis, [coherence], {}, limits=(0.0, 1.05)),
    ]
