"""The hump of the controlled spectrum: the mode of the linear loop with the calibrated lag, delay and sensors."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import cont2discrete

from plant_models.parameter_sets import path
from seat_controller_fmu.controller import prepare
from seat_controller_fmu.design.sampled_loop import sampled_controller
from seat_controller_fmu.interface import Parameters
from seat_controller_fmu.parameters import SAMPLE_TIME, SEAT_MASS, SUSPENSION_STIFFNESS

H = SAMPLE_TIME.value


def calibrated() -> dict[str, float]:
    import re

    text = path("prototype").read_text(encoding="utf-8")
    return {name: float(v) for name, v in re.findall(r'name="seat\.([\w.]+)".*?<ssv:Real value="([^"]+)"', text, re.S)}


def modes(driver_mass: float, lag: float, delay: float, bandwidth: float) -> list[tuple[float, float]]:
    """Return damped frequency in Hz and damping ratio of the loop's modes: a strapped load, without friction."""
    mass, stiffness = driver_mass + SEAT_MASS.value, SUSPENSION_STIFFNESS.value
    corner = 2.0 * np.pi * bandwidth
    # deflection, its rate, force, measured acceleration, measured deflection
    A, B = np.zeros((5, 5)), np.zeros((5, 1))
    A[0, 1] = 1.0
    A[1, [0, 2]] = -stiffness / mass, 1.0 / mass
    A[2, 2], B[2] = -1.0 / lag, 1.0 / lag
    A[3] = corner * np.array([-stiffness / mass, 0.0, 1.0 / mass, -1.0, 0.0])
    A[4, [0, 4]] = corner, -corner
    seat, force, *_ = cont2discrete((A, B, np.eye(5), np.zeros((5, 1))), H, method="zoh")
    A_c, B_c = sampled_controller(prepare(Parameters(driver_mass=driver_mass)))
    late = round(delay / H)
    n = 10 + late
    loop, measured = np.zeros((n, n)), np.zeros((2, n))
    measured[0, 3] = measured[1, 4] = 1.0
    new = B_c @ measured
    new[:, 6:10] += A_c
    applied = new[3] if late == 0 else np.eye(n)[n - 1]
    loop[6:10], loop[5] = new, applied
    loop[:5, :5] = seat
    loop[:5] += np.outer(force[:, 0], applied)
    for index in range(late):
        loop[10 + index] = new[3] if index == 0 else np.eye(n)[9 + index]
    z = np.linalg.eigvals(loop)
    s = np.log(z[(np.abs(z) > 1e-6) & (z.imag > 1e-9)]) / H
    return [(float(pole.imag) / (2.0 * np.pi), float(-pole.real / abs(pole))) for pole in s]


@pytest.mark.parametrize(("mass", "frequency", "damping"), [(55.0, 6.6, 0.31), (70.0, 5.4, 0.41)])
def test_the_fitted_lag_leaves_a_mode_where_the_spectrum_has_its_hump(mass: float, frequency: float, damping: float):
    p = calibrated()
    ((found, ratio),) = modes(mass, p["actuator.time_constant"], p["actuator.delay"], p["sensor.bandwidth"])
    assert found == pytest.approx(frequency, abs=0.05)
    assert ratio == pytest.approx(damping, abs=0.005)


def test_without_lag_there_is_no_such_mode():
    assert all(ratio > 0.7 or frequency > 20.0 for frequency, ratio in modes(55.0, 1e-4, 0.0, 500.0))
