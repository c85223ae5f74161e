"""Rides of the seat suspension through its FMUs: what the calibration measures, averaged over seeds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from cosim import Result
from cosim.fmi.description import Value
from cosim.metrics import Spectrum, peak, psd, rms, sine_transmissibility
from seat_cosim.paper.rig_ride import DURATION, SEEDS, SETTLE
from seat_cosim.paper.runner import DRIVER, FLOOR, SEAT
from seat_cosim.scenarios import driver_mass, seat_suspension

Array = np.ndarray[Any, Any]
Parameters = Mapping[str, Value]

FEW_SEEDS = SEEDS[:2]
"""Of surveys, which compare under one excitation."""
RESOLUTION = 0.125
"""Hz, of spectra: half the distance at which ISO 7096 looks."""


class Ride(NamedTuple):
    """A signal of rides that differ in their seed alone.

    Attributes
    ----------
    rms
        Over all rides, in m/s2.
    scatter
        Standard deviation of the rides' RMS over their mean.
    peak
        Mean of the rides' largest magnitudes, in m/s2.
    spectrum
        Mean over the rides.
    """

    rms: float
    scatter: float
    peak: float
    spectrum: Spectrum

    @property
    def peak_frequency(self) -> float:
        """Where the spectrum is largest, in Hz."""
        return float(self.spectrum.frequency[self.spectrum.density.argmax()])

    def error(self, duration: float) -> float:
        """Return sigma / RMS over a duration, for a Gaussian signal: 1 / (2 sqrt(B T)), B = (int G)^2 / int G^2."""
        density = self.spectrum.density
        bandwidth = self.spectrum.resolution * density.sum() ** 2 / (density @ density)
        return 1.0 / (2.0 * math.sqrt(bandwidth * duration))


class Rides:
    """Loaded FMUs of the seat suspension; a context manager.

    Parameters
    ----------
    fmus
        Folder of the three FMUs.
    load
        Parameters of what sits on the seat, for all rides.
    """

    def __init__(self, fmus: Path, load: Parameters) -> None:
        self.system = seat_suspension(fmus)
        self.load = load
        self._stack = ExitStack()

    def __enter__(self) -> Rides:
        self._session = self._stack.enter_context(self.system.open())
        return self

    def __exit__(self, *exception: object) -> None:
        self._stack.close()

    def run(
        self, stop_time: float, parameters: Parameters, mass: float, record: Iterable[str], record_every: int = 1
    ) -> Result:
        """Run once; an incomplete run is an error."""
        values = {**driver_mass(mass), **self.load, **parameters}
        result = self._session.run(stop_time, parameters=values, record=record, record_every=record_every)
        if result.error is not None:
            raise result.error
        return result

    def random(
        self, parameters: Parameters, mass: float = 55.0, seeds: Iterable[int] = SEEDS, signal: str = SEAT
    ) -> Ride:
        """Ride over random motion of the floor, once for each seed."""
        rides, spectra = [], []
        for seed in seeds:
            result = self.run(SETTLE + DURATION, {**parameters, "shaker.random.seed": seed}, mass, [signal], 5)
            rate = 1.0 / float(result.time[1])
            samples = result[signal][round(SETTLE * rate) :]
            rides.append((rms(samples), peak(samples)))
            spectra.append(psd(samples, rate, RESOLUTION))
        each, peaks = np.array(rides).T
        density = np.mean([spectrum.density for spectrum in spectra], axis=0)
        averages = sum(spectrum.averages for spectrum in spectra)
        return Ride(
            rms(each),
            float(each.std(ddof=1) / each.mean()) if len(each) > 1 else math.nan,
            float(peaks.mean()),
            Spectrum(spectra[0].frequency, density, averages),
        )

    def bump(self, parameters: Parameters, mass: float) -> tuple[float, float]:
        """Meet a bump; returns the peak accelerations of seat and driver in m/s2."""
        result = self.run(4.0, {"shaker.profile": "bump", **parameters}, mass, [SEAT, DRIVER])
        return peak(result[SEAT]), peak(result[DRIVER])

    def transmissibility(self, parameters: Parameters, frequencies: Iterable[float], amplitude: float) -> Array:
        """Shake with sines of one displacement amplitude, in m; returns RMS of the seat over RMS of the floor."""
        found = []
        for frequency in frequencies:
            sine = {
                "shaker.profile": "sine",
                "shaker.sine.frequency": frequency,
                "shaker.sine.amplitude": amplitude,
            }
            result = self.run(20.0, {**parameters, **sine}, 55.0, [SEAT, FLOOR])
            steady = sine_transmissibility(
                result[FLOOR], result[SEAT], 1.0 / float(result.time[1]), frequency, warm_up=8.0
            )
            found.append(steady.rms_ratio)
        return np.array(found)
