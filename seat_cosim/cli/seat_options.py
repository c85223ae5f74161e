"""Options of commands that run the seat suspension: its FMUs, driver, gains, observer and parameters."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, TypeVar

import click

from cosim.engine.structure import Structure
from cosim.fmi.values import Value
from cosim.system import System
from fmus import FLAVOURS
from seat_cosim import carried, choices, scenarios
from seat_cosim.cli.effect import refuse_without_effect
from seat_cosim.cli.options import parameters_option, set_option, settings
from seat_cosim.cli.paths import with_user_paths
from seat_cosim.evaluation.installation import Installation
from seat_cosim.evaluation.seat import installed
from seat_cosim.scenarios import Scenario

Command = TypeVar("Command", bound=Callable[..., Any])

OPTIONS: dict[str, Callable[[Any], Any]] = {
    "driver_mass": click.option(
        "--driver-mass",
        type=float,
        metavar="KG",
        help="The driver's mass, for seat and controller alike [default: 55].",
    ),
    "mode": click.option(
        "--mode",
        type=click.Choice(["published", "robust"]),
        help="Control law; robust knows the seat's actuator and travel [default: published].",
    ),
    "gains": click.option(
        "--gains",
        metavar="NAME|FILE",
        help="A preset (published, table1-printed, recommended, equal-rate) or a gains.json.",
    ),
    "observer": click.option(
        "--observer",
        type=click.Choice(scenarios.OBSERVERS),
        help="The paper's Observer 1 or 2, or Observer 1 with one rate at all masses [default: 1].",
    ),
    "control": click.option(
        "--control",
        type=click.Choice(["on", "off", "passive"]),
        help="Controller on or off; passive: off, in the well-tuned passive seat [default: on].",
    ),
    "parameter_files": parameters_option,
    "settings": set_option,
}
"""Field of :class:`SeatOptions` to the option that fills it."""

_FMU_OPTIONS = (
    click.option(
        "--flavour", type=click.Choice(FLAVOURS), default=FLAVOURS[0], show_default=True, help="Which FMUs to use."
    ),
    click.option(
        "--fmus",
        "fmus_folder",
        type=click.Path(path_type=Path),
        help="Folder with a subfolder for the flavour [default: fmus where it has FMUs, else those of the package].",
    ),
)


@dataclass(frozen=True)
class SeatOptions:
    """What a command line says about the seat suspension; None or empty where it says nothing.

    Attributes
    ----------
    flavour, fmus_folder
        Flavour of the FMUs, and the folder that has a subfolder for it; where None, see
        :func:`seat_cosim.carried.fmu_folder`.
    parameter_files
        Parameter sets, by name or file.
    mode
        ``published`` or ``robust``.
    gains
        Preset or file.
    observer
        One of :data:`seat_cosim.scenarios.OBSERVERS`.
    control
        ``on``, ``off`` or ``passive``.
    driver_mass
        In kg.
    settings
        Single parameters, as ``component.variable=value``.
    """

    flavour: str
    fmus_folder: Path | None
    parameter_files: tuple[str, ...] = ()
    mode: str | None = None
    gains: str | None = None
    observer: str | None = None
    control: str | None = None
    driver_mass: float | None = None
    settings: tuple[str, ...] = ()

    def system(self, floor: str = scenarios.SHAKER) -> System:
        """Return the seat suspension of the chosen FMUs, with its default parameters.

        Parameters
        ----------
        floor
            Component that moves the floor, a key of :data:`seat_cosim.scenarios.FLOORS`.
        """
        return scenarios.seat_suspension(carried.fmu_folder(self.flavour, self.fmus_folder), floor)

    def parameters(self, system: Structure, before: Mapping[str, Value] | None = None) -> dict[str, Value]:
        """Return the parameters that the options set.

        Later ones win: mode, parameter sets, gains, observer, control, driver's mass, single parameters.

        Parameters
        ----------
        system
            System whose parameters they are.
        before
            Parameters that hold where the options say nothing; a control law may depend on them.

        Returns
        -------
        dict
            ``component.variable`` to value, without those before.

        Raises
        ------
        SetupError
            If a set, gains or a setting cannot be read.
        """
        chosen = {name: getattr(self, name) for name in ("gains", "observer", "control", "driver_mass", "mode")}
        chosen["parameter_sets"] = self.parameter_files or None
        given = with_user_paths(settings(self.settings, system), system)
        return choices.parameters(chosen, given, system, before)

    def ride(self, scenario: Scenario, system: Structure) -> dict[str, Value]:
        """Return the parameters of a scenario, with what the options say.

        Parameters
        ----------
        scenario
            Its floor; a truck's seat has the end stops of a test.
        system
            System whose parameters they are.

        Returns
        -------
        dict
            ``component.variable`` to value.
        """
        stops = installed(system, Installation()) if scenario.floor == scenarios.TRUCK else {}
        given = {**scenario.parameters, **stops}
        return {**given, **self.parameters(system, given)}

    def check(self) -> None:
        """Check that every option has an effect; to be called by a command.

        Raises
        ------
        SetupError
            If one has none beside the others.
        """
        if self.gains:
            refuse_without_effect(["observer"], f"--gains {self.gains}", "gains have an observer of their own")
        if self.control in ("off", "passive"):
            refuse_without_effect(
                ["mode", "gains", "observer"], f"--control {self.control}", "the controller gives no force"
            )
        if self.mode == "robust":
            refuse_without_effect(
                ["gains", "observer"], "--mode robust", "the mode has a law and an observer of its own"
            )

    @property
    def choices(self) -> list[str]:
        """Names of what was chosen, for a title."""
        named = {"mode": self.mode, "gains": self.gains, "Observer": self.observer, "control": self.control}
        found = [f"{name} {choice}" for name, choice in named.items() if choice]
        return found + [Path(file).stem for file in self.parameter_files]


def seat_options(*names: str) -> Callable[[Command], Command]:
    """Return a decorator that gives a command options about the seat suspension.

    The command gets them as one argument ``seat``, a :class:`SeatOptions`.

    Parameters
    ----------
    names
        Keys of :data:`OPTIONS`; ``--flavour`` and ``--fmus`` are added in any case.
    """

    def decorate(command: Command) -> Command:
        @functools.wraps(command)
        def with_seat(**arguments: Any) -> Any:
            given = {field.name: arguments.pop(field.name) for field in fields(SeatOptions) if field.name in arguments}
            seat = SeatOptions(**given)
            seat.check()
            return command(seat=seat, **arguments)

        decorated: Any = with_seat
        for option in reversed([*(OPTIONS[name] for name in names), *_FMU_OPTIONS]):
            decorated = option(decorated)
        return decorated  # type: ignore[no-any-return]

    return decorate
