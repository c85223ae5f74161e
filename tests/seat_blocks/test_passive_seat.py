"""PassiveSeat against SeatPlant with the parameter set of a passive seat."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from seat_blocks.interface import PassiveParameters
from seat_blocks.parameters import PASSIVE_DAMPING, PASSIVE_FRICTION
from seat_blocks.passive_seat import PASSIVE_SEAT
from seat_cosim.scenarios import control, read_parameter_sets, seat_suspension
from tests.helpers.paths import NATIVE
from tests.seat_blocks.conftest import Block

FLOOR = {"shaker.profile": "random", "shaker.random.class": "EM2"}


@pytest.mark.parametrize("flavour", NATIVE)
def test_it_is_the_passive_seat_of_the_commands(native: Path, block: Block, flavour: str):
    parts = seat_suspension(native / flavour)
    passive = {**read_parameter_sets(["passive"], parts), **control(False)}
    expected = parts.simulate(stop_time=3.0, parameters={**FLOOR, **passive})
    found = block(flavour, "PassiveSeat").simulate(stop_time=3.0, parameters=FLOOR)
    for name in ("driver_acceleration", "seat_acceleration", "suspension_deflection", "floor_force", "friction_force"):
        assert np.abs(expected[f"seat.{name}"]).max() > 0.0
        assert (found[f"seat.{name}"] == expected[f"seat.{name}"]).all(), name
    assert not found["seat.force"].any()


def test_its_numbers_are_those_of_the_parameter_set(native: Path):
    values = read_parameter_sets(["passive"], seat_suspension(native / "fmi2"))
    assert values == {
        "seat.suspension_damping": PASSIVE_DAMPING.value,
        "seat.friction.alpha": PASSIVE_FRICTION.value,
    }


def test_it_has_neither_actuator_nor_sensors():
    names = [v.name for v in PASSIVE_SEAT.variables]
    assert not [name for name in names if name.startswith(("seat.actuator", "seat.sensor"))]
    assert "seat.end_stop.travel" in names
    seat = PassiveParameters().seat
    assert (seat.suspension_damping, seat.friction_alpha) == (PASSIVE_DAMPING.value, PASSIVE_FRICTION.value)
    assert (seat.actuator_delay, seat.acceleration_noise) == (0.0, 0.0)
