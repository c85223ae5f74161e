"""The floor of the cab through the FMUs: flavours, states, spectrum, and the seat on it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import welch

from cosim import System
from cosim.metrics import ride
from plant_models.truck.interface import Parameters
from plant_models.truck.modes import floor_response, road_density
from seat_cosim.scenarios import seat_suspension
from tests.helpers.paths import NATIVE

H = 0.002
PROFILES = ["iso8608", "bump", "pothole", "kerb", "file"]


def truck(folder: Path, flavour: str) -> System:
    system = System()
    system.add("truck", folder / flavour / "TruckCab.fmu" if flavour in NATIVE else folder / "TruckCab.fmu")
    return system


@pytest.mark.parametrize("profile", PROFILES)
def test_flavours_agree_to_the_last_bit(fmus: Path, native: Path, profile: str):
    given = {"truck.road.profile": profile, "truck.seat_force": 300.0}
    found = {f: truck(native if f in NATIVE else fmus, f).simulate(1.4, H, given) for f in (*NATIVE, "python")}
    for name in found["fmi2"].values:
        for flavour in ("fmi3", "python"):
            assert (found[flavour][name] == found["fmi2"][name]).all(), (flavour, name)
    assert np.abs(found["fmi2"]["truck.floor_acceleration"]).max() > 0.3


def test_the_spectrum_of_the_floor_is_that_of_the_linear_solution(native: Path):
    """In bands of a third of an octave, from 0.8 to 12 Hz, on class C at 60 km/h for 600 s.

    A band of m lines from K averages scatters by 1/sqrt(m K); the cells of the road take off (pi n cell)^2/3.
    """
    found = truck(native, "fmi2").simulate(600.0, H, {}, record=["truck.floor_acceleration"])
    floor = found["truck.floor_acceleration"][round(10.0 / H) :]
    length = round(20.0 / H)
    f, density = welch(floor, 1.0 / H, nperseg=length)
    averages = len(floor) / length
    parameters = Parameters()
    for centre in 0.8 * 2.0 ** (np.arange(12) / 3.0):
        band = (f >= centre * 2.0 ** (-1 / 6)) & (f < centre * 2.0 ** (1 / 6))
        expected = np.abs(floor_response(parameters, f[band])[0]) ** 2 * road_density(parameters, f[band])
        ratio = density[band].sum() / expected.sum()
        smoothed = (math.pi * centre / parameters.speed * 0.05) ** 2 / 3.0
        # lines within a peak are not equally strong: so many would be
        lines = expected.sum() ** 2 / (expected**2).sum()
        print(f"{centre:5.2f} Hz: {ratio:.3f}")
        assert abs(ratio - 1.0) < smoothed + 4.0 / math.sqrt(lines * averages)
    peak = f[np.argmax(density)]
    a_w = ride(found["truck.floor_acceleration"], 1.0 / H, 10.0).a_w
    print(f"peak at {peak:.2f} Hz, a_w {a_w:.2f} m/s2")
    assert 1.0 < peak < 4.0
    assert 0.6 < a_w < 0.9


def test_the_truck_takes_the_place_of_the_shaker(native: Path):
    """The same names and units: three connections stay as they are, and the seat isolates."""
    system = seat_suspension(native / "fmi2")
    system.replace("shaker", native / "fmi2" / "TruckCab.fmu")
    found = system.simulate(20.0, H, {})
    rates = [ride(found[name], 1.0 / H, 2.0).a_w for name in ("seat.driver_acceleration", "shaker.floor_acceleration")]
    assert rates[0] < 0.7 * rates[1]


def test_a_force_of_the_seat_moves_the_floor_at_once(native: Path):
    found = truck(native, "fmi3").simulate(0.01, H, {"truck.seat_force": 100.0})
    p = Parameters()
    expected = 100.0 * (1.0 / p.cab_mass + p.seat_position**2 / p.cab_pitch_inertia)
    assert found["truck.floor_acceleration"][0] == pytest.approx(expected, rel=1e-12)
    assert found["truck.floor_displacement"][0] == found["truck.road_elevation"][0] == 0.0
