"""Parameters without an effect: the shape of a floor that is not ridden, a law that does not run, an absent driver.

The names are those of this project's FMUs; parameters of other FMUs are taken as they are.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from enum import IntEnum
from typing import NamedTuple

from cosim.engine.structure import Structure
from cosim.errors import Problems, SetupError
from cosim.fmi.values import Value
from plant_models.seat.interface import DriverModel
from plant_models.shaker import interface as shaker
from plant_models.truck import interface as truck
from seat_controller_fmu.interface import Mode

_OF_PUBLISHED = (
    "anti_windup",
    "observer_gamma",
    "L1",
    "L2",
    "driver_mass_min",
    "driver_mass_max",
    "K1.deflection",
    "K1.rate",
    "K2.deflection",
    "K2.rate",
)
"""Parameters of the controller that only the mode published uses."""

_OF_ROBUST = ("actuator_time_constant", "actuator_delay", "travel")
"""Parameters of the controller that only the mode robust uses, beside those named ``robust.*``."""


_OF_DRIVERS = {
    "cushion_stiffness": DriverModel.lumped,
    "cushion_damping": DriverModel.lumped,
    "driver.contact_stiffness": DriverModel.seated,
    "driver.contact_damping": DriverModel.seated,
    "driver_force": DriverModel.external,
}
"""Variables of the seat that only one kind of driver uses."""


def refuse_idle(names: Iterable[str], system: Structure, parameters: Mapping[str, Value]) -> None:
    """Raise an error for parameters that a user gave and that have no effect in a run.

    Parameters
    ----------
    names
        Parameters that the user named, as ``component.variable``.
    system
        The system.
    parameters
        Parameters of the run, which win over those of the system.

    Raises
    ------
    SetupError
        With one problem for each of them: what it belongs to, and what the run has instead.
    """
    problems = Problems()
    problems.found += _problems(names, system, parameters)
    problems.raise_any()


def _problems(names: Iterable[str], system: Structure, parameters: Mapping[str, Value]) -> Iterator[str]:
    for name in names:
        component, _, variable = name.partition(".")
        model = system.models.get(component)
        use = _use(model.description.modelName, variable) if model and variable in model.variables else None
        if use is None:
            continue
        chosen = _item(system, f"{component}.{use.choice}", use.kind, parameters)
        if chosen is not None and chosen not in use.items:
            needed = " or ".join(use.items)
            yield f"{name}: expected {component}.{use.choice} = {needed}, which uses it, got {chosen}"


class _Use(NamedTuple):
    """When a variable is used: the enumeration that decides on it, and the items with which it is used."""

    choice: str
    kind: type[IntEnum]
    items: tuple[str, ...]


_RANDOM, _RECORDED = truck.Profile.iso8608.name, truck.Profile.file.name

_OF_ROAD = {
    "road.class": (_RANDOM,),
    "road.seed": (_RANDOM,),
    "road.file": (_RECORDED,),
    "road.fade": (_RANDOM, _RECORDED),
}
"""Parameter of the truck to the profiles that use it."""

_OBSTACLES = tuple(name for name in truck.Profile.__members__ if name not in (_RANDOM, _RECORDED))
"""Profiles that use the parameters of the truck named ``obstacle.*``."""


def _use(model: str, variable: str) -> _Use | None:
    """Return when a variable of this project's FMUs is used; None for one that always is."""
    prefix, dot, _ = variable.partition(".")
    if model == "Shaker" and dot and prefix in shaker.Profile.__members__:
        return _Use("profile", shaker.Profile, (prefix,))
    if model == "TruckCab" and (items := _OBSTACLES if prefix == "obstacle" else _OF_ROAD.get(variable)):
        return _Use("road.profile", truck.Profile, items)
    if model == "SeatController" and (prefix == "robust" or variable in _OF_ROBUST):
        return _Use("mode", Mode, (Mode.robust.name,))
    if model == "SeatController" and variable in _OF_PUBLISHED:
        return _Use("mode", Mode, (Mode.published.name,))
    if model == "SeatPlant" and variable in _OF_DRIVERS:
        return _Use("driver.model", DriverModel, (_OF_DRIVERS[variable].name,))
    return None


def _item(system: Structure, name: str, kind: type[IntEnum], parameters: Mapping[str, Value]) -> str | None:
    """Return the name of the item that an enumeration has in a run; None where it is not of this project's kind."""
    try:
        return kind(int(system.number(name, parameters))).name
    except (SetupError, TypeError, ValueError):
        return None
