"""The nominal model of the controller against the parameters of the plant."""

from __future__ import annotations

import pytest

from plant_models.seat import parameters as plant
from seat_controller_fmu import parameters as controller


@pytest.mark.parametrize("name", ["DRIVER_MASS", "SEAT_MASS", "SUSPENSION_STIFFNESS"])
def test_the_nominal_model_has_the_values_of_the_plant(name: str):
    """Value, unit, symbol and source: neither package imports the other."""
    assert getattr(controller, name) == getattr(plant, name)
