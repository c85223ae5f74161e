"""Damping test of ISO 10326-1: transmissibility at the suspension's resonance, under an inert mass."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cosim.engine.session import Session
from cosim.fmi.values import Value
from cosim.metrics import sine_transmissibility
from seat_cosim.evaluation.seat import inert_load
from seat_cosim.evaluation.system import EvaluatedSystem

INERT_MASS = 75.0
"""Inert mass on the seat, in kg."""

_LOWEST, _HIGHEST = 0.5, 2.0
"""Range in Hz in which the resonance is sought; *recalled*."""

_COARSE, _FINE = 0.1, 0.02
"""Distances in Hz of the frequencies that are tried: over the range, and about the largest of them."""

_WARM_UP, _DURATION = 10.0, 20.0
"""Of each sine, in s."""

_TRAVEL_SHARE, _MAX_STROKE = 0.4, 0.050
"""Stroke of the floor, peak to peak: share of the whole travel, at most this many m; *recalled*."""


@dataclass(frozen=True)
class DampingTest:
    """Result of a damping test.

    Attributes
    ----------
    frequency
        Frequency of the largest transmissibility, in Hz.
    transmissibility
        RMS acceleration of the seat over that of the floor at this frequency.
    amplitude
        Amplitude of the floor's displacement, in m.
    """

    frequency: float
    transmissibility: float
    amplitude: float


def floor_amplitude(travel: float | None) -> float:
    """Return the amplitude of the floor in a damping test, in m.

    Parameters
    ----------
    travel
        Travel of the seat to each side, in m; None for unlimited travel.

    Examples
    --------
    >>> floor_amplitude(0.040), floor_amplitude(None)
    (0.016, 0.025)
    """
    return min(_TRAVEL_SHARE * 2.0 * travel, _MAX_STROKE) / 2.0 if travel else _MAX_STROKE / 2.0


def run_damping_test(evaluated: EvaluatedSystem, session: Session, rate: float) -> DampingTest | None:
    """Run a damping test: sines of one amplitude, and the frequency with the largest transmissibility.

    Parameters
    ----------
    evaluated
        The system.
    session
        An open session of it.
    rate
        Number of rows per second.

    Returns
    -------
    DampingTest or None
        None for a system whose floor has no sine.

    Raises
    ------
    CosimError
        If an FMU failed.
    """
    signals = evaluated.signals
    frequency_name, amplitude_name = signals.sine_frequency, signals.sine_amplitude
    if frequency_name is None or amplitude_name is None:
        return None
    amplitude = floor_amplitude(evaluated.end_stop_travel)
    fixed: dict[str, Value] = {
        **inert_load(evaluated.system),
        **dict.fromkeys(signals.driver_mass, INERT_MASS),
        **signals.sine,
        amplitude_name: amplitude,
    }
    names = [signals.floor_acceleration, signals.seat_acceleration]

    def transmissibility(frequency: float) -> float:
        result = session.run(_DURATION, parameters={**fixed, frequency_name: frequency}, record=names)
        if result.error is not None:
            raise result.error
        floor, seat = (evaluated.in_si_units(name, result[name]) for name in names)
        return sine_transmissibility(floor, seat, rate, frequency, _WARM_UP).rms_ratio

    found = {frequency: transmissibility(frequency) for frequency in _grid(_LOWEST, _HIGHEST, _COARSE)}
    about = max(found, key=found.__getitem__)
    low, high = max(_LOWEST, about - _COARSE), min(_HIGHEST, about + _COARSE)
    found |= {each: transmissibility(each) for each in _grid(low, high, _FINE) if each not in found}
    resonance = max(found, key=found.__getitem__)
    return DampingTest(resonance, found[resonance], amplitude)


def _grid(low: float, high: float, distance: float) -> list[float]:
    """Return frequencies from low to high, both included, rounded so that each value appears once."""
    return [round(float(each), 6) for each in low + distance * np.arange(round((high - low) / distance) + 1)]
