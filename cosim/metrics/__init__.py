"""Metrics of rides and suspensions: pure functions of samples and a sampling rate.

They know neither FMUs nor names of signals.
"""

from cosim.metrics.exposure import ACTION, LIMIT, a8, comfort, daily_vdv, hours_to_a8, hours_to_vdv
from cosim.metrics.spectra import (
    Sine,
    Spectrum,
    fit_sine,
    psd,
    sine_transmissibility,
    transmissibility,
)
from cosim.metrics.suspension import actuator, deflection_range, end_stops, impact_share
from cosim.metrics.weighting import weighted, wk
from cosim.metrics.whole_body import (
    Ride,
    SeatFactor,
    crest_factor,
    mtvv,
    peak,
    ride,
    rms,
    running_rms,
    seat_factor,
    vdv,
    weighted_ride,
)

__all__ = [
    "ACTION",
    "LIMIT",
    "Ride",
    "SeatFactor",
    "Sine",
    "Spectrum",
    "a8",
    "actuator",
    "comfort",
    "crest_factor",
    "daily_vdv",
    "deflection_range",
    "end_stops",
    "fit_sine",
    "hours_to_a8",
    "hours_to_vdv",
    "impact_share",
    "mtvv",
    "peak",
    "psd",
    "ride",
    "rms",
    "running_rms",
    "seat_factor",
    "sine_transmissibility",
    "transmissibility",
    "vdv",
    "weighted",
    "weighted_ride",
    "wk",
]
