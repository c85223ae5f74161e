"""Figure of what all fitting sets predict, beside the paper: one point for each set."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from seat_cosim.paper.published import BUMP_PEAKS, REDUCTIONS
from seat_cosim.plotting import REPRODUCIBLE

Array = np.ndarray[Any, Any]

_LIGHT, _HEAVY = BUMP_PEAKS
_PANELS = (
    ("Reduction of the RMS (%)", "reduction", REDUCTIONS),
    ("Bump, passive: peak (m/s²)", "bump_passive", {mass: peaks["passive"] for mass, peaks in BUMP_PEAKS.items()}),
    ("Bump, controlled: peak (m/s²)", "bump_controlled", {m: peaks["controlled"] for m, peaks in BUMP_PEAKS.items()}),
)
"""Title, begin of the columns' names, the paper's numbers by load in kg."""
_COLOURS = (("1", "C0", "Observer 1"), ("equal-rate", "C1", "equal rate"))


def draw_predictions(values: Mapping[str, Array], observers: Array, committed: Mapping[str, float], path: Path) -> None:
    """Draw the predictions for 70 kg over those for 55 kg.

    Parameters
    ----------
    values
        Name of a prediction to its values, shape (sets,).
    observers
        Name of the observer of each set, shape (sets,).
    committed
        Name of a prediction to its value with the parameter sets of this project.
    path
        Figure file.
    """
    with mpl.rc_context({"font.size": 9, "axes.grid": True, "grid.alpha": 0.3, **REPRODUCIBLE}):
        figure = Figure(figsize=(9.6, 3.7), layout="constrained")
        for axes, (title, begin, paper) in zip(figure.subplots(1, 3), _PANELS, strict=True):
            light, heavy = f"{begin}_{_LIGHT:g}", f"{begin}_{_HEAVY:g}"
            for observer, colour, label in _COLOURS:
                chosen = observers == observer
                axes.plot(values[light][chosen], values[heavy][chosen], ".", color=colour, ms=4, alpha=0.6, label=label)
            axes.plot(committed[light], committed[heavy], "s", color="k", ms=6, mfc="none", label="of the report")
            axes.plot(paper[_LIGHT], paper[_HEAVY], "*", color="C3", ms=13, label="paper")
            axes.axline((paper[_LIGHT], paper[_LIGHT]), slope=1.0, color="0.6", lw=0.8, ls="--")
            axes.set_title(title, fontsize=9)
            axes.set_xlabel(f"{_LIGHT:g} kg")
            axes.set_ylabel(f"{_HEAVY:g} kg")
        figure.get_axes()[0].legend(fontsize=8, loc="lower right")
        figure.savefig(path, dpi=110, metadata={"Software": None} if path.suffix == ".png" else None)
