"""The studies of the mode robust: seeds apart, parameters that exist, a cost that tells good from bad."""

from __future__ import annotations

from pathlib import Path

import pytest

from fmus.variables import variables_of
from seat_controller_fmu.interface import Parameters
from studies import robust_table, tune_robust


def test_no_table_uses_a_seed_of_the_search():
    assert not set(robust_table.TEST_SEEDS) & set(tune_robust.TRAINING_SEEDS)
    assert {seed for *_, seed in (*tune_robust.RIDES, *tune_robust.OVERLOADS)} <= set(tune_robust.TRAINING_SEEDS)


def test_what_is_searched_are_parameters_and_the_defaults_are_legal():
    assert set(tune_robust.SEARCHED) <= {variable.name for variable in variables_of(Parameters)}
    assert tune_robust.is_legal(tune_robust.defaults())


@pytest.mark.long
def test_the_cost_of_the_defaults_is_below_that_of_a_bad_law(native: Path):
    with tune_robust.Rating(native / "fmi2") as rating:
        found = rating.cost(tune_robust.defaults())
        bad = rating.cost({**tune_robust.defaults(), "robust.friction_rate": 0.1, "robust.follow_slope": 0.0})
    print(found, bad)
    assert found.largest_seat < 0.24
    assert found.largest_overload < 1.0
    assert found.total < 0.8 * bad.total
