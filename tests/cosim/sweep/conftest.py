"""Systems of FMUs whose results have a closed form: y = 2 u + t, and one that brings its process down."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim import System
from tests.helpers.faulty import faulty_fmu


@pytest.fixture(scope="session")
def faulty_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sweep")
    for fault in ("ok", "error", "segfault"):
        system = System()
        system.add("cab", faulty_fmu(folder))
        system.add("seat", faulty_fmu(folder, fault))
        system.connect("cab.y", "seat.u")
        system.parameters = {"cab.u": 0.0}
        system.stop_time, system.step_size = 1.0, 0.01
        system.order = ("cab", "seat")
        system.save(folder / f"{fault}.ssp")
    return folder
