"""Figures: curves over time or over another quantity, with labels and units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

REPRODUCIBLE: Any = {"svg.hashsalt": "seat-cosim"}
"""Settings of matplotlib with which the same figure has the same bytes."""

_STYLE: Any = {
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "figure.dpi": 150,
    "font.size": 9,
    "grid.alpha": 0.3,
    "legend.columnspacing": 1.2,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "legend.handlelength": 1.6,
    "lines.linewidth": 1.2,
    **REPRODUCIBLE,
}
_LABELS = 0.8
"""Width that labels beside the axes take, in inches."""

_CHARACTERS = 15.0
"""Characters of a legend that fit into an inch."""

_SPACE = 6
"""Characters that line and space of a curve take in a legend."""


@dataclass(frozen=True)
class Curve:
    """One curve of a panel.

    Attributes
    ----------
    name
        Name in the legend.
    values
        Values on the vertical axis.
    style
        Line style, as keyword arguments of matplotlib's ``plot``.
    x
        Values on the horizontal axis; the panel's where None.
    """

    name: str
    values: np.ndarray[Any, Any]
    style: Mapping[str, Any]
    x: np.ndarray[Any, Any] | None = None


@dataclass(frozen=True)
class Panel:
    """Axes with curves and reference lines.

    Attributes
    ----------
    label
        Label of the vertical axis.
    x
        Values on the horizontal axis, for curves without values of their own; its first and last are the axis' limits.
    curves
        Curves to draw.
    marks
        Name to the level of a horizontal line, e.g. a limit.
    x_label
        Label of the panel's own horizontal axis; the panels share one where None.
    limits
        Limits of the vertical axis; chosen by the curves where None.
    legend
        Whether a single curve has a legend, too.
    """

    label: str
    x: np.ndarray[Any, Any]
    curves: Sequence[Curve]
    marks: Mapping[str, float]
    x_label: str | None = None
    limits: tuple[float, float] | None = None
    legend: bool = False


def literal(text: str) -> str:
    r"""Return a text that matplotlib draws as it is: dollar signs begin no formula, an underscore hides no legend.

    Examples
    --------
    >>> print(literal("cost_in_$"))
    cost_in_\$
    """
    return (" " if text.startswith("_") else "") + text.replace("$", r"\$")


def by_unit(
    time: np.ndarray[Any, Any],
    values: Mapping[str, np.ndarray[Any, Any]],
    units: Mapping[str, str | None],
    *,
    most: int = 6,
) -> list[Panel]:
    """Return panels that each hold the signals of one unit.

    Parameters
    ----------
    time
        In s.
    values, units
        Name of a signal to its samples, and to its unit.
    most
        Largest number of panels, and of curves in each; further ones are left out.
    """
    panels: dict[str, list[Curve]] = {}
    for name, signal in values.items():
        panels.setdefault(literal(units[name] or "no unit"), []).append(Curve(literal(name), signal, {}))
    return [Panel(f"({unit})", time, curves[:most], {}, legend=True) for unit, curves in list(panels.items())[:most]]


def draw(
    path: Path,
    title: str,
    panels: Sequence[Panel],
    x_label: str = "Time (s)",
    *,
    log: bool = False,
    width: float = 7.0,
    dpi: float | None = None,
    copies: Iterable[Path] = (),
) -> None:
    """Draw panels, one below the other; the same panels give the same bytes.

    Parameters
    ----------
    path
        File, by suffix ``.png`` or ``.svg``; the folder exists.
    title
        Line above the panels.
    panels
        Panels from top to bottom.
    x_label
        Label of the horizontal axis, which the panels share unless one has its own.
    log
        Whether both axes are logarithmic.
    width
        Width in inches.
    dpi
        Resolution in pixels per inch; 150 where None.
    copies
        Further files of the same figure.
    """
    own = any(panel.x_label for panel in panels)
    with mpl.rc_context(_STYLE):
        # without pyplot: a notebook keeps its own figures and backend
        figure = Figure(figsize=(width, 1.2 + 2.1 * len(panels)), layout="constrained")
        axes = figure.subplots(len(panels), 1, sharex=not own, squeeze=False)
        for axis, panel in zip(axes[:, 0], panels, strict=True):
            _fill(axis, panel, log, int(_CHARACTERS * (width - _LABELS)))
            if own:
                axis.set_xlabel(panel.x_label or x_label)
        axes[-1, 0].set_xlabel(panels[-1].x_label or x_label)
        figure.suptitle(title, x=0.01, ha="left", fontsize=10)
        save(figure, (path, *copies), dpi)


def save(figure: Figure, paths: Iterable[Path], dpi: float | None = None) -> None:
    """Save a figure without dates and versions.

    Parameters
    ----------
    figure
        The figure.
    paths
        Files, by suffix ``.png`` or ``.svg``.
    dpi
        Resolution in pixels per inch; the figure's own where None.
    """
    for path in paths:
        figure.savefig(path, dpi=dpi or "figure", metadata=_UNDATED[path.suffix])
        figure.set_layout_engine("none")  # once is enough


_UNDATED: dict[str, dict[str, Any]] = {".png": {"Software": None}, ".svg": {"Date": None, "Creator": None}}
"""Suffix to the metadata without dates and versions."""


def _fill(axis: Axes, panel: Panel, log: bool, characters: int) -> None:
    """Draw one panel, with a legend of at most so many characters in a line."""
    for curve in panel.curves:
        axis.plot(panel.x if curve.x is None else curve.x, curve.values, label=curve.name, **curve.style)
    for name, level in panel.marks.items():
        axis.axhline(level, color="0.5", linestyle=":", linewidth=1.0, label=name)
    axis.set_ylabel(panel.label)
    axis.set_xlim(panel.x[0], panel.x[-1])
    if panel.limits is not None:
        axis.set_ylim(*panel.limits)
    if log:
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.grid(which="minor", alpha=0.15)
    names = [*(curve.name for curve in panel.curves), *panel.marks]
    if panel.legend or len(names) > 1:
        # above the axes, where it hides no curve
        axis.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=_columns(names, characters), borderaxespad=0.0)


def _columns(names: Sequence[str], characters: int) -> int:
    """Return how many columns of a legend fit into a line of so many characters: four at most."""
    for count in (4, 3, 2):
        columns = [column for column in np.array_split(names, count) if len(column)]  # as matplotlib fills them
        if sum(max(map(len, column)) + _SPACE for column in columns) <= characters:
            return count
    return 1
