"""The paper's bump test: its three cases, the table beside the paper's numbers, its Fig. 5-7."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cosim.engine.run_options import RunOptions
from cosim.errors import writing_to
from cosim.fmi.values import Value
from cosim.metrics import peak, rms
from cosim.results.result import Result, prepare_folder
from cosim.run_folder import run_to_folder
from cosim.system import System
from seat_cosim.plotting import Curve, Panel, draw
from seat_cosim.scenarios import SCENARIOS, control, driver_mass, observer


@dataclass(frozen=True)
class Case:
    """One of the cases that the paper compares.

    Attributes
    ----------
    title
        Name in the paper's legends.
    parameters
        ``component.variable`` to value.
    style
        Line style in figures, as matplotlib takes it.
    """

    title: str
    parameters: Mapping[str, Value]
    style: Mapping[str, Any]


def cases(gammas: Mapping[int, float]) -> dict[str, Case]:
    """Return the three cases of the paper's section 3.2, by name.

    Parameters
    ----------
    gammas
        Number of an observer to its Gamma, in s/kg2.
    """
    found = {"uncontrolled": Case("Uncontrolled", control(False), {"color": "0.45", "linestyle": "--"})}
    for number, color in ((1, "C0"), (2, "C3")):
        found[f"observer{number}"] = Case(f"Observer {number}", observer(gammas[number]), {"color": color})
    return found


def run(
    system: System,
    cases: Mapping[str, Case],
    mass: float,
    folder: Path,
    progress: Callable[[str, float], None],
    command: Sequence[str] = (),
) -> Iterator[tuple[str, Result]]:
    """Run all cases with the FMUs loaded once, each into a folder of its own.

    Results of earlier runs in these folders are removed first.

    Parameters
    ----------
    system
        From :func:`seat_cosim.scenarios.seat_suspension`.
    cases
        From :func:`cases`.
    mass
        The driver's mass, in kg.
    folder
        Folder of the cases' folders.
    progress
        Called with a case's name and the share of its run that is done.
    command
        Words of the command line.

    Yields
    ------
    tuple of str and Result
        A case's name and result.

    Raises
    ------
    SetupError
        If the mass is out of range, or a folder cannot be written to.
    RunError
        If an FMU failed during loading or initialization.
    """
    bump = SCENARIOS["bump"]
    system.validate(bump.stop_time, parameters=driver_mass(mass))
    for name in cases:
        with writing_to(folder.parent):
            prepare_folder(folder / name)
    with system.open() as session:
        for name, case in cases.items():
            parameters = {**bump.parameters, **case.parameters, **driver_mass(mass)}
            result = run_to_folder(
                system,
                folder / name,
                RunOptions(
                    bump.stop_time,
                    parameters=parameters,
                    progress=lambda time, name=name: progress(name, time / bump.stop_time),  # type: ignore[misc]
                ),
                command=command,
                session=session,
            )
            yield name, result


def disturbance(result: Result, mass: float) -> np.ndarray[Any, Any]:
    """Compute the disturbance F_d = f_r + m_b (z_b'' - z_s'') + (u - u_sat) (5), which the observer estimates.

    Parameters
    ----------
    result
        Result of a run of the seat suspension.
    mass
        The driver's mass m_b, in kg.

    Returns
    -------
    numpy.ndarray
        In N, shape (rows,).
    """
    relative = result["seat.driver_acceleration"] - result["seat.seat_acceleration"]
    saturation = result["controller.force_demand"] - result["controller.force"]
    return np.asarray(result["seat.friction_force"] + mass * relative + saturation)


def _peak(name: str) -> Callable[[Result], float]:
    return lambda result: peak(result[name])


def _rms(name: str) -> Callable[[Result], float]:
    return lambda result: rms(result[name])


@dataclass(frozen=True)
class Measure:
    """A row of the table.

    Attributes
    ----------
    title, unit
        Quantity, and the unit in which it is shown.
    value
        Function of a result that returns the quantity in SI units.
    factor
        Factor from SI units to ``unit``.
    paper
        The paper's words or number; empty where it gives none.
    """

    title: str
    unit: str
    value: Callable[[Result], float]
    factor: float = 1.0
    paper: str = ""


def measures(force_limit: float) -> list[Measure]:
    """Return the rows of the table.

    Parameters
    ----------
    force_limit
        u_lim in N, at which the force of the paper's Fig. 7 saturates.
    """
    acceleration, demand, force = "seat.driver_acceleration", "controller.force_demand", "controller.force"
    return [
        Measure("Driver acceleration, peak", "m/s²", _peak(acceleration), paper='"about 4", uncontrolled (Fig. 5)'),
        Measure("Driver acceleration, RMS", "m/s²", _rms(acceleration)),
        Measure("Seat acceleration, peak", "m/s²", _peak("seat.seat_acceleration")),
        Measure("Seat acceleration, RMS", "m/s²", _rms("seat.seat_acceleration")),
        Measure("Force demand, peak", "N", _peak(demand)),
        Measure("Force, peak", "N", _peak(force), paper=f"saturates at {force_limit:g} (Fig. 7)"),
        Measure("Disturbance estimate, peak", "N", _peak("controller.disturbance_estimate")),
        Measure("Friction force, peak", "N", _peak("seat.friction_force"), paper='"around 80" (Fig. 18)'),
        Measure("Suspension deflection, peak", "mm", _peak("seat.suspension_deflection"), factor=1e3),
    ]


NOTES = (
    'Fig. 5 shows an uncontrolled peak "about 4 m/s²"; equations (1)-(2) with the paper\'s own friction (35)-(36) give '
    "3.2. It takes 0.7 times that friction to reach 4.0, none at all gives 6.1.",
    "The paper prints no further numbers for this simulation. Its bump experiment (2.02 to 1.32 m/s² at 55 kg) "
    "compares with another, passive seat, under an excitation that is not given.",
)
"""Notes for readers of the table."""


def figures(results: Mapping[str, Result], cases: Mapping[str, Case], mass: float) -> dict[str, list[Panel]]:
    """Return the counterparts of the paper's Fig. 5, 6 and 7.

    Parameters
    ----------
    results
        Name of a case to its result.
    cases
        From :func:`cases`.
    mass
        The driver's mass, in kg.

    Returns
    -------
    dict
        ``fig05``, ``fig06`` and ``fig07`` to panels over time in s.
    """

    def curves(signal: str, names: list[str]) -> list[Curve]:
        return [Curve(cases[name].title, results[name][signal], cases[name].style) for name in names]

    time = results["uncontrolled"].time
    observers = [name for name in results if name != "uncontrolled"]
    limit = max(peak(results[name]["controller.force"]) for name in observers)
    acceleration = Panel("Driver acceleration (m/s²)", time, curves("seat.driver_acceleration", list(results)), {})
    estimates = [
        Panel(
            f"{cases[name].title}: force (N)",
            time,
            [
                Curve("disturbance F_d (5)", disturbance(results[name], mass), {"color": "0.45", "linestyle": "--"}),
                Curve("estimate (21)", results[name]["controller.disturbance_estimate"], cases[name].style),
            ],
            {},
        )
        for name in observers
    ]
    marks = {f"±{limit:g} N": limit, "": -limit}
    force = Panel("Actuator force (N)", time, curves("controller.force", observers), marks)
    return {"fig05": [acceleration], "fig06": estimates, "fig07": [force]}


_FILES = {
    "fig05": ("fig05_driver_acceleration.png", "As the paper's Fig. 5: bump, acceleration of the driver"),
    "fig06": ("fig06_observers.png", "As the paper's Fig. 6: bump, disturbance and its estimates"),
    "fig07": ("fig07_force.png", "As the paper's Fig. 7: bump, saturated control force"),
}


def draw_figures(folder: Path, results: Mapping[str, Result], cases: Mapping[str, Case], mass: float) -> list[Path]:
    """Draw the counterparts of the paper's Fig. 5, 6 and 7.

    Parameters
    ----------
    folder
        Folder of the files; it exists.
    results, cases, mass
        See :func:`figures`.

    Returns
    -------
    list of Path
        The PNG files.
    """
    for key, panels in figures(results, cases, mass).items():
        name, title = _FILES[key]
        draw(folder / name, f"{title}, {mass:g} kg driver", panels)
    return [folder / name for name, _ in _FILES.values()]
