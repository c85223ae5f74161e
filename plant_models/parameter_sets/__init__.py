"""Parameter sets of the plant as SSP 1.0 files: what the paper does not publish, calibrated openly.

Names in them are ``component.variable`` of the seat suspension; each parameter says where its value comes from.
``python -m studies.calibrate --write`` makes them anew; ``docs/explanation/calibration.md`` tells how, and how sure
they are.
"""

from __future__ import annotations

from pathlib import Path

NAMES = ("load", "passive", "prototype", "ride")
"""The load of the experiments; the well-tuned passive seat; imperfections of the active prototype; the random ride."""


def path(name: str) -> Path:
    """Return the file of a set that comes with the package.

    Parameters
    ----------
    name
        One of :data:`NAMES`.

    Raises
    ------
    ValueError
        If it is none.

    Examples
    --------
    >>> path("passive").name
    'passive.ssv'
    """
    if name not in NAMES:
        raise ValueError(f"parameter set: expected one of {', '.join(NAMES)}, got {name}")
    return Path(__file__).with_name(f"{name}.ssv")
