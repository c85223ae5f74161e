"""Wk against the tables of the standard, and weighted signals against Wk."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cosim.errors import SignalError
from cosim.metrics.spectra import fit_sine, psd
from cosim.metrics.weighting import weighted, wk

RATE = 500.0

# ISO 2631-1:1997, table 3: third-octave frequencies and 1000 times the weighting Wk
FREQUENCIES = (
    *(0.1, 0.125, 0.16, 0.2, 0.25, 0.315, 0.4, 0.5, 0.63, 0.8, 1, 1.25, 1.6, 2, 2.5, 3.15, 4, 5, 6.3, 8, 10, 12.5, 16),
    *(20, 25, 31.5, 40, 50, 63, 80, 100, 125, 160, 200, 250, 315, 400),
)
FACTORS = (
    *(31.2, 48.6, 79.0, 121, 182, 263, 352, 418, 459, 477, 482, 484, 494, 531, 631, 804, 967, 1039, 1054, 1036, 988),
    *(902, 768, 636, 513, 405, 314, 246, 186, 132, 88.7, 54.0, 28.5, 15.2, 7.90, 3.98, 1.95),
)

signals = st.integers(1, 2**32 - 1).map(lambda seed: np.random.default_rng(seed).normal(size=400))


def sine(frequency: float, seconds: float, rate: float = RATE) -> np.ndarray:
    return np.sin(2.0 * np.pi * frequency * np.arange(round(seconds * rate)) / rate)


def test_wk_is_that_of_the_table():
    # 0.28 % at 80 Hz is the most: the table has three digits
    assert np.abs(wk(FREQUENCIES)) == pytest.approx(np.array(FACTORS) / 1000.0, rel=3e-3)


def test_wk_at_the_reference_frequency_of_iso_8041():
    assert abs(wk(100.0 / (2.0 * np.pi))) == pytest.approx(0.7718, abs=5e-5)


def test_a_wrong_parameter_would_not_pass_for_the_table(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("cosim.metrics.weighting._Q6", 0.92)
    assert np.abs(wk(FREQUENCIES)) != pytest.approx(np.array(FACTORS) / 1000.0, rel=3e-3)


@pytest.mark.parametrize(("rate", "bound"), [(160.0, 5e-3), (200.0, 1e-4), (RATE, 1e-6), (2000.0, 1e-6)])
def test_sines_are_weighted_as_wk_says_in_magnitude_and_phase(rate: float, bound: float):
    for frequency in np.geomspace(0.4, 79.0, 25):
        found = fit_sine(weighted(sine(frequency, 25.0, rate), rate, 10.0), rate, frequency)
        start = np.exp(2j * np.pi * frequency * 10.0)  # the time of the fit starts after the warm-up
        assert abs(found.amplitude / (-1j * start) / wk(frequency) - 1.0) < bound, frequency


def test_a_bilinear_filter_would_not_do():
    # it responds as the continuous one at the warped frequency
    warped = RATE / np.pi * np.tan(np.pi * 80.0 / RATE)
    assert abs(wk(warped) / wk(80.0)) < 0.87


def test_noise_weighted_in_time_has_the_rms_of_its_weighted_spectrum():
    # both see the same samples; what differs is the windows' share of each, and 0.25 Hz against Wk's slope
    noise = np.random.default_rng(5).normal(size=200 * round(RATE))
    spectrum = psd(noise, RATE)
    expected = np.sqrt(np.sum(np.abs(wk(spectrum.frequency)) ** 2 * spectrum.density) * spectrum.resolution)
    assert np.std(weighted(noise, RATE)) == pytest.approx(expected, rel=5e-3)


def test_the_impulse_response_is_nearly_causal_and_decays():
    impulse = np.zeros(15 * round(RATE))
    impulse[1000] = 1.0
    response = np.abs(weighted(impulse, RATE))
    assert response[:1000].max() < 0.006 * response.max()
    assert response[-100:].max() < 1e-4 * response.max()


def test_a_constant_fades_within_four_seconds():
    assert np.abs(weighted(np.full(5000, 9.81), RATE, warm_up=4.0)).max() < 1e-3 * 9.81


@settings(max_examples=20, deadline=None)
@given(signals, st.floats(-1e3, 1e3))
def test_weighting_is_linear(signal: np.ndarray, factor: float):
    shaken = np.roll(signal, 1)
    together = weighted(signal + factor * shaken, RATE)
    assert together == pytest.approx(weighted(signal, RATE) + factor * weighted(shaken, RATE), abs=1e-9)


@settings(max_examples=20, deadline=None)
@given(signals, st.integers(1, 2000))
def test_a_later_signal_is_weighted_alike(signal: np.ndarray, later: int):
    # the pads differ in length, so what is not causal wraps around differently
    shifted = weighted(np.concatenate((np.zeros(later), signal)), RATE, warm_up=later / RATE)
    assert shifted == pytest.approx(weighted(signal, RATE), abs=1e-4)


def test_the_warm_up_is_removed_from_the_weighted_signal():
    signal = sine(4.0, 3.0)
    assert np.array_equal(weighted(signal, RATE, 1.0), weighted(signal, RATE)[500:])


def test_too_low_a_rate_is_refused():
    with pytest.raises(SignalError, match="rate: expected at least 160 Hz, as Wk reaches to 80 Hz, got 100 Hz"):
        weighted(sine(1.0, 3.0, 100.0), 100.0)
