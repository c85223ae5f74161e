"""Hostile input: every target of the fuzzing, bounded; `make fuzz` runs them for longer."""

from __future__ import annotations

import sys
from pathlib import Path

import fuzz
import pytest
import subjects

from fmus.build import build

SEED = 20240607
"""The same cases with every run of the tests."""

CASES = {"calls": 25, "states": 150, "readers": 40}
"""By kind of target: so many that all of them take a minute of one core."""

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="loads Linux binaries")

BOUNDED = [name for name in fuzz.TARGETS if not name.endswith("sanitized") or name.startswith("states")]


@pytest.fixture(scope="session")
def built(fmu_folder: Path, native: Path, fmus: Path) -> Path:
    """Folder of the FMUs of all flavours, and of a system of them."""
    from cosim.scenarios import seat_suspension

    list(build(fmu_folder))
    system = seat_suspension(native / "fmi2")
    system.stop_time = 3.0
    system.save(fmu_folder / "SeatSuspension.ssp")
    return fmu_folder


@pytest.mark.parametrize("target", BOUNDED)
def test_property_holds(target: str, built: Path):
    compiled = target.endswith("sanitized") or target == "readers/recording"
    if compiled and not subjects.can_sanitize():
        pytest.skip("gcc is not installed")
    outcome = fuzz.play(target, built, SEED, CASES.get(target.partition("/")[0], 1))
    assert outcome.found is None, outcome.found
    assert outcome.cases > 0
