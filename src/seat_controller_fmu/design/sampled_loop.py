"""The sampled loop: two-mass seat with zero-order hold, rate filter, observer, additional delay. Linear, no friction.

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


class SampledSeat(NamedTuple):
    """The seat in discrete time: x' = A x + B_u u + B_floor d, with [a, delta] = C x + D u at the sample.

    The state is [z_s, z_s', z_b, z_b', z_v, z_v']. d is the floor acceleration z_v'', held over a sample. a is the seat
    acceleration, with the force u of the previous interval, and delta the deflection.

    Attributes
    ----------
    A, B_u, B_floor
        Shapes (6, 6), (6, 1), (6, 1).
    C, D
        Shapes (2, 6), (2, 1).
    driver
        Row of the driver's acceleration z_b'' over the state, shape (6,).
    """

    A: Array
    B_u: Array
    B_floor: Array
    C: Array
    D: Array
    driver: Array


def sampled_seat(seat: SeatModel) -> SampledSeat:
    """Discretise the two-mass seat (1)-(2) without friction, with zero-order hold over one sample.

    Parameters
    ----------
    seat
        Parameters of the seat.

    Returns
    -------
    SampledSeat
        Matrices of the seat for the sample time of the controller.
    """
    k, c, k_c, c_c = seat.suspension_stiffness, seat.suspension_damping, seat.cushion_stiffness, seat.cushion_damping
    m_s, m_b = seat.seat_mass, seat.driver_mass
    seat_row = np.array([-(k + k_c), -(c + c_c), k_c, c_c, k, c]) / m_s
    driver_row = np.array([k_c, c_c, -k_c, -c_c, 0.0, 0.0]) / m_b
    A = np.zeros((6, 6))
    A[0, 1] = A[2, 3] = A[4, 5] = 1.0
    A[1], A[3] = seat_row, driver_row
    B = np.zeros((6, 2))
    B[1, 0], B[5, 1] = 1.0 / m_s, 1.0
    C = np.vstack([seat_row, [1.0, 0.0, 0.0, 0.0, -1.0, 0.0]])
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

    The state is that of the seat (6, the last two are the floor's), the held force (1), the state of the controller (4)
    and the delayed demands.

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


def closed_loop(parameters: Parameters, seat: SeatModel, delay: int) -> ClosedLoop:
    """Close the loop of controller and seat.

    Parameters
    ----------
    parameters
        Parameters of the controller.
    seat
        Parameters of the seat.
    delay
        Additional samples between demand and force, at least 0.

    Returns
    -------
    ClosedLoop
        With 11 + ``delay`` states.
    """
    p = sampled_seat(seat)
    A_c, B_c = sampled_controller(prepare(parameters))
    n = 6 + 1 + 4 + delay
    held, w = 6, slice(7, 11)
    A = np.zeros((n, n))
    measured = np.zeros((2, n))
    measured[:, :6], measured[:, [held]] = p.C, p.D
    new_w = B_c @ measured
    new_w[:, w] += A_c
    demand = new_w[3]
    A[w] = new_w
    force = demand if delay == 0 else np.eye(n)[11 + delay - 1]
    A[held] = force
    A[:6, :6] = p.A
    A[:6] += np.outer(p.B_u[:, 0], force)
    for index in range(delay):  # a queue of demands
        A[11 + index] = demand if index == 0 else np.eye(n)[11 + index - 1]
    B_floor, B_force, C = np.zeros((n, 1)), np.zeros((n, 1)), np.zeros((1, n))
    B_floor[:6], B_force[:6], C[0, :6] = p.B_floor, p.B_u, p.driver
    B_force[held] = 1.0  # the accelerometer measures the effect of a force on the seat as that of the actuator's force
    return ClosedLoop(A, B_floor, B_force, C)


def spectral_radius(parameters: Parameters, seat: SeatModel, delay: int) -> float:
    """Return the largest magnitude of the poles of the closed loop.

    Parameters
    ----------
    parameters, seat, delay
        As of :func:`closed_loop`.

    Returns
    -------
    float
        Below 1 if the loop is stable.
    """
    A = closed_loop(parameters, seat, delay).A
    rest = [i for i in range(len(A)) if i not in (4, 5)]  # the motion of the floor is not part of the loop
    return float(np.abs(np.linalg.eigvals(A[np.ix_(rest, rest)])).max())


def delay_margin(parameters: Parameters, seat: SeatModel) -> float:
    """Return the longest additional delay with a stable loop, in whole samples up to :data:`MAX_DELAY`.

    Parameters
    ----------
    parameters
        Parameters of the controller.
    seat
        Parameters of the seat.

    Returns
    -------
    float
        In ms; NaN if the loop is unstable without additional delay.
    """
    for delay in range(MAX_DELAY + 1):
        if not spectral_radius(parameters, seat, delay) < 1.0:
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
