"""The seat suspension as a system of three FMUs, the scenarios it is run in, and parameters with which it is varied.

Only this module, :mod:`seat_cosim.evaluation.seat` and :mod:`seat_cosim.paper` use names of the components' variables.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from cosim.engine.structure import Structure
from cosim.errors import SetupError, did_you_mean
from cosim.fmi.values import Value
from cosim.ssp import read_parameters
from cosim.system import System
from fmus import FLAVOURS
from plant_models import parameter_sets
from plant_models.truck.interface import RoadClass

KMH = 3.6
"""Kilometres per hour in a metre per second."""

SHAKER, TRUCK = "shaker", "truck"
"""Components that move the cabin floor."""

FLOORS = {SHAKER: "Shaker", TRUCK: "TruckCab"}
"""Component that moves the cabin floor to its FMU."""

FMUS = {**FLOORS, "seat": "SeatPlant", "controller": "SeatController"}
"""Component to its FMU."""

SYSTEM_NAMES = {SHAKER: "SeatSuspension", TRUCK: "TruckSeat"}
"""Component that moves the floor to the name of the system."""

SYSTEM_FILES = {
    flavour: {floor: f"{name}{suffix}.ssp" for floor, name in SYSTEM_NAMES.items()}
    for flavour, suffix in (("fmi2", ""), ("fmi3", "-fmi3"))
}
"""Flavour and component that moves the floor to the file that describes the system of its FMUs."""

FLOOR_SIGNALS = ("floor_displacement", "floor_velocity", "floor_acceleration")
"""Outputs of a floor, and inputs of a seat."""

_LOOP = {
    "seat.force": "controller.force",
    "controller.seat_acceleration": "seat.seat_acceleration_measured",
    "controller.suspension_deflection": "seat.suspension_deflection_measured",
}
"""Connections of controller and seat."""


@dataclass(frozen=True)
class Scenario:
    """An excitation and the stop time of its runs.

    Attributes
    ----------
    description
        One line.
    parameters
        Parameters of the floor, as ``component.variable``.
    stop_time
        In s.
    floor
        Component that moves the floor, a key of :data:`FLOORS`.
    is_random
        Whether the motion is random, of which a figure shows a part: curves of a minute are a block of colour.
    """

    description: str
    parameters: Mapping[str, Value]
    stop_time: float
    floor: str = SHAKER
    is_random: bool = False


ROADS = tuple(RoadClass.__members__)
"""Classes of roads in ISO 8608."""

ROAD, SPEED = RoadClass.C.name, 60.0
"""Class of the road, and speed in km/h, that a truck has by default."""


def road(name: str, speed: float) -> dict[str, Value]:
    """Return the parameters of a truck on a road of ISO 8608.

    Parameters
    ----------
    name
        Class of the road, ``A`` to ``E``.
    speed
        In km/h.
    """
    return {f"{TRUCK}.road.profile": "iso8608", f"{TRUCK}.road.class": name, f"{TRUCK}.speed": speed / KMH}


SCENARIOS: dict[str, Scenario] = {
    "bump": Scenario("the paper's bump (34), met at t = 0", {"shaker.profile": "bump"}, 3.0),
    "sine": Scenario("a sine of the floor, 3 Hz and 6 mm by default", {"shaker.profile": "sine"}, 5.0),
    "sweep": Scenario("a logarithmic sweep, 0.5 to 20 Hz at 1 m/s2 by default", {"shaker.profile": "sweep"}, 60.0),
    "random": Scenario(
        "random motion of an ISO 7096 class, EM1 by default", {"shaker.profile": "random"}, 60.0, is_random=True
    ),
    "file": Scenario("a recording, the FMU's example by default", {"shaker.profile": "file"}, 10.0),
    "truck": Scenario(
        "a truck's cab, 60 km/h on a road of class C by default", road(ROAD, SPEED), 60.0, TRUCK, is_random=True
    ),
}
"""Name of a scenario to what it is."""


def overview(floor: str = SHAKER) -> dict[str, list[str]]:
    """Return the panels of a run's overview: quantity to its signals, which have one unit; the driver's first, on top.

    Parameters
    ----------
    floor
        Component that moves the floor.
    """
    return {
        "Acceleration": ["seat.driver_acceleration", "seat.seat_acceleration", f"{floor}.floor_acceleration"],
        "Displacement": ["seat.suspension_deflection", f"{floor}.floor_displacement"],
        "Force": ["controller.force", "controller.disturbance_estimate", "seat.friction_force"],
    }


OVERVIEW = overview()
"""Panels of the seat suspension on a shaker."""


def floor_of(components: Container[str]) -> str:
    """Return what moves the floor of a system with these components: the truck if it is among them, else a shaker."""
    return TRUCK if TRUCK in components else SHAKER


def seat_suspension(folder: Path, floor: str = SHAKER) -> System:
    """Return the system of a floor, seat and controller, connected.

    The components step in the order controller, seat, floor: there is no delay from sample to force, and the seat's
    step starts from the floor at its beginning. (With the shaker before the seat it would start from the floor at its
    end.) The force of the seat acts on the cab of a truck.

    Parameters
    ----------
    folder
        Folder of the three FMUs.
    floor
        Component that moves the floor, a key of :data:`FLOORS`.

    Raises
    ------
    SetupError
        If one of the FMUs does not exist.
    """
    order = ("controller", "seat", floor)
    system = _system({name: FMUS[name] for name in reversed(order)}, folder)
    system.name = SYSTEM_NAMES[floor]
    _connect(system, floor)
    for sink, source in _LOOP.items():
        system.connect(source, sink)
    system.order = order
    return system


def seat_block(folder: Path, fmu: str, floor: str = SHAKER) -> System:
    """Return the system of a floor and a seat that is one block, connected.

    Parameters
    ----------
    folder
        Folder of the FMUs.
    fmu
        ``ActiveSeat``, ``PassiveSeat`` or ``SemiActiveSeat``, or another FMU with their ports.
    floor
        Component that moves the floor, a key of :data:`FLOORS`.

    Raises
    ------
    SetupError
        If one of the FMUs does not exist.
    """
    system = _system({floor: FLOORS[floor], "seat": fmu}, folder)
    system.name = fmu
    _connect(system, floor)
    system.order = ("seat", floor)
    return system


def _system(fmus: Mapping[str, str], folder: Path) -> System:
    """Return a system of FMUs, without connections; raises SetupError with those that are missing."""
    missing = [fmu for fmu in fmus.values() if not (folder / f"{fmu}.fmu").is_file()]
    if missing:
        raise SetupError(
            f"{folder}: expected {', '.join(f'{fmu}.fmu' for fmu in missing)}, got no such file; "
            f"run: seat-cosim build{f' --flavour {folder.name}' if folder.name in FLAVOURS else ''}"
        )
    system = System()
    for name, fmu in fmus.items():
        system.add(name, folder / f"{fmu}.fmu")
    return system


def _connect(system: System, floor: str) -> None:
    """Connect the motion of a floor to the seat, and the force of the seat to a floor that gives way."""
    for signal in FLOOR_SIGNALS:
        system.connect(f"{floor}.{signal}", f"seat.{signal}")
    if floor == TRUCK:
        system.connect("seat.floor_force", f"{TRUCK}.seat_force")


def components_of(system: Structure, model: str) -> list[str]:
    """Return the names of a system's components that are of a model.

    Parameters
    ----------
    system
        The system.
    model
        Name of the model, such as ``SeatPlant``.
    """
    return [name for name, each in system.models.items() if each.description.modelName == model]


# ---- parameters of the seat suspension, as component.variable --------------------------------------------------------


def driver_mass(kilograms: float) -> dict[str, Value]:
    """Return the parameters of a driver's mass in kg, of seat and controller alike."""
    return {"seat.driver_mass": kilograms, "controller.driver_mass": kilograms}


def observer(gamma: float) -> dict[str, Value]:
    """Return the parameters of an observer by its constant Gamma of (23), in s/kg2; they replace its gains."""
    return {"controller.observer_gamma": gamma, "controller.L1": 0.0, "controller.L2": 0.0}


def paper_observer(number: int) -> dict[str, Value]:
    """Return the parameters of the paper's Observer 1 or 2."""
    from seat_controller_fmu.parameters import OBSERVERS

    return observer(OBSERVERS[number].value)


EQUAL_RATE = "equal-rate"
"""Name of the observer of the text at (23), "the same convergence rate for different driver weights"; also a preset."""

OBSERVERS = ("1", "2", EQUAL_RATE)
"""Names of the observers: the paper's two by (23) as printed, and Observer 1 with one rate for all masses."""


def named_observer(name: str) -> dict[str, Value]:
    """Return the parameters of an observer; the state feedback stays.

    Parameters
    ----------
    name
        One of :data:`OBSERVERS`.
    """
    if name != EQUAL_RATE:
        return paper_observer(int(name))
    return {parameter: value for parameter, value in gains(EQUAL_RATE).items() if parameter in _OBSERVER_GAINS}


_OBSERVER_GAINS = ("controller.L1", "controller.L2")


def control(on: bool) -> dict[str, Value]:
    """Return the parameter that switches the controller on or off."""
    return {"controller.enabled": on}


_TOLD = {
    "controller.actuator_time_constant": "seat.actuator.time_constant",
    "controller.actuator_delay": "seat.actuator.delay",
    "controller.travel": "seat.end_stop.travel",
}
"""Parameter of the controller's mode robust to what it is of the seat."""


def mode(name: str, parameters: Mapping[str, Value]) -> dict[str, Value]:
    """Return the parameters of a control law.

    Parameters
    ----------
    name
        ``published`` or ``robust``. The latter gets the actuator and the travel of the seat as parameters.
    parameters
        Parameters of the run. What they say about the controller's model of the actuator stays.

    Returns
    -------
    dict
        ``component.variable`` to value.
    """
    from seat_blocks.active_seat import free_travel

    known = {
        parameter: parameters[source]
        for parameter, source in _TOLD.items()
        if name == "robust" and parameters.get(source) and parameter not in parameters
    }
    if "controller.travel" in known:  # the law knows one travel for both ways: the shorter one
        travel, height = known["controller.travel"], parameters.get("seat.end_stop.height", 0.0)
        with suppress(ValueError):  # a text from a command line that is no number is refused by its own name
            known["controller.travel"] = free_travel(float(str(travel)), float(str(height)))
    return {"controller.mode": name, **known}


def gains(name_or_file: str) -> dict[str, Value]:
    """Return the controller's parameters of a set of gains.

    Parameters
    ----------
    name_or_file
        Name of a preset, or a ``gains.json``.

    Raises
    ------
    SetupError
        If there is no such preset or file, or the file does not hold gains.
    """
    from seat_controller_fmu.design.gains import load
    from seat_controller_fmu.design.setting import GainsError

    try:
        return {f"controller.{name}": value for name, value in load(name_or_file).parameters().items()}
    except GainsError as error:
        raise SetupError(str(error)) from error


def read_parameter_sets(names_or_files: Iterable[str], system: Structure) -> dict[str, Value]:
    """Read parameter sets; later ones win.

    Parameters
    ----------
    names_or_files
        Names from :data:`plant_models.parameter_sets.NAMES`, or ``.ssv`` files.
    system
        System whose parameters they are.

    Raises
    ------
    SetupError
        With all problems of the first set that has any.
    """
    found: dict[str, Value] = {}
    for word in names_or_files:
        if not Path(word).suffix and word not in parameter_sets.NAMES and not Path(word).expanduser().is_file():
            sets = f"a file, or a set among {', '.join(parameter_sets.NAMES)}"
            raise SetupError(
                f"parameters {word}: expected {sets}, got no such file{did_you_mean(word, parameter_sets.NAMES)}"
            )
        found |= read_parameters(
            parameter_sets.path(word) if word in parameter_sets.NAMES else Path(word).expanduser(), system
        )
    return found
