"""What is evaluated: a system, and which of its variables are meant."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cosim.errors import SetupError, did_you_mean
from cosim.fmi.values import Value
from cosim.system import System
from cosim.units import IDENTITY, Unit, conversion

_METRE, _ACCELERATION, _NEWTON = (
    Unit("m", (0, 1, 0, 0, 0, 0, 0, 0)),
    Unit("m/s2", (0, 1, -2, 0, 0, 0, 0, 0)),
    Unit("N", (1, 1, -2, 0, 0, 0, 0, 0)),
)


@dataclass(frozen=True)
class SignalMap:
    """Which variables of a system are meant, each as ``component.variable``.

    Attributes
    ----------
    floor, seat
        Outputs: acceleration of the floor, and where the driver sits.
    driver_mass
        Parameters that take the driver's mass, in kg.
    excitation
        What makes the floor move at random.
    excitation_class, seed
        Parameters that take the class and the seed.
    deflection, force
        Outputs: deflection of the suspension, force of the actuator; None for a system without.
    travel
        Parameter with the deflection in m, each way, at which the end stops are met, 0 for none; None without.
    """

    floor: str
    seat: str
    driver_mass: tuple[str, ...]
    excitation: Mapping[str, Value]
    excitation_class: str
    seed: str
    deflection: str | None = None
    force: str | None = None
    travel: str | None = None

    @property
    def signals(self) -> dict[str, Unit]:
        """Outputs to record, with the units their samples are wanted in."""
        wanted = {
            self.floor: _ACCELERATION,
            self.seat: _ACCELERATION,
            self.deflection: _METRE,
            self.force: _NEWTON,
        }
        return {name: unit for name, unit in wanted.items() if name is not None}

    def parameters(self, kind: str, mass: float, seed: int) -> dict[str, Value]:
        """Say what makes one ride: the excitation's class, the driver's mass in kg, the seed."""
        return {
            **self.excitation,
            self.excitation_class: kind,
            self.seed: seed,
            **dict.fromkeys(self.driver_mass, mass),
        }

    def found_in(self, system: System, given: Mapping[str, Any]) -> SignalMap:
        """Take these names for a system, others where they are given.

        Parameters
        ----------
        system
            Whose variables are meant.
        given
            Fields of this class to their values; these have to fit. Of the others, masses, deflection, force and
            travel are left out where the system has none of the name.

        Raises
        ------
        SetupError
            With all names that do not fit.
        """

        def there(name: str | None) -> str | None:
            return name if name and _exists(system, name) else None

        ports = replace(
            self,
            deflection=there(self.deflection),
            force=there(self.force),
            travel=there(self.travel),
            driver_mass=tuple(name for name in self.driver_mass if _exists(system, name)),
        )
        ports = replace(ports, **given)
        problems = ports._problems(system)
        if problems:
            raise SetupError(*problems)
        return ports

    def _problems(self, system: System) -> list[str]:
        """Find what does not fit a system."""
        outputs = system.outputs()
        problems = []
        for name, unit in self.signals.items():
            if name not in outputs:
                problems.append(
                    f"signal {name}: expected an output of {system.name}, got none{did_you_mean(name, outputs)}"
                )
            elif conversion(_unit(system, name), unit) is None:
                problems.append(f"signal {name}: expected a unit like {unit.name}, got {system.unit(name)}")
        if not self.driver_mass:
            problems.append(f"driver mass: expected a parameter of {system.name} that takes it, got none")
        parameters = (*self.driver_mass, *self.excitation, self.excitation_class, self.seed, self.travel)
        for name in filter(None, parameters):
            try:
                system.variable(system.parse(name))
            except SetupError as error:
                problems += error.problems
        return list(dict.fromkeys(problems))


def _exists(system: System, name: str) -> bool:
    return system.has(name)


def _unit(system: System, name: str) -> Unit | None:
    ref = system.parse(name)
    return system.models[ref.component].defined_unit(system.variable(ref))


@dataclass(frozen=True)
class EvaluatedSystem:
    """What is evaluated.

    Attributes
    ----------
    title
        A name for tables.
    system
        With all parameters it is evaluated with.
    ports
        Which of its variables are meant.
    """

    title: str
    system: System
    ports: SignalMap

    @property
    def travel(self) -> float | None:
        """Deflection in m, each way, at which the end stops are met; None where there are none."""
        if self.ports.travel is None:
            return None
        component, variable = self.system.parse(self.ports.travel)
        given = self.system.check_parameters({})[component].get(variable, self.system.start(self.ports.travel))
        return float(given) or None  # type: ignore[arg-type]  # a number, as its description says

    def converted(self, name: str, values: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
        """Convert samples of a signal to SI units; they are taken as they are where theirs is not defined."""
        transformation = conversion(_unit(self.system, name), self.ports.signals[name]) or IDENTITY
        return values if transformation == IDENTITY else transformation.factor * values + transformation.offset
