"""The floor's profiles: values, derivatives, right limits."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from fmus.component import ParameterError
from plant_models.shaker.interface import Inputs, Outputs, Parameters, Profile, SweepMode
from plant_models.shaker.profiles import bump, sine, sweep
from plant_models.shaker.shaker import advance, initialize, prepare


def test_bump_has_its_height_in_the_middle_and_ends_at_zero():
    assert bump(0.4, 0.07, 0.8, 1.0).floor_displacement == pytest.approx(0.07)
    assert bump(0.8, 0.07, 0.8, 1.0) == Outputs()
    assert bump(5.0, 0.07, 0.8, 1.0) == Outputs()


def test_acceleration_is_the_right_limit_at_both_jumps():
    jump = 0.035 * (2 * math.pi / 0.8) ** 2
    assert bump(0.0, 0.07, 0.8, 1.0).floor_acceleration == pytest.approx(jump)
    assert bump(400 * 0.002, 0.07, 0.8, 1.0).floor_acceleration == 0.0
    assert bump(0.1 + 0.7, 0.07, 0.8, 1.0).floor_acceleration == 0.0  # 0.7999999999999999


SWEEP = Parameters(profile=Profile.sweep, sweep_duration=20.0)
DOWN = replace(SWEEP, sweep_start_frequency=15.0, sweep_stop_frequency=1.0, sweep_mode=SweepMode.displacement)
EVEN = replace(SWEEP, sweep_start_frequency=2.0, sweep_stop_frequency=2.0)

MOTIONS = {
    "bump": lambda t: bump(t, 0.07, 0.8, 1.0),
    "sine": lambda t: sine(t, 3.0, 0.006),
    "sweep": lambda t: sweep(t, SWEEP),
    "sweep down": lambda t: sweep(t, DOWN),
    "sweep of one frequency": lambda t: sweep(t, EVEN),
}


@pytest.mark.parametrize("time", [0.05, 0.21, 0.4, 0.77, 1.9, 2.1, 9.99, 10.01, 17.0, 18.1, 19.9, 20.1])
@pytest.mark.parametrize("name", MOTIONS)
def test_velocity_and_acceleration_are_the_derivatives(time: float, name: str):
    """Central differences: errors of step^2/6 times the third derivative, up to 2e3 m/s4 here."""
    step = 1e-5
    before, here, after = (MOTIONS[name](t) for t in (time - step, time, time + step))
    slope = (after.floor_displacement - before.floor_displacement) / (2 * step)
    assert slope == pytest.approx(here.floor_velocity, abs=1e-7)
    slope = (after.floor_velocity - before.floor_velocity) / (2 * step)
    assert slope == pytest.approx(here.floor_acceleration, abs=1e-5)


@pytest.mark.parametrize("p", [SWEEP, DOWN, EVEN], ids=["up", "down", "one frequency"])
def test_a_sweep_leads_from_rest_to_rest_without_a_jump(p: Parameters):
    assert sweep(0.0, p) == sweep(p.sweep_duration, p) == sweep(-1.0, p) == sweep(1e6, p) == Outputs()
    for time in (1e-6, p.sweep_duration - 1e-6):
        near = sweep(time, p)
        assert max(abs(near.floor_displacement), abs(near.floor_velocity), abs(near.floor_acceleration)) < 1e-4


def amplitudes(p: Parameters, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Times between the fades at which a signal is largest, and its magnitudes there."""
    t = np.arange(p.sweep_fade, p.sweep_duration - p.sweep_fade, 2e-4)
    x = np.abs([getattr(sweep(s, p), name) for s in t.tolist()])
    peaks = 1 + np.flatnonzero((x[1:-1] > x[:-2]) & (x[1:-1] >= x[2:]))
    return t[peaks], x[peaks]


def test_a_sweep_keeps_the_amplitude_of_its_mode():
    """The acceleration up to (beta/omega)^2/2 of it, here 0.17 % at the end of the first fade."""
    _, acceleration = amplitudes(SWEEP, "floor_acceleration")
    assert np.abs(acceleration - 1.0).max() < 0.002
    _, displacement = amplitudes(DOWN, "floor_displacement")
    assert np.abs(displacement / DOWN.sweep_displacement - 1.0).max() < 1e-4


def test_a_sweep_runs_through_its_frequencies_logarithmically():
    """Half periods between peaks of the displacement against the frequency in their middle."""
    t, _ = amplitudes(DOWN, "floor_displacement")
    middle = (t[1:] + t[:-1]) / 2
    expected = 15.0 * (1.0 / 15.0) ** (middle / 20.0)
    assert 0.5 / np.diff(t) == pytest.approx(expected, rel=0.02)


def test_fades_that_do_not_fit_are_refused():
    with pytest.raises(ParameterError, match=r"expected sweep.fade up to half the sweep.duration, got 2.0 s of 3.0 s"):
        prepare(replace(SWEEP, sweep_duration=3.0))
    prepare(replace(SWEEP, profile=Profile.bump, sweep_duration=3.0))


def test_profile_chooses_and_a_step_goes_to_its_end():
    c = prepare(Parameters(profile=Profile.sine))
    state, outputs = initialize(Inputs(), c, 0.0)
    assert outputs.floor_velocity == pytest.approx(0.006 * 6 * math.pi)
    assert advance(state, Inputs(), c, 0.1, 0.002)[1] == sine(0.1 + 0.002, 3.0, 0.006)
    c = prepare(SWEEP)
    assert advance(state, Inputs(), c, 5.0, 0.002)[1] == sweep(5.002, SWEEP)
