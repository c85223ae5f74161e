"""The truck as a linear system: matrices, modes and frequency responses, independent of the equations of the kernel.

The matrices are sums over the springs and dampers, each a stiffness or damping times the outer product of the vector
that gives its length. ``python -m plant_models.truck.modes`` prints the modes of the default truck.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from plant_models.truck.interface import Parameters
from plant_models.truck.road import CORNER, LEVELS, REFERENCE

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

COORDINATES = ("z_c", "theta_c", "z_s", "theta_s", "z_1", "z_2")
"""Degrees of freedom, as in :mod:`plant_models.truck.vehicle`."""


class Matrices(NamedTuple):
    """M q'' + C q' + K q = B [r_1, r_2] + D F, and the floor's displacement z_v = D' q.

    Attributes
    ----------
    M, C, K
        Masses, dampings and stiffnesses in SI units, of shape (6, 6).
    B
        Forces of the road's elevation under both axles, of shape (6, 2), in N/m.
    D
        Forces of the seat's force, of shape (6,), in 1 and m.
    """

    M: Array
    C: Array
    K: Array
    B: Array
    D: Array


class Mode(NamedTuple):
    """One mode of the linear truck.

    Attributes
    ----------
    frequency
        Undamped natural frequency abs(s)/(2 pi), in Hz; s is the eigenvalue.
    damping
        Damping ratio -Re(s)/abs(s); 1 for a mode that does not oscillate.
    shape
        Relative size of the degrees of freedom, the largest being 1 and a radian counting as a metre.
    """

    frequency: float
    damping: float
    shape: Array


def matrices(p: Parameters) -> Matrices:
    """Build the matrices of a truck.

    Parameters
    ----------
    p
        Parameters of the truck.

    Returns
    -------
    Matrices
        In the order of :data:`COORDINATES`.
    """
    ahead = p.chassis_position - p.cab_position  # of the cab's centre of gravity before that of the chassis
    e_1, e_2 = ahead + p.cab_front_mount, ahead - p.cab_rear_mount
    l_1, l_2 = p.chassis_position, p.wheelbase - p.chassis_position
    elements = [
        (p.cab_front_stiffness, p.cab_front_damping, [1.0, -p.cab_front_mount, -1.0, e_1, 0.0, 0.0]),
        (p.cab_rear_stiffness, p.cab_rear_damping, [1.0, p.cab_rear_mount, -1.0, e_2, 0.0, 0.0]),
        (p.front_stiffness, p.front_damping, [0.0, 0.0, 1.0, -l_1, -1.0, 0.0]),
        (p.rear_stiffness, p.rear_damping, [0.0, 0.0, 1.0, l_2, 0.0, -1.0]),
        (p.front_tyre_stiffness, 0.0, [0.0, 0.0, 0.0, 0.0, 1.0, 0.0]),
        (p.rear_tyre_stiffness, 0.0, [0.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
    ]
    K, C, B = np.zeros((6, 6)), np.zeros((6, 6)), np.zeros((6, 2))
    for stiffness, damping, lengthening in elements:
        outer = np.outer(lengthening, lengthening)
        K += stiffness * outer
        C += damping * outer
    B[4, 0], B[5, 1] = p.front_tyre_stiffness, p.rear_tyre_stiffness
    masses = [
        p.cab_mass,
        p.cab_pitch_inertia,
        p.chassis_mass,
        p.chassis_pitch_inertia,
        p.front_axle_mass,
        p.rear_axle_mass,
    ]
    return Matrices(np.diag(masses), C, K, B, np.array([1.0, -p.seat_position, 0.0, 0.0, 0.0, 0.0]))


def state_matrix(m: Matrices) -> Array:
    """Return A of x' = A x without road and seat, with the state x = [q, q'].

    Parameters
    ----------
    m
        Matrices of the truck.

    Returns
    -------
    ndarray
        Of shape (12, 12).
    """
    size = len(m.M)
    zero, one = np.zeros((size, size)), np.eye(size)
    return np.block([[zero, one], [-np.linalg.solve(m.M, m.K), -np.linalg.solve(m.M, m.C)]])


def modes(p: Parameters) -> list[Mode]:
    """Return the modes of a truck.

    Parameters
    ----------
    p
        Parameters of the truck.

    Returns
    -------
    list of Mode
        Ascending in frequency; a mode that does not oscillate stands there with both its eigenvalues.
    """
    values, vectors = np.linalg.eig(state_matrix(matrices(p)))
    found = []
    for value, vector in zip(values, vectors.T, strict=True):
        if value.imag >= 0.0:
            shape = np.abs(vector[: len(COORDINATES)])
            size = float(abs(value))
            damping = -float(value.real) / size if size > 0.0 else 1.0
            found.append(Mode(size / (2.0 * np.pi), damping, shape / shape.max()))
    return sorted(found, key=lambda mode: mode.frequency)


def floor_response(p: Parameters, frequencies: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
    """Return the frequency responses of the floor's acceleration.

    Parameters
    ----------
    p
        Parameters of the truck.
    frequencies
        In Hz.

    Returns
    -------
    road : ndarray
        Per elevation of the road under the front axle, in 1/s2; the rear axle meets the same road the wheelbase later.
    force : ndarray
        Per force of the seat, in 1/kg.
    """
    m = matrices(p)
    road, force = [], []
    for frequency in np.asarray(frequencies, dtype=float):
        s = 2j * np.pi * frequency
        delayed = np.array([1.0, np.exp(-s * p.wheelbase / p.speed)])
        answers = np.linalg.solve(s * s * m.M + s * m.C + m.K, np.column_stack([m.B @ delayed, m.D.astype(complex)]))
        along = s * s * (m.D @ answers)
        road.append(along[0])
        force.append(along[1])
    return np.array(road), np.array(force)


def road_density(p: Parameters, frequencies: npt.ArrayLike) -> Array:
    """Return the power spectral density of the random road's elevation in time.

    Parameters
    ----------
    p
        Parameters of the truck.
    frequencies
        f in Hz; the spatial frequency is n = f/v.

    Returns
    -------
    ndarray
        G(n)/v, one-sided, in m2/Hz, without the smoothing by cells.
    """
    n = np.asarray(frequencies, dtype=float) / p.speed
    density: Array = LEVELS[p.road_class] * REFERENCE**2 / (n * n + CORNER**2) / p.speed
    return density


if __name__ == "__main__":
    print(f"{'Hz':>6} {'damping':>8}   " + "".join(f"{name:>9}" for name in COORDINATES))
    for each in modes(Parameters()):
        print(f"{each.frequency:6.2f} {each.damping:8.2f}   " + "".join(f"{size:9.2f}" for size in each.shape))
