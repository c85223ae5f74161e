"""Figures: curves over time or another axis, with labels and units."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

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
}


@dataclass(frozen=True)
class Curve:
    """One curve: its name in the legend, its values, a matplotlib line style, and its own x where not the panel's."""

    name: str
    values: np.ndarray[Any, Any]
    style: Mapping[str, Any]
    x: np.ndarray[Any, Any] | None = None


@dataclass(frozen=True)
class Panel:
    """Axes with some curves; ``marks`` are horizontal lines by name, e.g. a limit."""

    label: str
    x: np.ndarray[Any, Any]
    curves: Sequence[Curve]
    marks: Mapping[str, float]


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
    dpi: float | None = None,
) -> None:
    """Draw panels over one axis into a PNG.

    Parameters
    ----------
    path
        Where to; the folder exists.
    title
        One line above.
    panels
        From top to bottom.
    x_label
        Of the common axis.
    log
        Whether both axes are logarithmic.
    dpi
        Pixels an inch where not the usual ones.
    """
    with plt.rc_context(_STYLE):
        figure, axes = plt.subplots(
            len(panels), 1, sharex=True, squeeze=False, figsize=(7.0, 1.2 + 2.1 * len(panels)), layout="constrained"
        )
        for axis, panel in zip(axes[:, 0], panels, strict=True):
            for curve in panel.curves:
                axis.plot(panel.x if curve.x is None else curve.x, curve.values, label=curve.name, **curve.style)
            for name, level in panel.marks.items():
                axis.axhline(level, color="0.5", linestyle=":", linewidth=1.0, label=name)
            axis.set_ylabel(panel.label)
            axis.set_xlim(panel.x[0], panel.x[-1])
            if log:
                axis.set_xscale("log")
                axis.set_yscale("log")
                axis.grid(which="minor", alpha=0.15)
            if len(panel.curves) + len(panel.marks) > 1:
                # above the axes, where it hides no curve
                axis.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4, borderaxespad=0.0)
        axes[-1, 0].set_xlabel(x_label)
        figure.suptitle(title, x=0.01, ha="left", fontsize=10)
        figure.savefig(path, dpi=dpi or "figure", metadata={"Software": None})
        plt.close(figure)
