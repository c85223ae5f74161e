"""Notes on runs of the seat suspension that are possible, but probably not what was meant; they block nothing.

The names of variables here are those of the seat suspension; other systems get no such notes.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path

import numpy as np

from cosim.engine.network import VariableRef
from cosim.engine.structure import Structure
from cosim.fmi.values import Value
from cosim.results.result import Result
from cosim.units import GRAVITY, IDENTITY
from fmus.component import ParameterError
from plant_models.recording import read
from plant_models.shaker.interface import Profile
from seat_controller_fmu.parameters import SAMPLE_TIME
from seat_cosim.scenarios import FMUS, components_of, driver_mass

DRIVERS = (30.0, 200.0)
"""Range of a driver's mass in kg."""

MAX_FLOOR_DISPLACEMENT = 0.3
"""Largest displacement of a floor that a driver sits on, in m."""

MAX_FLOOR_ACCELERATION = 20.0
"""Largest acceleration of such a floor, in m/s2."""

MAX_ACCELERATION = 100.0
"""Largest acceleration of a driver or seat, in m/s2; ten times that of gravity."""

MIN_RATE = 20.0
"""Smallest number of rows per second of a recorded ride."""

QUIET_FLOOR = 0.2
"""RMS acceleration in m/s2 below which a recorded floor is quieter than a smooth road gives."""

_FLOOR = ("seat.floor_displacement", "seat.floor_velocity", "seat.floor_acceleration")
"""Inputs that describe one motion: displacement and its derivatives."""

_OUTSIDE = re.compile(r"driver_mass .*lies outside .*")
_NUMBER = r"[^\d]*([\d.]+)"


def notes_before(
    system: Structure, parameters: Mapping[str, Value], step_size: float | None = None, stop_time: float | None = None
) -> list[str]:
    """List what is doubtful about a run before it begins.

    Parameters
    ----------
    system
        The system.
    parameters
        Parameters of the run, which win over those of the system, as ``component.variable``.
    step_size, stop_time
        Communication step and stop time in s; the system's where None.
    """
    masses = {name: system.number(name, parameters) for name in driver_mass(0.0) if system.has(name)}
    return [
        *_mass_notes(masses),
        *_step_notes(system, system.step_size if step_size is None else step_size),
        *_floor_notes(system),
        *_unit_notes(system),
        *_recording_notes(system, parameters, system.stop_time if stop_time is None else stop_time),
    ]


def _mass_notes(masses: Mapping[str, float]) -> Iterator[str]:
    if len(set(masses.values())) > 1:
        listed = " and ".join(f"{name} = {mass:g} kg" for name, mass in masses.items())
        yield f"{listed}: the driver of the controller is not that of the seat; --driver-mass sets both"
    for name, mass in masses.items():
        if not DRIVERS[0] <= mass <= DRIVERS[1]:
            yield f"{name} = {mass:g} kg: drivers weigh {DRIVERS[0]:g} to {DRIVERS[1]:g} kg"


def _step_notes(system: Structure, step_size: float | None) -> Iterator[str]:
    for name in components_of(system, "SeatController"):
        own = system.component_steps.get(name, step_size)
        if own is not None and own > SAMPLE_TIME.value * (1.0 + 1e-9):
            yield (
                f"step size {own:g} s: {name} samples every {SAMPLE_TIME.value:g} s and takes several samples of one "
                f"input; use {SAMPLE_TIME.value:g} s or less"
            )


def _floor_notes(system: Structure) -> Iterator[str]:
    """Yield a note where the signals of one motion are scaled by different factors, apart from their units."""
    factors: dict[str, float] = {}
    for name in _FLOOR:
        sink = VariableRef(*name.split("."))
        if sink in system.connections:
            factors[sink.variable] = system.connections[sink].explicit.factor
    if factors and max(factors.values()) - min(factors.values()) > 1e-9 * max(map(abs, factors.values())):
        scales = ", ".join(f"{name} by {factor:g}" for name, factor in factors.items())
        yield f"seat: the signals of one floor are scaled differently ({scales}); scale all of them by one factor"


def _unit_notes(system: Structure) -> Iterator[str]:
    """Yield a note for each connection that an undeclared unit leaves unchecked, unless it is transformed."""
    for sink, connection in system.connections.items():
        source_unit, sink_unit = system.unit(str(connection.source)), system.unit(str(sink))
        if sink_unit and not source_unit and connection.transformation == IDENTITY:
            yield (
                f"{connection.source} declares no unit and is taken as {sink_unit} for {sink}; "
                f'where it has another: --connect "FACTOR*{connection.source}={sink}"'
            )


def _recording_notes(system: Structure, parameters: Mapping[str, Value], stop_time: float | None) -> Iterator[str]:
    """Yield notes on the recordings that a run plays."""
    checked = system.check_parameters(parameters)
    for name in components_of(system, FMUS["shaker"]):
        path = Path(str(checked[name].get("file.path", "")))
        if path.is_absolute() and system.number(f"{name}.profile", parameters) == Profile.file:
            with suppress(ParameterError):  # the FMU says why it cannot be used
                yield from recording_notes(str(path), stop_time)


def recording_notes(path: str, stop_time: float | None = None) -> Iterator[str]:
    """Yield what is doubtful about a recording: it ends before the run, or looks as if in other units than s and m/s2.

    Parameters
    ----------
    path
        The CSV file.
    stop_time
        End of the run in s; None where it is not known.

    Yields
    ------
    str
        A note.

    Raises
    ------
    ParameterError
        If the file cannot be used.
    """
    recording = read(path)
    values, end = np.array(recording.values), recording.axis[-1]
    if stop_time is not None and stop_time > end * (1.0 + 1e-6):
        yield (
            f"{path}: the recording ends at {end:g} s, the run at {stop_time:g} s, and the numbers count the still "
            f"floor after it; where that is not meant: --stop-time {end:g}"
        )
    step = float(np.median(np.diff(recording.axis)))
    if step > 1.0 / MIN_RATE:
        yield (
            f"{path}: a row every {step:g} s cannot hold a ride, which takes at least {MIN_RATE:g} rows per second: "
            "is the time in ms?"
        )
    if recording.quantity != "acceleration":
        return
    root, mean = float(np.sqrt(np.mean(np.square(values)))), float(values.mean())
    if 0.0 < root < QUIET_FLOOR:
        yield f"{path}: an acceleration of {root:.2g} m/s2 RMS is less than a smooth road gives: is it in g?"
    if abs(mean) > 0.5 * GRAVITY:
        yield f"{path}: the acceleration has a mean of {mean:.3g} m/s2: does it contain gravity?"


def notes_after(result: Result) -> list[str]:
    """List what is doubtful about the values of a run.

    Parameters
    ----------
    result
        Result of the run.
    """
    notes = []
    for name, limit, unit, whose in (
        ("floor_displacement", MAX_FLOOR_DISPLACEMENT, "m", "of floors that drivers sit on"),
        ("floor_acceleration", MAX_FLOOR_ACCELERATION, "m/s2", "of floors that drivers sit on"),
        ("seat_acceleration", MAX_ACCELERATION, "m/s2", "that drivers survive"),
        ("driver_acceleration", MAX_ACCELERATION, "m/s2", "that drivers survive"),
    ):
        for signal in (each for each in result.values if each.partition(".")[2] == name):
            peak = float(np.abs(result[signal]).max(initial=0.0))
            if result.units.get(signal) == unit and peak > limit:
                notes.append(f"{signal} reaches {peak:.3g} {unit}, beyond the {limit:g} {unit} {whose}: check units")
    return notes


def explained(warnings: Iterable[str], gains: str | None = None, *, control: bool = True) -> list[str]:
    """Put warnings of drivers outside the gains' range into one line that says what helps.

    Parameters
    ----------
    warnings
        Warnings of the FMUs.
    gains
        Preset or file of the gains; the published ones where None.
    control
        Whether the controller is on; where it is off, its gains do not matter, and there is no such line.

    Returns
    -------
    list of str
        The other warnings as they were, then that line.
    """
    others: list[str] = []
    drivers: dict[float, None] = {}
    limits: tuple[float, float] | None = None
    for text in warnings:
        found = _driver_outside(text)
        if found is None:
            others.append(text)
        else:
            drivers[found[0]] = None
            limits = found[1:]
    if limits is None or not control:
        return others
    masses = " and ".join(f"{mass:g}" for mass in drivers)
    line = (
        f"driver{'s' if len(drivers) > 1 else ''} of {masses} kg: outside the {limits[0]:g} to {limits[1]:g} kg that "
        "the gains are for; those of the nearer end are used"
    )
    return [*others, line + _better_gains(drivers, gains)]


def _driver_outside(text: str) -> tuple[float, float, float] | None:
    """Read the driver's mass and the range of the gains, in kg, from the controller's warning; None from another."""
    if not _OUTSIDE.search(text):
        return None
    named = re.search(rf"driver_mass ={_NUMBER}.*driver_mass_min ={_NUMBER}.*driver_mass_max ={_NUMBER}", text)
    found = named or re.search(rf"driver_mass{_NUMBER} kg lies outside \[{_NUMBER},{_NUMBER}\]", text)
    return None if found is None else (float(found[1]), float(found[2]), float(found[3].rstrip(".")))


def _better_gains(drivers: Iterable[float], gains: str | None) -> str:
    """Return a hint at the recommended gains, where they cover all drivers and are not in use."""
    from seat_controller_fmu.design.gains import preset

    setting = preset("recommended").setting
    covers = all(setting.driver_mass_min <= mass <= setting.driver_mass_max for mass in drivers)
    if gains == "recommended" or not covers:
        return ""
    return f"; --gains recommended is for {setting.driver_mass_min:g} to {setting.driver_mass_max:g} kg"
