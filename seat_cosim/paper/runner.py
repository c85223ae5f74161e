"""The bench the experiments run on: the FMUs, loaded once, and the seats that stand on it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from cosim.engine.session import Session
from cosim.fmi.values import Value
from cosim.metrics.samples import Samples
from cosim.results.result import Result
from cosim.system import System
from seat_cosim.paper.bump_test import Case
from seat_cosim.scenarios import control, driver_mass, observer

STEP = 0.002
"""Communication step and sample time, in s."""

RATE = 500.0
"""Samples a second."""

FLOOR = "shaker.floor_acceleration"
SEAT = "seat.seat_acceleration"
DRIVER = "seat.driver_acceleration"
DEFLECTION = "seat.suspension_deflection"
DEFLECTION_RATE = "seat.deflection_rate"
FRICTION = "seat.friction_force"
FORCE = "controller.force"

LIGHT, HEAVY = 55.0, 70.0
"""The paper's two loads, in kg."""


@dataclass(frozen=True)
class Calibration:
    """What the paper does not give, as parameters ``component.variable``, chosen so that its 55 kg numbers fit.

    Attributes
    ----------
    load
        What the experiments put on the seats.
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


@dataclass(frozen=True)
class Lab:
    """Runs what the experiments ask for.

    Attributes
    ----------
    system
        Of :func:`seat_cosim.scenarios.seat_suspension`.
    session
        It, loaded.
    calibration
        The parameters that are ours, not the paper's.
    recommended
        Gains that are ours, for any driver, as parameters of the controller.
    gammas
        Gamma of Observers 1 and 2, in s/kg2.
    settings
        All other symbols of Table 1, to their values in SI units.
    progress
        Called with what is being run.
    warnings
        What the FMUs warned of, each once.
    """

    system: System
    session: Session
    calibration: Calibration
    recommended: Mapping[str, Value]
    gammas: Mapping[int, float]
    settings: Mapping[str, float]
    progress: Callable[[str], None] = lambda text: None
    warnings: dict[str, None] = field(default_factory=dict)

    def run(
        self,
        stop_time: float,
        *parameters: Mapping[str, Value],
        mass: float = LIGHT,
        record: Sequence[str] | None = None,
    ) -> Result:
        """Run the system; later parameters win.

        Parameters
        ----------
        stop_time
            In s; rounded to whole steps.
        parameters
            ``component.variable`` to value.
        mass
            The driver's, in kg.
        record
            Outputs to record; all where None.

        Raises
        ------
        CosimError
            If the run does not reach its stop time.
        """
        merged = driver_mass(mass)
        for some in parameters:
            merged |= some
        result = self.session.run(round(stop_time / STEP) * STEP, STEP, merged, record)
        self.warnings.update(dict.fromkeys(result.warnings))
        if result.error is not None:
            raise result.error
        return result

    def ideal(self) -> dict[str, Case]:
        """Name the seats of the simulation, of the paper's equations alone."""
        return {
            "uncontrolled": Case("Uncontrolled", control(False), _STYLES["uncontrolled"]),
            "controlled": Case("Observer 1", observer(self.gammas[1]), _STYLES["controlled"]),
        }

    def seats(self) -> dict[str, Case]:
        """Name the seats of the experiments; the paper does not say with which observer: the one of its Fig. 8.

        ``ideal`` is the controlled one without the imperfections of actuator and sensors.
        """
        made = self.calibration
        active = observer(self.gammas[1])
        parameters = {
            "passive": {**made.load, **made.passive, **control(False)},
            "uncontrolled": {**made.load, **made.prototype, **control(False)},
            "controlled": {**made.load, **made.prototype, **active},
            "ideal": {**made.load, **active},
        }
        return {name: Case(name.capitalize(), values, _STYLES[name]) for name, values in parameters.items()}


_STYLES: dict[str, dict[str, Any]] = {
    "passive": {"color": "C2"},
    "uncontrolled": {"color": "0.45", "linestyle": "--"},
    "controlled": {"color": "C0"},
    "ideal": {"color": "C1", "linestyle": ":"},
}


def change(values: float, reference: float) -> float:
    """Return by how much a number differs from a reference, in %."""
    return 100.0 * (values / reference - 1.0)


def extent(values: Samples) -> tuple[float, float]:
    """Return the smallest and the largest."""
    return float(values.min()), float(values.max())
