"""The recording in every Shaker FMU, the default of its parameter ``file.path``."""

from __future__ import annotations

import math

EXAMPLE = "example.csv"
"""File name in the resources of the FMU."""

_DURATION, _RATE = 8.0, 200.0  # s, Hz
_VIBRATIONS = ((1.7, 1.0, 0.0), (3.1, 0.6, 1.0))  # frequency in Hz, amplitude in m/s2, phase in rad
_BIAS = 0.05  # m/s2


def acceleration(time: float) -> float:
    """Evaluate the recorded acceleration: two vibrations that fade in and out, and a bias.

    Parameters
    ----------
    time
        Time since the begin of the recording, in s.

    Returns
    -------
    float
        In m/s2.
    """
    window = math.sin(math.pi * time / _DURATION) ** 2
    return _BIAS + window * sum(a * math.sin(2.0 * math.pi * f * time + phase) for f, a, phase in _VIBRATIONS)


def example() -> bytes:
    """Return the recording as a CSV file with the columns time in s and acceleration in m/s2."""
    times = (k / _RATE for k in range(round(_DURATION * _RATE) + 1))
    rows = "".join(f"{time:.3f},{acceleration(time):.5f}\n" for time in times)
    return f"time,acceleration\n{rows}".encode()
