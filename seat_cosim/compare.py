"""The same ride with several controllers: sets of gains, observers, none, the passive seat, or other FMUs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cosim.engine.editing import edit
from cosim.engine.run_options import RunOptions
from cosim.errors import SetupError
from cosim.fmi.values import Value
from cosim.results.result import Result
from cosim.run_folder import run_to_folder
from cosim.system import System
from seat_controller_fmu.interface import Mode
from seat_cosim import scenarios
from seat_cosim.overview import excerpt
from seat_cosim.plotting import Curve, Panel, draw
from seat_cosim.ride_summary import RideSummary, evaluated_system, summarize

_OBSERVERS = {"observer1": 1, "observer2": 2}
ROBUST = Mode.robust.name
"""The variant with the controller's mode robust."""

_SIGNALS = {
    "Driver's acceleration": "seat.driver_acceleration",
    "Deflection": "seat.suspension_deflection",
    "Force": "controller.force",
}
"""Panel of the figure to its signal."""

_WIDEST = 2.6
"""Width of the line that is drawn first, in points."""


@dataclass(frozen=True)
class Variant:
    """A controller to compare.

    Attributes
    ----------
    title
        Name in table and figure.
    parameters
        Parameters that make it, as ``component.variable``.
    fmu
        FMU that takes the controller's place; None for ours.
    """

    title: str
    parameters: Mapping[str, Value]
    fmu: Path | None = None


@dataclass(frozen=True)
class Ride:
    """A ride with one of the controllers.

    Attributes
    ----------
    variant
        The controller.
    system
        The system that was run, with all parameters.
    result
        Its result.
    summary
        Its numbers.
    """

    variant: Variant
    system: System
    result: Result
    summary: RideSummary


def variant(word: str, system: System, parameters: Mapping[str, Value]) -> Variant:
    """Read what to compare.

    Parameters
    ----------
    word
        ``observer1``, ``observer2``, ``robust``, ``off``, ``passive``, a preset or file of gains (``.json``), or a
        controller's ``.fmu``.
    system
        The seat suspension.
    parameters
        Parameters of the ride, which the mode robust takes its actuator and travel from.

    Raises
    ------
    SetupError
        If it is none of these.
    """
    if word in _OBSERVERS:
        return Variant(word, scenarios.paper_observer(_OBSERVERS[word]))
    if word == ROBUST:
        return Variant(word, scenarios.mode(word, parameters))
    if word == "off":
        return Variant(word, scenarios.control(False))
    if word == "passive":
        return Variant(word, {**scenarios.control(False), **scenarios.read_parameter_sets(["passive"], system)})
    if word.endswith(".fmu"):
        return Variant(Path(word).stem, {}, Path(word).expanduser())
    try:
        return Variant(
            Path(word).stem if word.endswith(".json") else word, scenarios.gains(str(Path(word).expanduser()))
        )
    except SetupError as error:
        known = ", ".join((*_OBSERVERS, ROBUST, "off", "passive", "FILE.fmu"))
        raise SetupError(*(f"{problem}; or one of {known}" for problem in error.problems)) from error


def rides(
    words: Sequence[str],
    make_system: Callable[[], System],
    parameters: Callable[[System], Mapping[str, Value]],
    stop_time: float,
    folder: Path,
    command: Sequence[str] = (),
) -> Iterator[Ride]:
    """Run the same ride with several controllers, each into a folder of its own.

    Parameters
    ----------
    words
        What to compare, see :func:`variant`.
    make_system
        Returns the seat suspension.
    parameters
        Returns the parameters of the ride for a system; those of a variant come before.
    stop_time
        In s.
    folder
        Folder of the variants' folders.
    command
        Words of the command line.

    Yields
    ------
    Ride
        After each run.

    Raises
    ------
    SetupError
        If something is wrong that can be seen before the first run.
    RunError
        If an FMU failed.
    """
    prepared = []
    for word in words:
        system = make_system()
        wanted = parameters(system)
        chosen = variant(word, system, wanted)
        edit(system, {} if chosen.fmu is None else {"controller": chosen.fmu}, (), ())
        given = {name: value for name, value in wanted.items() if _has(system, name)}
        system.parameters |= {**{n: v for n, v in chosen.parameters.items() if _has(system, n)}, **given}
        system.validate(stop_time)
        prepared.append((chosen, system))
    titles = [chosen.title for chosen, _ in prepared]
    if twice := [title for title in titles if titles.count(title) > 1]:
        raise SetupError(f"compare: expected each once, got {twice[0]} twice")
    for chosen, system in prepared:
        result = run_to_folder(system, folder / chosen.title, RunOptions(stop_time), command=command)
        if result.error is not None:
            raise result.error
        evaluated = evaluated_system(system)
        assert evaluated is not None
        yield Ride(chosen, system, result, summarize(evaluated, result))


def _has(system: System, name: str) -> bool:
    component, _, variable = name.partition(".")
    return component in system.models and variable in system.models[component].variables


def draw_comparison(path: Path, scenario: str, ridden: Sequence[Ride]) -> None:
    """Draw driver's acceleration, deflection and force of all rides over each other; of random ones a part.

    Parameters
    ----------
    path
        Figure file; its folder exists.
    scenario
        Name of the scenario, for the title.
    ridden
        The rides.
    """
    panels, title, part = [], f"Seat suspension, {scenario}", slice(None)
    if scenarios.SCENARIOS[scenario].is_random:
        driver = _SIGNALS["Driver's acceleration"]
        have = [ride.result for ride in ridden if driver in ride.result.values]
        part, words = excerpt(have[0].time, [each[driver] for each in have]) if have else (part, "")
        title += words
    for label, signal in _SIGNALS.items():
        results = {ride.variant.title: ride.result for ride in ridden if signal in ride.result.values}
        widths = np.linspace(_WIDEST, 1.0, len(results))  # curves that cover each other stay visible
        curves = [
            Curve(name, result[signal][part], {"linewidth": width})
            for (name, result), width in zip(results.items(), widths, strict=True)
        ]
        if results:
            first = next(iter(results.values()))
            panels.append(Panel(f"{label}\n({first.units[signal]})", first.time[part], curves, {}))
    draw(path, title, panels)
