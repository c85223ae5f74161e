"""The co-simulation against implicit solutions: golden data from outside, and the tests' own solver.

Bounds: 0.1 % relative RMS in the driver's acceleration, 0.5 % in the deflection, 0.1 % in their peaks. Measured:
0.005 to 0.02 % in the acceleration; what remains is the floor's extrapolation over a step.
"""

from __future__ import annotations

import numpy as np
import pytest

from cosim import System
from seat_cosim.scenarios import SCENARIOS, control, driver_mass
from tests.helpers.compare import relative_peak, relative_rms
from tests.helpers.files import read_csv
from tests.helpers.paths import DATA
from tests.helpers.reference import Case, Floor, bump, sine, solve

BOUNDS = {"driver_acceleration": 1e-3, "suspension_deflection": 5e-3}
PEAK_BOUND = 1e-3
H = 0.002

GOLDEN = {"bump55_uncontrolled": control(False), "bump55_observer1": control(True)}


def errors(result, expected: dict[str, np.ndarray]) -> dict[str, tuple[float, float]]:
    return {
        name: (
            relative_rms(result[f"seat.{name}"], expected[name]),
            relative_peak(result[f"seat.{name}"], expected[name]),
        )
        for name in BOUNDS
    }


def check(found: dict[str, tuple[float, float]]) -> None:
    for name, (rms, peak) in found.items():
        print(f"{name}: relative RMS {rms:.2e}, relative peak {peak:.2e}")
        assert rms < BOUNDS[name]
        assert peak < PEAK_BOUND


@pytest.mark.parametrize("name", GOLDEN)
def test_bump_agrees_with_the_golden_data(system: System, name: str):
    expected = read_csv(DATA / f"{name}.csv")
    result = system.simulate(3.0, H, {**SCENARIOS["bump"].parameters, **GOLDEN[name]})
    assert len(result.time) == len(expected["time"])
    check(errors(result, expected))
    force = result["controller.force_demand"][:-1]
    if name == "bump55_observer1":
        assert relative_rms(force, expected["force_demand"][:-1]) < 1e-3
        assert (
            relative_rms(result["controller.disturbance_estimate"][:-1], expected["disturbance_estimate"][:-1]) < 1e-3
        )
    else:
        assert not force.any()


@pytest.mark.parametrize(
    ("case", "scenario", "floor"),
    [
        (Case(m_b=70.0), "bump", bump()),
        (Case(m_b=70.0, enabled=False), "bump", bump()),
        (Case(m_b=55.0, gamma=-1e-6), "bump", bump()),
        (Case(m_b=55.0), "sine", sine()),
        (Case(m_b=70.0, enabled=False), "sine", sine()),
    ],
    ids=["bump 70 kg", "bump 70 kg uncontrolled", "bump Observer 2", "sine 55 kg", "sine 70 kg uncontrolled"],
)
def test_runs_agree_with_the_implicit_solver(system: System, case: Case, scenario: str, floor: Floor):
    steps = 1000
    expected = solve(case, floor, steps)
    parameters = {**SCENARIOS[scenario].parameters, **driver_mass(case.m_b), **control(case.enabled)}
    result = system.simulate(steps * H, H, {**parameters, "controller.observer_gamma": case.gamma})
    check(errors(result, expected))


@pytest.mark.slow
def test_the_solver_itself_agrees_with_the_golden_data():
    expected = read_csv(DATA / "bump55_observer1.csv")
    found = solve(Case(), bump(), 500)
    for name in ("driver_acceleration", "suspension_deflection", "force", "friction_force"):
        assert relative_rms(found[name][:500], expected[name][:500]) < 1e-8


def test_a_shaker_that_steps_first_fails_these_bounds(system: System):
    """What the order is for: the seat would feel the floor of the step's end."""
    expected = read_csv(DATA / "bump55_uncontrolled.csv")
    system.order = ("shaker", "controller", "seat")
    result = system.simulate(3.0, H, control(False))
    assert errors(result, expected)["driver_acceleration"][0] > 10 * BOUNDS["driver_acceleration"]


def test_a_floor_without_its_velocity_fails_these_bounds(fmus, system: System):
    held = System()
    for name, model in system.models.items():
        held.add(name, model.path)
    for sink, feed in system.connections.items():
        if sink.variable != "floor_velocity":
            held.connect(str(feed.source), str(sink))
    held.order = system.order
    result = held.simulate(3.0, H, control(False))
    expected = read_csv(DATA / "bump55_uncontrolled.csv")
    assert errors(result, expected)["driver_acceleration"][0] > BOUNDS["driver_acceleration"]
