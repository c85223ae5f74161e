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
    draw(path, f"Seat suspension, {scenario}", _panels(system, result))


def _panels(system: System, result: Result) -> list[Panel]:
    """Return the main signals of the seat suspension, earlier curves above later ones."""
    return [
        Panel(
            f"{label} ({system.unit(signals[0])})",
            result.time,
            [Curve(signal, result[signal], {"zorder": 3.0 - 0.1 * i}) for i, signal in enumerate(signals)],
            {},
        )
        for label, signals in OVERVIEW.items()
    ]


def draw_system(path: Path, system: System, result: Result, names: Iterable[str] = ()) -> None:
    """Draw signals of a run of any system; no figure is made where the result has none of them.

    A system with all signals of the seat suspension gets their figure, if no names are given.

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
    title, main = literal(system.name), [name for signals in OVERVIEW.values() for name in signals]
    if not names and all(name in result.values for name in main):
        draw(path, title, _panels(system, result))
        return
    sources = dict.fromkeys(str(connection.source) for connection in system.connections.values())
    shown = {name: result[name] for name in (names or sources) if name in result.values}
    if shown:
        draw(path, title, by_unit(result.time, shown, result.units))
