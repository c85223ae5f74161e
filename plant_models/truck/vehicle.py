"""The vehicle: cab, chassis and two axles in a plane, linear, from static equilibrium.

Degrees of freedom are heave z and pitch theta of cab (c) and chassis (s), and heave of the axles (1 front, 2 rear); up
and nose down are positive. A point at the distance x ahead of a centre of gravity moves by z - x theta. With the
compressions of mounts, suspensions and tyres

    y_c1 = (z_s - e_1 theta_s) - (z_c - b_1 theta_c),    y_c2 = (z_s - e_2 theta_s) - (z_c + b_2 theta_c),
    y_1  = z_1 - (z_s - l_1 theta_s),                    y_2  = z_2 - (z_s + l_2 theta_s),
    y_t1 = r_1 - z_1,                                    y_t2 = r_2 - z_2

and the forces f_i = k_i y_i + c_i y_i', f_ti = k_ti y_ti, which push their ends apart,

    m_c z_c''     = f_c1 + f_c2 + F                  I_c theta_c'' = -b_1 f_c1 + b_2 f_c2 - d F
    m_s z_s''     = f_1 + f_2 - f_c1 - f_c2          I_s theta_s'' = -l_1 f_1 + l_2 f_2 + e_1 f_c1 + e_2 f_c2
    m_1 z_1''     = f_t1 - f_1                       m_2 z_2''     = f_t2 - f_2

F is the force of the seat on the floor at the distance d ahead of the cab's centre of gravity. The tyres touch the road
in a point, have no damping and never lift off. Classical Runge-Kutta integrates the equations.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from fmus.component import ParameterError
from fmus.subnormal import flush_subnormal
from plant_models.truck.interface import Outputs, Parameters

MAX_SUBSTEP = 2e-3
"""Longest Runge-Kutta substep, in s: eight in a radian of the wheel hop at 10 Hz."""

SUBSTEPS_PER_RADIAN = 2.0
"""Substeps per radian of the fastest motion; explicit RK4 is stable down to 0.36 and within 1e-4 of exact at 2."""

MIN_SUBSTEP = 1e-5
"""Parameters that need a substep below this, in s, are refused: a step would take too long."""

DEGREES = 6
"""Number of degrees of freedom: z_c, theta_c, z_s, theta_s, z_1, z_2."""

Motion = tuple[float, ...]
"""Values of the degrees of freedom: displacements in m and rad, or their rates."""


class Coefficients(NamedTuple):
    """Coefficients of the vehicle, in the symbols above.

    Attributes
    ----------
    per_m_c, per_I_c, per_m_s, per_I_s, per_m_1, per_m_2
        Inverse masses in 1/kg and inertias in 1/(kg.m2).
    b_1, b_2, e_1, e_2, l_1, l_2, d
        Lengths in m.
    k_c1, k_c2, k_1, k_2, k_t1, k_t2
        Stiffnesses in N/m.
    c_c1, c_c2, c_1, c_2
        Dampings in N.s/m.
    substep
        Longest Runge-Kutta substep, in s.
    """

    per_m_c: float
    per_I_c: float
    per_m_s: float
    per_I_s: float
    per_m_1: float
    per_m_2: float
    b_1: float
    b_2: float
    e_1: float
    e_2: float
    l_1: float
    l_2: float
    d: float
    k_c1: float
    k_c2: float
    k_1: float
    k_2: float
    k_t1: float
    k_t2: float
    c_c1: float
    c_c2: float
    c_1: float
    c_2: float
    substep: float


def _max_substep(c: Coefficients) -> float:
    """Return the longest substep in s for the fastest motion of these parameters; refuse one that is too short.

    The traces of M^-1 K and M^-1 C bound the eigenvalues of both, and so all of the vehicle:
    |s| <= sqrt(trace M^-1 K) + trace M^-1 C.
    """
    front_mount = c.per_m_c + c.b_1 * c.b_1 * c.per_I_c + c.per_m_s + c.e_1 * c.e_1 * c.per_I_s
    rear_mount = c.per_m_c + c.b_2 * c.b_2 * c.per_I_c + c.per_m_s + c.e_2 * c.e_2 * c.per_I_s
    front = c.per_m_s + c.l_1 * c.l_1 * c.per_I_s + c.per_m_1
    rear = c.per_m_s + c.l_2 * c.l_2 * c.per_I_s + c.per_m_2
    stiffness = c.k_c1 * front_mount + c.k_c2 * rear_mount + c.k_1 * front + c.k_2 * rear
    stiffness = stiffness + c.k_t1 * c.per_m_1 + c.k_t2 * c.per_m_2
    damping = c.c_c1 * front_mount + c.c_c2 * rear_mount + c.c_1 * front + c.c_2 * rear
    fastest = math.sqrt(stiffness) + damping
    needed = 1.0 / (SUBSTEPS_PER_RADIAN * fastest) if fastest > 0.0 else MAX_SUBSTEP
    if not needed >= MIN_SUBSTEP:
        raise ParameterError(
            f"truck: expected a fastest motion below {1.0 / (SUBSTEPS_PER_RADIAN * MIN_SUBSTEP):g} rad/s, "
            f"got up to {fastest:g} rad/s from stiffnesses and dampings on masses and inertias"
        )
    return min(MAX_SUBSTEP, needed)


def prepare(p: Parameters) -> Coefficients:
    """Derive the coefficients of the vehicle.

    Parameters
    ----------
    p
        Parameters of the truck, each within its range.

    Returns
    -------
    Coefficients
        For :func:`substep` and :func:`outputs`.

    Raises
    ------
    ParameterError
        If the chassis' centre of gravity is not between the axles, or the truck is so stiff that a step would take too
        long.
    """
    if not p.chassis_position <= p.wheelbase:
        raise ParameterError(
            f"truck: expected chassis.position up to chassis.wheelbase (the axles carry the chassis), got "
            f"chassis.position = {p.chassis_position} m, chassis.wheelbase = {p.wheelbase} m"
        )
    cab = p.chassis_position - p.cab_position
    c = Coefficients(
        per_m_c=1.0 / p.cab_mass,
        per_I_c=1.0 / p.cab_pitch_inertia,
        per_m_s=1.0 / p.chassis_mass,
        per_I_s=1.0 / p.chassis_pitch_inertia,
        per_m_1=1.0 / p.front_axle_mass,
        per_m_2=1.0 / p.rear_axle_mass,
        b_1=p.cab_front_mount,
        b_2=p.cab_rear_mount,
        e_1=cab + p.cab_front_mount,
        e_2=cab - p.cab_rear_mount,
        l_1=p.chassis_position,
        l_2=p.wheelbase - p.chassis_position,
        d=p.seat_position,
        k_c1=p.cab_front_stiffness,
        k_c2=p.cab_rear_stiffness,
        k_1=p.front_stiffness,
        k_2=p.rear_stiffness,
        k_t1=p.front_tyre_stiffness,
        k_t2=p.rear_tyre_stiffness,
        c_c1=p.cab_front_damping,
        c_c2=p.cab_rear_damping,
        c_1=p.front_damping,
        c_2=p.rear_damping,
        substep=0.0,
    )
    return c._replace(substep=_max_substep(c))


def _accelerations(z: Motion, v: Motion, roads: tuple[float, float], force: float, c: Coefficients) -> Motion:
    """Solve the equations of motion for the accelerations in m/s2 and rad/s2."""
    z_c, theta_c, z_s, theta_s, z_1, z_2 = z
    v_c, omega_c, v_s, omega_s, v_1, v_2 = v
    r_1, r_2 = roads
    f_c1 = c.k_c1 * ((z_s - c.e_1 * theta_s) - (z_c - c.b_1 * theta_c)) + c.c_c1 * (
        (v_s - c.e_1 * omega_s) - (v_c - c.b_1 * omega_c)
    )
    f_c2 = c.k_c2 * ((z_s - c.e_2 * theta_s) - (z_c + c.b_2 * theta_c)) + c.c_c2 * (
        (v_s - c.e_2 * omega_s) - (v_c + c.b_2 * omega_c)
    )
    f_1 = c.k_1 * (z_1 - (z_s - c.l_1 * theta_s)) + c.c_1 * (v_1 - (v_s - c.l_1 * omega_s))
    f_2 = c.k_2 * (z_2 - (z_s + c.l_2 * theta_s)) + c.c_2 * (v_2 - (v_s + c.l_2 * omega_s))
    return (
        (f_c1 + f_c2 + force) * c.per_m_c,
        (c.b_2 * f_c2 - c.b_1 * f_c1 - c.d * force) * c.per_I_c,
        (f_1 + f_2 - f_c1 - f_c2) * c.per_m_s,
        (c.l_2 * f_2 - c.l_1 * f_1 + c.e_1 * f_c1 + c.e_2 * f_c2) * c.per_I_s,
        (c.k_t1 * (r_1 - z_1) - f_1) * c.per_m_1,
        (c.k_t2 * (r_2 - z_2) - f_2) * c.per_m_2,
    )


def _moved(x: Motion, time: float, rate: Motion) -> Motion:
    """Return x + time rate."""
    return tuple(a + time * b for a, b in zip(x, rate, strict=True))


def _combined(x: Motion, sixth: float, rates: tuple[Motion, Motion, Motion, Motion]) -> Motion:
    """Return x after a substep of six ``sixth``, in s, with the rates of its four stages."""
    return tuple(
        flush_subnormal(a + sixth * (r_1 + 2.0 * (r_2 + r_3) + r_4))
        for a, r_1, r_2, r_3, r_4 in zip(x, *rates, strict=True)
    )


def substep(
    z: Motion,
    v: Motion,
    h: float,
    roads: tuple[tuple[float, float], ...],
    forces: tuple[float, float, float],
    c: Coefficients,
) -> tuple[Motion, Motion]:
    """Take one step of classical Runge-Kutta.

    Parameters
    ----------
    z, v
        Displacements in m and rad, and their rates.
    h
        Length of the substep, in s.
    roads
        Elevation under front and rear axle at begin, middle and end of the substep, in m.
    forces
        Force of the seat at the same times, in N.
    c
        Coefficients from :func:`prepare`.

    Returns
    -------
    z, v
        At the end of the substep.
    """
    first, middle, last = roads
    f_1, f_2, f_3 = forces
    half = 0.5 * h
    a = _accelerations(z, v, first, f_1, c)
    v_2 = _moved(v, half, a)
    a_2 = _accelerations(_moved(z, half, v), v_2, middle, f_2, c)
    v_3 = _moved(v, half, a_2)
    a_3 = _accelerations(_moved(z, half, v_2), v_3, middle, f_2, c)
    v_4 = _moved(v, h, a_3)
    a_4 = _accelerations(_moved(z, h, v_3), v_4, last, f_3, c)
    sixth = h / 6.0
    return _combined(z, sixth, (v, v_2, v_3, v_4)), _combined(v, sixth, (a, a_2, a_3, a_4))


def outputs(z: Motion, v: Motion, roads: tuple[float, float], force: float, c: Coefficients) -> Outputs:
    """Evaluate the outputs of the truck.

    Parameters
    ----------
    z, v
        Displacements in m and rad, and their rates.
    roads
        Elevation under front and rear axle, in m.
    force
        Force of the seat, in N.
    c
        Coefficients from :func:`prepare`.

    Returns
    -------
    Outputs
        All of them.
    """
    a = _accelerations(z, v, roads, force, c)
    return Outputs(
        floor_displacement=z[0] - c.d * z[1],
        floor_velocity=v[0] - c.d * v[1],
        floor_acceleration=a[0] - c.d * a[1],
        road_elevation=roads[0],
        chassis_acceleration=a[2],
        cab_pitch=z[1],
        front_tyre_force=c.k_t1 * (roads[0] - z[4]),
        rear_tyre_force=c.k_t2 * (roads[1] - z[5]),
    )
