"""Flushing of subnormal numbers.

A state that decays would become subnormal, and arithmetic with subnormal numbers is five to ten times slower.
"""

from __future__ import annotations

MIN_STATE = 1e-30
"""States of smaller magnitude are set to zero, in their own unit."""


def flush_subnormal(state: float) -> float:
    """Set a state of subnormal magnitude to zero.

    Parameters
    ----------
    state
        State, in any unit.

    Returns
    -------
    float
        The state, or 0 if its magnitude is below :data:`MIN_STATE`.
    """
    return 0.0 if abs(state) < MIN_STATE else state
