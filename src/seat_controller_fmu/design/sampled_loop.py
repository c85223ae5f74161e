"""The sampled loop: seat and driver with zero-order hold, rate filter, observer, additional delay. Linear, no friction.

The paper's design is in continuous time and has no delay. The controller here has the same coefficients as the control
law, the seat the same parameters as the plant.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import numpy as np
from scipy.signal import cont2discrete

from seat_controller_fmu.controller import Coefficients, prepare
from seat_controller_fmu.interface import Parameters
from seat_controller_fmu.parameters import SAMPLE_TIME

Array = np.ndarray[Any, Any]

MAX_DELAY = 60
"""Largest number of additional samples of delay in the search for the delay margin."""


class SeatModel(Protocol):
    """A linear seat with two masses, suspension and cushion.

    Attributes
    ----------
    driver_mass, seat_mass
        m_b and m_s, in kg.
    suspension_stiffness, suspension_damping
        k_f in N/m, c_f in N.s/m.
    cushion_stiffness, cushion_damping
        k_c in N/m, c_c in N.s/m.
    """

    driver_mass: float
    seat_mass: float
    suspension_stiffness: float
    suspension_damping: float
    cushion_stiffness: float
    cushion_damping: float


SeatFor = Callable[[float], SeatModel]
"""Function from the driver's mass in kg to the seat with that driver."""


class DriverBody(NamedTuple):
    """A driver as a chain of masses above the seat, upwards.

    Attributes
    ----------
    masses
        In kg; the first is the one that counts as the driver, z_b.
    stiffnesses, dampings
        Of the link below each mass, in N/m and N.s/m.
    """

    masses: tuple[float, ...]
    stiffnesses: tuple[float, ...]
    dampings: tuple[float, ...]


BodyFor = Callable[[float], DriverBody]
"""Function from the driver's mass in kg to a driver of several masses."""


def mechanics(seat: SeatModel, body: DriverBody | None = None) -> Array:
    """Return the matrix of the equations of motion of seat and driver on a floor at rest.

    Parameters
    ----------
    seat
        Parameters of the seat.
    body
        Driver in place of the mass on the cushion; None for this mass.

    Returns
    -------
    array
        Over displacement and velocity of each of n masses, seat first, then the driver upwards; shape (2 n, 2 n).
    """
    if body is None:
        body = DriverBody((seat.driver_mass,), (seat.cushion_stiffness,), (seat.cushion_damping,))
    masses = (seat.seat_mass, *body.masses)
    k, c = (seat.suspension_stiffness, *body.stiffnesses, 0.0), (seat.suspension_damping, *body.dampings, 0.0)
    A = np.zeros((2 * len(masses), 2 * len(masses)))
    for i, mass in enumerate(masses):
        z, v = 2 * i, 2 * i + 1
        A[z, v] = 1.0
        A[v, z], A[v, v] = -(k[i] + k[i + 1]) / mass, -(c[i] + c[i + 1]) / mass
        if i > 0:
            A[v, z - 2], A[v, v - 2] = k[i] / mass, c[i] / mass
        if i + 1 < len(masses):
            A[v, z + 2], A[v, v + 2] = k[i + 1] / mass, c[i + 1] / mass
    return A


class SampledSeat(NamedTuple):
    """The seat in discrete time: x' = A x + B_u u + B_floor d, with [a, delta] = C x + D u at the sample.

    The state is [z_s, z_s', z_b, z_b', z_v, z_v'], n = 6, with the other masses of a body before the floor. d is the
    floor acceleration z_v'', held over a sample. a is the seat acceleration, with the force u of the previous interval,
    and delta the deflection.

    Attributes
    ----------
    A, B_u, B_floor
        Shapes (n, n), (n, 1), (n, 1).
    C, D
        Shapes (2, n), (2, 1).
    driver
        Row of the driver's acceleration z_b'' over the state, shape (n,).
    """

    A: Array
    B_u: Array
    B_floor: Array
    C: Array
    D: Array
    driver: Array


def sampled_seat(seat: SeatModel, body: DriverBody | None = None) -> SampledSeat:
    """Discretise the seat (1)-(2) without friction, with zero-order hold over one sample.

    Parameters
    ----------
    seat
        Parameters of the seat.
    body
        As of :func:`mechanics`.

    Returns
    -------
    SampledSeat
        Matrices of the seat for the sample time of the controller.
    """
    m_s, moving = seat.seat_mass, mechanics(seat, body)
    z_v = len(moving)
    v_v, n = z_v + 1, z_v + 2
    A = np.zeros((n, n))
    A[:z_v, :z_v] = moving
    A[1, z_v], A[1, v_v] = seat.suspension_stiffness / m_s, seat.suspension_damping / m_s
    A[z_v, v_v] = 1.0
    driver_row = A[3].copy()
    B = np.zeros((n, 2))
    B[1, 0], B[v_v, 1] = 1.0 / m_s, 1.0
    C = np.vstack([A[1], np.eye(n)[0] - np.eye(n)[z_v]])
    D = np.array([[1.0 / m_s, 0.0], [0.0, 0.0]])
    A, B, C, D, _ = cont2discrete((A, B, C, D), SAMPLE_TIME.value, method="zoh")
    return SampledSeat(A=A, B_u=B[:, 0:1], B_floor=B[:, 1:2], C=C, D=D[:, 0:1], driver=driver_row)


def sampled_controller(c: Coefficients) -> tuple[Array, Array]:
    """Return the controller in state space: w' = A_c w + B_c [a, delta] with the state w = [v, delta, F_hat, u].

    The state is that after the last sample. The force demand is the last entry of w'. The loop is linear while the
    demand is below the force limit.

    Parameters
    ----------
    c
        Coefficients of the controller.

    Returns
    -------
    A_c, B_c : array
        Shapes (4, 4) and (4, 2).
    """
    v = np.array([c.rate_decay, -c.rate_gain, 0.0, 0.0, 0.0, c.rate_gain])
    F = np.array([0.0, 0.0, 1.0 + c.observer_force, -c.observer_force, c.observer_acceleration, c.observer_deflection])
    u = c.rate_gain_K * v + F
    u[5] += c.deflection_gain
    rows = np.vstack([v, [0.0, 0.0, 0.0, 0.0, 0.0, 1.0], F, u])
    return rows[:, :4], rows[:, 4:]


class ClosedLoop(NamedTuple):
    """The closed loop x' = A x + B_floor z_v'' + B_force f; the driver's acceleration is C x.

    The state is that of the seat (6, more with a body; the last two are the floor's), the held force (1), the state of
    the controller (4) and the delayed demands.

    Attributes
    ----------
    A
        Shape (n, n).
    B_floor, B_force
        Shape (n, 1): floor acceleration in m/s2, force on the seat in N.
    C
        Shape (1, n).
    """

    A: Array
    B_floor: Array
    B_force: Array
    C: Array


def closed_loop(parameters: Parameters, seat: SeatModel, delay: int, body: DriverBody | None = None) -> ClosedLoop:
    """Close the loop of controller and seat.

    Parameters
    ----------
    parameters
        Parameters of the controller.
    seat
        Parameters of the seat.
    delay
        Additional samples between demand and force, at least 0.
    body
        As of :func:`mechanics`.

    Returns
    -------
    ClosedLoop
        With 5 + ``delay`` states and those of the seat.
    """
    p = sampled_seat(seat, body)
    A_c, B_c = sampled_controller(prepare(parameters))
    held = len(p.A)
    w, queue = slice(held + 1, held + 5), held + 5
    n = queue + delay
    A = np.zeros((n, n))
    measured = np.zeros((2, n))
    measured[:, :held], measured[:, [held]] = p.C, p.D
    new_w = B_c @ measured
    new_w[:, w] += A_c
    demand = new_w[3]
    A[w] = new_w
    force = demand if delay == 0 else np.eye(n)[n - 1]
    A[held] = force
    A[:held, :held] = p.A
    A[:held] += np.outer(p.B_u[:, 0], force)
    for index in range(delay):  # a queue of demands
        A[queue + index] = demand if index == 0 else np.eye(n)[queue + index - 1]
    B_floor, B_force, C = np.zeros((n, 1)), np.zeros((n, 1)), np.zeros((1, n))
    B_floor[:held], B_force[:held], C[0, :held] = p.B_floor, p.B_u, p.driver
    B_force[held] = 1.0  # the accelerometer measures the effect of a force on the seat as that of the actuator's force
    return ClosedLoop(A, B_floor, B_force, C)


def spectral_radius(parameters: Parameters, seat: SeatModel, delay: int, body: DriverBody | None = None) -> float:
    """Return the largest magnitude of the poles of the closed loop.

    Parameters
    ----------
    parameters, seat, delay, body
        As of :func:`closed_loop`.

    Returns
    -------
    float
        Below 1 if the loop is stable.
    """
    A = closed_loop(parameters, seat, delay, body).A
    floor = len(A) - delay - 7  # the motion of the floor is not part of the loop
    rest = [i for i in range(len(A)) if i not in (floor, floor + 1)]
    return float(np.abs(np.linalg.eigvals(A[np.ix_(rest, rest)])).max())


def delay_margin(parameters: Parameters, seat: SeatModel, body: DriverBody | None = None) -> float:
    """Return the longest additional delay with a stable loop, in whole samples up to :data:`MAX_DELAY`.

    Parameters
    ----------
    parameters
        Parameters of the controller.
    seat
        Parameters of the seat.
    body
        As of :func:`mechanics`.

    Returns
    -------
    float
        In ms; NaN if the loop is unstable without additional delay.
    """
    for delay in range(MAX_DELAY + 1):
        if not spectral_radius(parameters, seat, delay, body) < 1.0:
            break
    else:
        delay = MAX_DELAY + 1
    return (delay - 1) * (SAMPLE_TIME.value * 1e3) if delay else float("nan")


def response(loop: ClosedLoop, B: Array, frequencies: Array) -> Array:
    """Evaluate the frequency response of the driver's acceleration to an input that is held over a sample.

    Parameters
    ----------
    loop
        Loop from :func:`closed_loop`.
    B
        Its ``B_floor`` (response in m/s2 per m/s2 of floor acceleration) or ``B_force`` (in m/s2 per N on the seat).
    frequencies
        In Hz, above 0 and well below the Nyquist frequency, shape (n,).

    Returns
    -------
    array
        Complex, shape (n,).
    """
    z = np.exp(2j * np.pi * np.asarray(frequencies) * SAMPLE_TIME.value)
    matrices = z[:, None, None] * np.eye(len(loop.A)) - loop.A
    states = np.linalg.solve(matrices, np.broadcast_to(B.astype(complex), (len(z), *B.shape)))
    return np.asarray((loop.C @ states)[:, 0, 0])
