"""Figures of a design of gains: transmissibility, delay margin, and what a delay margin costs in isolation."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from seat_controller_fmu.design.certificate import delay_margins, masses_of
from seat_controller_fmu.design.gains import Gains, preset
from seat_controller_fmu.design.tradeoff import TradeOffCriteria, TradeOffPoint, front, survey, transmissibility
from seat_cosim.nominal_seat import friction_force, nominal_seat
from seat_cosim.plotting import Curve, Panel, draw

_MASSES_SHOWN = (45.0, 55.0, 80.0, 120.0)
"""Drivers of the transmissibility, in kg."""
_SCALES = (0.5, 0.7, 0.85, 1.0, 1.1, 1.25, 1.5)
"""Observer gains of the survey, relative to those of the design."""
_FOLLOWS = (0.08, 0.14, 0.2, 0.3)
"""Frequencies below which the seat follows the cabin, in Hz, of the survey."""


def draw_transmissibility(gains: Gains, path: Path) -> None:
    """Draw the transmissibility of the closed loop for several drivers, linear and without friction.

    Parameters
    ----------
    gains
        The set.
    path
        Figure file; its folder exists.
    """
    frequencies = np.logspace(-1.5, 1.5, 400)
    curves = [
        Curve(f"{mass:g} kg", transmissibility(gains, nominal_seat, mass, frequencies), {"color": f"C{i}"})
        for i, mass in enumerate(sorted({*_MASSES_SHOWN, gains.setting.driver_mass_min, gains.setting.driver_mass_max}))
    ]
    panel = Panel("Driver over floor acceleration", frequencies, curves, {"1": 1.0})
    draw(path, "Closed-loop transmissibility, linear and without friction", [panel], "Frequency (Hz)", log=True)


def draw_delay_margin(gains: Gains, path: Path) -> None:
    """Draw the delay margin over the driver's mass, beside that of the published gains.

    Parameters
    ----------
    gains
        The set.
    path
        Figure file; its folder exists.
    """
    range_shown = masses_of(gains.setting)
    masses = np.arange(range_shown[0], range_shown[-1] + 1.0, 2.5)
    sets: Mapping[str, tuple[Gains, Mapping[str, Any]]] = {
        "these gains": (gains, {"color": "C0"}),
        "published": (preset("published"), {"color": "0.45", "linestyle": "--"}),
    }
    curves = [
        Curve(
            name,
            np.array(list(delay_margins(found, nominal_seat, tuple(masses)).values())),
            {**style, "drawstyle": "steps-mid"},
        )
        for name, (found, style) in sets.items()
    ]
    panel = Panel("Delay margin (ms)", masses, curves, {"30 ms": 30.0})
    draw(path, "Extra delay the sampled loop survives", [panel], "Driver mass (kg)")


def draw_pareto(gains: Gains, path: Path, progress: Callable[[float], None] = lambda share: None) -> None:
    """Survey observer and state feedback around a set of gains, and draw isolation over delay margin.

    Parameters
    ----------
    gains
        The set.
    path
        Figure file; its folder exists.
    progress
        Called with the share of the survey that is done.
    """
    published = preset("published")
    criteria = TradeOffCriteria.relative_to(published, nominal_seat, friction_force())
    sets = survey(gains, criteria, _SCALES, _FOLLOWS, progress)
    curves = []
    for i, follow in enumerate(_FOLLOWS):
        of_one = [s for s in sets if s.follow == follow and np.isfinite(s.margin)]
        curves.append(_points(f"$f_x$ = {follow:g} Hz", of_one, {"color": f"C{i}", "marker": "o", "linewidth": 0.8}))
    curves.append(_points("Pareto front", front(sets), {"color": "0.2", "linewidth": 3.0, "alpha": 0.25}))
    for name, found, marker in (("published", published, "s"), ("these gains", gains, "*")):
        rated = criteria.rate(found, 1.0, 0.0)
        curves.append(_points(name, [rated], {"color": "k", "marker": marker, "markersize": 11, "linestyle": "none"}))
    widest = max(s.margin for s in sets if np.isfinite(s.margin))
    panel = Panel(
        "Driver's RMS over published", np.array([0.0, widest + 4.0]), curves, {"no worse than published": 1.0}
    )
    title = "What a delay margin costs: observer gains from half to one and a half of these"
    draw(path, title, [panel], "Smallest delay margin over 45-120 kg (ms)")


def _points(name: str, sets: Sequence[TradeOffPoint], style: Mapping[str, Any]) -> Curve:
    """Return a curve of isolation over delay margin."""
    return Curve(name, np.array([s.rms for s in sets]), style, np.array([s.margin for s in sets]))
