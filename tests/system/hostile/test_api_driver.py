"""The random driver over the native FMUs' API; a longer run is `make test-all`."""

from __future__ import annotations

from pathlib import Path

import pytest

from seat_cosim.components import COMPONENTS
from tests.helpers.paths import NATIVE
from tests.system.hostile.api_driver import ApiDriver
from tests.system.hostile.extracted_fmus import ExtractedFmu, extracted_fmu

SYSTEM = ("SeatController", "SeatPlant", "Shaker")
"""Components with kernels of their own; the others join these."""

CALLS = 200
"""Calls of one instance."""


@pytest.fixture(params=[(flavour, component.name) for flavour in NATIVE for component in COMPONENTS], ids=str)
def fmu(request: pytest.FixtureRequest, native: Path, tmp_path: Path) -> ExtractedFmu:
    flavour, name = request.param
    return extracted_fmu(native / flavour / f"{name}.fmu", flavour, tmp_path)


def drive(fmu: ExtractedFmu, seeds: range) -> None:
    """Drive instances at random; each has to be refused often enough and copied often enough to say something."""
    refused = copies = calls = 0
    for seed in seeds:
        driver = ApiDriver(fmu, seed)
        try:
            driver.run(CALLS)
        finally:
            driver.close()
        refused, copies, calls = refused + driver.refused, copies + driver.copies, calls + driver.calls
    assert calls == CALLS * len(seeds)
    assert 0.2 * calls < refused < 0.8 * calls
    assert copies > 0.02 * calls


def test_a_refused_call_leaves_no_trace_and_a_copy_behaves_like_its_original(fmu: ExtractedFmu):
    drive(fmu, range(100 if fmu.name in SYSTEM else 30))


@pytest.mark.long
def test_the_same_for_half_a_million_calls(fmu: ExtractedFmu):
    drive(fmu, range(1000, 3500))
