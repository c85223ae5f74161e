"""Uneven times: rounding, jitter, lost samples, gaps; parts of a recording."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cosim.errors import SetupError
from cosim.recordings import ChannelRequest, ReadOptions, Recording, read_recording

COUNT = 5000


def motion(t: np.ndarray) -> np.ndarray:
    return np.sin(2.0 * np.pi * 3.0 * t) + 0.3 * np.sin(2.0 * np.pi * 17.0 * t)


def write(path: Path, times: np.ndarray, moments: np.ndarray | None = None, places: int = 9) -> Path:
    """Write samples of the motion, taken at moments that may differ from the times in the file."""
    values = motion(times if moments is None else moments)
    rows = (f"{t:.{places}f},{a:.9f}" for t, a in zip(times, values, strict=True))
    path.write_text("\n".join(["time [s],acc [m/s2]", *rows]))
    return path


def read(path: Path, **options: object) -> Recording:
    return read_recording(path, {"a": ChannelRequest("acc", "--seat")}, ReadOptions(**options))  # type: ignore[arg-type]


def error_of(found: Recording) -> float:
    """Return the largest error of samples, apart from the ends of a spline."""
    return max(
        float(np.abs(part.values["a"] - motion(part.begin + np.arange(part.size) / found.rate))[5:-5].max())
        for part in found.parts
    )


@pytest.mark.parametrize(
    ("rate", "places"), [(300.0, 3), (512.0, 3), (2048.0, 3), (1000.0, 2), (800.0, 3), (44.1e3, 4)]
)
def test_rounded_times_are_even(rate: float, places: int, tmp_path: Path):
    """Also where rounding gives many samples the same time."""
    times = np.arange(COUNT) / rate
    found = read(write(tmp_path / "a.csv", times.round(places), times, places))
    assert found.rate == pytest.approx(rate, rel=2.0 * 10.0**-places / times[-1])
    np.testing.assert_allclose(found.samples("a"), motion(times), atol=1e-9)
    assert any(f"times are rounded to {10.0**-places:g} s" in note for note in found.notes)


@pytest.mark.parametrize("jitter", [0.002, 0.05, 0.2, 0.45])
def test_jitter_is_resampled_and_reported(jitter: float, tmp_path: Path):
    rng = np.random.default_rng(1)
    times = (np.arange(COUNT) + rng.uniform(-jitter, jitter, COUNT)) / 500.0
    times -= times[0]
    found = read(write(tmp_path / "a.csv", times))
    assert found.rate == pytest.approx(500.0, rel=0.01)
    assert error_of(found) < 2e-4
    assert any("by a cubic spline" in note for note in found.notes)


def test_single_lost_samples_are_interpolated_and_counted(tmp_path: Path):
    times = np.delete(np.arange(COUNT) / 500.0, [100, 700, 2500])
    found = read(write(tmp_path / "a.csv", times))
    assert found.rate == pytest.approx(500.0, rel=1e-6)
    assert error_of(found) < 2e-3
    assert any("3 single samples are missing and interpolated" in note for note in found.notes)


@pytest.mark.parametrize("length", [2, 3, 250])
def test_gaps_are_refused_with_place_and_length(length: int, tmp_path: Path):
    times = np.delete(np.arange(COUNT) / 500.0, np.arange(1001, 1001 + length))
    expected = f"got 1: {(length + 1) / 500.0:.4g} s after 2 s"
    with pytest.raises(SetupError, match=expected):
        read(write(tmp_path / "a.csv", times))


def test_a_recording_is_split_at_gaps(tmp_path: Path):
    times = np.delete(np.arange(COUNT) / 500.0, [*range(1001, 1251), *range(3000, 3100)])
    found = read(write(tmp_path / "a.csv", times), gaps="split")
    assert [part.size for part in found.parts] == [1001, 1749, 1900]
    assert [part.begin for part in found.parts] == pytest.approx([0.0, 2.502, 6.2])
    assert found.duration == pytest.approx(4650 / 500.0)
    assert error_of(found) < 1e-8


def test_missing_values_are_gaps(tmp_path: Path):
    path = write(tmp_path / "a.csv", np.arange(COUNT) / 500.0)
    lines = path.read_text().splitlines()
    lines[2001:2101] = [line.split(",")[0] + "," for line in lines[2001:2101]]
    path.write_text("\n".join(lines))
    with pytest.raises(SetupError, match=r"0\.202 s after 3\.998 s"):
        read(path)
    assert len(read(path, gaps="split").parts) == 2


def test_a_part_of_a_recording_is_chosen_by_its_times(tmp_path: Path):
    times = np.delete(np.arange(COUNT) / 500.0, np.arange(1001, 1251))
    path = write(tmp_path / "a.csv", times)
    found = read(path, start=4.0, stop=6.0)
    np.testing.assert_allclose(found.samples("a"), motion(4.0 + np.arange(1001) / 500.0), atol=1e-8)
    with pytest.raises(SetupError, match="expected a begin before the end"):
        read(path, start=6.0, stop=4.0)


def test_times_that_stand_still_are_refused(tmp_path: Path):
    times = np.arange(COUNT) / 500.0
    times[1000] = times[999]
    with pytest.raises(SetupError, match=r"got 1\.998 s twice, in rows 1000 and 1001"):
        read(write(tmp_path / "a.csv", times))
