"""The sampled loop as it runs: two-mass seat, zero-order hold, rate filter, observer, extra delay. Linear, no friction.

What the paper's design leaves out. The controller's part is built from the very coefficients its step uses, the seat's
from the seat's parameters, so nothing is modelled twice.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import numpy as np
from scipy.linalg import expm

from seat_controller_fmu.controller import Coefficients, prepare
from seat_controller_fmu.interface import Parameters
from seat_controller_fmu.parameters import SAMPLE_TIME

Array = np.ndarray[Any, Any]

LONGEST_DELAY = 60
"""Most extra samples of delay that are looked at."""


class SeatModel(Protocol):
    """The seat that the loop is closed around: two masses, suspension and cushion, linear.

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
"""Driver's mass in kg to the seat with that driver."""


class Plant(NamedTuple):
    """The seat from sample to sample: x' = A x + B_u u + B_d d, with [a, delta] = C x + D u at the sample.

    The state is [z_s, z_s', z_b, z_b', z_v, z_v'], d the floor's acceleration z_v'' or a force on the seat, held over a
    sample; a is the seat's acceleration, with the force u of the previous interval, delta the deflection.
    """

    A: Array
    B_u: Array
    B_floor: Array
    C: Array
    D: Array
    driver: Array


def plant(seat: SeatModel) -> Plant:
    """Discretise the two-mass seat (1)-(2) without friction over one sample."""
    k, c, k_c, c_c = seat.suspension_stiffness, seat.suspension_damping, seat.cushion_stiffness, seat.cushion_damping
    m_s, m_b = seat.seat_mass, seat.driver_mass
    seat_row = np.array([-(k + k_c), -(c + c_c), k_c, c_c, k, c]) / m_s
    driver_row = np.array([k_c, c_c, -k_c, -c_c, 0.0, 0.0]) / m_b
    A = np.zeros((6, 6))
    A[0, 1] = A[2, 3] = A[4, 5] = 1.0
    A[1], A[3] = seat_row, driver_row
    B = np.zeros((6, 2))
    B[1, 0], B[5, 1] = 1.0 / m_s, 1.0
    both = expm(np.block([[A, B], [np.zeros((2, 8))]]) * SAMPLE_TIME.value)
    deflection = np.array([1.0, 0.0, 0.0, 0.0, -1.0, 0.0])
    return Plant(
        A=both[:6, :6],
        B_u=both[:6, 6:7],
        B_floor=both[:6, 7:8],
        C=np.vstack([seat_row, deflection]),
        D=np.array([[1.0 / m_s], [0.0]]),
        driver=driver_row,
    )


def controller(c: Coefficients) -> tuple[Array, Array]:
    """Write the controller's sample as w' = A_c w + B_c [a, delta] with w = [v, delta, F_hat, u] of the last sample.

    The demand is the last entry of w'; the loop is linear as long as it stays below the limit.
    """
    v = np.array([c.rate_decay, -c.rate_gain, 0.0, 0.0, 0.0, c.rate_gain])
    F = np.array([0.0, 0.0, 1.0 + c.observer_force, -c.observer_force, c.observer_acceleration, c.observer_deflection])
    u = c.rate_gain_K * v + F
    u[5] += c.deflection_gain
    rows = np.vstack([v, [0.0, 0.0, 0.0, 0.0, 0.0, 1.0], F, u])
    return rows[:, :4], rows[:, 4:]


class Loop(NamedTuple):
    """The closed loop, x' = A x + B_floor z_v'' + B_force f; the driver's acceleration is C x.

    Attributes
    ----------
    A, B_floor, B_force, C
        Of the loop's state: seat (6, the last two are the floor's), held force, controller (4), delayed demands.
    """

    A: Array
    B_floor: Array
    B_force: Array
    C: Array


def loop(parameters: Parameters, seat: SeatModel, delay: int) -> Loop:
    """Close the loop.

    Parameters
    ----------
    parameters
        The controller's.
    seat
        The seat's; its friction is left out.
    delay
        Extra samples between the demand and the force, at least 0.
    """
    p = plant(seat)
    A_c, B_c = controller(prepare(parameters))
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
    for place in range(delay):  # a queue of demands
        A[11 + place] = demand if place == 0 else np.eye(n)[11 + place - 1]
    B_floor, B_force, C = np.zeros((n, 1)), np.zeros((n, 1)), np.zeros((1, n))
    B_floor[:6], B_force[:6], C[0, :6] = p.B_floor, p.B_u, p.driver
    B_force[held] = 1.0  # the accelerometer feels a force on the seat as it feels the actuator's
    return Loop(A, B_floor, B_force, C)


def spectral_radius(parameters: Parameters, seat: SeatModel, delay: int) -> float:
    """Return the largest magnitude of the loop's poles; below 1 it is stable."""
    A = loop(parameters, seat, delay).A
    rest = [i for i in range(len(A)) if i not in (4, 5)]  # the floor's own motion is not in the loop
    return float(np.abs(np.linalg.eigvals(A[np.ix_(rest, rest)])).max())


def delay_margin(parameters: Parameters, seat: SeatModel) -> float:
    """Return the longest extra delay up to which the loop stays stable, in ms.

    Looked for in whole samples up to :data:`LONGEST_DELAY`; NaN where the loop is unstable without any.
    """
    for delay in range(LONGEST_DELAY + 1):
        if not spectral_radius(parameters, seat, delay) < 1.0:
            break
    else:
        delay = LONGEST_DELAY + 1
    return (delay - 1) * (SAMPLE_TIME.value * 1e3) if delay else float("nan")


def response(loop: Loop, B: Array, frequencies: Array) -> Array:
    """Evaluate the driver's acceleration per unit of an input that is held over a sample.

    Parameters
    ----------
    loop
        From :func:`loop`.
    B
        Its ``B_floor`` (per m/s2 of floor acceleration) or ``B_force`` (m/s2 per N on the seat).
    frequencies
        In Hz, above 0 and well below the Nyquist frequency.

    Returns
    -------
    array
        Complex, one value a frequency.
    """
    z = np.exp(2j * np.pi * np.asarray(frequencies) * SAMPLE_TIME.value)
    matrices = z[:, None, None] * np.eye(len(loop.A)) - loop.A
    states = np.linalg.solve(matrices, np.broadcast_to(B.astype(complex), (len(z), *B.shape)))
    return np.asarray((loop.C @ states)[:, 0, 0])
