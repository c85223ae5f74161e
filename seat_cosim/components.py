"""All components of this project, and the experiment that their FMUs recommend."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fmus import FLAVOURS
from fmus.component import DefaultExperiment
from plant_models.seat.seat import SEAT_PLANT
from plant_models.shaker.shaker import SHAKER
from seat_controller_fmu.controller import SEAT_CONTROLLER
from seat_controller_fmu.parameters import SAMPLE_TIME

if TYPE_CHECKING:  # the exporter takes long to load
    from fmus.export.fmu_file import BuildResult

COMPONENTS = (SEAT_CONTROLLER, SEAT_PLANT, SHAKER)
"""What is built."""

EXPERIMENT = DefaultExperiment(stop_time=3.0, step_size=SAMPLE_TIME.value)
"""The paper's bump with its decay, in communication steps of the controller's sample time."""


def build(folder: Path, flavours: Sequence[str] = FLAVOURS, platforms: Sequence[str] = ()) -> Iterator[BuildResult]:
    """Build all components of this project; parameters as those of :func:`fmus.export.build.build`."""
    from fmus.export.build import build as build_all

    return build_all(COMPONENTS, EXPERIMENT, folder, flavours, platforms)
