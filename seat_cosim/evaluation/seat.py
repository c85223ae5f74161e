"""The seat suspension as an evaluated system, and the passive seat that it is compared with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from cosim.engine.structure import Structure
from cosim.fmi.values import Value
from cosim.system import System
from plant_models.seat.interface import DriverModel
from seat_cosim.evaluation.installation import Installation
from seat_cosim.evaluation.system import EvaluatedSystem, SignalMap
from seat_cosim.scenarios import FLOORS, FMUS, SHAKER, TRUCK, components_of, control, driver_mass, read_parameter_sets

PASSIVE_NOTE = (
    "The passive seat is not the paper's, of which nothing is published: its damping is fitted on one of its numbers, "
    "its friction is assumed; see docs/explanation/calibration.md."
)
"""Note on the parameter set ``passive``, for readers of a report."""

_TRAVEL, _STIFFNESS, _DAMPING = "seat.end_stop.travel", "seat.end_stop.stiffness", "seat.end_stop.damping"

_OF_THE_TEST = ("driver_mass", "driver.", "cushion_", "end_stop.", "floor_signals")
"""Beginnings of the names of SeatPlant's parameters that belong to the test: driver, cushion, end stops, floor."""


def seat_signals(shaker: str = SHAKER) -> SignalMap:
    """Return the signal map of the seat suspension.

    Parameters
    ----------
    shaker
        Name of the component that is a Shaker of this project.

    Examples
    --------
    >>> seat_signals("rig").floor_acceleration
    'rig.floor_acceleration'
    """
    return SignalMap(
        floor_acceleration=f"{shaker}.floor_acceleration",
        seat_acceleration="seat.driver_acceleration",
        driver_mass=tuple(driver_mass(0.0)),
        excitation={f"{shaker}.profile": "random"},
        excitation_class=f"{shaker}.random.class",
        seed=f"{shaker}.random.seed",
        suspension_deflection="seat.suspension_deflection",
        actuator_force="controller.force",
        end_stop_travel=_TRAVEL,
        end_stop_height="seat.end_stop.height",
        force_limit="controller.force_limit",
        noise_seed="seat.sensor.seed",
        sine={f"{shaker}.profile": "sine"},
        sine_frequency=f"{shaker}.sine.frequency",
        sine_amplitude=f"{shaker}.sine.amplitude",
    )


def truck_signals(truck: str = TRUCK) -> SignalMap:
    """Return the signal map of the seat in a truck, whose classes are roads at a speed, such as ``C60``.

    Parameters
    ----------
    truck
        Name of the component that is a TruckCab of this project.
    """
    return replace(
        seat_signals(truck),
        excitation={f"{truck}.road.profile": "iso8608"},
        excitation_class=f"{truck}.road.class",
        seed=f"{truck}.road.seed",
        speed=f"{truck}.speed",
        sine={},
        sine_frequency=None,
        sine_amplitude=None,
    )


SIGNALS = {SHAKER: seat_signals, TRUCK: truck_signals}
"""What moves the floor to the signal map of the suspension on it."""


def installed(system: Structure, installation: Installation) -> dict[str, Value]:
    """Return the parameters that give a seat the travel and the end stops of a test.

    Parameters
    ----------
    system
        The system; one without the parameters of our SeatPlant's end stops keeps its own.
    installation
        Travel and end stops.

    Returns
    -------
    dict
        ``component.variable`` to value.
    """
    if not all(map(system.has, (_TRAVEL, _STIFFNESS, _DAMPING))):
        return {}
    if installation.travel is None:
        return {_TRAVEL: 0.0}
    return {_TRAVEL: installation.travel, _STIFFNESS: installation.stiffness, _DAMPING: installation.damping}


def common_parameters(system: System, component: str = SHAKER, floor: str = SHAKER) -> dict[str, Value]:
    """Return the parameters of a system that belong to the test, not to its seat: floor, driver, travel, end stops.

    Parameters
    ----------
    system
        The system that is tested; parameters of other FMUs than ours are the seat's.
    component
        Name of what moves its floor.
    floor
        What that is, a key of :data:`seat_cosim.scenarios.FLOORS`.

    Returns
    -------
    dict
        Names in the seat suspension, as ``component.variable``, to values.
    """
    shaken = component in components_of(system, FLOORS[floor])
    seated = "seat" in components_of(system, FMUS["seat"])
    found = {}
    for name, value in system.parameters.items():
        owner, _, variable = name.partition(".")
        if owner == component and shaken:
            found[f"{floor}.{variable}"] = value
        elif owner == "seat" and seated and variable.startswith(_OF_THE_TEST):
            found[name] = value
    return found


def semi_active_seat(system: System, common: Mapping[str, Value], floor: str) -> EvaluatedSystem:
    """Return the semi-active seat as an evaluated system.

    Parameters
    ----------
    system
        From :func:`seat_cosim.scenarios.seat_block`; its parameters are changed.
    common
        Parameters of the test, from :func:`installed` and :func:`common_parameters`, by their names in the seat
        suspension.
    floor
        What moves the floor, a key of :data:`seat_cosim.scenarios.FLOORS`.
    """

    def in_block(name: str) -> str:
        return f"seat.{name}" if name.startswith("seat.") else name

    system.parameters |= {in_block(name): value for name, value in common.items()}
    ours = SIGNALS[floor]()
    signals = replace(
        ours,
        driver_mass=(in_block("seat.driver_mass"),),
        actuator_force=None,
        force_limit=None,
        end_stop_travel=in_block(_TRAVEL),
        end_stop_height=in_block("seat.end_stop.height"),
        noise_seed=in_block("seat.sensor.seed"),
    )
    return EvaluatedSystem("semi-active seat", system, signals, has_actuator=False)


def inert_load(system: System) -> dict[str, Value]:
    """Return the parameters that strap the load to a seat, without a cushion between; none for other seats than ours.

    Parameters
    ----------
    system
        The system.
    """
    if "seat" not in components_of(system, FMUS["seat"]):
        return {}
    one_mass = {"seat.driver.model": DriverModel.lumped.name}
    strapped = read_parameter_sets(["load"], system)
    return strapped | one_mass if "driver.model" in system.models["seat"].variables else strapped


def passive_seat(
    system: System,
    parameters: Mapping[str, Value],
    common: Mapping[str, Value] | None = None,
    measured: Mapping[str, str] | None = None,
    signals: SignalMap | None = None,
) -> EvaluatedSystem:
    """Switch a seat suspension's controller off and return it as an evaluated system.

    Parameters
    ----------
    system
        From :func:`seat_cosim.scenarios.seat_suspension`; its parameters are changed.
    parameters
        Parameters of the passive seat, as ``component.variable``.
    common
        Parameters of the test, from :func:`installed` and :func:`common_parameters`; they win.
    measured
        Outputs at which the test measures accelerations: fields of the signal map to their names.
    signals
        Signal map of the suspension; that of one on a shaker where None.
    """
    system.parameters |= {**control(False), **parameters, **(common or {})}
    places: dict[str, Any] = dict(measured or {})
    signals = replace(signals or seat_signals(), actuator_force=None, force_limit=None, **places)
    return EvaluatedSystem("passive seat", system, signals, is_passive=True, has_actuator=False)
