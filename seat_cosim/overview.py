"""Overview figures of single runs: main signals over time."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cosim.results.result import Result
from cosim.system import System
from seat_cosim.plotting import Curve, Panel, by_unit, draw, literal
from seat_cosim.scenarios import FMUS, OVERVIEW, SCENARIOS, floor_of, overview

DRIVER = OVERVIEW["Acceleration"][0]
"""The driver's acceleration."""

EXCERPT = 10.0
"""Length in s of the part of a random ride that a figure shows."""

Signal = np.ndarray[Any, Any]


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
        Result with all outputs of :func:`seat_cosim.scenarios.overview`.
    """
    title, part = f"Seat suspension, {scenario}", slice(None)
    if SCENARIOS[scenario].is_random:
        part, words = excerpt(result.time, [result[DRIVER]] if DRIVER in result.values else [])
        title += words
    draw(path, title, _panels(system, result, part))


def excerpt(time: Signal, signals: Sequence[Signal], length: float = EXCERPT) -> tuple[slice, str]:
    """Choose the part of a long ride that a figure shows: that around the largest peak.

    Parameters
    ----------
    time
        In s, shape (rows,).
    signals
        Signals whose largest magnitude counts, each of the same shape.
    length
        Of the part, in s.

    Returns
    -------
    rows : slice
        Rows of the part; all of a ride that is not much longer.
    words : str
        What a title adds to say so; empty for the whole ride.

    Examples
    --------
    >>> time = np.linspace(0.0, 60.0, 61)
    >>> excerpt(time, [np.where(time == 40.0, -1.0, 0.0)])
    (slice(35, 46, None), ': 10 s around the largest acceleration of 60 s')
    """
    if not signals or time[-1] - time[0] <= 1.5 * length:
        return slice(None), ""
    peaks = np.max(np.abs(signals), axis=0)
    middle = min(max(time[int(peaks.argmax())], time[0] + 0.5 * length), time[-1] - 0.5 * length)
    first = int(np.searchsorted(time, middle - 0.5 * length))
    last = int(np.searchsorted(time, middle + 0.5 * length, side="right"))
    return slice(first, last), f": {length:g} s around the largest acceleration of {time[-1] - time[0]:g} s"


def _is_ours(system: System, name: str) -> bool:
    """Whether an output is one of this project's FMUs, whose main signals have panels of their own."""
    return system.models[system.parse(name).component].description.modelName in FMUS.values()


def _panels(system: System, result: Result, part: slice = slice(None)) -> list[Panel]:
    """Return the main signals of the seat suspension that a result has, earlier curves above later ones."""
    panels = []
    for label, signals in overview(floor_of(system.models)).items():
        curves = [
            Curve(signal, result[signal][part], {"zorder": 3.0 - 0.1 * i})
            for i, signal in enumerate(signals)
            if signal in result.values
        ]
        if curves:
            unit = system.unit(curves[0].name)
            panels.append(Panel(f"{label} ({unit})", result.time[part], curves, {}, legend=True))
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
