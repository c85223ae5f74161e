"""The system as one container FMU of another tool: it validates, and runs anywhere with the same bits.

Containers step their components as this master does, from the same times with the same values, so there is nothing to
round differently: in the same exchange the results are equal. A container hands over a discrete value at the end of the
step in which it was made, one row later than this master's table shows it (see ``here``).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.validation import validate_fmu

from cosim import System
from cosim.units import Linear
from seat_cosim.scenarios import driver_mass, seat_suspension
from tests.helpers.containers import checked, contain, contain_ssp, shown_as
from tests.helpers.peers import SIGNALS, differences, here, missing, run

STEP_SIZE = 0.002
STEPS = 500
FORCE = "controller.force"

if reason := missing("fmucontainer"):
    pytest.skip(f"fmucontainer: {reason}", allow_module_level=True)


def bump(native: Path, flavour: str = "fmi2") -> System:
    system = seat_suspension(native / flavour)
    system.stop_time = STEPS * STEP_SIZE
    return system


def contained(system: System, folder: Path, sequential: bool = True) -> Path:
    return contain(system, folder, STEP_SIZE, list(SIGNALS), sequential)


@pytest.mark.parametrize("flavour", ["fmi2", "fmi3"])
def test_a_container_validates(native: Path, tmp_path: Path, flavour: str):
    fmu = contained(bump(native, flavour), tmp_path)
    assert validate_fmu(str(fmu)) == []
    assert checked(fmu) == []


def test_the_toolbox_has_nothing_against_our_fmus(native: Path):
    for flavour in ("fmi2", "fmi3"):
        for fmu in sorted((native / flavour).glob("*.fmu")):
            assert checked(fmu) == []


@pytest.mark.parametrize(
    ("peer", "same", "other"),
    [("fmucontainer", "jacobi", "gauss-seidel"), ("fmucontainer, sequential", "gauss-seidel", "jacobi")],
)
def test_in_fmpy_a_container_gives_the_same_bits_in_the_same_exchange(
    native: Path, tmp_path: Path, peer: str, same: str, other: str
):
    system = bump(native)
    system.parameters = driver_mass(70.0)
    system.save(tmp_path / "bump.ssp")
    found = run(peer, tmp_path / "bump.ssp", STEPS, STEP_SIZE, list(SIGNALS))
    assert differences(found, here(system, same)) == [0.0, 0.0]
    assert np.greater(differences(found, here(system, other)), [1e-3, 0.1]).all()
    assert np.abs(found[FORCE]).max() > 100.0


def test_a_container_of_fmi_3_components_gives_the_same_bits(native: Path, tmp_path: Path):
    system = bump(native, "fmi3")
    fmu = contained(system, tmp_path)
    result = simulate_fmu(str(fmu), stop_time=system.stop_time, step_size=STEP_SIZE, output_interval=STEP_SIZE)
    found = {signal: result[shown_as(signal)][1:] for signal in SIGNALS}
    assert differences(found, here(system, "gauss-seidel")) == [0.0, 0.0]


@pytest.mark.parametrize("isolate", [[], ["box"]])
def test_a_container_runs_in_this_master(native: Path, tmp_path: Path, isolate: list[str]):
    inside = bump(native)
    box = System()
    box.add("box", contained(inside, tmp_path))
    result = box.simulate(STEPS * STEP_SIZE, STEP_SIZE, isolate=isolate)
    expected = inside.simulate(record=list(SIGNALS))
    acceleration, force = (result[f"box.{shown_as(signal)}"] for signal in SIGNALS)
    assert np.array_equal(acceleration, expected["seat.driver_acceleration"])
    assert np.array_equal(force[1:], expected[FORCE][:-1])  # the container does not say that it is sampled


def test_the_ssp_file_itself_becomes_a_container(native: Path, tmp_path: Path):
    """By the tool's own reader, which exchanges all at once and shows links only, by the names of the models."""
    system = bump(native)
    system.save(tmp_path / "bump.ssp")
    fmu = contain_ssp(tmp_path / "bump.ssp", STEP_SIZE)
    assert validate_fmu(str(fmu)) == []
    assert checked(fmu) == []
    shown = ["seatcontroller.force", "seatplant.suspension_deflection_measured"]
    settings = {"stop_time": system.stop_time, "step_size": STEP_SIZE, "output_interval": STEP_SIZE}
    found = simulate_fmu(str(fmu), output=shown, **settings)
    expected = system.simulate(algorithm="jacobi")
    assert np.array_equal(found[shown[0]][1:], expected[FORCE][:-1])
    assert np.array_equal(found[shown[1]], expected["seat.suspension_deflection_measured"])


def test_transformations_are_not_lost_in_silence(native: Path, tmp_path: Path):
    system = bump(native)
    system.disconnect("seat.force")
    system.connect(FORCE, "seat.force", Linear(-1.0))
    with pytest.raises(ValueError, match=r"seat\.force: expected connections without transformation"):
        contained(system, tmp_path)
