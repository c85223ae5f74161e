"""Installation of a test: travel and end stops, which belong to the test and are the same for every seat in it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cosim.errors import SetupError

RUBBER_STIFFNESS = 1e5
"""Stiffness of the test's rubber end stops, in N/m; assumed: 40 kg at rest compress them by 4 mm."""

RUBBER_DAMPING = 1e3
"""Damping of the test's rubber end stops, in N s/m; assumed."""


@dataclass(frozen=True)
class Installation:
    """Travel and end stops of a test.

    Attributes
    ----------
    travel
        Deflection in m, to each side, at which the end stops begin; None for unlimited travel.
    stiffness, damping
        Of the end stops, in N/m and N s/m.

    Raises
    ------
    SetupError
        If the travel is not a finite number above 0.

    Examples
    --------
    >>> Installation.of("none").travel is None, Installation.of("30").travel
    (True, 0.03)
    """

    travel: float | None = 0.040
    stiffness: float = RUBBER_STIFFNESS
    damping: float = RUBBER_DAMPING

    def __post_init__(self) -> None:
        """Check the travel."""
        if self.travel is not None and not (math.isfinite(self.travel) and self.travel > 0.0):
            raise SetupError(f"travel: expected more than 0 mm each way, or none, got {1e3 * self.travel:g} mm")

    @classmethod
    def of(cls, text: str) -> Installation:
        """Read the travel from the text of an option.

        Parameters
        ----------
        text
            Travel in mm, or ``none``.

        Raises
        ------
        SetupError
            If it is neither.
        """
        if text.strip().lower() == "none":
            return cls(travel=None)
        try:
            return cls(travel=float(text) / 1e3)
        except ValueError:
            raise SetupError(f"--travel {text}: expected mm each way, or none") from None

    @property
    def words(self) -> str:
        """Words for a reader."""
        if self.travel is None:
            return "unlimited travel, no end stops"
        return (
            f"end stops at {1e3 * self.travel:g} mm each way, rubber of {self.stiffness / 1e3:g} kN/m and "
            f"{self.damping:g} N·s/m"
        )
