"""Values of the seated driver, each with unit, symbol and source.

The body is the model with four degrees of freedom that Boileau and Rakheja fitted to the responses of seated drivers
in 1998. Its numbers are as recalled: the paper could not be read, and no stored copy of its table was found to check
them against. What supports them: the masses sum to 55.2 kg, 73.6 % of a person of 75 kg, and apparent mass and
transmissibility have their peaks where measurements have them (see docs/explanation/seated-driver.md).
"""

from __future__ import annotations

from fmus.variables import Quantity

_PUBLISHED = "Boileau and Rakheja 1998, as recalled"

DRIVER_MASS = Quantity(55.0, "kg", "m_b", "Table 1")

PELVIS_MASS = Quantity(12.78, "kg", "m_4", _PUBLISHED)
LOWER_TORSO_MASS = Quantity(8.62, "kg", "m_3", _PUBLISHED)
UPPER_TORSO_MASS = Quantity(28.49, "kg", "m_2", _PUBLISHED)
HEAD_MASS = Quantity(5.31, "kg", "m_1", _PUBLISHED)

CONTACT_STIFFNESS = Quantity(90_000.0, "N/m", "k_4", _PUBLISHED)
LOWER_TORSO_STIFFNESS = Quantity(162_800.0, "N/m", "k_3", _PUBLISHED)
UPPER_TORSO_STIFFNESS = Quantity(183_000.0, "N/m", "k_2", _PUBLISHED)
HEAD_STIFFNESS = Quantity(310_000.0, "N/m", "k_1", _PUBLISHED)

CONTACT_DAMPING = Quantity(2_064.0, "N.s/m", "c_4", _PUBLISHED)
LOWER_TORSO_DAMPING = Quantity(4_585.0, "N.s/m", "c_3", _PUBLISHED)
UPPER_TORSO_DAMPING = Quantity(4_750.0, "N.s/m", "c_2", _PUBLISHED)
HEAD_DAMPING = Quantity(400.0, "N.s/m", "c_1", _PUBLISHED)
