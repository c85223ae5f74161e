"""Hostile input: every target of the fuzzing, bounded; `make fuzz` runs them for longer."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from seat_cosim.components import build
from tests.system.hostile import extracted_fmus, fuzz

SEED = 20240607
"""The same cases with every run of the tests."""

CASES = {"calls": 25, "states": 150, "readers": 25}
"""By kind of target: so many that all of them take a minute of one core."""

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="loads Linux binaries")


def groups() -> dict[str, list[str]]:
    """Name what runs in one process: targets of one kind and flavour, as a process takes a second to start.

    Those with sanitizers are for the longer run: to compile one takes 5 s, and `test_native_api` has its own. So is
    MDF4: asammdf reads some damaged files without end.
    """
    found: dict[str, list[str]] = {}
    for target in fuzz.TARGETS:
        if not target.endswith("sanitized") and target != "readers/mdf4":
            found.setdefault(target.rpartition("/")[0], []).append(target)
    return found


@pytest.fixture(scope="session")
def built(fmu_folder: Path, native: Path, fmus: Path) -> Path:
    """Folder of the FMUs of all flavours, and of a system of them."""
    from seat_cosim.scenarios import seat_suspension

    list(build(fmu_folder))
    system = seat_suspension(native / "fmi2")
    system.stop_time = 3.0
    system.save(fmu_folder / "SeatSuspension.ssp")
    return fmu_folder


@pytest.mark.parametrize(
    "group", [pytest.param(name, marks=[pytest.mark.long] if name == "values/python" else []) for name in groups()]
)
def test_property_holds(group: str, built: Path):
    if group == "readers" and not extracted_fmus.can_sanitize():
        pytest.skip("gcc is not installed")
    outcome = fuzz.play(groups()[group], built, SEED, CASES.get(group.partition("/")[0], 1))
    assert outcome.found is None, outcome.found
    assert outcome.cases > 0
