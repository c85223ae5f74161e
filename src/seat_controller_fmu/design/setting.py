"""Setting of a design of gains: mass range, observer gains and weights of the inequalities."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from seat_controller_fmu.fuzzy import MassRange, observer_gain
from seat_controller_fmu.parameters import SEAT_MASS, SUSPENSION_STIFFNESS

Pair = tuple[float, float]


class GainsError(ValueError):
    """A set of gains that is incomplete or out of range."""


@dataclass(frozen=True)
class Setting:
    """Inputs of a design, except its objective.

    Attributes
    ----------
    driver_mass_min, driver_mass_max
        m_bmin and m_bmax, in kg.
    L1, L2
        Observer gains at M_min and M_max, in kg/s, below 0.
    alpha
        Weight of the seat acceleration in Z_1 (10).
    c_0
        Weight of the estimation error in (27); the paper does not give it.
    P_2
        Block of the Lyapunov matrix for the estimation error, chosen by the designer.
    observer_gamma
        Gamma in s/kg2, from which L1 and L2 follow by (23); None if they were chosen otherwise.
    """

    driver_mass_min: float
    driver_mass_max: float
    L1: float
    L2: float
    alpha: float
    c_0: float
    P_2: float
    observer_gamma: float | None = None

    def __post_init__(self) -> None:
        problems = [
            f"{name}: expected a finite number above 0, got {getattr(self, name)}"
            for name in ("driver_mass_min", "driver_mass_max", "alpha", "c_0", "P_2")
            if not 0.0 < getattr(self, name) < inf
        ]
        problems += [
            f"{name}: expected an observer gain below 0 (a stable observer), got {getattr(self, name)}"
            for name in ("L1", "L2")
            if not -inf < getattr(self, name) < 0.0
        ]
        if not self.driver_mass_min < self.driver_mass_max:
            problems.append(
                "driver mass range: expected driver_mass_min < driver_mass_max, got "
                f"{self.driver_mass_min} kg and {self.driver_mass_max} kg; swap them"
            )
        if problems:
            raise GainsError("; ".join(problems))

    @property
    def vertices(self) -> MassRange:
        """M_min and M_max (11), in kg."""
        return MassRange(self.driver_mass_min + SEAT_MASS.value, self.driver_mass_max + SEAT_MASS.value)

    @property
    def stiffness(self) -> float:
        """Stiffness k_f of the suspension in N/m."""
        return SUSPENSION_STIFFNESS.value

    @property
    def observer(self) -> Pair:
        """L_1 and L_2 in kg/s."""
        return self.L1, self.L2


def by_gamma(mass_min: float, mass_max: float, gamma: float, alpha: float, c_0: float, P_2: float) -> Setting:
    """Return a setting with the observer gains of (23).

    Parameters
    ----------
    mass_min, mass_max
        Lightest and heaviest driver, in kg.
    gamma
        Gamma, in s/kg2, below 0.
    alpha, c_0, P_2
        Weights, see :class:`Setting`.

    Returns
    -------
    Setting
        The setting.

    Raises
    ------
    GainsError
        If a value is out of range.
    """
    vertices = MassRange(mass_min + SEAT_MASS.value, mass_max + SEAT_MASS.value)
    L_1, L_2 = (observer_gain(mass, gamma) for mass in vertices)
    return Setting(mass_min, mass_max, L_1, L_2, alpha, c_0, P_2, gamma)


def equal_rate(mass_min: float, mass_max: float, rate: float, alpha: float, c_0: float, P_2: float) -> Setting:
    """Return a setting with an observer that has the same pole at all masses, L_i = rate M_i.

    Parameters
    ----------
    mass_min, mass_max
        Lightest and heaviest driver, in kg.
    rate
        Pole of the observer, in 1/s, below 0.
    alpha, c_0, P_2
        Weights, see :class:`Setting`.

    Returns
    -------
    Setting
        The setting.

    Raises
    ------
    GainsError
        If a value is out of range.
    """
    L_1, L_2 = rate * (mass_min + SEAT_MASS.value), rate * (mass_max + SEAT_MASS.value)
    return Setting(mass_min, mass_max, L_1, L_2, alpha, c_0, P_2)
