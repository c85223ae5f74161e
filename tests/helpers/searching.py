"""Looking for counterexamples: each property is searched shortly in every run, and long in ``make test-all``."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis.strategies import SearchStrategy

SEARCH = (Phase.explicit, Phase.generate, Phase.target, Phase.shrink)


def examples(short: int, long: int) -> pytest.MarkDecorator:
    """Run a test with so many examples, and a long one with more."""
    return pytest.mark.parametrize("count", [short, pytest.param(long, marks=pytest.mark.long)])


def for_all(count: int, check: Callable[..., None], *, quick: bool = False, **values: SearchStrategy[Any]) -> None:
    """Look for values for which a check fails; the same ones in each run.

    Parameters
    ----------
    count
        How many to try.
    check
        Called with them; fails by an assertion.
    quick
        Whether the first counterexample will do, however complicated.
    values
        Name of an argument to what it may be.
    """
    settings(
        max_examples=count,
        deadline=None,
        derandomize=True,
        database=None,
        report_multiple_bugs=False,
        phases=(Phase.generate,) if quick else SEARCH,
        suppress_health_check=list(HealthCheck),
    )(given(**values)(check))()


def fails(count: int, check: Callable[..., None], **values: SearchStrategy[Any]) -> None:
    """Make sure that a check can fail: that there are values for which it does."""
    with pytest.raises(AssertionError):
        for_all(count, check, quick=True, **values)
