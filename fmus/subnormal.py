"""Subnormal numbers: a state that fades out would become subnormal, and arithmetic with it five to ten times slower."""

from __future__ import annotations

SMALLEST_STATE = 1e-30
"""States of smaller magnitude are zero, in their own unit."""


def flush_subnormal(state: float) -> float:
    """Return a state, or zero where its magnitude is below :data:`SMALLEST_STATE`."""
    return 0.0 if abs(state) < SMALLEST_STATE else state
