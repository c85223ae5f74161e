"""The paper's equations once more, written from the paper alone and solved implicitly: the code's touchstone.

Nothing of the project's models is imported. Mechanics and the Bouc-Wen equation are integrated in time by scipy's Radau
with the floor's exact motion, the controller's sampled equations stand in their plain form.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

Floor = Callable[[float], tuple[float, float, float]]


@dataclass(frozen=True)
class Case:
    """Parameters of a reference run, SI units."""

    m_b: float = 55.0
    gamma: float = -3e-6
    enabled: bool = True
    m_s: float = 28.0
    k_c: float = 90e3
    c_c: float = 2500.0
    k_f: float = 4600.0
    u_lim: float = 250.0
    M_min: float = 73.0
    M_max: float = 108.0
    f_c: float = 30.0
    h: float = 0.002


def bump(height: float = 0.07, length: float = 0.8, speed: float = 1.0) -> Floor:
    """Displacement, velocity, acceleration of (34)."""
    w, a = 2 * np.pi * speed / length, height / 2

    def motion(t: float) -> tuple[float, float, float]:
        if t >= length / speed - 1e-12:
            return 0.0, 0.0, 0.0
        return a * (1 - np.cos(w * t)), a * w * np.sin(w * t), a * w * w * np.cos(w * t)

    return motion


def sine(frequency: float = 3.0, amplitude: float = 0.006) -> Floor:
    """Displacement, velocity, acceleration of A sin(2 pi f t)."""
    w = 2 * np.pi * frequency
    return lambda t: (
        amplitude * np.sin(w * t),
        amplitude * w * np.cos(w * t),
        -amplitude * w * w * np.sin(w * t),
    )


def bouc_wen_rate(v: float, z: float) -> float:
    """(36) with its erratum corrected."""
    return 6.9321 * v - 2.1617e8 * abs(v) * abs(z) * z + 9.8889e7 * v * z * z


ALPHA = 3.0983e5


def accelerations(t: float, y: np.ndarray, u: float, case: Case, floor: Floor) -> tuple[float, float]:
    """(1) and (2), the force u acting."""
    z_s, v_s, z_b, v_b, z_d = y
    cushion = case.k_c * (z_b - z_s) + case.c_c * (v_b - v_s)
    seat = (-case.k_f * (z_s - floor(t)[0]) + cushion - ALPHA * z_d + u) / case.m_s
    return seat, -cushion / case.m_b


def rates(t: float, y: np.ndarray, u: float, case: Case, floor: Floor) -> list[float]:
    """Derivatives of [z_s, z_s', z_b, z_b', z_d]."""
    seat, driver = accelerations(t, y, u, case, floor)
    return [y[1], seat, y[3], driver, bouc_wen_rate(y[1] - floor(t)[1], y[4])]


def solve(case: Case, floor: Floor, steps: int) -> dict[str, np.ndarray]:
    """Sample, hold the force, integrate to the next sample; row k holds the values at t_k."""
    M = min(max(case.m_b + case.m_s, case.M_min), case.M_max)
    h_1 = (1 / M - 1 / case.M_max) / (1 / case.M_min - 1 / case.M_max)
    K = h_1 * np.array([4573.0, -90.0]) + (1 - h_1) * np.array([4560.0, -134.0])
    L = h_1 / (case.M_min * case.gamma) + (1 - h_1) / (case.M_max * case.gamma)
    tau = 1 / (2 * np.pi * case.f_c)
    y, u, u_sat, F, v, previous = np.zeros(5), 0.0, 0.0, 0.0, 0.0, None
    rows = []
    for k in range(steps + 1):
        t = k * case.h
        seat, driver = accelerations(t, y, u_sat, case, floor)
        delta = y[0] - floor(t)[0]
        if case.enabled and k < steps:
            v = (tau * v + delta - (delta if previous is None else previous)) / (tau + case.h)
            previous = delta
            F = F + case.h * L * (seat - (-case.k_f / M * delta + (u - F) / M))
            u = float(K @ [delta, v]) + F
            u_sat = float(np.clip(u, -case.u_lim, case.u_lim))
        rows.append([t, delta, seat, driver, u, u_sat, F, ALPHA * y[4]])
        if k < steps:
            solution = solve_ivp(rates, (t, t + case.h), y, "Radau", rtol=1e-8, atol=1e-11, args=(u_sat, case, floor))
            y = solution.y[:, -1]
    names = ("time", "suspension_deflection", "seat_acceleration", "driver_acceleration")
    names += ("force_demand", "force", "disturbance_estimate", "friction_force")
    return dict(zip(names, np.array(rows).T, strict=True))


def open_loop(case: Case, floor: Floor, force: Callable[[float], float], knots: float, times: np.ndarray) -> np.ndarray:
    """Driver's acceleration and deflection at given times under a prescribed floor and force; shape (times, 2).

    The force is constant between multiples of ``knots``, in s; ``times`` are multiples of a fraction of it.
    """
    rows, y = [], np.zeros(5)
    for k in range(round(times[-1] / knots)):
        begin, end = k * knots, (k + 1) * knots
        wanted = times[(times > begin - 1e-9) & (times < end - 1e-9)]
        at = (force(begin), case, floor)
        solution = solve_ivp(
            lambda t, y, at=at: rates(t, y, *at),
            (begin, end),
            y,
            "Radau",
            rtol=1e-8,
            atol=1e-11,
            max_step=2e-3,
            t_eval=[*wanted, end],
        )
        for t, state in zip(wanted, solution.y.T, strict=False):
            rows.append([accelerations(t, state, *at)[1], state[0] - floor(t)[0]])
        y = solution.y[:, -1]
    return np.array(rows)
