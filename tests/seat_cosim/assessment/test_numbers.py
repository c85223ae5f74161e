"""Numbers of measured rides: those of simulations, of recordings with gaps, gravity and offsets."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from cosim.errors import SetupError
from cosim.metrics import psd, ride, transmissibility
from cosim.recordings import ACCELERATION, Part, Recording
from cosim.recordings.recording import ChannelInfo
from cosim.units import GRAVITY
from seat_cosim.assessment.figures import thinned
from seat_cosim.assessment.numbers import assess, combined
from seat_cosim.assessment.spectra import ride_spectra
from seat_cosim.measured import without_offsets

RATE = 500.0


def recording(*parts: Mapping[str, np.ndarray], unit: str | None = "m/s2") -> Recording:
    """Return a recording with a second without samples between its parts."""
    begins = np.cumsum([0.0, *(len(next(iter(part.values()))) / RATE + 1.0 for part in parts)])
    channels = {key: ChannelInfo(key, ACCELERATION, unit, RATE) for key in parts[0]}
    made = tuple(Part(float(begin), part) for begin, part in zip(begins, parts, strict=False))
    return Recording(Path("ride.csv"), RATE, made, channels, ())


def noise(seconds: float, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal(round(seconds * RATE))


def test_a_ride_without_gaps_has_the_metrics_of_its_samples():
    floor, seat = noise(40.0), noise(40.0, 2)
    found = assess(recording({"floor": floor, "seat": seat}), hours=4.0)
    assert found.channels["seat"].ride == ride(seat, RATE)
    assert found.seat_factor is not None
    assert found.seat_factor.rms == ride(seat, RATE).a_w / ride(floor, RATE).a_w
    exposure = found.channels["seat"].exposure
    assert exposure.a8 == pytest.approx(ride(seat, RATE).a_w / math.sqrt(2.0))
    assert exposure.to_action == pytest.approx(8.0 * (0.5 / ride(seat, RATE).a_w) ** 2)
    np.testing.assert_allclose(found.spectra.densities["seat"].density, psd(seat, RATE).density, rtol=1e-12)
    assert found.spectra.transmissibility is not None
    np.testing.assert_array_equal(found.spectra.transmissibility.ratio, transmissibility(floor, seat, RATE).ratio)


def test_parts_are_combined_by_energy_and_dose():
    one, two = noise(40.0), 3.0 * noise(20.0, 2)
    rides = [ride(one, RATE), ride(two, RATE)]
    found = assess(recording({"seat": one}, {"seat": two})).channels["seat"].ride
    assert found == combined(rides)
    assert found.duration == 60.0
    assert found.a_w**2 * 60.0 == pytest.approx(rides[0].a_w ** 2 * 40.0 + rides[1].a_w ** 2 * 20.0)
    assert found.vdv**4 == pytest.approx(rides[0].vdv ** 4 + rides[1].vdv ** 4)
    assert found.mtvv == max(each.mtvv for each in rides)
    assert found.crest_factor * found.a_w == pytest.approx(max(each.crest_factor * each.a_w for each in rides))


def test_spectra_of_parts_are_averages_of_power_and_cross_power():
    """Two parts with opposite phase have a coherence of 0 together, of 1 each."""
    x = noise(40.0)
    for sign, coherence in ((1.0, 1.0), (-1.0, 0.0)):
        found = ride_spectra(recording({"floor": x, "seat": x}, {"floor": x, "seat": sign * x}), 0.25)
        assert found.transmissibility is not None
        np.testing.assert_allclose(found.transmissibility.coherence, coherence, atol=1e-12)
        assert found.transmissibility.averages == pytest.approx(2.0 * transmissibility(x, x, RATE).averages)
        np.testing.assert_allclose(found.densities["floor"].density, psd(x, RATE).density)


def test_short_parts_are_left_out_and_reported():
    found = assess(recording({"seat": noise(40.0)}, {"seat": noise(0.5)}, {"seat": noise(3.0)}))
    assert found.recording.duration == 43.0
    assert any("parts shorter than 1 s are left out, 0.5 s in all" in note for note in found.notes)
    assert any("spectra leave out short parts, 3 s in all" in note for note in found.notes)
    with pytest.raises(SetupError, match=r"expected at least 1 s without a gap, got 0\.5 s"):
        assess(recording({"seat": noise(0.5)}))


@pytest.mark.parametrize("gravity", [GRAVITY, -GRAVITY, 0.97 * GRAVITY])
def test_gravity_is_subtracted_and_reported(gravity: float):
    x = noise(20.0) - noise(20.0).mean()
    found = without_offsets(recording({"seat": x + gravity}))
    np.testing.assert_allclose(found.samples("seat"), x, atol=1e-12)
    assert any("contains gravity" in note for note in found.notes)


def test_an_offset_is_subtracted_and_reported_and_a_small_mean_stays():
    x = noise(20.0) - noise(20.0).mean()
    assert any(
        "has an offset; the mean of 0.3 m/s2" in note for note in without_offsets(recording({"a": x + 0.3})).notes
    )
    small = recording({"a": x + 0.01})
    np.testing.assert_array_equal(without_offsets(small).samples("a"), small.samples("a"))
    assert without_offsets(small).notes == ()


def test_gravity_in_g_without_a_unit_is_refused():
    x = 0.1 * (noise(20.0) - noise(20.0).mean()) + 1.0
    with pytest.raises(SetupError, match=r"got none and a mean of 1, as of gravity in g; --unit g"):
        without_offsets(recording({"a": x}, unit=None))
    assert without_offsets(recording({"a": x})).samples("a").mean() == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("factor", "unit", "words"), [(0.05, None, "is it in g"), (60.0, "m/s2", "check the unit")])
def test_doubtful_sizes_are_reported(factor: float, unit: str | None, words: str):
    (note,) = without_offsets(recording({"a": factor * (noise(20.0) - noise(20.0).mean())}, unit=unit)).notes
    assert words in note


@pytest.mark.parametrize("hours", [0.0, -1.0, 25.0, math.nan])
def test_impossible_days_are_refused(hours: float):
    with pytest.raises(SetupError, match="--hours"):
        assess(recording({"seat": noise(20.0)}), hours)


def test_thinning_keeps_the_extremes():
    t, x = np.arange(10_007) / RATE, noise(10_007 / RATE)
    time, values = thinned(t, x, 200)
    assert len(values) < 400
    assert (values.min(), values.max(), time[-1]) == (x.min(), x.max(), t[-1])
    assert np.all(np.diff(time) > 0.0)
    np.testing.assert_array_equal(thinned(t[:100], x[:100], 200)[1], x[:100])
