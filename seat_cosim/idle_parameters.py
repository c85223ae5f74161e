"""Parameters without an effect: the shape of a floor that is not ridden, a law that does not run, an absent driver.

The names are those of this project's FMUs; parameters of other FMUs are taken as they are.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from cosim.engine.structure import Structure
from cosim.errors import Problems, SetupError
from cosim.fmi.values import Value
from plant_models.seat.interface import DriverModel
from plant_models.shaker.interface import Profile
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
        owner = _owner(model.description.modelName, variable) if model and variable in model.variables else None
        if owner is None:
            continue
        choice, needed = owner
        chosen = _item(system, f"{component}.{choice}", parameters)
        if chosen is not None and chosen != needed:
            yield f"{name}: expected {component}.{choice} = {needed}, which uses it, got {chosen}"


def _owner(model: str, variable: str) -> tuple[str, str] | None:
    """Return the parameter that decides on the use of a variable, and the item with which it is used."""
    prefix, dot, _ = variable.partition(".")
    if model == "Shaker" and dot and prefix in Profile.__members__:
        return "profile", prefix
    if model == "SeatController" and (prefix == "robust" or variable in _OF_ROBUST):
        return "mode", Mode.robust.name
    if model == "SeatController" and variable in _OF_PUBLISHED:
        return "mode", Mode.published.name
    if model == "SeatPlant" and variable in _OF_DRIVERS:
        return "driver.model", _OF_DRIVERS[variable].name
    return None


def _item(system: Structure, name: str, parameters: Mapping[str, Value]) -> str | None:
    """Return the name of the item that an enumeration has in a run; None where it is not of this project's kind."""
    try:
        component, variable = system.parse(name)
        value = system.check_parameters(parameters)[component].get(variable, system.start(name))
        kind = {"profile": Profile, "mode": Mode, "driver.model": DriverModel}[variable]
        return kind(int(value)).name  # type: ignore[arg-type]  # a number
    except (SetupError, TypeError, ValueError):
        return None
