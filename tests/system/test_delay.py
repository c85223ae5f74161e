"""Delay margins of the sampled loop against time simulations through the FMUs, without friction and force limit."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from plant_models.seat.interface import Parameters as Seat
from seat_controller_fmu.design.gains import preset
from seat_controller_fmu.design.sampled_loop import delay_margin
from seat_controller_fmu.parameters import OBSERVERS
from tests.helpers.rig import LINEAR, Rig, bump, driver, settles

MASSES = (45.0, 55.0, 80.0, 120.0)
KICK = bump(8.0, height=0.001)


@pytest.fixture(scope="module")
def rig(fmus: Path) -> Iterator[Rig]:
    with Rig(fmus) as loaded:
        yield loaded


@pytest.mark.parametrize("mass", MASSES)
@pytest.mark.parametrize("number", OBSERVERS)
def test_predicted_margins_agree_with_the_fmus_within_one_sample(rig: Rig, number: int, mass: float):
    gains, gamma = preset("published"), OBSERVERS[number].value
    parameters = gains.controller(mass)
    parameters.observer_gamma, parameters.L1, parameters.L2 = gamma, 0.0, 0.0
    samples = round(delay_margin(parameters, Seat(driver_mass=mass)) / 2.0)
    fmu = {**LINEAR, **driver(mass), "controller.observer_gamma": gamma}
    assert settles(rig.run(KICK, fmu, samples - 1))
    assert not settles(rig.run(KICK, fmu, samples + 2))


def test_the_recommended_gains_settle_at_30_ms_and_the_published_do_not(rig: Rig):
    for name, expected in (("recommended", True), ("published", False)):
        gains = {f"controller.{key}": value for key, value in preset(name).parameters().items()}
        assert settles(rig.run(KICK, {**LINEAR, **gains, **driver(45.0)}, 15)) is expected
