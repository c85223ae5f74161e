"""The study of the blocks: its search leaves seeds for the table, and finds what the defaults are."""

from __future__ import annotations

from pathlib import Path

import pytest

from seat_blocks.parameters import SKYHOOK_DAMPING, VELOCITY_CORNER
from seat_blocks.semi_active_seat import SEMI_ACTIVE_SEAT
from studies import seat_blocks


def test_the_table_is_of_rides_that_the_search_did_not_use():
    assert not set(seat_blocks.TEST_SEEDS) & set(seat_blocks.TRAINING_SEEDS)
    assert set(seat_blocks.SEARCHED) <= {v.name for v in SEMI_ACTIVE_SEAT.variables}


@pytest.mark.slow
def test_the_defaults_are_better_than_their_neighbours(native: Path):
    """Half and twice of each number that was searched cost more, on the rides of the search."""
    seat = seat_blocks.on_shaker(native / "fmi2", "SemiActiveSeat")
    found = {"seat.damper.skyhook": SKYHOOK_DAMPING.value, "seat.damper.velocity_corner": VELOCITY_CORNER.value}
    with seat.system.open() as session:
        least = seat_blocks.cost(seat, session, found)
        print(least)
        for name, value in found.items():
            for factor in (0.5, 2.0):
                assert seat_blocks.cost(seat, session, {**found, name: factor * value}) > least
