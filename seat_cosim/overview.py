"""Overview figures of single runs: main signals over time."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from cosim.results.result import Result
from cosim.system import System
from seat_cosim.plotting import Curve, Panel, by_unit, draw, literal
from seat_cosim.scenarios import OVERVIEW


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
    panels = [
        Panel(f"{label} ({system.unit(signals[0])})", result.time, [Curve(s, result[s], {}) for s in signals], {})
        for label, signals in OVERVIEW.items()
    ]
    draw(path, f"Seat suspension, {scenario}", panels)


def draw_system(path: Path, system: System, result: Result, names: Iterable[str] = ()) -> None:
    """Draw signals of a run of any system; no figure is made where the result has none of them.

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
    shown = {name: result[name] for name in (names or sources) if name in result.values}
    if shown:
        draw(path, literal(system.name), by_unit(result.time, shown, result.units))
