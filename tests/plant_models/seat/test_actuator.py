"""The actuator's limit, delay and lag against closed forms, mostly on a seat that is a free mass."""

from __future__ import annotations

import math
from itertools import accumulate
from pathlib import Path

import numpy as np
import pytest

from plant_models.seat.actuator import DELAY_LINE_CAPACITY
from plant_models.seat.interface import MAX_DELAY, Inputs, Parameters
from plant_models.seat.seat import State, advance, initialize, prepare
from tests.helpers.rig import Rig, bump

H = 0.002
FREE = {"friction_alpha": 0.0, "suspension_stiffness": 0.0, "cushion_stiffness": 0.0, "cushion_damping": 0.0}
MASS = Parameters().seat_mass


def pushed(forces: list[float], steps: list[float], **parameters: float) -> State:
    """Push a free seat with one force after the other; it starts at rest without force."""
    c = prepare(Parameters(**FREE, **parameters))
    state, _ = initialize(Inputs(), c, 0.0)
    times = accumulate([0.0, *steps])
    for force, time, step in zip(forces, times, steps, strict=False):
        state, _ = advance(state, Inputs(force=force), c, time, step)
    return state


def moved(forces: list[float], times: list[float], end: float) -> tuple[float, float]:
    """Velocity and displacement of the seat's mass under forces that each begin at a time."""
    changes = np.diff([0.0, *forces])
    since = np.maximum(end - np.array(times), 0.0)
    return float(changes @ since / MASS), float(changes @ since**2 / 2 / MASS)


# ---- lag -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("time_constant", [1e-6, 1e-4, 2e-3, 0.05, 2.0])
@pytest.mark.parametrize("step", [1e-4, H, 7.3e-3])
def test_a_lag_answers_a_step_exponentially_and_moves_a_free_mass_exactly(time_constant: float, step: float):
    count, force = 40, 100.0
    state = pushed([force] * count, [step] * count, actuator_time_constant=time_constant)
    t = count * step
    left = -math.expm1(-t / time_constant)
    assert state.actuator.force == pytest.approx(force * left, rel=1e-11)
    velocity = force / MASS * (t - time_constant * left)
    displacement = force / MASS * (t * t / 2 - time_constant * (t - time_constant * left))
    scale = force / MASS * t  # cancellation leaves digits of this size
    assert state.masses.seat_velocity == pytest.approx(velocity, rel=1e-9, abs=1e-13 * scale)
    assert state.masses.seat_displacement == pytest.approx(displacement, rel=1e-9, abs=1e-13 * scale * t)


def test_a_lag_fades_to_zero_and_not_to_subnormal_numbers():
    state = pushed([100.0] * 5 + [0.0] * 200, [H] * 205, actuator_time_constant=1e-3)
    assert state.actuator.force == 0.0


# ---- delay -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("delay", [1e-5, 1.3e-3, H, 0.0137, 0.1, MAX_DELAY])
@pytest.mark.parametrize("step", [H, H / 4, 5e-3])
def test_a_delay_shifts_by_any_time_exactly_at_any_step_size(delay: float, step: float):
    random = np.random.default_rng(5)
    every = max(1, round(H / step))  # the force changes every 2 ms or with every longer step
    count = round(0.6 / step)
    values = random.normal(0.0, 100.0, count // every + 1)
    forces = [float(values[k // every]) for k in range(count)]
    times = [k * step for k in range(count)]
    state = pushed(forces, [step] * count, actuator_delay=delay)
    velocity, displacement = moved(forces, [t + delay for t in times], count * step)
    assert state.masses.seat_velocity == pytest.approx(velocity, rel=1e-9)
    assert state.masses.seat_displacement == pytest.approx(displacement, rel=1e-9)


def test_step_sizes_may_change_while_forces_are_on_their_way():
    random = np.random.default_rng(6)
    steps = list(random.uniform(1e-3, 6e-3, 200))
    forces = list(random.normal(0.0, 100.0, 200))
    state = pushed(forces, steps, actuator_delay=0.0371)
    velocity, displacement = moved(forces, [t + 0.0371 for t in accumulate([0.0, *steps[:-1]])], sum(steps))
    assert state.masses.seat_velocity == pytest.approx(velocity, rel=1e-9)
    assert state.masses.seat_displacement == pytest.approx(displacement, rel=1e-9)


@pytest.mark.parametrize("step", [1e-5, 1e-4, 3e-4])
def test_at_tiny_steps_a_force_is_late_by_a_128th_of_the_delay_at_most(step: float):
    """The value of the force is the time of its command."""
    delay = 0.05
    c = prepare(Parameters(**FREE, actuator_delay=delay))
    state, _ = initialize(Inputs(), c, 0.0)
    for k in range(round(0.15 / step)):
        state, _ = advance(state, Inputs(force=k * step), c, k * step, step)
        assert state.actuator.line_length <= 2 * DELAY_LINE_CAPACITY
        age = k * step - state.actuator.force
        if k * step > 2 * delay:
            assert delay - step - 1e-12 < age < delay * (1 + 1 / DELAY_LINE_CAPACITY) + 2 * step


def test_a_delay_in_the_seat_is_one_in_the_loop(native: Path):
    """Three samples, with Observer 1: the same as a host that holds the force back, to rounding."""
    with Rig(native / "fmi2") as rig:
        outside = rig.run(bump(1.0), {}, delay=3)
        inside = rig.run(bump(1.0), {"seat.actuator.delay": 3 * H})
        prompt = rig.run(bump(1.0), {})
    assert np.abs(inside.acceleration - outside.acceleration).max() < 1e-9
    assert np.abs(prompt.acceleration - outside.acceleration).max() > 0.01


# ---- limit, and all together -----------------------------------------------------------------------------------------


def test_the_force_is_clipped_before_it_is_delayed():
    limited = pushed([400.0, -1e6, 50.0] * 50, [H] * 150, actuator_force_limit=120.0, actuator_delay=0.013)
    clipped = pushed([120.0, -120.0, 50.0] * 50, [H] * 150, actuator_delay=0.013)
    assert limited == clipped
    assert limited != pushed([400.0, -1e6, 50.0] * 50, [H] * 150, actuator_delay=0.013)


def test_the_delayed_force_is_lagged():
    delay, time_constant, count = 0.0137, 0.004, 20
    state = pushed([300.0] * count, [H] * count, actuator_force_limit=100.0, actuator_delay=delay,
                   actuator_time_constant=time_constant)  # fmt: skip
    assert state.actuator.force == pytest.approx(-100.0 * math.expm1(-(count * H - delay) / time_constant), rel=1e-11)


def test_the_actuator_is_in_steady_state_at_the_start():
    c = prepare(Parameters(actuator_force_limit=50.0, actuator_delay=0.01, actuator_time_constant=0.01))
    state, outputs = initialize(Inputs(force=80.0), c, 0.0)
    assert outputs.seat_acceleration == pytest.approx(50.0 / MASS, rel=1e-15)
    assert state.actuator.force == 50.0
    state, _ = advance(state, Inputs(force=80.0), c, 0.0, H)
    assert state.actuator.line_length == 0
    assert state.actuator.force == 50.0
