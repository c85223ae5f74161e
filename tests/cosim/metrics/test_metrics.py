"""Metrics of rides and suspensions against closed forms; invalid samples are errors that name the signal."""

from __future__ import annotations

import math
import re
from dataclasses import astuple, replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cosim.errors import CosimError, SignalError
from cosim.metrics.samples import trim
from cosim.metrics.suspension import actuator, deflection_range, end_stops
from cosim.metrics.weighting import weighted, wk
from cosim.metrics.whole_body import Ride, crest_factor, mtvv, peak, ride, rms, running_rms, seat_factor, vdv
from tests.helpers.paths import ROOT

RATE = 500.0

seeds = st.integers(1, 2**32 - 1)
lively = settings(max_examples=20, deadline=None)


def sine(frequency: float, seconds: float, amplitude: float = 1.0) -> np.ndarray:
    return amplitude * np.sin(2.0 * np.pi * frequency * np.arange(round(seconds * RATE)) / RATE)


def noise(seed: int, seconds: float = 3.0) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=round(seconds * RATE))


def test_a_sine_has_its_closed_forms():
    wave = sine(5.0, 20.0, amplitude=2.0)
    assert rms(wave) == pytest.approx(2.0 / math.sqrt(2.0))
    assert peak(-wave) == pytest.approx(2.0)
    assert crest_factor(wave) == pytest.approx(math.sqrt(2.0))
    assert vdv(wave, RATE) == pytest.approx(2.0 * (3.0 / 8.0 * 20.0) ** 0.25)
    assert mtvv(wave, RATE) == pytest.approx(2.0 / math.sqrt(2.0))


def test_a_sines_ride_is_that_of_the_weighted_sine():
    found = ride(sine(6.3, 60.0, amplitude=2.0), RATE, warm_up=10.0)
    amplitude = 2.0 * abs(wk(6.3))
    assert found.duration == pytest.approx(50.0)
    assert found.a_w == pytest.approx(amplitude / math.sqrt(2.0), rel=1e-6)
    assert found.vdv == pytest.approx(amplitude * (3.0 / 8.0 * 50.0) ** 0.25, rel=1e-6)
    assert found.crest_factor == pytest.approx(math.sqrt(2.0), rel=1e-3)  # samples may miss the peak
    assert found.rms_suffices


@pytest.mark.parametrize(("length", "expected"), [(0.25, math.sqrt(0.25)), (0.999, math.sqrt(0.998)), (3.0, 1.0)])
def test_mtvv_of_a_burst_is_its_share_of_a_second(length: float, expected: float):
    signal = np.zeros(round(10 * RATE))
    signal[2000 : 2000 + round(length * RATE)] = 1.0
    assert mtvv(signal, RATE) == pytest.approx(expected, abs=2e-3)


def test_the_running_rms_starts_when_its_second_is_full():
    found = running_rms(np.concatenate((np.ones(500), np.zeros(500))), RATE)
    assert found == pytest.approx(np.sqrt(np.linspace(1.0, 0.0, 501)))


def test_the_rms_does_not_suffice_for_shocks():
    calm = Ride(a_w=1.0, vdv=1.4 * 16.0**0.25, mtvv=1.4, crest_factor=4.0, duration=16.0)
    assert calm.rms_suffices
    for change in ({"crest_factor": 9.1}, {"mtvv": 1.51}, {"vdv": 1.76 * 2.0}):
        assert not replace(calm, **change).rms_suffices


def test_seat_factors_divide_rides():
    seat = Ride(a_w=0.5, vdv=1.5, mtvv=1.0, crest_factor=5.0, duration=30.0)
    floor = Ride(a_w=1.0, vdv=2.0, mtvv=1.0, crest_factor=3.0, duration=30.0)
    assert astuple(seat_factor(seat, floor)) == (0.5, 0.75)


@lively
@given(seeds, st.floats(1e-3, 1e3))
def test_a_ride_scales_and_its_seat_factor_does_not(seed: int, factor: float):
    seat, floor = ride(noise(seed), RATE), ride(noise(seed + 1), RATE)
    louder = ride(-factor * noise(seed), RATE)
    assert astuple(louder)[:3] == pytest.approx([factor * value for value in astuple(seat)[:3]])
    assert louder.crest_factor == pytest.approx(seat.crest_factor)
    both = seat_factor(louder, ride(factor * noise(seed + 1), RATE))
    assert astuple(both) == pytest.approx(astuple(seat_factor(seat, floor)))


@lively
@given(seeds)
def test_the_metrics_keep_their_order(seed: int):
    found = ride(noise(seed) * np.linspace(0.0, 1.0, 1500) ** 4, RATE)
    assert found.vdv >= found.a_w * found.duration**0.25  # the power mean inequality
    assert found.a_w * found.crest_factor >= found.mtvv
    assert found.mtvv >= found.a_w * 0.999  # here the last second is the loudest
    assert found.crest_factor >= 1.0


@lively
@given(seeds, st.floats(0.0, 1.5))
def test_the_warm_up_of_a_ride_is_that_of_its_weighted_signal(seed: int, warm_up: float):
    w = trim(weighted(noise(seed), RATE), RATE, warm_up)
    assert ride(noise(seed), RATE, warm_up).a_w == rms(w)
    assert ride(noise(seed), RATE, warm_up).vdv == vdv(w, RATE)


def test_rest_has_no_crest_factor():
    assert math.isnan(crest_factor(np.zeros(500)))


def test_a_deflections_range():
    found = deflection_range([9.0, 0.01, -0.03, 0.02], rate=1.0, warm_up=1.0)
    assert (found.lowest, found.highest, found.peak) == (-0.03, 0.02, 0.03)
    assert found.peak_to_peak == pytest.approx(0.05)
    assert found.rms == pytest.approx(math.sqrt(14e-4 / 3.0))


def test_end_stops_count_separate_contacts_on_each_side():
    #               under way | one | across: one each | touching counts
    found = end_stops([5, 5, 0, 4, 6, 4.5, 3, -5, 0, 4, 3.9], rate=2.0, travel=4.0)
    assert (found.upper, found.lower, found.hits) == (3, 1, 4)
    assert found.time == 7 / 2.0
    assert found.deepest == 2.0


def test_end_stops_of_a_seat_whose_equilibrium_is_not_in_the_middle():
    found = end_stops([5, 6, 0, -2, -3, 0, -1.9], rate=2.0, travel=4.0, height=-2.0)
    assert (found.upper, found.lower, found.deepest) == (1, 1, 1.0)
    mirrored = end_stops([-5, -6, 0, 2, 3, 0, 1.9], rate=2.0, travel=4.0, height=2.0)
    assert (mirrored.upper, mirrored.lower, mirrored.time) == (1, 1, found.time)


def test_end_stops_out_of_reach():
    found = end_stops(sine(2.0, 3.0, amplitude=0.04), RATE, travel=0.05)
    assert (found.hits, found.time, found.deepest) == (0, 0.0, 0.0)


def test_a_sines_contacts_are_two_a_period():
    found = end_stops(sine(2.0, 3.1, amplitude=0.06), RATE, travel=0.05)
    assert (found.upper, found.lower) == (7, 6)
    # share of a period above asin(5/6), to a sample per crossing
    assert found.time == pytest.approx(3.1 * (1.0 - 2.0 / math.pi * math.asin(5.0 / 6.0)), abs=0.06)


def test_a_held_force_does_exactly_its_work():
    found = actuator([100.0, -50.0, 7.0], [0.0, 0.02, 0.03], rate=10.0)
    assert found.energy == pytest.approx(100.0 * 0.02 - 50.0 * 0.01)
    assert found.power_mean == pytest.approx(1.5 / 0.2)
    assert found.power_positive == pytest.approx(2.0 / 0.2)
    assert found.power_absolute == pytest.approx(2.5 / 0.2)
    assert found.power_peak == pytest.approx(20.0)
    assert found.force_rms == pytest.approx(math.sqrt((100.0**2 + 50.0**2) / 2.0))
    assert found.force_peak == 100.0


def test_a_damping_force_takes_power_and_a_spring_none():
    # delta = a sin(w t): force -c delta' takes c (a w)^2 / 2; a spring's held force lags by half a sample
    a, w, c = 0.02, 2.0 * math.pi * 2.0, 400.0
    delta = sine(2.0, 10.002, amplitude=a)
    rate = a * w * np.cos(w * np.arange(delta.size) / RATE)
    damper = actuator(-c * rate, delta, RATE)
    assert damper.power_mean == pytest.approx(-c * (a * w) ** 2 / 2.0, rel=1e-3)
    assert damper.energy == pytest.approx(10.0 * damper.power_mean)
    assert damper.power_positive == pytest.approx(0.0, abs=2e-3 * damper.power_absolute)
    middle = (delta[1:] + delta[:-1]) / 2.0
    spring = actuator(np.append(-4600.0 * middle, 0.0), delta, RATE)
    assert abs(spring.energy) < 1e-9
    assert spring.power_positive == pytest.approx(spring.power_absolute / 2.0)


@lively
@given(seeds, st.floats(1e-3, 1e3))
def test_energy_scales_and_powers_keep_their_order(seed: int, factor: float):
    force, deflection = noise(seed), noise(seed + 1)
    found, stronger = actuator(force, deflection, RATE), actuator(factor * force, deflection, RATE)
    assert astuple(stronger) == pytest.approx([factor * value for value in astuple(found)], abs=1e-9 * factor)
    assert abs(found.power_mean) <= found.power_absolute <= found.power_peak
    assert found.power_mean == pytest.approx(2.0 * found.power_positive - found.power_absolute)


def test_the_script_of_the_page_runs(native: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    page = (ROOT / "docs" / "how-to" / "compute-metrics.md").read_text(encoding="utf-8")
    script, *_ = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    (tmp_path / "fmus").symlink_to(native)
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    exec(script, names)
    # a controlled seat below its 250 N isolates at 2 Hz
    assert names["seat_factor"](*(names["ride"](names[end], 500.0, 10.0) for end in ("driver", "floor"))).rms < 0.8


GOOD = np.ones(2000)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: rms([]), r"signal: expected samples in one dimension, got an array of shape \(0,\)"),
        (lambda: rms([[1.0, 2.0]]), r"got an array of shape \(1, 2\)"),
        (lambda: rms([1.0, math.nan, math.inf]), "signal: expected finite numbers, got nan at sample 1"),
        (lambda: rms([1j]), "signal: expected real numbers, got complex128"),
        (lambda: rms(["a"]), "signal: expected real numbers, got <U1"),
        (lambda: vdv(GOOD, 0.0), "rate: expected a finite number above 0 Hz, got 0 Hz"),
        (lambda: vdv(GOOD, math.nan), "rate: expected a finite number above 0 Hz, got nan Hz"),
        (lambda: mtvv(GOOD[:499], RATE), "weighted: expected at least 1 s of samples at 500 Hz .*, got 0.998 s"),
        (lambda: ride(GOOD, RATE, warm_up=-1.0), "warm_up: expected a finite number of at least 0 s, got -1 s"),
        (
            lambda: ride(GOOD, RATE, warm_up=4.0),
            "acceleration: expected at least 0.002 s .* after 4 s of warm-up, got 0 s",
        ),
        (lambda: seat_factor(ride(GOOD, RATE), ride(GOOD[1:], RATE)), "one duration, got 4 s and 3.998 s"),
        (
            lambda: seat_factor(ride(GOOD, RATE), ride(0.0 * GOOD, RATE)),
            "floor: expected a weighted acceleration above 0",
        ),
        (lambda: deflection_range([math.inf], RATE), "deflection: expected finite numbers, got inf at sample 0"),
        (lambda: end_stops(GOOD, RATE, travel=0.0), "travel: expected a finite number above 0 m, got 0 m"),
        (lambda: end_stops(GOOD, RATE, 1.0, height=np.nan), "height: expected a finite number, got nan m"),
        (lambda: actuator(GOOD, GOOD[1:], RATE), "signals of one length, got force 2000, deflection 1999 samples"),
        (lambda: actuator([1.0], [1.0], RATE), "force: expected at least 0.004 s"),
    ],
)
def test_invalid_samples_are_errors(call, message: str):
    with pytest.raises(SignalError, match=message) as error:
        call()
    assert isinstance(error.value, CosimError)
    assert isinstance(error.value, ValueError)
