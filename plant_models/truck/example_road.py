"""The road in every TruckCab FMU, the default of its parameter ``road.file``."""

from __future__ import annotations

import math

EXAMPLE = "road.csv"
"""File name in the resources of the FMU."""

_LENGTH, _STEP = 200.0, 0.25  # m
_WAVES = ((11.0, 0.008, 0.0), (4.0, 0.003, 1.0))  # wavelength in m, amplitude in m, phase in rad


def elevation(distance: float) -> float:
    """Evaluate the elevation of the road: two waves that fade in and out.

    Parameters
    ----------
    distance
        From the begin of the road, in m.

    Returns
    -------
    float
        In m.
    """
    window = math.sin(math.pi * distance / _LENGTH) ** 2
    return window * sum(a * math.sin(2.0 * math.pi * distance / length + phase) for length, a, phase in _WAVES)


def example() -> bytes:
    """Return the road as a CSV file with the columns distance in m and elevation in m."""
    distances = (k * _STEP for k in range(round(_LENGTH / _STEP) + 1))
    rows = "".join(f"{distance:.2f},{elevation(distance):.5f}\n" for distance in distances)
    return f"distance,elevation\n{rows}".encode()
