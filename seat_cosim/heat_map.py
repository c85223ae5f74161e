"""Heat maps: numbers in rows and columns, coloured by how far they are below or above 1."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from seat_cosim.plotting import REPRODUCIBLE, save

_STYLE: Any = {"figure.dpi": 120, "font.size": 9, **REPRODUCIBLE, "svg.fonttype": "none"}
_LARGEST = 2.0
"""Value at which the scale of colours ends; white is 1."""
_STRENGTH = 0.6
"""Strength of the colours from 0 to 1, with which letters are legible on all of them."""


@dataclass(frozen=True)
class HeatMap:
    """One heat map of a figure.

    Attributes
    ----------
    title
        Line above the map.
    rows, columns
        Names of rows and columns.
    values
        Numbers, shape (rows, columns).
    framed
        Whether a frame is drawn around a number, shape (rows, columns).
    """

    title: str
    rows: Sequence[str]
    columns: Sequence[str]
    values: np.ndarray[Any, Any]
    framed: np.ndarray[Any, Any]


def draw_heat_maps(paths: Iterable[Path], maps: Sequence[HeatMap]) -> None:
    """Draw maps below each other; the same maps give the same bytes.

    Parameters
    ----------
    paths
        Files of the same figure, by suffix ``.png`` or ``.svg``; the folders exist.
    maps
        Maps from top to bottom.
    """
    height = sum(0.8 + 0.28 * len(each.rows) for each in maps)
    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=(6.4, height), layout="constrained")
        axes = figure.subplots(len(maps), 1, squeeze=False)
        for axis, each in zip(axes[:, 0], maps, strict=True):
            colours = mpl.colormaps["RdBu_r"](each.values / _LARGEST)
            axis.imshow(1.0 - _STRENGTH * (1.0 - colours[..., :3]), aspect="auto", interpolation="nearest")
            axis.set_xticks(range(len(each.columns)), each.columns)
            axis.set_yticks(range(len(each.rows)), each.rows)
            axis.tick_params(length=0)
            axis.spines[:].set_visible(False)
            axis.set_title(each.title, loc="left", fontsize=9)
            for (i, j), value in np.ndenumerate(each.values):
                axis.text(j, i, f"{value:.2f}", ha="center", va="center")
                if each.framed[i, j]:
                    axis.add_patch(Rectangle((j - 0.46, i - 0.44), 0.92, 0.88, fill=False, lw=1.5))
        save(figure, paths)
