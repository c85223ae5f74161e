"""Each FMU alone in fmpy's own ``simulate_fmu``, driven by a CSV file of what it met in this master."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.util import read_csv

from cosim import Result, System
from seat_cosim.scenarios import seat_suspension

STEP_SIZE = 0.002
STOP_TIME = 1.0
ROUNDING = 1e-11
"""Share of the largest value; measured 7e-13, as fmpy interpolates inputs between the lines of the file."""

FMUS = {"shaker": "Shaker", "seat": "SeatPlant", "controller": "SeatController"}


@pytest.fixture(scope="module", params=["fmi2", "fmi3", "python"])
def folder(request: pytest.FixtureRequest, native: Path, fmus: Path) -> Path:
    return fmus if request.param == "python" else native / request.param


@pytest.fixture(scope="module")
def system(folder: Path) -> System:
    return seat_suspension(folder)


@pytest.fixture(scope="module")
def result(system: System) -> Result:
    return system.simulate(STOP_TIME, STEP_SIZE)


def write_inputs(path: Path, system: System, result: Result, name: str) -> None:
    """Write what a component's inputs were at t_k, over the step that begins there."""
    fed = {sink.variable: str(feed.source) for sink, feed in system.connections.items() if sink.component == name}
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(["time", *fed])
        writer.writerows(zip(*(c.tolist() for c in (result.time, *(result[s] for s in fed.values()))), strict=True))


@pytest.mark.parametrize("name", FMUS)
def test_fmpy_finds_what_this_master_found(folder: Path, system: System, result: Result, tmp_path: Path, name: str):
    write_inputs(tmp_path / "in.csv", system, result, name)
    inputs = read_csv(str(tmp_path / "in.csv")) if name != "shaker" else None
    found = simulate_fmu(
        str(folder / f"{FMUS[name]}.fmu"), stop_time=STOP_TIME, output_interval=STEP_SIZE, input=inputs
    )
    assert len(found) == len(result.time)
    model = system.models[name]
    for output in (variable.name for variable in model.outputs):
        theirs, ours = found[output].astype(float), result[f"{name}.{output}"]
        if model.is_sampled(output):  # fmpy shows it after the step in which it was computed
            theirs, ours = theirs[1:], ours[:-1]
        assert np.abs(theirs - ours).max() <= ROUNDING * np.abs(ours).max(), output
    assert np.ptp(found[model.outputs[0].name]) > 0.0
