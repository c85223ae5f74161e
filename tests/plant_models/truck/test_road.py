"""The road under the axles: its spectrum, one road for both axles, obstacles, a road from a file."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import welch

from cosim import RunError, System
from fmus.component import ParameterError
from plant_models.truck import road
from plant_models.truck.example_road import elevation as example_elevation
from plant_models.truck.example_road import example
from plant_models.truck.interface import Inputs, Parameters, Profile, RoadClass
from plant_models.truck.road import BEFORE, CELLS_PER_METRE, CORNER, LEVELS, REFERENCE, Track
from plant_models.truck.truck import advance, initialize, prepare
from tests.helpers.paths import NATIVE

CELL = 1.0 / CELLS_PER_METRE
SPEED = 20.0
H = 0.002


def nodes(parameters: Parameters, count: int) -> np.ndarray:
    """Elevation at the ends of the cells, before it fades in."""
    coefficients, track, found = road.prepare(parameters), BEFORE, []
    for k in range(count):
        track = road.advance(track, (k + 0.5) * CELL, coefficients)
        found.append(track.end)
    return np.array(found)


def drive(parameters: Parameters, steps: int, step: float = H) -> list[tuple[float, float, float]]:
    """Time, and elevation under front and rear axle as their tyres feel it, at the communication points."""
    c = prepare(parameters)
    state, _ = initialize(Inputs(), c, 0.0)
    rows = []
    for k in range(steps):
        state, outputs = advance(state, Inputs(), c, k * step, step)
        rear = outputs.rear_tyre_force / parameters.rear_tyre_stiffness + state.displacements[5]
        rows.append(((k + 1) * step, outputs.road_elevation, rear))
    return rows


# ---- random road -----------------------------------------------------------------------------------------------------


def test_the_spectrum_of_the_road_is_that_of_iso_8608():
    """Welch over 200,000 cells; the error of a band of m lines from K averages is 1/sqrt(m K).

    Up to 1 cycle/m, corner and cells change the spectrum of the nodes by at most (n_c/n)^2 and (pi n cell)^2/3.
    """
    length, count = 4096, 200_000
    n, density = welch(nodes(Parameters(), count), CELLS_PER_METRE, nperseg=length)
    averages = count / length  # overlap only makes it better
    level = LEVELS[RoadClass.C]
    for low, high in [(0.02, 0.05), (0.05, 0.1), (0.1, 0.2), (0.2, 0.5), (0.5, 1.0)]:
        band = (n >= low) & (n < high)
        expected = level * (n[band] / REFERENCE) ** -2
        ratio = float(np.mean(density[band] / expected))
        known = (CORNER / low) ** 2 + (math.pi * high * CELL) ** 2 / 3.0
        print(f"{low} to {high} cycle/m: {ratio:.3f} of ISO 8608")
        assert abs(ratio - 1.0) < known + 4.0 / math.sqrt(band.sum() * averages)


def test_the_spectrum_of_the_nodes_is_that_of_the_filter():
    """|z(n)|^2 of the trapezoidal rule, up to the largest spatial frequency of ISO 8608, 2.83 cycle/m."""
    length, count = 2048, 100_000
    n, density = welch(nodes(Parameters(road_seed=7), count), CELLS_PER_METRE, nperseg=length)
    band = (n > 0.03) & (n < 2.83)
    angle, half = math.pi * n[band] * CELL, math.pi * CORNER * CELL
    shaped = (CELL * math.pi * REFERENCE) ** 2 / (np.sin(angle) ** 2 + (half * np.cos(angle)) ** 2)
    ratio = density[band] / (LEVELS[RoadClass.C] * shaped)
    assert abs(ratio.mean() - 1.0) < 4.0 / math.sqrt(band.sum() * count / length)
    slope = np.polyfit(np.log(n[band]), np.log(ratio), 1)[0]
    assert abs(slope) < 0.03


def test_each_class_is_twice_the_one_before_at_every_place():
    roads = [nodes(Parameters(road_class=each), 200) for each in RoadClass]
    for better, worse in pairwise(roads):
        assert (worse == 2.0 * better).all()


def test_the_seed_decides_on_the_road():
    one, same, other = (nodes(Parameters(road_seed=seed), 4000) for seed in (3, 3, 4))
    assert (one == same).all()
    increments = np.diff(one), np.diff(other)
    assert abs(np.corrcoef(*increments)[0, 1]) < 4.0 / math.sqrt(4000)


def test_the_rear_axle_meets_the_road_of_the_front_axle():
    """Cell by cell, to the last bit, whatever the communication steps."""
    parameters = Parameters(speed=SPEED, wheelbase=4.5)
    c = prepare(parameters)
    found: dict[str, dict[int, Track]] = {}
    for step in (0.002, 0.0031):
        state, _ = initialize(Inputs(), c, 0.0)
        front, rear = {}, {}
        for k in range(round(1.5 / step)):
            state, _ = advance(state, Inputs(), c, k * step, step)
            front[state.front.cell], rear[state.rear.cell] = state.front, state.rear
        del rear[BEFORE.cell]
        shared = front.keys() & rear.keys()
        assert len(shared) > 200
        assert all(front[cell] == rear[cell] for cell in shared)
        found[str(step)] = front
    first, second = found.values()
    assert all(first[cell] == second[cell] for cell in first.keys() & second.keys())


def test_the_rear_axle_is_later_by_the_wheelbase():
    wheelbase = 4.5
    delay = round(wheelbase / SPEED / H)
    rows = np.array(drive(Parameters(speed=SPEED, wheelbase=delay * H * SPEED, road_fade=0.01), 700))
    front, rear = rows[:, 1], rows[:, 2]
    assert np.abs(front).max() > 5e-3
    assert rear[:delay] == pytest.approx(0.0, abs=1e-15)
    assert rear[delay:] == pytest.approx(front[:-delay], abs=1e-12)


def test_the_road_begins_flat_and_smooth():
    c = road.prepare(Parameters(road_fade=10.0))
    track = road.advance(BEFORE, 0.05, c)
    assert road.elevation(BEFORE, -3.0, c) == road.elevation(track, 0.0, c) == 0.0
    assert abs(road.elevation(track, 0.05, c)) < 1e-8
    rough, fading = (np.array(drive(Parameters(road_fade=fade), 500))[:, 1] for fade in (0.01, 10.0))
    assert rough[350:] == pytest.approx(fading[350:], abs=0.0)  # after 10 m


def test_the_floor_hardly_depends_on_the_communication_steps():
    """The bends of the road within a substep cost 0.07 % of the floor's acceleration at 2 ms, against 0.25 ms."""
    c = prepare(Parameters())
    floors = {}
    for step in (0.002, 0.00025):
        state, _ = initialize(Inputs(), c, 0.0)
        every, rows = round(H / step), []
        for k in range(round(6.0 / step)):
            state, outputs = advance(state, Inputs(), c, k * step, step)
            rows.append(outputs.floor_acceleration)
        floors[step] = np.array(rows[every - 1 :: every])
    coarse, fine = floors.values()
    error = np.sqrt(np.mean((coarse - fine) ** 2) / np.mean(fine**2))
    print(f"relative error {error:.1e}")
    assert error < 2e-3


def test_a_run_may_start_at_any_time():
    """The front axle is at the begin of the road at the start; 1024 s lose no digits."""
    c = prepare(Parameters())
    floors = []
    for start in (0.0, 1024.0, -1024.0):
        state, _ = initialize(Inputs(), c, start)
        for k in range(100):
            state, outputs = advance(state, Inputs(), c, start + k * 2.0**-9, 2.0**-9)
        floors.append(outputs.floor_acceleration)
    assert floors[0] == floors[1] == floors[2] != 0.0


# ---- obstacles -------------------------------------------------------------------------------------------------------


def shape(profile: Profile, share: np.ndarray) -> np.ndarray:
    """Elevation of an obstacle of height 1 over the share of its length."""
    inside = np.clip(share, 0.0, 1.0)
    if profile == Profile.kerb:
        return inside**3 * (10.0 - 15.0 * inside + 6.0 * inside**2)
    return (-1.0 if profile == Profile.pothole else 1.0) * np.sin(np.pi * inside) ** 2


@pytest.mark.parametrize("profile", [Profile.bump, Profile.pothole, Profile.kerb])
def test_obstacles_have_their_shape_under_both_axles(profile: Profile):
    parameters = Parameters(
        speed=SPEED,
        road_profile=profile,
        obstacle_height=0.08,
        obstacle_length=1.5,
        obstacle_position=3.0,
    )
    time, front, rear = np.array(drive(parameters, 600)).T
    for axle, place in ((front, 3.0), (rear, 3.0 + parameters.wheelbase)):
        assert axle == pytest.approx(0.08 * shape(profile, (SPEED * time - place) / 1.5), abs=1e-12)
    assert np.abs(front).max() == pytest.approx(0.08, rel=1e-3)


def test_a_kerb_lifts_the_truck_for_good():
    parameters = Parameters(road_profile=Profile.kerb, obstacle_height=0.1, obstacle_position=1.0)
    c = prepare(parameters)
    state, _ = initialize(Inputs(), c, 0.0)
    for k in range(5000):
        state, outputs = advance(state, Inputs(), c, k * H, H)
    assert outputs.floor_displacement == pytest.approx(0.1, abs=1e-5)  # ten times the longest time constant
    assert outputs.cab_pitch == pytest.approx(0.0, abs=1e-5)


# ---- a road from a file ----------------------------------------------------------------------------------------------


def from_file(path: Path, **others: float) -> Parameters:
    return Parameters(road_profile=Profile.file, road_file=str(path), **others)


def test_a_road_from_a_file_is_interpolated(tmp_path: Path):
    x = np.cumsum(np.random.default_rng(1).uniform(0.1, 0.3, 60)) + 7.0
    z = np.random.default_rng(2).normal(0.0, 0.02, 60) + 1.0
    path = tmp_path / "road.csv"
    rows = zip(x.tolist(), z.tolist(), strict=True)
    path.write_text("distance,elevation\n" + "".join(f"{a!r},{b!r}\n" for a, b in rows))
    c = road.prepare(from_file(path, road_fade=0.01))
    for distance in np.linspace(-1.0, 20.0, 400)[1:]:
        expected = np.interp(distance, x - x[0], z - z[0]) if distance > 0.0 else 0.0
        if not 0.0 < distance < 0.01:
            assert road.elevation(BEFORE, float(distance), c) == pytest.approx(expected, abs=1e-13)


def test_the_example_is_the_road_that_it_claims_to_be(tmp_path: Path):
    path = tmp_path / "road.csv"
    path.write_bytes(example())
    c = road.prepare(from_file(path))
    for distance in (37.25, 80.5, 150.0):
        assert road.elevation(BEFORE, distance, c) == pytest.approx(example_elevation(distance), abs=5e-6)


WRONG = {
    "columns": ("time,elevation\n0,0\n", "line 1: expected the columns distance and elevation, got time,elevation"),
    "order": ("distance,elevation\n0,0\n2,0\n1,0\n", "line 4: expected a distance above 2 m, got 1 m"),
    "number": ("distance,elevation\n0,high\n", "line 2: expected a number of up to 1e+12 either way as elevation, got"),
    "rows": ("distance,elevation\n0,0\n1,0\n", "line 3: expected at least 10 rows, got 2"),
    "gap": (
        "distance,elevation\n" + "".join(f"{k},0\n" for k in (*range(12), 30)),
        "line 14: expected a step of at most 10 times the median of 1 m, got 19 m",
    ),
}


@pytest.mark.parametrize("what", WRONG)
def test_wrong_files_are_refused_in_one_line(what: str, tmp_path: Path):
    content, message = WRONG[what]
    path = tmp_path / "road.csv"
    path.write_text(content)
    with pytest.raises(ParameterError) as caught:
        prepare(from_file(path))
    assert str(caught.value).startswith(f"{path}, {message}")


@pytest.mark.parametrize("flavour", NATIVE)
def test_native_fmus_read_the_same_road(flavour: str, native: Path, tmp_path: Path):
    path = tmp_path / "own.csv"
    path.write_text("distance,elevation\n" + "".join(f"{0.2 * k:g},{0.01 * math.sin(k):g}\n" for k in range(100)))
    system = System()
    system.add("truck", native / flavour / "TruckCab.fmu")
    given = {"truck.road.profile": "file", "truck.road.file": str(path)}
    found = system.simulate(1.4, H, given)["truck.floor_acceleration"]
    c = prepare(from_file(path))
    state, outputs = initialize(Inputs(), c, 0.0)
    expected = [outputs.floor_acceleration]
    for k in range(700):
        state, outputs = advance(state, Inputs(), c, k * H, H)
        expected.append(outputs.floor_acceleration)
    assert np.abs(expected).max() > 0.1
    assert found.tolist() == expected
    path.write_text(WRONG["order"][0])
    with pytest.raises(RunError, match="expected a distance above 2 m, got 1 m"):
        system.simulate(0.1, H, given)
