"""Test inputs: the seeds of each class conform, by the FMU and by an estimate of their spectrum of another make."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

from cosim import System
from cosim.engine.session import Session
from plant_models.shaker.interface import RandomClass
from seat_cosim.evaluation.inputs import INPUTS, RESOLUTION, conformity, target_density, target_peak
from seat_cosim.evaluation.protocol import Protocol

RATE, WARM_UP, DURATION = 500.0, 10.0, 180.0
each = pytest.mark.parametrize("name", INPUTS)


@pytest.fixture(scope="module")
def shaker(native: Path) -> Iterator[Session]:
    """The Shaker alone."""
    system = System()
    system.add("shaker", native / "fmi2" / "Shaker.fmu")
    system.step_size = 1.0 / RATE
    with system.open() as session:
        yield session


def floor(shaker: Session, name: str, seed: int, duration: float = DURATION) -> np.ndarray:
    """Acceleration of the floor, with the warm-up."""
    parameters = {"shaker.profile": "random", "shaker.random.class": name, "shaker.random.seed": seed}
    return shaker.run(WARM_UP + duration, parameters=parameters)["shaker.floor_acceleration"]


def segments(samples: np.ndarray, resolution: float) -> tuple[np.ndarray, np.ndarray]:
    """Spectrum by the mean periodogram of half-overlapping Hann segments, written out with numpy's FFT."""
    length = round(RATE / resolution)
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(length) / length)
    starts = range(0, samples.size - length + 1, length // 2)
    pieces = np.array([samples[start : start + length] for start in starts])
    pieces = (pieces - pieces.mean(axis=1, keepdims=True)) * window
    power = np.abs(np.fft.rfft(pieces, axis=1)) ** 2
    return np.fft.rfftfreq(length, 1.0 / RATE), 2.0 * power.mean(axis=0) / (RATE * float(window @ window))


def test_all_classes_of_the_shaker_have_an_input():
    assert list(INPUTS) == [each.name for each in RandomClass]
    assert (Protocol().duration, Protocol().warm_up) == (DURATION, WARM_UP)


@each
def test_the_seeds_conform_to_10_percent_of_the_peak_and_5_percent_of_the_rms(shaker: Session, name: str):
    known = INPUTS[name]
    assert len(set(known.seeds)) == 3
    for seed in known.seeds:
        samples = floor(shaker, name, seed)
        frequency, density = segments(samples[round(WARM_UP * RATE) :], RESOLUTION)
        band = (frequency >= known.low) & (frequency <= known.high)
        error = (density - target_density(name, np.maximum(frequency, 1e-9)))[band] / target_peak(name)
        assert np.abs(error).max() <= 0.10, seed
        # the band's RMS from the whole signal's periodogram, without segments and window
        remaining = samples[round(WARM_UP * RATE) :]
        power = np.abs(np.fft.rfft(remaining)) ** 2 * 2.0 / remaining.size**2
        lines = np.fft.rfftfreq(remaining.size, 1.0 / RATE)
        rms = math.sqrt(power[(lines >= known.low) & (lines <= known.high)].sum())
        assert rms == pytest.approx(known.rms, rel=0.05), seed
        found = conformity(name, samples, RATE, WARM_UP)
        assert found.share <= 1.0
        assert found.psd_error == pytest.approx(error[np.abs(error).argmax()], abs=1e-3)
        assert found.rms == pytest.approx(rms, rel=1e-9)


@each
def test_the_target_is_the_standards_by_its_rms(name: str):
    known = INPUTS[name]
    power = quad(lambda f: float(target_density(name, f)), known.low, known.high, limit=200)[0]
    assert math.sqrt(power) == pytest.approx(known.rms, rel=0.0032)


@pytest.mark.parametrize("name", ["EM1", "EM2", "EM3", "EM4"])
def test_seeds_that_do_not_conform_are_found(shaker: Session, name: str):
    quiet = conformity(name, floor(shaker, name, 3), RATE, WARM_UP)
    assert -0.062 < quiet.rms_error < -0.048
    assert quiet.share > 1.0
    peaked = conformity(name, floor(shaker, name, 1), RATE, WARM_UP)
    assert abs(peaked.rms_error) < 0.05
    assert abs(peaked.psd_error) > 0.13


def test_a_scaled_input_does_not_conform(shaker: Session):
    samples = floor(shaker, "EM5", INPUTS["EM5"].seeds[0])
    assert conformity("EM5", samples, RATE, WARM_UP).share <= 1.0
    assert conformity("EM5", 1.08 * samples, RATE, WARM_UP).share > 1.0
    assert conformity("EM6", samples, RATE, WARM_UP).share > 1.0


def test_what_has_no_spectrum_is_not_judged(shaker: Session):
    samples = floor(shaker, "EM5", 1, duration=3.0)
    assert conformity("EM5", samples, RATE, WARM_UP) is None
    assert conformity("own", samples, RATE) is None
