"""Figures: curves over time or another axis, with labels and units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

REPRODUCIBLE: Any = {"svg.hashsalt": "seat-cosim"}
"""Settings under which the same figure has the same bytes."""

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
_NARROW = 6.0
"""Figures less wide, in inches, have legends of two columns: they are for pages that a phone shows as well."""


@dataclass(frozen=True)
class Curve:
    """One curve: its name in the legend, its values, a matplotlib line style, and its own x where not the panel's."""

    name: str
    values: np.ndarray[Any, Any]
    style: Mapping[str, Any]
    x: np.ndarray[Any, Any] | None = None


@dataclass(frozen=True)
class Panel:
    """Axes with some curves.

    Attributes
    ----------
    label
        Of the vertical axis.
    x
        Where the curves are, unless they say so themselves; its ends are those of the axis.
    curves
        What is drawn.
    marks
        Horizontal lines by name, e.g. a limit.
    x_label
        Of a horizontal axis of its own; the figure's where None.
    limits
        Ends of the vertical axis; what the curves need where None.
    """

    label: str
    x: np.ndarray[Any, Any]
    curves: Sequence[Curve]
    marks: Mapping[str, float]
    x_label: str | None = None
    limits: tuple[float, float] | None = None


def by_unit(
    time: np.ndarray[Any, Any],
    values: Mapping[str, np.ndarray[Any, Any]],
    units: Mapping[str, str | None],
    *,
    most: int = 6,
) -> list[Panel]:
    """Put signals of one unit into one panel.

    Parameters
    ----------
    time
        In s.
    values, units
        By signal.
    most
        Number of panels, and of curves in each, at most; what comes later is left out.
    """
    panels: dict[str, list[Curve]] = {}
    for name, signal in values.items():
        panels.setdefault(units[name] or "no unit", []).append(Curve(name, signal, {}))
    return [
        Panel(f"{curves[0].name}\n({unit})" if len(curves) == 1 else f"({unit})", time, curves[:most], {})
        for unit, curves in list(panels.items())[:most]
    ]


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
        Where to; its suffix, ``.png`` or ``.svg``, says what. The folder exists.
    title
        One line above.
    panels
        From top to bottom.
    x_label
        Of the horizontal axis, which panels share unless one has its own.
    log
        Whether both axes are logarithmic.
    width
        In inches.
    dpi
        Pixels an inch where not the usual ones.
    copies
        Further files of the same figure.
    """
    own = any(panel.x_label for panel in panels)
    with plt.rc_context(_STYLE):
        figure, axes = plt.subplots(
            len(panels),
            1,
            sharex=not own,
            squeeze=False,
            figsize=(width, 1.2 + 2.1 * len(panels)),
            layout="constrained",
        )
        for axis, panel in zip(axes[:, 0], panels, strict=True):
            _fill(axis, panel, log, 4 if width >= _NARROW else 2)
            if own:
                axis.set_xlabel(panel.x_label or x_label)
        axes[-1, 0].set_xlabel(panels[-1].x_label or x_label)
        figure.suptitle(title, x=0.01, ha="left", fontsize=10)
        save(figure, (path, *copies), dpi)


def save(figure: Figure, paths: Iterable[Path], dpi: float | None = None) -> None:
    """Save a figure without dates and versions, and close it; ``dpi`` is its own where None."""
    for path in paths:
        figure.savefig(path, dpi=dpi or "figure", metadata=_UNDATED[path.suffix])
        figure.set_layout_engine("none")  # once is enough
    plt.close(figure)


_UNDATED: dict[str, dict[str, Any]] = {".png": {"Software": None}, ".svg": {"Date": None, "Creator": None}}
"""What keeps times and versions out of files, by suffix."""


def _fill(axis: Axes, panel: Panel, log: bool, columns: int) -> None:
    """Draw one panel, the legend in so many columns."""
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
    if len(panel.curves) + len(panel.marks) > 1:
        # above the axes, where it hides no curve
        axis.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, borderaxespad=0.0)
