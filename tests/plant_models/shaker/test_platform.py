"""A platform that follows the profile: the lag's closed form, and limits that hold."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from fmus.component import ParameterError
from plant_models.shaker.interface import Inputs, Outputs, Parameters, Profile, RandomClass, SweepMode
from plant_models.shaker.shaker import TICK, advance, initialize, prepare
from tests.plant_models.shaker.test_noise import run


@pytest.mark.parametrize("bandwidth", [2.0, 10.0, 50.0])
@pytest.mark.parametrize("frequency", [1.0, 3.0, 12.0])
def test_the_response_to_a_sine_is_the_closed_form(bandwidth: float, frequency: float):
    """Amplitude and phase of 1/(1 - r^2 + 2 zeta r i), r = f/f_p; the tick costs up to (omega tick)^2/6."""
    p = Parameters(profile=Profile.sine, sine_frequency=frequency, sine_amplitude=0.01, platform_bandwidth=bandwidth)
    times = TICK * np.arange(1, 4001)
    rows = run(p, times)[2001:]  # the transient has gone: 4 s at 1.4 pi bandwidth
    carrier = np.exp(-2j * math.pi * frequency * times[2000:])
    response = 2j * (rows[:, 0] * carrier).mean() / 0.01
    ratio = frequency / bandwidth
    expected = 1.0 / complex(1.0 - ratio * ratio, 2.0 * p.platform_damping * ratio)
    assert abs(response / expected - 1.0) < (2 * math.pi * frequency * TICK) ** 2 / 6 + 2e-4
    print(f"{bandwidth:g} Hz, {frequency:g} Hz: {abs(response):.4f}, {math.degrees(cmath.phase(response)):.2f} degrees")


LIMITS = {"platform_stroke": 0.02, "platform_velocity_limit": 0.3, "platform_acceleration_limit": 5.0}
VIOLENT = [
    {"profile": Profile.sine, "sine_frequency": 0.7, "sine_amplitude": 0.2},
    {"profile": Profile.sine, "sine_frequency": 12.0, "sine_amplitude": 0.1},
    {"profile": Profile.bump, "bump_height": 1.0, "bump_speed": 3.0},
    {"profile": Profile.sweep, "sweep_mode": SweepMode.displacement, "sweep_displacement": 0.1, "sweep_duration": 10.0},
    {"profile": Profile.random, "random_class": RandomClass.EM5, "random_scale": 5.0},
]


@pytest.mark.parametrize("names", [[name] for name in LIMITS] + [list(LIMITS)], ids=lambda n: "+".join(n))
@pytest.mark.parametrize("violence", VIOLENT, ids=lambda v: f"{v['profile'].name}")
@pytest.mark.parametrize("bandwidth", [3.0, 20.0, 50.0])
def test_limits_hold_for_every_profile(violence: dict, names: list[str], bandwidth: float):
    p = Parameters(**violence, **{name: LIMITS[name] for name in names}, platform_bandwidth=bandwidth)
    rows = run(p, TICK / 4 * np.arange(1, 8001))
    for column, name in enumerate(LIMITS):
        if name in names:
            assert np.abs(rows[:, column]).max() <= LIMITS[name] * (1 + 1e-12), name
    assert np.abs(rows[:, 0]).max() > 0.25 * LIMITS["platform_stroke"], "it should move at all"


def test_stroke_is_used_up_to_its_end():
    p = Parameters(
        profile=Profile.sine, sine_frequency=0.2, sine_amplitude=0.2, platform_bandwidth=10.0, platform_stroke=0.05
    )
    assert np.abs(run(p, TICK * np.arange(1, 2001))[:, 0]).max() == pytest.approx(0.05, rel=0.01)


@pytest.mark.parametrize("profile", [Profile.sine, Profile.random], ids=lambda p: p.name)
def test_displacement_and_velocity_are_exact_integrals(profile: Profile):
    h = TICK / 4
    d, v, a = run(
        Parameters(profile=profile, platform_bandwidth=8.0, platform_acceleration_limit=1.0), h * np.arange(1, 3001)
    ).T
    assert np.abs(v[1:] - v[:-1] - h * a[:-1]).max() < 1e-15 * 3000
    assert np.abs(d[1:] - d[:-1] - h * (v[:-1] + h * a[:-1] / 2)).max() < 1e-15


def test_without_a_bandwidth_there_is_no_platform():
    assert prepare(Parameters()).platform is None
    with pytest.raises(ParameterError, match=r"expected platform\.bandwidth above 0 .* got 0\.0 Hz"):
        prepare(Parameters(platform_stroke=0.05))


def test_a_platform_at_rest_has_no_subnormal_states():
    c = prepare(Parameters(platform_bandwidth=10.0))
    state, _ = initialize(Inputs(), c, 0.0)
    state, _ = advance(state, Inputs(), c, 0.0, 1.0)
    assert state.platform_displacement != 0.0
    state, floor = advance(state, Inputs(), c, 1.0, 4.0)
    assert (state.platform_displacement, state.platform_velocity, floor) == (0.0, 0.0, Outputs())
