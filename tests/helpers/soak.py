"""A long run of the seat through the master, and what was seen of it."""

from __future__ import annotations

import os
import time
from array import array
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from cosim.engine.run_options import RunOptions
from cosim.results.result import COMPLETE, Result
from cosim.run_folder import run_to_folder
from seat_cosim.scenarios import seat_suspension

Array = np.ndarray[Any, Any]

HOUR = 3600.0
STEP_SIZE = 0.002
EVERY = 50
"""Steps from one recorded row to the next: 0.1 s, 864 001 rows a day."""

WATCHED = {"shaker.floor_acceleration": "m/s²", "seat.driver_acceleration": "m/s²", "controller.force": "N"}
"""Signals that should be stationary, with their units."""


class Soak(NamedTuple):
    """What was seen of a long run.

    Attributes
    ----------
    times, cpu, resident
        Simulated time in s, CPU time of this process in s and its resident memory in bytes, some twenty times a second
        while the run went on.
    result
        The thinned table, read back from the file.
    """

    times: Array
    cpu: Array
    resident: Array
    result: Result

    def time_error(self) -> float:
        """Largest difference in s of a row's time and its number's multiple of the step size."""
        return float(np.abs(self.result.time - np.arange(len(self.result.time)) * EVERY * STEP_SIZE).max())

    def step_costs(self, span: float) -> Array:
        """CPU time of a step in us, over each span of so many simulated s."""
        ends = np.arange(0.0, self.times[-1] + 0.5 * span, span)
        return np.diff(np.interp(ends, self.times, self.cpu)) / span * STEP_SIZE * 1e6

    def rms(self, signal: str, span: float) -> Array:
        """Root mean square of a recorded signal over each span of so many s."""
        rows = round(span / (EVERY * STEP_SIZE))
        values = self.result[signal]
        return np.sqrt(np.mean(values[: len(values) // rows * rows].reshape(-1, rows) ** 2, axis=1))

    def predicted_scatter(self, signal: str, span: float) -> float:
        """Relative standard deviation of such a root mean square of Gaussian noise with the signal's spectrum.

        1/(2 sqrt(B T)), B = (int G)^2 / int G^2 being the bandwidth of the recorded samples; the square of the
        periodogram is on average twice that of the spectrum.
        """
        values = self.result[signal] - self.result[signal].mean()
        periodogram = np.abs(np.fft.rfft(values)[1:]) ** 2
        resolution = 1.0 / (len(values) * EVERY * STEP_SIZE)
        bandwidth = resolution * periodogram.sum() ** 2 / (0.5 * np.sum(periodogram**2))
        return float(0.5 / np.sqrt(bandwidth * span))


def resident() -> int:
    """Resident memory of this process in bytes (Linux)."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def soak(fmus: Path, stop_time: float, folder: Path, report: Callable[[str], None] = lambda text: None) -> Soak:
    """Let the seat ride EM3 for a time in s; the table goes to a folder, memory keeps nothing of it."""
    system = seat_suspension(fmus)
    system.parameters = {"shaker.profile": "random", "shaker.random.class": "EM3"}
    seen = array("d")  # of its own it takes 24 bytes a look

    def look(reached: float) -> None:
        seen.extend((reached, time.process_time(), resident()))
        report(f"{reached / HOUR:.2f} of {stop_time / HOUR:g} h")

    result = run_to_folder(
        system,
        folder,
        RunOptions(stop_time, STEP_SIZE, record=list(WATCHED), record_every=EVERY, progress=look, keep=False),
    )
    if result.error is not None:
        raise result.error
    return Soak(*np.array(seen).reshape(-1, 3).T, Result.read(folder / COMPLETE))
