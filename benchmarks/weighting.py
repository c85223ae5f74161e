"""Wk in time against Wk itself: errors at several sampling rates beside a bilinear filter's, and the figure.

.venv/bin/python -m benchmarks.weighting [SVG FILE]
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
from rich.console import Console
from rich.table import Table

from cosim.metrics.spectra import fit_sine
from cosim.metrics.weighting import weighted, wk

FREQUENCIES = (0.4, 1.0, 4.0, 8.0, 20.0, 40.0, 63.0, 79.0)
RATES = (160.0, 200.0, 500.0, 1000.0)
SETTLE, SECONDS = 10.0, 25.0


def in_time(frequency: float, rate: float) -> complex:
    """Weight a sine that begins at t = 0 and find what became of it."""
    time = np.arange(round(SECONDS * rate)) / rate
    found = fit_sine(weighted(np.sin(2.0 * np.pi * frequency * time), rate, SETTLE), rate, frequency)
    return found.amplitude / (-1j * np.exp(2j * np.pi * frequency * SETTLE))


def bilinear(frequency: float, rate: float) -> complex:
    """Respond as a recursive filter made by the bilinear transform: as Wk at the warped frequency."""
    warped = rate / np.pi * np.tan(np.pi * frequency / rate)
    return complex(wk(warped))


def figure(path: Path) -> None:
    """Draw the magnitude of Wk; text stays text, and the file carries no date or version."""
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "wk", "font.size": 9, "font.family": "sans-serif"}):
        canvas, axis = plt.subplots(figsize=(6.4, 3.0), layout="constrained")
        frequency = np.geomspace(0.1, 400.0, 240)
        axis.loglog(frequency, np.abs(wk(frequency)))
        axis.axvspan(0.5, 80.0, color="C0", alpha=0.08, label="0.5-80 Hz: health, comfort, perception")
        axis.set(xlabel="Frequency (Hz)", ylabel="|Wk|", xlim=(0.1, 400.0), ylim=(1e-3, 2.0))
        axis.set_xticks([0.1, 1, 10, 100], ["0.1", "1", "10", "100"])
        axis.set_yticks([0.001, 0.01, 0.1, 1], ["0.001", "0.01", "0.1", "1"])
        axis.grid(alpha=0.3)
        axis.legend(frameon=False, loc="lower center")
        canvas.savefig(path, metadata={"Creator": None, "Date": None})


def main() -> None:
    """Print the table; draw the figure where a file is named."""
    table = Table("Hz", "|Wk|", *(f"{rate:g} Hz" for rate in RATES), "bilinear, 500 Hz", title="Relative error of Wk")
    for frequency in FREQUENCIES:
        expected = complex(wk(frequency))
        errors = [f"{abs(in_time(frequency, rate) / expected - 1.0):.1e}" for rate in RATES]
        warped = abs(bilinear(frequency, 500.0) / expected) - 1.0
        table.add_row(f"{frequency:g}", f"{abs(expected):.3f}", *errors, f"{warped:+.1%}")
    Console().print(table)
    for name in sys.argv[1:]:
        figure(Path(name))


if __name__ == "__main__":
    main()
