"""The Takagi-Sugeno model over the driver's mass."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from seat_controller_fmu.fuzzy import MassRange, observer_gain
from seat_controller_fmu.parameters import (
    DRIVER_MASS_MAX,
    DRIVER_MASS_MIN,
    OBSERVERS,
    PUBLISHED_OBSERVER_GAINS,
    SEAT_MASS,
)

VERTICES = MassRange(DRIVER_MASS_MIN.value + SEAT_MASS.value, DRIVER_MASS_MAX.value + SEAT_MASS.value)


def test_memberships_are_exact_at_both_vertices():
    assert VERTICES.memberships(VERTICES.minimum) == (1.0, 0.0)
    assert VERTICES.memberships(VERTICES.maximum) == (0.0, 1.0)


@given(st.floats(min_value=1.0, max_value=1000.0))
def test_memberships_lie_in_the_unit_interval_and_sum_to_one(mass: float):
    h_1, h_2 = VERTICES.memberships(mass)
    assert 0.0 <= h_1 <= 1.0
    assert h_1 + h_2 == 1.0


@given(st.floats(min_value=VERTICES.minimum, max_value=VERTICES.maximum))
def test_sectors_reproduce_the_inverse_mass_inside_the_range(mass: float):
    assert VERTICES.inverse_mass(mass) == pytest.approx(1.0 / mass, rel=1e-14)


@pytest.mark.parametrize(("mass", "end"), [(10.0, VERTICES.minimum), (500.0, VERTICES.maximum)])
def test_the_mass_is_clamped_outside_the_range(mass: float, end: float):
    assert VERTICES.inverse_mass(mass) == pytest.approx(1.0 / end, rel=1e-15)


@pytest.mark.parametrize("number", [1, 2])
def test_published_observer_gains_follow_from_gamma(number: int):
    gains = [observer_gain(mass, OBSERVERS[number].value) for mass in VERTICES]
    assert gains == pytest.approx(PUBLISHED_OBSERVER_GAINS[number], abs=0.8)  # printed without decimals


def test_the_printed_mass_range_does_not_give_the_published_observer_gains():
    assert observer_gain(120.0 + SEAT_MASS.value, OBSERVERS[1].value) == pytest.approx(-2252, abs=1)
