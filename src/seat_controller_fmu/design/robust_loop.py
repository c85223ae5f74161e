"""The sampled loop of the mode robust: its linear core with a seat of two masses and an actuator with lag and delay.

The controller's matrices are the answers of :func:`seat_controller_fmu.robust.step` to unit vectors, so they are those
of the code. The core is linear with the follow term held constant, without friction ahead, force limit, overload
damper, stillness and faults. Scheduling and limits are covered by simulation only.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import expm

from seat_controller_fmu import robust
from seat_controller_fmu.design.sampled_loop import MAX_DELAY, BodyFor, DriverBody, SeatFor, SeatModel, mechanics
from seat_controller_fmu.interface import Parameters
from seat_controller_fmu.parameters import SAMPLE_TIME

Array = np.ndarray[Any, Any]

_SIGNALS = (
    "position",
    "rate",
    "floor",
    "applied",
    "answered",
    "part",
    "cushion_1",
    "cushion_2",
    "estimate",
    "bias",
    "followed",
    "slow",
)
"""States of the linear core."""

_UNBOUNDED = 1e15
_FREQUENCIES = np.logspace(-1.5, np.log10(50.0), 400)
_RIGID_STIFFNESS, _RIGID_DAMPING = 5e6, 2e4
"""Cushion of a load that is bolted to the seat, in N/m and N.s/m: beyond 20 Hz for all masses."""


def _linear_core(c: robust.RobustCoefficients, follow: float) -> robust.RobustCoefficients:
    """Return the coefficients of the linear core, with a constant follow term."""
    return c._replace(
        limit=_UNBOUNDED,
        bias_bound=_UNBOUNDED,
        follow_min=follow,
        follow_max=follow,
        friction_share=0.0,
        overload_slope=0.0,
        still_begin=-1.0,
        still_slope=1.0,
        start_rate=0.0,
        ramp=1.0,
        adapts_mass=False,
        estimates=False,
        faults=c.faults._replace(
            sample_time=_UNBOUNDED, acceleration_range=_UNBOUNDED, deflection_range=_UNBOUNDED, knows_stops=False
        ),
    )


def linear_controller(parameters: Parameters, follow: float = 0.0) -> tuple[Array, Array]:
    """Return the linear core in state space: w' = A w + B [a, delta]; the last entry of w' is the force demand.

    Parameters
    ----------
    parameters
        Parameters of the controller.
    follow
        beta, held constant.

    Returns
    -------
    A, B : array
        Shapes (n, n) and (n, 2).
    """
    c = _linear_core(robust.prepare(parameters), follow)
    signals = (*_SIGNALS, "lagging") if c.has_lead else _SIGNALS
    used = 2 * c.delay
    rest = robust.start(c)._replace(active=True, level=1.0)

    def after(w: Array, a: float, delta: float) -> Array:
        line = (*w[len(signals) : -1].tolist(), *rest.line[used:])
        state = rest._replace(**dict(zip(signals, w.tolist(), strict=False)), line=line)
        sample = robust.Sample(a, delta, delta, 0.0, float(w[-1]), True)
        state, demand, _ = robust.step(state, sample, c)
        oldest = 2 * state.place
        queue = (*state.line[oldest:used], *state.line[:oldest])
        return np.array([*(getattr(state, name) for name in signals), *queue, demand])

    n = len(signals) + used + 1
    nothing = np.zeros(n)
    A = np.array([after(w, 0.0, 0.0) for w in np.eye(n)]).T
    B = np.array([after(nothing, 1.0, 0.0), after(nothing, 0.0, 1.0)]).T
    return A, B


class ActuatedSeat(NamedTuple):
    """The seat with its actuator's lag in discrete time: x' = A x + B_u u + B_floor d, [a, delta] = C x.

    The state is [z_s - z_v, z_s' - z_v', z_b - z_v, z_b' - z_v', force on the seat], n = 5, with the other masses of a
    body before the force; d is the floor's acceleration.

    Attributes
    ----------
    A, B_u, B_floor
        Shapes (n, n), (n, 1), (n, 1).
    C
        Shape (2, n).
    driver
        Row of the driver's acceleration z_b'' over the state, shape (n,).
    """

    A: Array
    B_u: Array
    B_floor: Array
    C: Array
    driver: Array


def actuated_seat(seat: SeatModel, lag: float, body: DriverBody | None = None) -> ActuatedSeat:
    """Discretise the seat (1)-(2) without friction, with force demand and floor held over a sample.

    Parameters
    ----------
    seat
        Parameters of the seat.
    lag
        Time constant of the actuator, in s; 0 for none.
    body
        As of :func:`~seat_controller_fmu.design.sampled_loop.mechanics`.

    Returns
    -------
    ActuatedSeat
        Matrices of the seat.
    """
    moving = mechanics(seat, body)
    force = len(moving)
    demand, floor, n = force + 1, force + 2, force + 1
    held = np.zeros((force + 3, force + 3))  # state, demand, floor
    held[:force, :force] = moving
    held[1, force] = 1.0 / seat.seat_mass
    held[1:force:2, floor] = -1.0
    a_s, a_b = held[1, :n].copy(), held[3, :n].copy()
    if lag > 0.0:
        held[force, force], held[force, demand] = -1.0 / lag, 1.0 / lag
    else:
        held[1, demand], held[1, force] = held[1, force], 0.0  # the demand itself acts
    step = expm(held * SAMPLE_TIME.value)
    A, B_u, B_floor = step[:n, :n], step[:n, [demand]], step[:n, [floor]]
    if lag <= 0.0:
        A[force], B_u[force] = 0.0, 1.0
    return ActuatedSeat(A, B_u, B_floor, np.vstack([a_s, np.eye(n)[0]]), a_b)


class RobustLoop(NamedTuple):
    """The closed loop x' = A x + B z_v''; the driver's acceleration is C x.

    Attributes
    ----------
    A, B, C
        Shapes (n, n), (n, 1), (1, n).
    """

    A: Array
    B: Array
    C: Array


def closed_loop(controller: tuple[Array, Array], seat: ActuatedSeat, delay: int) -> RobustLoop:
    """Close the loop of controller, actuator and seat.

    Parameters
    ----------
    controller
        From :func:`linear_controller`.
    seat
        From :func:`actuated_seat`.
    delay
        Samples between demand and actuator, at least 0.

    Returns
    -------
    RobustLoop
        With the state of seat, controller and delayed demands.
    """
    A_c, B_c = controller
    first, count = len(seat.A), len(A_c)
    n = first + count + delay
    rows = np.zeros((count, n))
    rows[:, :first] = B_c @ seat.C
    rows[:, first : first + count] = A_c
    demand = rows[-1]
    force = demand if delay == 0 else np.eye(n)[n - 1]
    A, B, C = np.zeros((n, n)), np.zeros((n, 1)), np.zeros((1, n))
    A[:first, :first] = seat.A
    A[:first] += np.outer(seat.B_u[:, 0], force)
    A[first : first + count] = rows
    for index in range(delay):  # a queue of demands
        A[first + count + index] = demand if index == 0 else np.eye(n)[first + count + index - 1]
    B[:first], C[0, :first] = seat.B_floor, seat.driver
    return RobustLoop(A, B, C)


def delay_margin(controller: tuple[Array, Array], seat: ActuatedSeat, delay: int = 0) -> float:
    """Return the longest extra delay with a stable loop, in whole samples.

    Parameters
    ----------
    controller, seat
        As of :func:`closed_loop`.
    delay
        Samples of the actuator's own delay.

    Returns
    -------
    float
        In ms; NaN if the loop is unstable without extra delay.
    """
    for extra in range(MAX_DELAY + 2):
        loop = closed_loop(controller, seat, delay + extra)
        if extra > MAX_DELAY or not np.abs(np.linalg.eigvals(loop.A)).max() < 1.0:
            break
    return (extra - 1) * (SAMPLE_TIME.value * 1e3) if extra else float("nan")


def worst_case_gain(loop: RobustLoop) -> float:
    """Return the largest gain from the floor's to the driver's acceleration, 0.03 to 50 Hz.

    Parameters
    ----------
    loop
        From :func:`closed_loop`.

    Returns
    -------
    float
        Dimensionless.
    """
    z = np.exp(2j * np.pi * _FREQUENCIES * SAMPLE_TIME.value)
    matrices = z[:, None, None] * np.eye(len(loop.A)) - loop.A
    states = np.linalg.solve(matrices, np.broadcast_to(loop.B.astype(complex), (len(z), *loop.B.shape)))
    return float(np.abs((loop.C @ states)[:, 0, 0]).max())


@dataclass(frozen=True)
class Case:
    """A case of the certificate.

    Attributes
    ----------
    name
        What differs from the nominal loop.
    follow
        beta, as a share of its bound.
    told_mass
        Driver's mass in kg that the controller assumes; None for the true one.
    cushion
        Factor on stiffness and damping of the cushion; infinite for a rigid load.
    seated
        Whether the driver is a body of several masses in place of the mass on the cushion.
    """

    name: str
    follow: float = 0.0
    told_mass: float | None = None
    cushion: float = 1.0
    seated: bool = False


CASES = (
    Case("follow term off"),
    Case("follow term half", follow=0.5),
    Case("follow term at its bound", follow=1.0),
    Case("off, 75 kg told", told_mass=75.0),
    Case("at its bound, 75 kg told", follow=1.0, told_mass=75.0),
    Case("off, cushion x 0.6", cushion=0.6),
    Case("off, cushion x 1.6", cushion=1.6),
    Case("off, rigid load not told", cushion=float("inf")),
    Case("off, seated driver", seated=True),
)
"""Cases of the certificate."""


class LoopCertificate(NamedTuple):
    """Delay margins and worst-case gains of the sampled loop.

    Attributes
    ----------
    delay_margin_ms, worst_case_gain
        Name of the case to the values by driver's mass in kg, in ms and 1.
    """

    delay_margin_ms: dict[str, dict[float, float]]
    worst_case_gain: dict[str, dict[float, float]]

    @property
    def problems(self) -> list[str]:
        """Loops that are unstable without extra delay, one line each."""
        return [
            f"{case}: expected stable at {mass:g} kg, got unstable without any extra delay"
            for case, margins in self.delay_margin_ms.items()
            for mass, margin in margins.items()
            if math.isnan(margin)
        ]


def _with_cushion(seat: Any, factor: float) -> Any:
    """Return a seat with another cushion."""
    if np.isinf(factor):
        return replace(seat, cushion_stiffness=_RIGID_STIFFNESS, cushion_damping=_RIGID_DAMPING)
    return replace(
        seat, cushion_stiffness=factor * seat.cushion_stiffness, cushion_damping=factor * seat.cushion_damping
    )


def certify(
    parameters: Parameters, seat_for: SeatFor, masses: tuple[float, ...], body_for: BodyFor | None = None
) -> LoopCertificate:
    """Compute delay margins and worst-case gains; the actuator is the one that the parameters name.

    Parameters
    ----------
    parameters
        Parameters of the controller; the driver's mass is replaced.
    seat_for
        Function from the driver's mass in kg to the seat.
    masses
        Drivers' masses, in kg.
    body_for
        Function from the driver's mass in kg to the seated driver; without the cases of one if None.

    Returns
    -------
    LoopCertificate
        For each of :data:`CASES` and each mass.
    """
    lag, delay = parameters.actuator_time_constant, robust.prepare(parameters).delay
    margins: dict[str, dict[float, float]] = {}
    gains: dict[str, dict[float, float]] = {}
    for case in CASES:
        if case.seated and body_for is None:
            continue
        for mass in masses:
            told = mass if case.told_mass is None else case.told_mass
            controller = linear_controller(
                replace(parameters, driver_mass=told), case.follow * parameters.robust_follow_max
            )
            body = body_for(mass) if case.seated and body_for else None
            seat = actuated_seat(_with_cushion(seat_for(mass), case.cushion), lag, body)
            margins.setdefault(case.name, {})[mass] = delay_margin(controller, seat, delay)
            gains.setdefault(case.name, {})[mass] = worst_case_gain(closed_loop(controller, seat, delay))
    return LoopCertificate(margins, gains)
