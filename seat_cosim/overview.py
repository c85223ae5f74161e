"""Overview figures of single runs: main signals over time."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from cosim.results.result import Result
from cosim.system import System
from seat_cosim.plotting import Curve, Panel, by_unit, draw, literal
from seat_cosim.scenarios import FMUS, OVERVIEW

DRIVER = OVERVIEW["Acceleration"][0]
"""The driver's acceleration."""


def draw_scenario(path: Path, scenario: str, system: System, result: Result) -> None:
    """Draw the main signals of a run of the seat suspension.

    Parameters
    ----------
    path
        Figure file; its folder exists.
    scenario
        Name of the scenario, for the title.
    system
        The seat suspension.
    result
        Result with all outputs of :data:`seat_cosim.scenarios.OVERVIEW`.
    """
    draw(path, f"Seat suspension, {scenario}", _panels(system, result))


def _is_ours(system: System, name: str) -> bool:
    """Whether an output is one of this project's FMUs, whose main signals have panels of their own."""
    return system.models[system.parse(name).component].description.modelName in FMUS.values()


def _panels(system: System, result: Result) -> list[Panel]:
    """Return the main signals of the seat suspension that a result has, earlier curves above later ones."""
    panels = []
    for label, signals in OVERVIEW.items():
        curves = [
            Curve(signal, result[signal], {"zorder": 3.0 - 0.1 * i})
            for i, signal in enumerate(signals)
            if signal in result.values
        ]
        if curves:
            unit = system.unit(curves[0].name)
            panels.append(Panel(f"{label} ({unit})", result.time, curves, {}, legend=True))
    return panels


def draw_system(path: Path, system: System, result: Result, names: Iterable[str] = ()) -> None:
    """Draw signals of a run of any system; no figure is made where the result has none of them.

    A system with a driver gets the figure of the seat suspension, and connected signals of other FMUs, if no names
    are given.

    Parameters
    ----------
    path
        Figure file; its folder exists.
    system
        The system.
    result
        Result of the run.
    names
        Outputs to draw; where empty, those that are connected.
    """
    sources = dict.fromkeys(str(connection.source) for connection in system.connections.values())
    panels = [] if names or DRIVER not in result.values else _panels(system, result)
    if panels:  # what others feed the seat with
        sources = dict.fromkeys(name for name in sources if not _is_ours(system, name))
    drawn = {curve.name for panel in panels for curve in panel.curves}
    shown = {name: result[name] for name in (names or sources) if name in result.values and name not in drawn}
    panels += by_unit(result.time, shown, result.units)
    if panels:
        draw(path, literal(system.name), panels)
