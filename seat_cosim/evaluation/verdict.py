"""Verdict of an evaluation: which results exceed the limits of ISO 7096, and which are not repeatable."""

from __future__ import annotations

from seat_cosim.evaluation.protocol import MAX_SPREAD, MIN_RUNS, seat_limit
from seat_cosim.evaluation.results import DriverClassResult, Evaluation

MODEL_NOTE = "Everything is computed by co-simulation; no person and no seat was measured."
LIMITS_NOTE = "The SEAT limits are those of ISO 7096 as recalled: check them in the standard before relying on them."

_MOST_NAMED = 6
"""Number of results up to which the verdict names those that are not repeatable."""


def exceeds_limit(excitation_class: str, result: DriverClassResult) -> bool:
    """Return whether a result's SEAT is above the limit of its class; False for a class without a limit.

    Parameters
    ----------
    excitation_class
        Class of ISO 7096, ``EM1`` to ``EM9``.
    result
        Result of that class.
    """
    limit = seat_limit(excitation_class)
    return limit is not None and result.seat > limit


def verdict(evaluation: Evaluation) -> str:
    """Return one line: how many results are within the limits, and which are not repeatable.

    Parameters
    ----------
    evaluation
        Of one system.
    """
    results = evaluation.results
    limited = [(name, result) for (name, _), result in results.items() if seat_limit(name) is not None]
    within = sum(not exceeds_limit(name, result) for name, result in limited)
    text = f"SEAT within the limit in {within} of {len(limited)} combinations of class and driver"
    scattered = [f"{name} {mass:g} kg" for (name, mass), result in results.items() if not result.is_repeatable]
    if not scattered:
        return f"{text}; all runs within {MAX_SPREAD:.0%} of their mean"
    few = min(len(result.rides) for result in results.values()) < MIN_RUNS
    why = "fewer than the three runs of ISO 10326-1" if few else f"runs more than {MAX_SPREAD:.0%} from their mean"
    where = ", ".join(scattered) if len(scattered) <= _MOST_NAMED else f"{len(scattered)} of {len(results)}"
    return f"{text}; {why} in {where}"
