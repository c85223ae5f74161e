"""The numbers of docs/explanation/seated-driver.md: explicit coupling of seat and driver, alone and as FMUs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studies import seated_driver
from studies.seated_driver import RIDES, SEAT, coupled_system, coupling_errors, curves, longest_step, modes


def test_the_damping_of_the_page():
    found = {
        (order, step_size): modes(SEAT, step_size, order)
        for order in (None, "driver, seat", "jacobi")
        for step_size in (2e-3, 1e-3)
    }
    damping = {key: (round(seat.damping, 4), round(body.damping, 3)) for key, (seat, body) in found.items()}
    assert damping == {
        (None, 2e-3): (0.0030, 0.646),
        (None, 1e-3): (0.0030, 0.646),
        ("driver, seat", 2e-3): (0.0005, 0.648),
        ("driver, seat", 1e-3): (0.0018, 0.647),
        ("jacobi", 2e-3): (0.0053, 0.645),
        ("jacobi", 1e-3): (0.0041, 0.645),
    }
    assert longest_step(SEAT, "driver, seat") == pytest.approx(2.4)
    assert longest_step(replace(SEAT, suspension_damping=300.0), "jacobi") == pytest.approx(10.3)


def test_the_table_of_curves_on_the_page():
    mass, head = curves(80.0, np.array([2.0, 5.0, 10.0, 20.0]))
    assert mass.round(2).tolist() == [1.15, 1.61, 0.56, 0.23]
    assert head.round(2).tolist() == [1.18, 1.76, 0.67, 0.31]
    assert seated_driver.lumped(np.array([5.0])).round(2).tolist() == [1.38]


def test_the_fmus_deviate_as_the_page_says(native: Path):
    parameters, stop = RIDES["bump, uncontrolled"]
    pelvis, pelvis_rms, head, _ = coupling_errors(2e-3, "driver, seat", parameters, stop, native / "fmi3")
    assert (pelvis, pelvis_rms, head) == pytest.approx((2.0, 1.0, 1.8), abs=0.06)


def test_nothing_is_reported_of_a_system_with_a_driver_outside(native: Path):
    """No unconnected input, no algebraic loop within a step."""
    system = coupled_system("driver, seat", native / "fmi2")
    assert system.notes({"seat.driver.model": "external"}) == []
