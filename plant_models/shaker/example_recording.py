"""The recording that every Shaker FMU carries: what its ``file.path`` names until it is set."""

from __future__ import annotations

import math

EXAMPLE = "example.csv"
"""Its name in the FMU's resources."""

_DURATION, _RATE = 8.0, 200.0
_VIBRATIONS = ((1.7, 1.0, 0.0), (3.1, 0.6, 1.0))
_BIAS = 0.05


def acceleration(time: float) -> float:
    """Swell and fade away at two frequencies, as a sensor with a bias reports it: m/s2 at a time in s."""
    swell = math.sin(math.pi * time / _DURATION) ** 2
    return _BIAS + swell * sum(a * math.sin(2.0 * math.pi * f * time + phase) for f, a, phase in _VIBRATIONS)


def example() -> bytes:
    """Write the recording as CSV."""
    times = (k / _RATE for k in range(round(_DURATION * _RATE) + 1))
    rows = "".join(f"{time:.3f},{acceleration(time):.5f}\n" for time in times)
    return f"time,acceleration\n{rows}".encode()
