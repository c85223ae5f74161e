"""A smooth step, with which signals fade in and out."""

from __future__ import annotations


def smooth_step(x: float) -> tuple[float, float, float]:
    """Evaluate a smooth step from 0 at x = 0 to 1 at x = 1, without slope and curvature at both ends.

    Parameters
    ----------
    x
        Any number.

    Returns
    -------
    value, slope, curvature : float
        The quintic 10 x^3 - 15 x^4 + 6 x^5 and its derivatives.

    Examples
    --------
    >>> smooth_step(0.5)
    (0.5, 1.875, 0.0)
    """
    if x <= 0.0:
        return 0.0, 0.0, 0.0
    if x >= 1.0:
        return 1.0, 0.0, 0.0
    return (
        x * x * x * (10.0 + x * (6.0 * x - 15.0)),
        30.0 * x * x * (1.0 - x) * (1.0 - x),
        60.0 * x * (1.0 - x) * (1.0 - 2.0 * x),
    )
