"""A long run through the master: memory flat, time exact, the cost of a step what it was, the motion stationary."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2

from tests.helpers.soak import EVERY, HOUR, STEP_SIZE, WATCHED, soak

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc/self/statm")

PARTS = 12
LATE = 0.25
"""A quarter of a run: so much later, everything has warmed up."""


@pytest.mark.parametrize("stop_time", [0.5 * HOUR, pytest.param(24.0 * HOUR, marks=pytest.mark.long)])
def test_a_long_run_is_at_its_end_what_it_was_at_its_begin(native: Path, tmp_path: Path, stop_time: float):
    found = soak(native / "fmi2", stop_time, tmp_path)
    span = stop_time / PARTS

    # time: an integer times the step size, without error
    assert found.result.complete
    assert len(found.result.time) == round(stop_time / STEP_SIZE) // EVERY + 1
    assert found.result.time[-1] == stop_time
    assert found.time_error() == 0.0

    # memory: the looks at it take 24 bytes each, an allocator's page or two more
    settled = found.resident[found.times > LATE * stop_time]
    assert settled[-1] - settled[0] < 0.5e6

    # statistics: the variance of 12 root mean squares over the predicted one is chi-squared with 11 degrees
    for name in WATCHED:
        values = found.rms(name, span)
        ratio = (values.std(ddof=1) / values.mean() / found.predicted_scatter(name, span)) ** 2
        assert (PARTS - 1) * ratio < chi2.isf(1e-4, PARTS - 1)
    floor = found.rms("shaker.floor_acceleration", span)  # Gaussian: its scatter is not smaller either
    ratio = (floor.std(ddof=1) / floor.mean() / found.predicted_scatter("shaker.floor_acceleration", span)) ** 2
    assert (PARTS - 1) * ratio > chi2.ppf(1e-4, PARTS - 1)

    # cost: printed, not judged; machines are shared
    costs = found.step_costs(span)
    print(f"CPU time of a step: first {costs[0]:.3f} us, last {costs[-1]:.3f} us, median {np.median(costs):.3f} us")
    assert (np.diff(found.cpu) >= 0.0).all()


def test_a_floor_that_grows_is_not_stationary(native: Path, tmp_path: Path):
    found = soak(native / "fmi2", 600.0, tmp_path)
    found.result.values["seat.driver_acceleration"][:] *= np.linspace(1.0, 1.5, len(found.result.time))
    values = found.rms("seat.driver_acceleration", 50.0)
    ratio = (values.std(ddof=1) / values.mean() / found.predicted_scatter("seat.driver_acceleration", 50.0)) ** 2
    assert (PARTS - 1) * ratio > chi2.isf(1e-4, PARTS - 1)
