"""The seated body: four masses in a chain above the seat (Boileau and Rakheja 1998), for the driver and the seat.

    m_4 z_4'' = f_3 - f_4,     f_4 = k_4 (z_4 - z_s) + c_4 (z_4' - z_s')        pelvis and thighs on the seat
    m_3 z_3'' = f_2 - f_3,     f_3 = k_3 (z_3 - z_4) + c_3 (z_3' - z_4')        lower torso
    m_2 z_2'' = f_1 - f_2,     f_2 = k_2 (z_2 - z_3) + c_2 (z_2' - z_3')        chest and upper torso
    m_1 z_1'' = -f_1,          f_1 = k_1 (z_1 - z_2) + c_1 (z_1' - z_2')        head and neck

f_4 is the contact force, that of the body on the seat, up positive, without static weight. Displacements are absolute,
from static equilibrium. The published numbers are those of a body with 55.2 kg on the seat. For another mass on the
seat all masses, stiffnesses and dampings are multiplied by the ratio of the masses, so frequencies and damping ratios
stay and the apparent mass is in proportion to the mass. Sequences here run upwards: pelvis, lower torso, upper torso,
head.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from plant_models.driver import parameters as p
from plant_models.runge_kutta import Numbers

MASSES = (p.PELVIS_MASS.value, p.LOWER_TORSO_MASS.value, p.UPPER_TORSO_MASS.value, p.HEAD_MASS.value)
"""Published masses, in kg."""

STIFFNESSES = (p.LOWER_TORSO_STIFFNESS.value, p.UPPER_TORSO_STIFFNESS.value, p.HEAD_STIFFNESS.value)
"""Published stiffnesses inside the body, in N/m; that of the contact is a parameter."""

DAMPINGS = (p.LOWER_TORSO_DAMPING.value, p.UPPER_TORSO_DAMPING.value, p.HEAD_DAMPING.value)
"""Published dampings inside the body, in N.s/m."""

REFERENCE_MASS = MASSES[0] + MASSES[1] + MASSES[2] + MASSES[3]
"""Mass on the seat of the published body, in kg."""


class Body(NamedTuple):
    """Coefficients of a body, each sequence running upwards.

    Attributes
    ----------
    masses, per_mass
        In kg and 1/kg, length 4.
    k, c
        Stiffness in N/m and damping in N.s/m of the link below each mass, length 4; the first is the contact.
    """

    masses: Numbers
    per_mass: Numbers
    k: Numbers
    c: Numbers


def prepare(mass: float, contact_stiffness: float, contact_damping: float) -> Body:
    """Scale the published body to a mass on the seat.

    Parameters
    ----------
    mass
        Mass on the seat, in kg, above 0.
    contact_stiffness, contact_damping
        Of the contact of the published body, in N/m and N.s/m; scaled with the mass as all others.

    Returns
    -------
    Body
        Its coefficients.
    """
    scale = mass / REFERENCE_MASS
    masses = tuple(scale * m for m in MASSES)
    return Body(
        masses=masses,
        per_mass=tuple(1.0 / m for m in masses),
        k=tuple(scale * k for k in (contact_stiffness, *STIFFNESSES)),
        c=tuple(scale * c for c in (contact_damping, *DAMPINGS)),
    )


def fastest(body: Body) -> float:
    """Return a bound of the fastest motion of the body, from the links at each mass.

    Parameters
    ----------
    body
        From :func:`prepare`.

    Returns
    -------
    float
        In rad/s.
    """
    found = 0.0
    for i in range(4):
        k = body.k[i] + body.k[i + 1] if i < 3 else body.k[i]
        c = body.c[i] + body.c[i + 1] if i < 3 else body.c[i]
        found = max(found, math.sqrt(k * body.per_mass[i]) + c * body.per_mass[i])
    return found


def contact_force(deflection: float, rate: float, body: Body) -> float:
    """Return the force f_4 of the body on the seat.

    Parameters
    ----------
    deflection
        z_4 - z_s, in m.
    rate
        Its rate, in m/s.
    body
        From :func:`prepare`.

    Returns
    -------
    float
        In N, up positive.
    """
    return body.k[0] * deflection + body.c[0] * rate


def accelerations(z: Numbers, v: Numbers, contact: float, body: Body) -> Numbers:
    """Solve the equations of motion for the accelerations.

    Parameters
    ----------
    z, v
        Displacements in m and velocities in m/s, length 4.
    contact
        Force f_4 of the body on the seat, in N.
    body
        From :func:`prepare`.

    Returns
    -------
    tuple of float
        In m/s2, length 4.
    """
    links = [body.k[i] * (z[i] - z[i - 1]) + body.c[i] * (v[i] - v[i - 1]) for i in range(1, 4)]
    below, above = (contact, *links), (*links, 0.0)
    return tuple((above[i] - below[i]) * body.per_mass[i] for i in range(4))
