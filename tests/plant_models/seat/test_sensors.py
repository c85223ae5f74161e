"""The sensors' noise, bias, resolution and bandwidth."""

from __future__ import annotations

import math

import numpy as np
import pytest

from plant_models.seat.interface import Inputs, Outputs, Parameters
from plant_models.seat.seat import advance, initialize, prepare
from plant_models.seat.sensors import TICK, low_pass

H = 0.002
NOISE = {"acceleration_noise": 0.2, "deflection_noise": 1e-4}


def ride(count: int, step: float = H, force: float = 30.0, **parameters: float) -> list[Outputs]:
    """Outputs at 0, step, 2 step … under a force that changes sign twice a second."""
    c = prepare(Parameters(**parameters))
    state, outputs = initialize(Inputs(), c, 0.0)
    found = [outputs]
    for k in range(count):
        sign = 1.0 if math.floor(2.0 * k * step + 1e-9) % 2 else -1.0
        state, outputs = advance(state, Inputs(force=sign * force), c, k * step, step)
        found.append(outputs)
    return found


def sensor_errors(outputs: list[Outputs]) -> tuple[np.ndarray, np.ndarray]:
    """Differences between measurements and true values."""
    return (
        np.array([o.seat_acceleration_measured - o.seat_acceleration for o in outputs]),
        np.array([o.suspension_deflection_measured - o.suspension_deflection for o in outputs]),
    )


@pytest.mark.slow
def test_noise_is_normal_with_the_rms_of_the_parameter():
    """Mean, RMS and correlations within three standard errors."""
    count = 10_000
    for noise, rms in zip(sensor_errors(ride(count, **NOISE)), NOISE.values(), strict=True):
        assert abs(noise.mean()) < 3 * rms / math.sqrt(count)
        assert abs(noise.std() / rms - 1) < 3 / math.sqrt(2 * count)
        assert abs(np.corrcoef(noise[1:], noise[:-1])[0, 1]) < 3 / math.sqrt(count)
        assert (np.abs(noise) > 2 * rms).mean() == pytest.approx(0.0455, abs=3 * math.sqrt(0.0455 / count))


@pytest.mark.slow
def test_the_sensors_noises_are_independent_and_follow_the_seed():
    noises = [noise for seed in (1, 2) for noise in sensor_errors(ride(5000, sensor_seed=seed, **NOISE))]
    correlations = np.corrcoef(noises)[np.triu_indices(4, 1)]
    assert np.abs(correlations).max() < 4 / math.sqrt(5000)
    again = sensor_errors(ride(100, sensor_seed=2, **NOISE))
    assert (again[0] == noises[2][:101]).all()


@pytest.mark.parametrize("part", [2, 4, 5])
def test_noise_is_held_over_ticks_whatever_the_communication_step(part: int):
    coarse, fine = (sensor_errors(ride(100 * n, H / n, **NOISE)) for n in (1, part))
    for one, other, rms in zip(coarse, fine, NOISE.values(), strict=True):
        within = other[:-1].reshape(100, part)
        assert np.abs(within - one[:-1, None]).max() < 1e-12 * rms  # rounding of the sum with the truth
        assert np.abs(np.diff(one)).min() > 1e-6 * rms
    assert TICK == H


def test_a_bias_is_added():
    outputs = ride(50, acceleration_bias=0.5, deflection_bias=-0.002)
    assert np.allclose(sensor_errors(outputs)[0], 0.5, rtol=1e-12)
    assert np.allclose(sensor_errors(outputs)[1], -0.002, rtol=1e-12)


def test_readings_are_the_nearest_multiples_of_the_resolution():
    outputs = ride(500, force=150.0, acceleration_resolution=0.05, deflection_resolution=1e-3)
    for values, resolution in (
        ([(o.seat_acceleration_measured, o.seat_acceleration) for o in outputs], 0.05),
        ([(o.suspension_deflection_measured, o.suspension_deflection) for o in outputs], 1e-3),
    ):
        read, true = np.array(values).T
        assert np.abs(read / resolution - np.round(read / resolution)).max() < 1e-9
        assert np.abs(read - true).max() <= resolution / 2 * (1 + 1e-9)
        assert len(set(read)) > 10


def test_what_is_too_large_for_the_resolution_passes():
    c = prepare(Parameters(deflection_resolution=1e-12))
    assert initialize(Inputs(floor_displacement=1e300), c, 0.0)[1].suspension_deflection_measured == -1e300


# ---- bandwidth -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("angle", [1e-9, 1e-3, 0.5, 50.0])
def test_the_low_pass_is_exact_on_a_ramp(angle: float):
    """y' = (x - y) angle, x from 2 to 5 over unit time, y from 1."""
    exact = 5.0 - 3.0 / angle + (1.0 - 2.0 + 3.0 / angle) * math.exp(-angle)
    assert low_pass(1.0, 2.0, 5.0, angle) == pytest.approx(exact, rel=1e-12, abs=4e-15 / angle)


@pytest.mark.parametrize("bandwidth", [0.5, 20.0, 2000.0])
@pytest.mark.parametrize("step", [5e-4, H, 0.01])
def test_the_low_pass_follows_a_parabola_within_the_substeps_curvature(bandwidth: float, step: float):
    """A free seat under a constant force: its deflection is a t^2/2."""
    free = {"friction_alpha": 0.0, "suspension_stiffness": 0.0, "cushion_stiffness": 0.0, "cushion_damping": 0.0}
    c = prepare(Parameters(**free, sensor_bandwidth=bandwidth))
    inputs = Inputs(force=100.0)
    state, outputs = initialize(inputs, c, 0.0)
    assert outputs.seat_acceleration_measured == outputs.seat_acceleration
    tau, a = 1 / (2 * math.pi * bandwidth), outputs.seat_acceleration
    for k in range(40):
        state, outputs = advance(state, inputs, c, k * step, step)
        t = (k + 1) * step
        exact = a * (t * t / 2 - t * tau - tau * tau * math.expm1(-t / tau))
        # a parabola is up to a h^2/8 off its chord
        assert outputs.suspension_deflection_measured == pytest.approx(exact, abs=a * c.substep**2 / 8)
        assert outputs.seat_acceleration_measured == pytest.approx(a, rel=1e-12)


def test_the_low_pass_comes_before_noise_and_resolution():
    outputs = ride(300, force=150.0, sensor_bandwidth=1.0, acceleration_resolution=0.05, acceleration_bias=0.01)
    read = np.array([o.seat_acceleration_measured for o in outputs])
    assert np.abs(read / 0.05 - np.round(read / 0.05)).max() < 1e-9
    smooth = np.array([o.seat_acceleration_measured for o in ride(300, force=150.0, sensor_bandwidth=1.0)])
    assert np.abs(read - smooth - 0.01).max() <= 0.025 * (1 + 1e-9)
    assert np.abs(smooth).max() < 0.5 * max(abs(o.seat_acceleration) for o in outputs)
