"""A motion over a communication step: a second-order Taylor series about its begin."""

from __future__ import annotations

from typing import NamedTuple


class Motion(NamedTuple):
    """Motion of a base over one step.

    Attributes
    ----------
    displacement
        At the begin, in m, up positive.
    velocity
        At the begin, in m/s.
    acceleration
        In m/s2, constant over the step.
    """

    displacement: float
    velocity: float
    acceleration: float

    def displacement_at(self, tau: float) -> float:
        """Return the displacement in m at ``tau`` seconds after the begin of the step."""
        return self.displacement + tau * (self.velocity + 0.5 * tau * self.acceleration)

    def velocity_at(self, tau: float) -> float:
        """Return the velocity in m/s at ``tau`` seconds after the begin of the step."""
        return self.velocity + tau * self.acceleration

    def from_time(self, tau: float) -> Motion:
        """Return the same motion about a later time.

        Parameters
        ----------
        tau
            Time after the begin of the step, in s.

        Returns
        -------
        Motion
            Of the same acceleration.
        """
        return Motion(self.displacement_at(tau), self.velocity_at(tau), self.acceleration)
