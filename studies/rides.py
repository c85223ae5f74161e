"""Rides of the seat suspension through its FMUs: the metrics of the calibration, averaged over seeds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from cosim import Result
from cosim.fmi.values import Value
from cosim.metrics import Spectrum, peak, psd, rms, sine_transmissibility
from seat_cosim.paper.rig_ride import DURATION, SEEDS, WARM_UP
from seat_cosim.paper.runner import DRIVER, FLOOR, SEAT
from seat_cosim.scenarios import driver_mass, seat_suspension

Array = np.ndarray[Any, Any]
Parameters = Mapping[str, Value]

FEW_SEEDS = SEEDS[:2]
"""Seeds of surveys, which compare under the same excitation."""
RESOLUTION = 0.125
"""Resolution of spectra, in Hz: half the distance of the frequencies in ISO 7096."""


class Ride(NamedTuple):
    """Metrics of a signal over rides that differ in their seed alone.

    Attributes
    ----------
    rms
        RMS over all rides, in m/s2.
    scatter
        Standard deviation of the rides' RMS, relative to their mean.
    peak
        Mean of the rides' largest magnitudes, in m/s2.
    spectrum
        Mean of the rides' spectra.
    """

    rms: float
    scatter: float
    peak: float
    spectrum: Spectrum

    @property
    def peak_frequency(self) -> float:
        """Frequency at which the spectrum is largest, in Hz."""
        return float(self.spectrum.frequency[self.spectrum.density.argmax()])

    def error(self, duration: float) -> float:
        """Return the relative standard deviation of the RMS of a Gaussian signal with this spectrum.

        It is 1 / (2 sqrt(B T)) with the bandwidth B = (int G)^2 / int G^2.

        Parameters
        ----------
        duration
            T, in s.
        """
        density = self.spectrum.density
        bandwidth = self.spectrum.resolution * density.sum() ** 2 / (density @ density)
        return 1.0 / (2.0 * math.sqrt(bandwidth * duration))


class Rides:
    """The seat suspension with its FMUs loaded; a context manager.

    Parameters
    ----------
    fmus
        Folder of the three FMUs.
    load
        Parameters of the load on the seat in all rides, as ``component.variable``.

    Attributes
    ----------
    system
        The seat suspension.
    load
        As given.
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
        """Run once.

        Parameters
        ----------
        stop_time
            In s.
        parameters
            ``component.variable`` to value; they win over load and mass.
        mass
            The driver's mass, in kg.
        record
            Outputs to record.
        record_every
            Number of steps from one recorded row to the next.

        Raises
        ------
        CosimError
            If the run does not reach its stop time.
        """
        values = {**driver_mass(mass), **self.load, **parameters}
        result = self._session.run(stop_time, parameters=values, record=record, record_every=record_every)
        if result.error is not None:
            raise result.error
        return result

    def random(
        self, parameters: Parameters, mass: float = 55.0, seeds: Iterable[int] = SEEDS, signal: str = SEAT
    ) -> Ride:
        """Ride over random motion of the floor, once for each seed.

        Parameters
        ----------
        parameters
            ``component.variable`` to value.
        mass
            The driver's mass, in kg.
        seeds
            Seeds of the excitation.
        signal
            Output whose metrics are returned, in m/s2.
        """
        rides, spectra = [], []
        for seed in seeds:
            result = self.run(WARM_UP + DURATION, {**parameters, "shaker.random.seed": seed}, mass, [signal], 5)
            rate = 1.0 / float(result.time[1])
            samples = result[signal][round(WARM_UP * rate) :]
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
        """Run a bump.

        Parameters
        ----------
        parameters
            ``component.variable`` to value.
        mass
            The driver's mass, in kg.

        Returns
        -------
        tuple of float
            Peak accelerations of seat and driver, in m/s2.
        """
        result = self.run(4.0, {"shaker.profile": "bump", **parameters}, mass, [SEAT, DRIVER])
        return peak(result[SEAT]), peak(result[DRIVER])

    def transmissibility(self, parameters: Parameters, frequencies: Iterable[float], amplitude: float) -> Array:
        """Run sines of one amplitude, with a driver of 55 kg.

        Parameters
        ----------
        parameters
            ``component.variable`` to value.
        frequencies
            In Hz.
        amplitude
            Amplitude of the floor's displacement, in m.

        Returns
        -------
        numpy.ndarray
            RMS acceleration of the seat over that of the floor, shape (frequencies,).
        """
        found = []
        for frequency in frequencies:
            sine = {
                "shaker.profile": "sine",
                "shaker.sine.frequency": frequency,
                "shaker.sine.amplitude": amplitude,
            }
            result = self.run(20.0, {**parameters, **sine}, 55.0, [SEAT, FLOOR])
            rate = 1.0 / float(result.time[1])
            steady = sine_transmissibility(result[FLOOR], result[SEAT], rate, frequency, warm_up=8.0)
            found.append(steady.rms_ratio)
        return np.array(found)
