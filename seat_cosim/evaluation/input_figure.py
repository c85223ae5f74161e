"""Figure of the inputs: spectra of the floor in every run, between the bounds of their classes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from seat_cosim.evaluation.inputs import INPUTS, MAX_PSD_ERROR, InputConformity, target_density, target_peak
from seat_cosim.plotting import REPRODUCIBLE, save

_STYLE: Any = {"figure.dpi": 120, "font.size": 8, **REPRODUCIBLE, "svg.fonttype": "none"}
_COLUMNS = 3
_HIGHEST = 12.0
"""Highest frequency that is drawn, in Hz."""


def draw_inputs(paths: Iterable[Path], inputs: Mapping[str, Sequence[InputConformity]]) -> None:
    """Draw the spectra of inputs, a panel for each class; the same inputs give the same bytes.

    Parameters
    ----------
    paths
        Files of the same figure, by suffix; the folders exist.
    inputs
        Name of a class to its inputs.
    """
    rows = math.ceil(len(inputs) / _COLUMNS)
    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=(6.4, 0.3 + 1.6 * rows), layout="constrained")
        axes = figure.subplots(rows, min(_COLUMNS, len(inputs)), squeeze=False)
        for axis in axes.ravel()[len(inputs) :]:
            axis.set_visible(False)
        for axis, (name, found) in zip(axes.ravel(), inputs.items(), strict=False):
            highest = min(INPUTS[name].high, _HIGHEST)
            f = np.linspace(INPUTS[name].low, highest, 300)
            target, allowed = target_density(name, f), MAX_PSD_ERROR * target_peak(name)
            axis.fill_between(f, np.maximum(target - allowed, 0.0), target + allowed, color="0.85", lw=0)
            for each in found:
                lines = np.array([line for line in each.spectrum if line[0] <= highest])
                axis.plot(*lines.T, lw=0.9)
            axis.set_title(name, loc="left", fontsize=8)
            axis.set_xlim(0.0, highest)
            axis.set_ylim(bottom=0.0)
        figure.supxlabel("frequency, Hz", fontsize=8)
        figure.supylabel("density, (m/s²)²/Hz", fontsize=8)
        save(figure, paths)
