"""Components of this project, and the default experiment of their FMUs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fmus import FLAVOURS
from fmus.component import DefaultExperiment
from plant_models.driver.driver import SEATED_DRIVER
from plant_models.seat.seat import SEAT_PLANT
from plant_models.shaker.shaker import SHAKER
from plant_models.truck.truck import TRUCK_CAB
from seat_blocks.active_seat import ACTIVE_SEAT
from seat_blocks.passive_seat import PASSIVE_SEAT
from seat_blocks.semi_active_seat import SEMI_ACTIVE_SEAT
from seat_controller_fmu.controller import SEAT_CONTROLLER
from seat_controller_fmu.parameters import SAMPLE_TIME

if TYPE_CHECKING:  # the exporter takes long to load
    from fmus.export.fmu_file import BuildResult

COMPONENTS = (
    SEAT_CONTROLLER,
    SEAT_PLANT,
    SHAKER,
    SEATED_DRIVER,
    TRUCK_CAB,
    ACTIVE_SEAT,
    PASSIVE_SEAT,
    SEMI_ACTIVE_SEAT,
)
"""Components of which FMUs are built."""

EXPERIMENT = DefaultExperiment(stop_time=3.0, step_size=SAMPLE_TIME.value)
"""Default experiment of the FMUs: the paper's bump and its decay, with the controller's sample time as step size."""


def build(folder: Path, flavours: Sequence[str] = FLAVOURS, platforms: Sequence[str] = ()) -> Iterator[BuildResult]:
    """Build the FMUs of all components of this project.

    Parameters
    ----------
    folder
        Each flavour's FMUs go to the subfolder of its name.
    flavours
        Names from :data:`fmus.FLAVOURS`.
    platforms
        Platforms of native FMUs, see :data:`fmus.export.native_fmu.PLATFORMS`; the host's where empty.

    Returns
    -------
    iterator of BuildResult
        Each FMU after it was built.

    Raises
    ------
    BuildError
        If a build tool fails.
    """
    from fmus.export.build import build as build_all

    return build_all(COMPONENTS, EXPERIMENT, folder, flavours, platforms)
