"""Random motion: the spectra of all classes, measured through the native FMU, and what makes it consistent."""

from __future__ import annotations

import math
import shutil
import subprocess
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.signal import welch

from fmus.export.native_fmu import STANDARDS, source_files
from plant_models.shaker.interface import Inputs, Outputs, Parameters, Profile, RandomClass
from plant_models.shaker.noise import SPECTRA
from plant_models.shaker.shaker import SHAKER, TICK, advance, initialize, prepare
from tests.helpers.paths import ROOT


class Tabulated(NamedTuple):
    """RMS of a class in m/s2 over its band in Hz."""

    rms: float
    low: float
    high: float


TABLE = {
    "EM1": Tabulated(1.71, 0.89, 11.22),
    "EM2": Tabulated(2.05, 0.89, 11.22),
    "EM3": Tabulated(1.73, 0.89, 11.22),
    "EM4": Tabulated(0.96, 0.89, 11.22),
    "EM5": Tabulated(1.94, 0.89, 17.78),
    "EM6": Tabulated(1.65, 0.89, 17.78),
    "EM7": Tabulated(2.26, 0.89, 11.22),
    "EM8": Tabulated(1.05, 0.89, 17.78),
    "EM9": Tabulated(1.63, 0.89, 17.78),
    "IT1": Tabulated(1.58, 0.89, 17.78),
    "IT2": Tabulated(1.05, 0.89, 17.78),
    "IT3": Tabulated(0.96, 0.89, 11.22),
    "IT4": Tabulated(1.59, 0.89, 17.78),
    "AG1": Tabulated(2.26, 0.89, 11.22),
    "AG2": Tabulated(1.94, 0.89, 11.22),
    "AG3": Tabulated(1.74, 0.89, 11.22),
}
"""ISO 7096, EN 13490 and ISO 5007."""

RESOLUTION = 0.125
"""Of spectra, in Hz."""

WARM_UP = 5.0
"""In s: then the motion is stationary."""

OFTEN = ("EM1", "EM3", "EM9")
"""Classes whose long realisations are computed in every run of the tests."""

each = pytest.mark.parametrize("chosen", list(RandomClass), ids=lambda c: c.name)


def formula(chosen: RandomClass, f: np.ndarray | float) -> np.ndarray | float:
    """G(f) in (m/s2)2/Hz, from the magnitudes of Butterworth filters."""
    n, f_h, m, f_l, g = SPECTRA[chosen]
    return g * (f / f_h) ** (2 * n) / (1 + (f / f_h) ** (2 * n)) / (1 + (f / f_l) ** (2 * m))


def band_rms(chosen: RandomClass) -> float:
    t = TABLE[chosen.name]
    return math.sqrt(quad(lambda f: formula(chosen, f), t.low, t.high, limit=200)[0])


@each
def test_the_formula_has_the_tabulated_rms(chosen: RandomClass):
    """Within the rounding of the table's figures, 0.32 % of 1.58."""
    assert band_rms(chosen) == pytest.approx(TABLE[chosen.name].rms, rel=0.0032)


# ---- spectra ---------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The Shaker FMU's sources in a host that writes a random floor's acceleration."""
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    folder = tmp_path_factory.mktemp("random_floor")
    for name, content in source_files(SHAKER, STANDARDS["fmi2"], "{token}").items():
        (folder / name).write_bytes(content)
    sources = [*sorted(path.name for path in folder.glob("*.c")), str(ROOT / "tests/native/random_floor.c")]
    options = ["-std=c99", "-O2", "-ffp-contract=off", "-I."]
    subprocess.run(["gcc", *options, *sources, "-o", "host", "-lm"], cwd=folder, check=True)
    return folder / "host"


def acceleration(program: Path, chosen: RandomClass, seed: int, duration: float) -> np.ndarray:
    """Run the FMU; returns the acceleration of the floor at every tick after the warm-up."""
    warm_up, steps = round(WARM_UP / TICK), round(duration / TICK)
    words = [str(program), str(chosen.value), str(seed), str(warm_up + steps)]
    run = subprocess.run(words, capture_output=True, check=True)
    return np.frombuffer(run.stdout)[warm_up:]


def band_mean_square(found: np.ndarray, t: Tabulated) -> float:
    """Mean square within a band, from the whole signal's periodogram."""
    power = np.abs(np.fft.rfft(found)) ** 2 * 2 / len(found) ** 2
    f = np.fft.rfftfreq(len(found), TICK)
    return float(power[(f >= t.low) & (f <= t.high)].sum())


@pytest.mark.parametrize(
    "chosen",
    [pytest.param(c, id=c.name, marks=[] if c.name in OFTEN else [pytest.mark.long]) for c in RandomClass],
)
def test_each_class_has_its_rms_and_spectrum_over_10000_s(program: Path, chosen: RandomClass):
    found, t = acceleration(program, chosen, 1, 10_000.0), TABLE[chosen.name]
    rms = math.sqrt(band_mean_square(found, t))
    f, psd = welch(found, 1 / TICK, nperseg=round(1 / RESOLUTION / TICK))
    within = f <= t.high
    expected = formula(chosen, f[within])
    worst = np.abs(psd[within] - expected).max() / expected.max()
    print(f"{chosen.name}: band RMS {rms / t.rms - 1:+.2%} of the table, PSD within {worst:.1%} of the peak")
    assert rms == pytest.approx(t.rms, rel=0.03)
    assert worst < 0.10


@each
def test_200_s_of_each_seed_lie_within_three_sigma(program: Path, chosen: RandomClass):
    """Sigma of the band RMS is 1/(2 sqrt(B T)) of it, with the statistical bandwidth B = (int G)^2/int G^2."""
    t, duration = TABLE[chosen.name], 200.0
    power = quad(lambda f: formula(chosen, f), t.low, t.high, limit=200)[0]
    bandwidth = power**2 / quad(lambda f: formula(chosen, f) ** 2, t.low, t.high, limit=200)[0]
    sigma = 1 / (2 * math.sqrt(bandwidth * duration))
    assert 0.01 < sigma < 0.036
    found = [
        math.sqrt(band_mean_square(acceleration(program, chosen, seed, duration), t) / power) - 1 for seed in (1, 2, 3)
    ]
    print(f"{chosen.name}: {', '.join(f'{x / sigma:+.2f}' for x in found)} sigma of {sigma:.2%}")
    assert max(map(abs, found)) < 3 * sigma
    assert len({round(x, 6) for x in found}) == 3


# ---- the motion ------------------------------------------------------------------------------------------------------


def run(p: Parameters, ends: np.ndarray, start: float = 0.0) -> np.ndarray:
    """Step to each of some times; rows of displacement, velocity, acceleration, that at the start first."""
    c = prepare(p)
    state, floor = initialize(Inputs(), c, start)
    rows, time = [floor], start
    for end in ends.tolist():
        state, floor = advance(state, Inputs(), c, time, end - time)
        rows.append(floor)
        time = end
    return np.array([(x.floor_displacement, x.floor_velocity, x.floor_acceleration) for x in rows])


def random(chosen: RandomClass = RandomClass.EM1, **given: float) -> Parameters:
    return Parameters(profile=Profile.random, random_class=chosen, **given)


@each
def test_velocity_and_acceleration_are_the_derivatives(chosen: RandomClass):
    """Within a tick the jerk is continuous: cubic polynomials follow the motion to the fourth derivative times dt^3."""
    dt = 1e-5
    rows = run(
        random(chosen), 1.0 + 2 * TICK * np.arange(400)[:, None].repeat(3, 1).ravel() + np.tile([1, 2, 3], 400) * dt
    )
    d, v, a = rows[1:].reshape(400, 3, 3).transpose(2, 0, 1)
    scale = np.abs(a).max()
    assert np.abs((d[:, 2] - d[:, 0]) / (2 * dt) - v[:, 1]).max() < 1e-7 * scale
    assert np.abs((v[:, 2] - v[:, 0]) / (2 * dt) - a[:, 1]).max() < 1e-5 * scale


def test_communication_steps_do_not_change_the_motion():
    times = TICK * np.arange(1, 501)
    expected = run(random(), times)
    assert (run(random(), times[4::5])[1:] == expected[5::5]).all()
    fine = run(random(), np.sort(np.concatenate([times, times - 0.0007, times - 0.0013])))
    assert (fine[3::3] == expected[1:]).all()


def test_it_starts_at_rest_wherever_it_starts():
    for start in (0.0, 0.0013, -5.0, 100.0):
        assert run(random(), np.array([]), start)[0].tolist() == [0.0, 0.0, 0.0]
    rows = run(random(), 0.002 * np.arange(1, 4))
    assert np.abs(rows[1]).max() < 0.2
    # between its start and the first tick after it nothing moves
    assert not run(random(), np.array([0.0019]), 0.0013).any()


def test_the_seed_chooses_the_motion_and_the_scale_its_size():
    times = TICK * np.arange(1, 200)
    one = run(random(random_seed=1), times)
    assert (run(random(random_seed=1), times) == one).all()
    assert np.corrcoef(run(random(random_seed=2), times)[:, 2], one[:, 2])[0, 1] < 0.9
    assert run(random(random_seed=1, random_scale=0.5), times) == pytest.approx(0.5 * one, rel=1e-12)
    assert not run(random(random_scale=0.0), times).any()


@pytest.mark.slow
def test_the_displacement_does_not_drift():
    """Over 300 s each signal's mean is small against its standard deviation: none is integrated."""
    rows = run(random(RandomClass.EM2), 0.25 * np.arange(1, 1201))
    assert (np.abs(rows.mean(axis=0)) < 0.1 * rows.std(axis=0)).all()
    assert np.abs(rows[:, 0]).max() < 6 * rows[:600, 0].std()


def test_the_floor_is_at_rest_before_the_first_tick():
    assert Outputs() == initialize(Inputs(), prepare(random()), 0.001)[1]
