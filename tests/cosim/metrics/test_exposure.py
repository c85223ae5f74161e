"""Daily exposures and comfort against the directive's and the standard's figures."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cosim.errors import SignalError
from cosim.metrics.exposure import ACTION, LIMIT, a8, comfort, daily_vdv, hours_to_a8, hours_to_vdv

levels = st.floats(0.05, 20.0)


def test_eight_hours_at_a_value_are_that_value():
    for value in (ACTION, LIMIT):
        assert a8(value.a8, 8.0) == value.a8
        assert hours_to_a8(value.a8, value) == 8.0
        assert hours_to_vdv(value.vdv, 8 * 3600.0, value) == pytest.approx(8.0)


def test_the_directives_figures():
    assert ACTION[1:] == (0.5, 9.1)
    assert LIMIT[1:] == (1.15, 21.0)


def test_twice_the_vibration_takes_a_quarter_of_the_time_and_a_sixteenth_of_the_dose():
    assert hours_to_a8(1.0, ACTION) == pytest.approx(2.0)
    assert hours_to_vdv(18.2, 8 * 3600.0, ACTION) == pytest.approx(0.5)


def test_a_measurement_is_extrapolated_to_a_day():
    assert daily_vdv(2.0, 8 * 3600.0 / 16.0) == pytest.approx(4.0)


@given(levels, st.floats(1.0, 1e5))
def test_after_the_time_to_a_value_it_is_reached(level: float, duration: float):
    assert a8(level, hours_to_a8(level, LIMIT)) == pytest.approx(LIMIT.a8)
    assert daily_vdv(level, duration, hours_to_vdv(level, duration, ACTION)) == pytest.approx(ACTION.vdv)


def test_without_vibration_no_value_is_reached():
    assert hours_to_a8(0.0, ACTION) == hours_to_vdv(0.0, 10.0, ACTION) == math.inf
    assert hours_to_a8(1e-300, ACTION) == hours_to_vdv(1e-300, 10.0, ACTION) == math.inf


@pytest.mark.parametrize(
    ("a_w", "expected"),
    [
        (0.0, ["not uncomfortable"]),
        (0.4, ["a little uncomfortable"]),
        (0.55, ["a little uncomfortable", "fairly uncomfortable"]),
        (0.7, ["fairly uncomfortable"]),
        (0.9, ["fairly uncomfortable", "uncomfortable"]),
        (1.1, ["uncomfortable"]),
        (1.4, ["uncomfortable", "very uncomfortable"]),
        (1.8, ["very uncomfortable"]),
        (2.2, ["very uncomfortable", "extremely uncomfortable"]),
        (30.0, ["extremely uncomfortable"]),
    ],
)
def test_comfort_has_bands_that_overlap(a_w: float, expected: list[str]):
    assert comfort(a_w) == tuple(expected)


@given(st.floats(0.0, 1e6))
def test_every_level_has_a_reaction(a_w: float):
    assert 1 <= len(comfort(a_w)) <= 2


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: a8(-1.0, 8.0), "a_w: expected a finite number of at least 0 m/s2, got -1 m/s2"),
        (lambda: a8(1.0, math.inf), "hours: expected a finite number of at least 0 h, got inf h"),
        (lambda: hours_to_vdv(1.0, 0.0, LIMIT), "duration: expected a finite number above 0 s, got 0 s"),
        (lambda: comfort(math.nan), "a_w: expected a finite number of at least 0 m/s2, got nan m/s2"),
    ],
)
def test_invalid_numbers_are_errors(call, message: str):
    with pytest.raises(SignalError, match=message):
        call()
