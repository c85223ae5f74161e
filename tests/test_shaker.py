"""The floor's profiles: values, derivatives, right limits."""

from __future__ import annotations

import math

import pytest

from plant_models.shaker import advance, bump, floor_motion, initial, sine
from plant_models.shaker_interface import Inputs, Outputs, Parameters, Profile


def test_bump_has_its_height_in_the_middle_and_ends_at_zero():
    assert bump(0.4, 0.07, 0.8, 1.0).floor_displacement == pytest.approx(0.07)
    assert bump(0.8, 0.07, 0.8, 1.0) == Outputs()
    assert bump(5.0, 0.07, 0.8, 1.0) == Outputs()


def test_acceleration_is_the_right_limit_at_both_jumps():
    jump = 0.035 * (2 * math.pi / 0.8) ** 2
    assert bump(0.0, 0.07, 0.8, 1.0).floor_acceleration == pytest.approx(jump)
    assert bump(400 * 0.002, 0.07, 0.8, 1.0).floor_acceleration == 0.0
    assert bump(0.1 + 0.7, 0.07, 0.8, 1.0).floor_acceleration == 0.0  # 0.7999999999999999


@pytest.mark.parametrize("time", [0.05, 0.21, 0.4, 0.77])
@pytest.mark.parametrize("motion", [lambda t: bump(t, 0.07, 0.8, 1.0), lambda t: sine(t, 3.0, 0.006)])
def test_velocity_and_acceleration_are_the_derivatives(time: float, motion):
    step = 1e-5
    before, here, after = motion(time - step), motion(time), motion(time + step)
    slope = (after.floor_displacement - before.floor_displacement) / (2 * step)
    assert slope == pytest.approx(here.floor_velocity, abs=1e-8)
    slope = (after.floor_velocity - before.floor_velocity) / (2 * step)
    assert slope == pytest.approx(here.floor_acceleration, abs=1e-6)


def test_profile_chooses_and_a_step_goes_to_its_end():
    p = Parameters(profile=Profile.sine)
    assert floor_motion(0.1, p) == sine(0.1, 3.0, 0.006)
    state, outputs = initial(Inputs(), p, 0.0)
    assert outputs.floor_velocity == pytest.approx(0.006 * 6 * math.pi)
    assert advance(state, Inputs(), p, 0.1, 0.002)[1] == sine(0.1 + 0.002, 3.0, 0.006)
