"""Parameter sets of the plant as SSP 1.0 files: values that the paper does not publish, calibrated against its tables.

The names in a set are ``component.variable`` of the seat suspension. Each parameter states the source of its value.
``python -m studies.calibrate --write`` writes the files; ``docs/explanation/calibration.md``
describes the method and the uncertainty.
"""

from __future__ import annotations

from pathlib import Path

NAMES = ("load", "passive", "prototype", "ride")
"""The load of the experiments; the passive reference seat; imperfections of the active prototype; the random ride."""


def path(name: str) -> Path:
    """Return the file of a parameter set.

    Parameters
    ----------
    name
        One of :data:`NAMES`.

    Returns
    -------
    Path
        The ``.ssv`` file in this package.

    Raises
    ------
    ValueError
        If there is no set of that name.

    Examples
    --------
    >>> path("passive").name
    'passive.ssv'
    """
    if name not in NAMES:
        raise ValueError(f"parameter set: expected one of {', '.join(NAMES)}, got {name}")
    return Path(__file__).with_name(f"{name}.ssv")
