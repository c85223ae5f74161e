"""All components of this project."""

from __future__ import annotations

from plant_models.seat import SEAT_PLANT
from plant_models.shaker import SHAKER
from seat_controller_fmu.controller import SEAT_CONTROLLER

COMPONENTS = (SEAT_CONTROLLER, SEAT_PLANT, SHAKER)
"""What is built."""
