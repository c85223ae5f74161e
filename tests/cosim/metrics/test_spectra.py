"""Spectral densities and transmissibilities against known signals and filters."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal as dsp

from cosim.errors import SignalError
from cosim.metrics.spectra import Sine, fit_sine, psd, sine_transmissibility, transmissibility
from seat_cosim.scenarios import control, driver_mass, seat_suspension

RATE = 500.0
NOISE = np.random.default_rng(7).normal(size=round(400 * RATE))
FILTER = dsp.butter(2, [1.0, 30.0], "bandpass", fs=RATE, output="sos")


def sine(frequency: float, seconds: float, phase: float = 0.0, rate: float = RATE) -> np.ndarray:
    return np.sin(2.0 * np.pi * frequency * np.arange(round(seconds * rate)) / rate + phase)


def response(frequency: np.ndarray | float) -> np.ndarray:
    return dsp.freqz_zpk(*dsp.sos2zpk(FILTER), np.atleast_1d(frequency), fs=RATE)[1]


def test_white_noise_is_flat_and_adds_up_to_its_variance():
    spectrum = psd(3.0 * NOISE, RATE)
    assert spectrum.resolution == 0.25
    # sigma of a variance estimated from N samples is sqrt(2 / N) of it, 0.3 %
    assert spectrum.rms() ** 2 == pytest.approx(9.0, rel=0.01)
    assert np.mean(spectrum.density[4:-4]) == pytest.approx(9.0 / (RATE / 2.0), rel=0.01)


def test_lines_of_a_spectrum_scatter_as_it_says():
    spectrum = psd(NOISE, RATE)
    scatter = np.std(spectrum.density[2:-2]) / np.mean(spectrum.density[2:-2])
    # about 1000 lines, of which neighbours are correlated: sigma of their scatter about 3 %
    assert scatter == pytest.approx(spectrum.error, rel=0.1)


def test_half_overlapping_segments_are_worth_a_little_less_than_their_number():
    # 199 segments; halves of the Hann window share 1/6 of its power, neighbours so 1/36 of their scatter (Welch 1967)
    assert psd(NOISE, RATE).averages == pytest.approx(199.0 / (1.0 + 2.0 * 198.0 / 199.0 / 36.0))
    assert psd(NOISE[:2000], RATE).averages == 1.0


def test_a_sine_has_half_its_squared_amplitude_around_its_line():
    spectrum = psd(2.0 * sine(8.0, 60.0), RATE)
    assert spectrum.rms(7.0, 9.0) == pytest.approx(math.sqrt(2.0), rel=1e-6)
    assert spectrum.density.max() == pytest.approx(2.0 / (1.5 * 0.25), rel=1e-6)  # the Hann window's bandwidth
    assert spectrum.frequency[spectrum.density.argmax()] == 8.0


def test_the_resolution_is_rounded_to_whole_samples():
    assert psd(NOISE, RATE, resolution=0.3).resolution == pytest.approx(500.0 / 1667.0)


@settings(max_examples=30, deadline=None)
@given(st.floats(0.01, 249.0))
def test_bands_add_up(border: float):
    spectrum = psd(NOISE[:5000], RATE)
    assert math.hypot(spectrum.rms(high=border), spectrum.rms(low=border)) == pytest.approx(spectrum.rms())


def test_a_known_filter_is_found_from_noise():
    found = transmissibility(NOISE, dsp.sosfilt(FILTER, NOISE), RATE, resolution=0.1)
    inside = (found.frequency > 2.0) & (found.frequency < 60.0)
    assert found.coherence[inside].min() > 0.99
    # the filter's slope over a line's width, at most 1 % of it here
    assert found.ratio[inside] == pytest.approx(response(found.frequency[inside]), rel=0.02)


def test_a_mere_delay_and_gain_is_found_almost_exactly():
    found = transmissibility(NOISE[1:], 0.5 * NOISE[:-1], RATE)
    assert found.ratio == pytest.approx(0.5 * np.exp(-2j * np.pi * found.frequency / RATE), abs=2e-3)
    assert found.coherence[1:-1].min() > 0.999


@pytest.mark.parametrize("level", [0.3, 1.0, 3.0])
def test_noise_of_the_response_costs_coherence_and_confidence_but_no_bias(level: float):
    disturbance = level * np.random.default_rng(8).normal(size=NOISE.size)
    found = transmissibility(NOISE, NOISE + disturbance, RATE)
    expected = 1.0 / (1.0 + level**2)
    bias = (1.0 - expected) ** 2 / found.averages
    lines = found.frequency.size
    assert np.mean(found.coherence) == pytest.approx(expected + bias, abs=0.01)
    # in both parts the ratio scatters by the same error, here about 1; mean over lines: 1 / sqrt(lines) of it
    error = math.sqrt((1.0 - expected) / (2.0 * expected * found.averages))
    assert np.median(found.error) == pytest.approx(error, rel=0.05)
    assert abs(np.mean(found.ratio) - 1.0) < 4.0 * error * math.sqrt(2.0 / lines)
    assert np.std(found.ratio.real) == pytest.approx(error, rel=0.12)
    assert np.std(found.ratio.imag) == pytest.approx(error, rel=0.12)


def test_without_excitation_there_is_no_coherence():
    found = transmissibility(np.tile([1.0, -1.0], 5000), np.zeros(10000), RATE)
    assert not found.coherence.any()
    assert np.isinf(found.error).all()


@pytest.mark.parametrize("frequency", [0.7, 1.0, 3.3, 17.0])
def test_a_known_filter_is_found_from_a_sine(frequency: float):
    excitation = 0.3 * sine(frequency, 30.0, phase=1.0) + 5.0
    found = sine_transmissibility(excitation, dsp.sosfilt(FILTER, excitation), RATE, frequency, warm_up=15.0)
    assert found.ratio == pytest.approx(response(frequency)[0], rel=1e-6)
    assert found.gain == abs(found.ratio)
    assert max(found.excitation.distortion, found.response.distortion) < 1e-6


def test_a_warm_up_that_is_too_short_gives_distortion():
    excitation = sine(1.0, 30.0)
    found = sine_transmissibility(excitation, dsp.sosfilt(FILTER, excitation + 5.0), RATE, 1.0)
    assert found.response.distortion > 0.1


def test_a_cubic_seat_has_the_distortion_of_its_third_harmonic():
    # (sin)^3 = 3/4 sin - 1/4 sin of three times the frequency
    x = sine(2.0, 5.1)  # of which the last ten periods count
    found = sine_transmissibility(x, x + 0.4 * x**3, RATE, 2.0)
    assert found.gain == pytest.approx(1.3)
    assert found.response.distortion == pytest.approx(0.1 / 1.3)
    assert found.rms_ratio == pytest.approx(math.hypot(1.3, 0.1))


@settings(max_examples=40, deadline=None)
@given(
    frequency=st.floats(0.5, 100.0),
    amplitude=st.floats(0.01, 100.0),
    phase=st.floats(-3.0, 3.0),
    offset=st.floats(-100.0, 100.0),
    warm_up=st.floats(0.0, 1.0),
)
def test_a_sine_is_fitted_with_any_warm_up(
    frequency: float, amplitude: float, phase: float, offset: float, warm_up: float
):
    found = fit_sine(amplitude * sine(frequency, 4.0, phase) + offset, RATE, frequency, warm_up)
    assert found.amplitude == pytest.approx(-1j * amplitude * np.exp(1j * phase), rel=1e-9, abs=1e-9)
    assert found.offset == pytest.approx(offset, abs=1e-9)
    assert found.distortion < 1e-9


def test_a_constant_signal_is_no_sine():
    found = fit_sine(np.zeros(1000), RATE, 2.0)
    assert found == Sine(2.0, 0j, 0.0, 0.0)
    assert found.distortion == math.inf


def test_the_seats_own_transmissibility_comes_through_the_fmus(native: Path):
    frequency, rate = 3.0, 500.0
    still = {"seat.friction.alpha": 0.0, "seat.suspension_damping": 600.0, **control(False)}
    shaken = {"shaker.profile": "sine", "shaker.sine.frequency": frequency, **driver_mass(70.0), **still}
    result = seat_suspension(native / "fmi2").simulate(20.0, parameters=shaken)
    found = sine_transmissibility(
        result["shaker.floor_acceleration"], result["seat.driver_acceleration"], rate, frequency, warm_up=12.0
    )
    # (1)-(2) at s: the cushion carries the driver by a ratio, and both hang on the suspension
    s = 2j * math.pi * frequency
    cushion, suspension = 90e3 + 2500.0 * s, 4600.0 + 600.0 * s
    carried = cushion / (70.0 * s**2 + cushion)
    expected = suspension * carried / (28.0 * s**2 + suspension + cushion * (1.0 - carried))
    assert found.ratio == pytest.approx(expected, rel=1e-3)  # the floor's extrapolation over a step costs 2e-4
    assert found.response.distortion < 1e-6


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: psd(NOISE[:100], RATE),
            "signal: expected at least 4 s of samples at 500 Hz after 0 s of warm-up, got 0.2",
        ),
        (lambda: psd(NOISE[:3000], RATE, warm_up=4.0), "at least 4 s .* after 4 s of warm-up, got 2 s"),
        (lambda: psd(NOISE, RATE, resolution=200.0), "resolution: expected at most a quarter of the rate, 125 Hz"),
        (lambda: psd(NOISE, RATE, resolution=0.0), "resolution: expected a finite number above 0 Hz, got 0 Hz"),
        (lambda: psd(NOISE, RATE).rms(3.0, 2.0), "band: expected low < high, got 3 and 2 Hz"),
        (lambda: transmissibility(NOISE[:3000], NOISE[:3000], RATE), "excitation: expected at least 8 s"),
        (lambda: transmissibility(NOISE, NOISE[1:], RATE), "excitation 200000, response 199999 samples"),
        (
            lambda: transmissibility(np.ones(5000), NOISE[:5000], RATE),
            "expected a signal that changes, got 1 throughout",
        ),
        (lambda: fit_sine(NOISE[:100], RATE, 2.0), "at least 0.5 s"),
        (lambda: fit_sine(NOISE, RATE, 250.0), "frequency: expected below half the sampling rate, 250 Hz, got 250"),
        (lambda: sine_transmissibility(np.ones(999), NOISE[:999], RATE, 5.0), "excitation: expected a sine of 5 Hz"),
        (lambda: sine_transmissibility(np.zeros(999), NOISE[:999], RATE, 5.0), "excitation: expected a sine of 5 Hz"),
    ],
)
def test_signals_without_an_estimate_are_errors(call, message: str):
    with pytest.raises(SignalError, match=message):
        call()
