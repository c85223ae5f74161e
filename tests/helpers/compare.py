"""How far two signals differ."""

from __future__ import annotations

import numpy as np


def relative_rms(found: np.ndarray, expected: np.ndarray) -> float:
    """RMS of the difference over RMS of what is expected."""
    return float(np.sqrt(np.mean((found - expected) ** 2) / np.mean(expected**2)))


def relative_peak(found: np.ndarray, expected: np.ndarray) -> float:
    """Relative difference of the largest magnitudes."""
    return float(abs(np.abs(found).max() / np.abs(expected).max() - 1.0))
