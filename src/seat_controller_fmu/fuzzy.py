"""The Takagi-Sugeno model over the driver's mass: sectors and memberships (11)-(12), observer gains (23)."""

from __future__ import annotations

from typing import NamedTuple


class MassRange(NamedTuple):
    """Vertices of the Takagi-Sugeno model.

    Attributes
    ----------
    minimum, maximum
        M_min and M_max, the total masses (4) at the ends of the driver's mass range, in kg.
    """

    minimum: float
    maximum: float

    def memberships(self, mass: float) -> tuple[float, float]:
        """Evaluate h_1 and h_2 (12), clamped to [0, 1] outside the range.

        Parameters
        ----------
        mass
            Total mass M = m_b + m_s (4), in kg.

        Returns
        -------
        tuple of float
            h_1 and h_2 = 1 - h_1.

        Examples
        --------
        >>> MassRange(73.0, 108.0).memberships(73.0)
        (1.0, 0.0)
        """
        slowest, fastest = 1.0 / self.maximum, 1.0 / self.minimum
        h_1 = (1.0 / mass - slowest) / (fastest - slowest)
        h_1 = min(max(h_1, 0.0), 1.0)
        return h_1, 1.0 - h_1

    def inverse_mass(self, mass: float) -> float:
        """Evaluate 1/M = h_1/M_min + h_2/M_max (11) with M clamped to the range.

        Parameters
        ----------
        mass
            Total mass M = m_b + m_s (4), in kg.

        Returns
        -------
        float
            1/M, in 1/kg.
        """
        h_1, h_2 = self.memberships(mass)
        return h_1 / self.minimum + h_2 / self.maximum


def observer_gain(mass: float, gamma: float) -> float:
    """Evaluate L_i = D_2i/Gamma with D_2i = 1/M_i (23).

    Parameters
    ----------
    mass
        Total mass M_i at the vertex, in kg.
    gamma
        Gamma < 0, in s/kg2, so that the pole L_i D_2i of the observer has the unit 1/s.

    Returns
    -------
    float
        L_i, in kg/s.
    """
    return 1.0 / (mass * gamma)
