"""Evaluated systems: a system, and the names of the variables that an evaluation reads and sets."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from cosim.errors import SetupError, did_you_mean
from cosim.fmi.values import Value
from cosim.system import System
from cosim.units import IDENTITY, Unit, conversion
from seat_cosim.scenarios import KMH

_METRE, _ACCELERATION, _NEWTON = (
    Unit("m", (0, 1, 0, 0, 0, 0, 0, 0)),
    Unit("m/s2", (0, 1, -2, 0, 0, 0, 0, 0)),
    Unit("N", (1, 1, -2, 0, 0, 0, 0, 0)),
)


class Road(NamedTuple):
    """A class of excitation that is a road and a speed.

    Attributes
    ----------
    name
        Class of the road by ISO 8608.
    speed
        In km/h.

    Examples
    --------
    >>> Road.of("C60"), str(Road("D", 37.5))
    (Road(name='C', speed=60.0), 'D37.5')
    """

    name: str
    speed: float

    @classmethod
    def of(cls, text: str) -> Road:
        """Read a road and a speed.

        Parameters
        ----------
        text
            Such as ``C60``.

        Raises
        ------
        SetupError
            If it is none.
        """
        found = re.fullmatch(r"([A-Z])(\d+(?:\.\d+)?)", text)
        if found is None or not float(found[2]) > 0.0:
            raise SetupError(f"class {text}: expected a road and a speed in km/h, such as C60")
        return cls(found[1], float(found[2]))

    def __str__(self) -> str:
        return f"{self.name}{self.speed:g}"


@dataclass(frozen=True)
class SignalMap:
    """Names of the variables that an evaluation needs, as ``component.variable``.

    Attributes
    ----------
    floor_acceleration, seat_acceleration
        Outputs: acceleration of the floor, and of the place where the driver sits.
    driver_mass
        Parameters that take the driver's mass, in kg.
    excitation
        Parameters, with their values, under which the floor moves at random.
    excitation_class, seed
        Parameters that take the class and the seed of the excitation.
    speed
        Parameter that takes the speed in m/s, where a class is a road and a speed in km/h, such as ``C60``; None for
        classes that are the names of an enumeration.
    suspension_deflection, actuator_force
        Outputs; None for a system without.
    end_stop_travel
        Parameter that holds the deflection, in m to each side, at which the end stops are met (0: no end stops); None
        for a system without.
    end_stop_height
        Parameter that holds the height, in m, of static equilibrium above the middle of that travel; None for a system
        without.
    force_limit
        Parameter that holds the largest force of the actuator (0: none); None for a system without.
    noise_seed
        Parameter that takes the seed of the sensors' noise; None for a system without.
    sine
        Parameters, with their values, under which the floor moves as a sine.
    sine_frequency, sine_amplitude
        Parameters that take its frequency in Hz and the amplitude of its displacement in m.
    """

    floor_acceleration: str
    seat_acceleration: str
    driver_mass: tuple[str, ...]
    excitation: Mapping[str, Value]
    excitation_class: str
    seed: str
    suspension_deflection: str | None = None
    actuator_force: str | None = None
    end_stop_travel: str | None = None
    end_stop_height: str | None = None
    force_limit: str | None = None
    noise_seed: str | None = None
    sine: Mapping[str, Value] = field(default_factory=dict)
    sine_frequency: str | None = None
    sine_amplitude: str | None = None
    speed: str | None = None

    @property
    def outputs(self) -> dict[str, Unit]:
        """Outputs to record, and the SI units of the samples that an evaluation takes."""
        wanted = {
            self.floor_acceleration: _ACCELERATION,
            self.seat_acceleration: _ACCELERATION,
            self.suspension_deflection: _METRE,
            self.actuator_force: _NEWTON,
        }
        return {name: unit for name, unit in wanted.items() if name is not None}

    def parameters(self, excitation_class: str, mass: float, seed: int) -> dict[str, Value]:
        """Return the parameters of one ride.

        Parameters
        ----------
        excitation_class
            Name of the class.
        mass
            The driver's mass, in kg.
        seed
            Seed of the excitation.

        Returns
        -------
        dict
            ``component.variable`` to value.
        """
        return {
            **self.excitation,
            **self._of_class(excitation_class),
            self.seed: seed,
            **dict.fromkeys(self.driver_mass, mass),
        }

    def _of_class(self, name: str) -> dict[str, Value]:
        """Return the parameters of a class; raises SetupError for one that is no road and speed, where it must be."""
        if self.speed is None:
            return {self.excitation_class: name}
        road = Road.of(name)
        return {self.excitation_class: road.name, self.speed: road.speed / KMH}

    def within(self, system: System) -> SignalMap:
        """Return this map without the optional names that a system does not have.

        Parameters
        ----------
        system
            The system. Masses, deflection, force, its limit, travel, its height and the noise's seed are left out where
            there is no such variable.
        """

        def if_known(name: str | None) -> str | None:
            return name if name and system.has(name) else None

        return replace(
            self,
            suspension_deflection=if_known(self.suspension_deflection),
            actuator_force=if_known(self.actuator_force),
            end_stop_travel=if_known(self.end_stop_travel),
            end_stop_height=if_known(self.end_stop_height),
            force_limit=if_known(self.force_limit),
            noise_seed=if_known(self.noise_seed),
            driver_mass=tuple(name for name in self.driver_mass if system.has(name)),
        )

    def for_system(self, system: System, given: Mapping[str, Any]) -> SignalMap:
        """Return this map with other names, and without optional ones that a system does not have.

        Parameters
        ----------
        system
            The system that has the variables.
        given
            Field of this class to its value; the system must have these variables. Of the other fields, those of
            :meth:`within` are left out where there is no such variable.

        Raises
        ------
        SetupError
            With all names that do not fit the system.
        """
        known = self.within(system)
        if given.get("end_stop_travel"):  # the height belongs to the travel that it is known with, not to another one
            known = replace(known, end_stop_height=None)
        signals = replace(known, **given)
        problems = signals._problems(system)
        if problems:
            raise SetupError(*problems)
        return signals

    def _problems(self, system: System) -> list[str]:
        """Find the names that do not fit a system."""
        outputs = system.outputs()
        problems = []
        for name, unit in self.outputs.items():
            if name not in outputs:
                problems.append(
                    f"signal {name}: expected an output of {system.name}, got none{did_you_mean(name, outputs)}"
                )
            elif conversion(_unit(system, name), unit) is None:
                problems.append(f"signal {name}: expected a unit like {unit.name}, got {system.unit(name)}")
        if not self.driver_mass:
            problems.append(f"driver mass: expected a parameter of {system.name} that takes it, got none")
        parameters = (
            *(*self.driver_mass, *self.excitation, self.excitation_class, self.seed),
            *(self.end_stop_travel, self.end_stop_height),
            *(*self.sine, self.sine_frequency, self.sine_amplitude, self.speed),
        )
        for name in filter(None, parameters):
            try:
                system.variable(system.parse(name))
            except SetupError as error:
                problems += error.problems
        return list(dict.fromkeys(problems))


def _unit(system: System, name: str) -> Unit | None:
    ref = system.parse(name)
    return system.models[ref.component].defined_unit(system.variable(ref))


@dataclass(frozen=True)
class EvaluatedSystem:
    """A system to evaluate.

    Attributes
    ----------
    title
        Name in tables and figures.
    system
        The system, with all parameters that stay the same in every ride.
    signals
        Names of the variables that the evaluation reads and sets.
    test_travel
        Travel of the test in m, to each side, within which a system without end stops of its own must stay; None for
        unlimited travel.
    is_passive
        Whether it is the passive seat, with which others are compared.
    has_actuator
        Whether it has one: without, there are no criteria of the force.
    """

    title: str
    system: System
    signals: SignalMap
    test_travel: float | None = None
    is_passive: bool = False
    has_actuator: bool = True

    @property
    def end_stop_travel(self) -> float | None:
        """Travel in m, from its middle to each side, to the end stops, its own or the test's; None for none."""
        return self._value(self.signals.end_stop_travel, _METRE) or self.test_travel

    @property
    def end_stop_height(self) -> float:
        """Height in m of static equilibrium above the middle of the travel; 0 where the system does not know it."""
        return self._value(self.signals.end_stop_height, _METRE) or 0.0

    @property
    def force_limit(self) -> float | None:
        """Largest force of the actuator in N; None where it is not known."""
        return self._value(self.signals.force_limit, _NEWTON)

    @property
    def sensor_seed(self) -> int:
        """Seed of the sensors' noise in the first run; 0 for a system without."""
        name = self.signals.noise_seed
        return 0 if name is None else int(self.system.number(name))

    def _value(self, name: str | None, unit: Unit) -> float | None:
        """Return the value of a parameter in SI units; None for 0, and where there is no such parameter."""
        if name is None:
            return None
        transformation = conversion(_unit(self.system, name), unit) or IDENTITY
        return transformation.factor * self._number(name) or None

    def _number(self, name: str) -> float:
        return self.system.number(name)

    def in_si_units(self, name: str, values: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
        """Convert samples of an output to SI units.

        Parameters
        ----------
        name
            One of the signal map's outputs.
        values
            Samples in the FMU's unit; returned as they are where the FMU does not define it.
        """
        transformation = conversion(_unit(self.system, name), self.signals.outputs[name]) or IDENTITY
        return values if transformation == IDENTITY else transformation.factor * values + transformation.offset
