"""Runner of the experiments: the FMUs of the seat suspension, loaded once, and the seats that the paper compares."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from cosim.engine.session import Session
from cosim.engine.structure import Structure
from cosim.fmi.values import Value
from cosim.metrics.samples import Samples
from cosim.results.result import Result
from cosim.system import System
from plant_models.parameter_sets import NAMES
from seat_controller_fmu import parameters as design
from seat_cosim.paper.bump_test import Case
from seat_cosim.scenarios import (
    OBSERVERS,
    control,
    driver_mass,
    gains,
    named_observer,
    observer,
    read_parameter_sets,
)

STEP = 0.002
"""Communication step size and sample time, in s."""

RATE = 500.0
"""Sampling rate, in Hz."""

FLOOR = "shaker.floor_acceleration"
SEAT = "seat.seat_acceleration"
SEAT_MEASURED = "seat.seat_acceleration_measured"
"""As the rig's accelerometer gives it; the paper's figures of the experiment show this one."""

DRIVER = "seat.driver_acceleration"
DEFLECTION = "seat.suspension_deflection"
DEFLECTION_RATE = "seat.deflection_rate"
FRICTION = "seat.friction_force"
FORCE = "controller.force"

LIGHT, HEAVY = 55.0, 70.0
"""The paper's two loads, in kg."""


@dataclass(frozen=True)
class Calibration:
    """Parameters that the paper does not give, as ``component.variable``, fitted to its numbers of the 55 kg driver.

    Attributes
    ----------
    load
        Load of the experiments on the seats.
    prototype
        Imperfections of the active seat, its sensors and actuator.
    passive
        The passive seat.
    ride
        The random excitation.
    """

    load: Mapping[str, Value]
    prototype: Mapping[str, Value]
    passive: Mapping[str, Value]
    ride: Mapping[str, Value]

    @classmethod
    def read(cls, system: Structure) -> Calibration:
        """Read the parameter sets of this project, for the seat suspension."""
        return cls(**{name: read_parameter_sets([name], system) for name in NAMES})


@dataclass(frozen=True)
class ExperimentRunner:
    """Runs the seat suspension under the conditions of an experiment.

    Attributes
    ----------
    system
        From :func:`seat_cosim.scenarios.seat_suspension`.
    session
        Session of the system.
    calibration
        Parameters that the paper does not give.
    recommended
        Controller's parameters of the recommended gains.
    gammas
        Number of an observer to its Gamma, in s/kg2.
    settings
        Symbol of the design in Table 1 to its value, in SI units.
    rig_observer
        Observer of the prototype on the rig, one of :data:`seat_cosim.scenarios.OBSERVERS`.
    progress
        Called with a description of the current experiment.
    warnings
        Warnings of the FMUs, each text once.
    """

    system: System
    session: Session
    calibration: Calibration
    recommended: Mapping[str, Value]
    gammas: Mapping[int, float]
    settings: Mapping[str, float]
    rig_observer: str = OBSERVERS[0]
    progress: Callable[[str], None] = lambda text: None
    warnings: dict[str, None] = field(default_factory=dict)

    def run(
        self,
        stop_time: float,
        *parameters: Mapping[str, Value],
        mass: float = LIGHT,
        record: Sequence[str] | None = None,
    ) -> Result:
        """Run the system with some parameters.

        Parameters
        ----------
        stop_time
            In s; rounded to whole steps.
        parameters
            ``component.variable`` to value; later ones win.
        mass
            The driver's mass, in kg.
        record
            Outputs to record; all where None.

        Raises
        ------
        CosimError
            If the run does not reach its stop time.
        """
        merged = driver_mass(mass)
        for given in parameters:
            merged |= given
        result = self.session.run(round(stop_time / STEP) * STEP, STEP, merged, record)
        self.warnings.update(dict.fromkeys(result.warnings))
        if result.error is not None:
            raise result.error
        return result

    def ideal(self) -> dict[str, Case]:
        """Return the seats of the simulation, of the paper's equations alone, by name."""
        return {
            "uncontrolled": Case("Uncontrolled", control(False), _STYLES["uncontrolled"]),
            "controlled": Case("Observer 1", observer(self.gammas[1]), _STYLES["controlled"]),
        }

    def seats(self) -> dict[str, Case]:
        """Return the seats of the experiments, by name.

        The paper does not say which observer they had; by default that of its Fig. 8 is taken. ``ideal`` is the
        controlled seat without the imperfections of actuator and sensors. The passive seat has the prototype's sensors.
        """
        calibration = self.calibration
        active = named_observer(self.rig_observer)
        sensors = {name: value for name, value in calibration.prototype.items() if name.startswith(_SENSORS)}
        parameters = {
            "passive": {**calibration.load, **calibration.passive, **sensors, **control(False)},
            "uncontrolled": {**calibration.load, **calibration.prototype, **control(False)},
            "controlled": {**calibration.load, **calibration.prototype, **active},
            "ideal": {**calibration.load, **active},
        }
        return {name: Case(name.capitalize(), values, _STYLES[name]) for name, values in parameters.items()}

    @property
    def lag_is_fitted(self) -> bool:
        """Whether the prototype's lag was fitted with its observer; if not, the controlled seat is predicted."""
        return self.rig_observer == OBSERVERS[0]


@contextmanager
def open_runner(
    system: System, progress: Callable[[str], None] = lambda text: None, rig_observer: str = OBSERVERS[0]
) -> Iterator[ExperimentRunner]:
    """Load the FMUs of the seat suspension for the experiments of the paper.

    Parameters
    ----------
    system
        From :func:`seat_cosim.scenarios.seat_suspension`.
    progress
        Called with a description of the current experiment.
    rig_observer
        Observer of the prototype on the rig, one of :data:`seat_cosim.scenarios.OBSERVERS`.

    Yields
    ------
    ExperimentRunner
        With this project's calibration and recommended gains, and the paper's observers and design.
    """
    calibration = Calibration.read(system)
    with system.open() as session:
        yield ExperimentRunner(
            system,
            session,
            calibration,
            recommended=gains("recommended"),
            gammas={number: gamma.value for number, gamma in design.OBSERVERS.items()},
            settings={"alpha": design.ALPHA.value, "P_2": design.P_2.value, "lambda": design.LAMBDA.value},
            rig_observer=rig_observer,
            progress=progress,
        )


_SENSORS = "seat.sensor."
"""Begin of the names of the sensors' parameters."""

_STYLES: dict[str, dict[str, Any]] = {
    "passive": {"color": "C2"},
    "uncontrolled": {"color": "0.45", "linestyle": "--"},
    "controlled": {"color": "C0"},
    "ideal": {"color": "C1", "linestyle": ":"},
}


def change(value: float, reference: float) -> float:
    """Return the relative difference of a value from a reference, in %.

    Parameters
    ----------
    value, reference
        Numbers of one unit.
    """
    return 100.0 * (value / reference - 1.0)


def extent(values: Samples) -> tuple[float, float]:
    """Return the smallest and the largest value."""
    return float(values.min()), float(values.max())
