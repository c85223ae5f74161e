"""Figures of the calibration: other values that would fit as well, and the spectra."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from seat_cosim.plotting import Curve, Panel, draw
from seat_cosim.scenarios import control
from studies.calibration import (
    BAND,
    CONTROLLED_RMS,
    PASSIVE_RMS,
    SINE_AMPLITUDE,
    Comparison,
    Shape,
    passive_seat,
    prototype_seat,
)
from studies.rides import FEW_SEEDS, FLOOR, Parameters, Rides

DAMPINGS = np.array([60.0, 90, 130, 180, 250, 350, 500, 700, 850, 1000, 1200])
FRICTIONS = (0.0, 0.2, 0.4, 0.6, 0.8)
LAGS = np.array([0.0, 0.005, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06])
DELAYS = (0.0, 0.002, 0.008, 0.016)
SENSORS = (50.0, 10.0)
DPI = 95
"""Resolution of the figures, with which each is smaller than 100 kB."""
STYLES = {
    "passive": {"color": "C0"},
    "uncontrolled": {"color": "0.45", "linestyle": "--"},
    "prototype": {"color": "C3"},
    "ideal": {"color": "C2", "linestyle": ":"},
}


def draw_figures(rides: Rides, sets: Mapping[str, Parameters], light: Comparison, folder: Path) -> None:
    """Draw all figures.

    Parameters
    ----------
    rides
        Runs the seats.
    sets
        Name to parameter set.
    light
        Rides with a load of 55 kg.
    folder
        Folder of the figures; it exists.
    """
    draw_passive(rides, sets["ride"], folder / "calibration_passive.png")
    draw_prototype(rides, sets["ride"], folder / "calibration_prototype.png")
    draw_spectra(rides, sets, light, folder / "calibration_spectra.png")


def draw_passive(rides: Rides, floor: Parameters, path: Path) -> None:
    """Draw RMS and transmissibility of passive seats over damping, for several frictions.

    Parameters
    ----------
    rides
        Runs the seats.
    floor
        Parameters of the excitation.
    path
        Figure file.
    """
    rows = []
    for friction in FRICTIONS:
        for damping in DAMPINGS:
            seat = passive_seat(rides, damping, friction)
            shaken = rides.random({**floor, **control(False), **seat}, seeds=FEW_SEEDS)
            shape = Shape.of(rides, seat)
            rows.append((shaken.rms, shaken.peak_frequency, shape.gain.min()))
    values = np.array(rows).reshape(len(FRICTIONS), len(DAMPINGS), -1)
    panels = [
        Panel(label, DAMPINGS, [_of_friction(k, values[k, :, index]) for k in range(len(FRICTIONS))], marks)
        for index, (label, marks) in enumerate(
            (
                ("RMS (m/s²)", {"paper": PASSIVE_RMS}),
                ("Spectrum's peak (Hz)", {'paper: "around 2 Hz"': 2.0}),
                ("Better by, 2.5-4.5 Hz", {"uncontrolled seat": 0.0}),
            )
        )
    ]
    draw(path, "Passive seat, 55 kg: friction relative to the prototype's", panels, "Damping (N s/m)", dpi=DPI)


def _of_friction(index: int, values: np.ndarray) -> Curve:
    return Curve(f"friction x {FRICTIONS[index]:g}", values, {"color": f"C{index}"})


def draw_prototype(rides: Rides, floor: Parameters, path: Path) -> None:
    """Draw the controlled seat's RMS over lag, delay and bandwidth of the sensors.

    Parameters
    ----------
    rides
        Runs the seats.
    floor
        Parameters of the excitation.
    path
        Figure file.
    """
    panels = []
    for bandwidth in SENSORS:
        curves = []
        for index, delay in enumerate(DELAYS):
            rms = [
                rides.random({**floor, **prototype_seat(lag, delay, bandwidth)}, seeds=FEW_SEEDS).rms for lag in LAGS
            ]
            curves.append(Curve(f"delay {1e3 * delay:g} ms", np.array(rms), {"color": f"C{index}"}))
        panels.append(Panel(f"RMS (m/s²)\nsensors {bandwidth:g} Hz", 1e3 * LAGS, curves, {"paper": CONTROLLED_RMS}))
    draw(path, "Controlled seat, 55 kg: lag, delay and sensors that fit equally well", panels, "Lag (ms)", dpi=DPI)


def draw_spectra(rides: Rides, sets: Mapping[str, Parameters], light: Comparison, path: Path) -> None:
    """Draw spectra as in Fig. 15, and transmissibilities as in Fig. 10.

    Parameters
    ----------
    rides
        Runs the seats.
    sets
        Name to parameter set.
    light
        Rides with a load of 55 kg.
    path
        Figure file.
    """
    shaken = rides.random({**sets["ride"], **control(False)}, seeds=FEW_SEEDS, signal=FLOOR)
    shown = shaken.spectrum.frequency <= 6.0
    frequency = shaken.spectrum.frequency[shown]
    curves = [Curve("floor", shaken.spectrum.density[shown], {"color": "0.75"})]
    curves += [Curve(n, found.spectrum.density[shown], STYLES[n]) for n, found in light._asdict().items()]
    seats = {
        "passive": {**control(False), **sets["passive"]},
        "uncontrolled": control(False),
        "prototype": sets["prototype"],
    }
    sines = np.concatenate((np.arange(0.8, 2.5, 0.2), BAND, [5.0, 6.0]))
    panels = [Panel("PSD ((m/s²)²/Hz)", frequency, curves, {})]
    for amplitude in (SINE_AMPLITUDE, 2 * SINE_AMPLITUDE):
        gains = [
            Curve(name, rides.transmissibility(seat, sines, amplitude), STYLES[name], sines)
            for name, seat in seats.items()
        ]
        panels.append(Panel(f"Transmissibility\nsine of {1e3 * amplitude:g} mm", frequency, gains, {}))
    draw(path, "Spectra as in Fig. 15, transmissibilities as in Fig. 10, 55 kg", panels, "Frequency (Hz)", dpi=DPI)
