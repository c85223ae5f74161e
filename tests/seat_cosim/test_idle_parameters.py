"""Parameters that are refused as idle have no effect; others of mode, profile and driver have one."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from cosim.engine.run_options import RunOptions
from cosim.engine.session import Session
from cosim.errors import SetupError
from cosim.system import System
from plant_models.seat.interface import DriverModel
from plant_models.shaker.interface import Profile
from plant_models.truck.interface import Profile as RoadProfile
from seat_controller_fmu.interface import Mode
from seat_cosim.idle_parameters import refuse_idle
from seat_cosim.scenarios import TRUCK, seat_suspension
from tests.helpers.shell import Shell

CHOICES = [
    *({"controller.mode": mode.name} for mode in Mode),
    *({"shaker.profile": profile.name} for profile in Profile),
    *({"truck.road.profile": profile.name} for profile in RoadProfile),
    *({"seat.driver.model": model.name} for model in DriverModel),
]


@pytest.fixture(scope="module")
def seat(native: Path) -> System:
    return seat_suspension(native / "fmi2")


@pytest.fixture(scope="module")
def sessions(seat: System, native: Path) -> Iterator[dict[str, tuple[System, Session]]]:
    """Components to a system that has them, and its session."""
    driven = seat_suspension(native / "fmi2", TRUCK)
    with seat.open() as shaken, driven.open() as on_road:
        yield {**dict.fromkeys(seat.models, (seat, shaken)), TRUCK: (driven, on_road)}


def is_idle(name: str, system: System, choice: dict[str, str]) -> bool:
    try:
        refuse_idle([name], system, choice)
    except SetupError:
        return True
    return False


def changed(system: System, name: str) -> object:
    """Return another value of a parameter that its range allows."""
    component, variable = system.parse(name)
    about = system.models[component].variables[variable]
    if about.type == "Boolean":
        return not about.start
    if about.type in ("Enumeration", "Integer"):
        return 2 if int(about.start) == 1 else 1
    start = float(about.start)
    candidates = [start * 1.01, start * 0.99, start + 0.01, start - 0.01]
    within = [c for c in candidates if float(about.min or -np.inf) <= c <= float(about.max or np.inf) and c != start]
    return within[0]


@pytest.mark.parametrize("choice", CHOICES, ids=lambda choice: "".join(choice.values()))
def test_what_is_refused_has_no_effect(sessions: dict[str, tuple[System, Session]], choice: dict[str, str]):
    component = next(iter(choice)).partition(".")[0]
    seat, session = sessions[component]
    names = [
        f"{component}.{name}"
        for name, variable in seat.models[component].variables.items()
        if variable.causality == "parameter" and variable.type != "String"
    ]
    idle = [name for name in names if is_idle(name, seat, choice)]
    assert len(idle) > {TRUCK: 2, "seat": 1}.get(component, 8)

    recorded = [name for name in seat.outputs() if name != "controller.friction_estimate"]  # repeats its parameter

    def rows(**parameters: object) -> np.ndarray:
        options = RunOptions(0.3, parameters={**choice, **parameters}, record=recorded)
        return session.execute(options, options.check(seat)).rows

    as_it_is = rows()
    for name in idle:
        assert rows(**{name: changed(seat, name)}).tobytes() == as_it_is.tobytes(), name


@pytest.mark.parametrize(
    ("choice", "used"),
    [
        (
            {"controller.mode": "published"},
            ["controller.K1.rate", "controller.observer_gamma", "controller.link_length"],
        ),
        ({"controller.mode": "robust"}, ["controller.travel", "controller.robust.bias_rate", "controller.force_limit"]),
        ({"shaker.profile": "sine"}, ["shaker.sine.amplitude", "shaker.platform.bandwidth", "shaker.profile"]),
        ({"seat.driver.model": "seated"}, ["seat.driver.contact_stiffness", "seat.driver_mass"]),
        ({}, ["seat.driver_mass", "nobody.robust.x", "shaker.bump.height", "shaker.sine"]),
    ],
)
def test_what_is_used_is_not_refused(seat: System, choice: dict[str, str], used: list[str]):
    assert not [name for name in used if is_idle(name, seat, choice)]


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (
            "run bump --set shaker.sine.frequency=2",
            "shaker.sine.frequency: expected shaker.profile = sine, which uses it",
        ),
        ("run bump --set controller.travel=0.05", "controller.mode = robust, which uses it, got published"),
        ("run bump --mode robust --set controller.L1=-100", "controller.mode = published, which uses it, got robust"),
        ("simulate SeatSuspension --set shaker.file.fade=1", "expected shaker.profile = file, which uses it, got bump"),
        (
            "run bump --set seat.driver.contact_damping=2000",
            "seat.driver.contact_damping: expected seat.driver.model = seated, which uses it, got lumped",
        ),
        ("evaluate --set shaker.bump.height=0.05", "expected shaker.profile = bump, which uses it, got random"),
        ("compare off passive --set shaker.sweep.duration=9", "shaker.sweep.duration: expected shaker.profile = sweep"),
        (
            "simulate SeatSuspension --algorithm jacobi --order shaker,seat,controller",
            "--order with --algorithm jacobi",
        ),
    ],
)
def test_a_command_refuses_what_has_no_effect(native: Path, shell: Shell, command: str, message: str):
    words = command.split()
    where = ["--fmus", str(native)] if words[0] == "compare" else []
    code, _, error = shell(*words, *where)
    assert (code, len(error.splitlines())) == (2, 1), error
    assert message in error
