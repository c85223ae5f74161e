"""Estimator of the driver's mass and the suspension's friction: gated least squares.

While the seat slides one way, s = sgn v, the balance of forces (1) reads

    y = u - k_f delta - m_s a_s = m_b a_b + F_r s + c

with the force u that acts as modelled, the seat's measured acceleration a_s, and the driver's acceleration a_b that the
model of the cushion gives for it. c takes the bias and the offset of the sensors. The unknowns m_b, F_r and c follow by
least squares with exponential forgetting. c is eliminated first, then F_r; what is left beside m_b is its information.
Only samples count in which the seat has been sliding one way for 40 ms: around a reversal friction is no constant,
which would falsify the mass. Where there is no information the estimates stay at the nominal values, towards which a
ridge pulls them.
"""

from __future__ import annotations

from typing import NamedTuple

from seat_controller_fmu.interface import Parameters
from seat_controller_fmu.parameters import SAMPLE_TIME

SLIDING_RATE = 0.05
"""The seat slides if its deflection changes faster, in m/s."""
SLIDING_SAMPLES = 20.0
"""Samples after which sliding in one direction counts: 40 ms."""
FORGETTING = 0.15
"""Rate of the forgetting, in 1/s of sliding."""
SAMPLES_PER_SOLUTION = 50.0
"""Samples of sliding from one solution to the next."""
GAIN = 0.3
"""Share of the way to each solution that the estimates go."""
MASS_RIDGE, FRICTION_RIDGE = 5.0, 10.0
"""Weights of the nominal values, in (m/s2)^2 samples and in samples."""
MASS_INFORMATION, FRICTION_INFORMATION = 50.0, 250.0
"""Information from which on an estimate is to be trusted, in the same units."""
MASS_MIN, MASS_MAX, FRICTION_MAX = 35.0, 150.0, 150.0
"""Bounds of the estimates, in kg and N; friction is not negative."""


class EstimatorState(NamedTuple):
    """State of the estimator.

    Attributes
    ----------
    mass, friction
        Estimates, in kg and N.
    direction
        Of sliding: -1, 1, or 0 while the seat does not slide.
    sliding
        Samples since the seat slides in this direction, at most :data:`SLIDING_SAMPLES`.
    fresh
        Samples of sliding since the last solution.
    n, s, a, sa, aa, y, sy, ay
        Weighted sums over the samples of sliding: 1, s, a_b, a_b s, a_b^2, y, y s, y a_b.
    mass_trusted, friction_trusted
        Whether the information suffices.
    """

    mass: float
    friction: float
    direction: float = 0.0
    sliding: float = 0.0
    fresh: float = 0.0
    n: float = 0.0
    s: float = 0.0
    a: float = 0.0
    sa: float = 0.0
    aa: float = 0.0
    y: float = 0.0
    sy: float = 0.0
    ay: float = 0.0
    mass_trusted: bool = False
    friction_trusted: bool = False

    @property
    def sliding_direction(self) -> float:
        """Direction of sliding once it has lasted long enough, else 0."""
        return self.direction if self.sliding >= SLIDING_SAMPLES else 0.0


class EstimatorCoefficients(NamedTuple):
    """Coefficients of the estimator.

    Attributes
    ----------
    memory
        Factor on the sums a sample.
    nominal_mass, nominal_friction
        In kg and N.
    """

    memory: float
    nominal_mass: float
    nominal_friction: float


def prepare(parameters: Parameters) -> EstimatorCoefficients:
    """Derive the coefficients of the estimator from the parameters.

    Parameters
    ----------
    parameters
        Parameters of the controller.

    Returns
    -------
    EstimatorCoefficients
        With driver's mass and friction of the parameters as the nominal values.
    """
    memory = 1.0 - FORGETTING * SAMPLE_TIME.value
    return EstimatorCoefficients(memory, parameters.driver_mass, parameters.robust_friction)


def start(c: EstimatorCoefficients) -> EstimatorState:
    """Return the state without information.

    Parameters
    ----------
    c
        Coefficients from :func:`prepare`.

    Returns
    -------
    EstimatorState
        The estimates are the nominal values.
    """
    return EstimatorState(c.nominal_mass, c.nominal_friction)


def slide(state: EstimatorState, rate: float) -> EstimatorState:
    """Count the samples of sliding.

    Parameters
    ----------
    state
        State after the previous sample.
    rate
        Rate of the deflection, in m/s.

    Returns
    -------
    EstimatorState
        With direction and number of samples.
    """
    direction = 1.0 if rate > SLIDING_RATE else -1.0 if rate < -SLIDING_RATE else 0.0
    slides_on = direction == state.direction and direction != 0.0
    sliding = min(state.sliding + 1.0, SLIDING_SAMPLES) if slides_on else 0.0
    return state._replace(direction=direction, sliding=sliding)


def step(state: EstimatorState, force: float, acceleration: float, c: EstimatorCoefficients) -> EstimatorState:
    """Take a sample of sliding.

    Parameters
    ----------
    state
        State from :func:`slide`.
    force
        y, in N.
    acceleration
        a_b, in m/s2.
    c
        Coefficients from :func:`prepare`.

    Returns
    -------
    EstimatorState
        After the sample.
    """
    memory, direction = c.memory, state.direction
    state = state._replace(
        n=memory * state.n + 1.0,
        s=memory * state.s + direction,
        a=memory * state.a + acceleration,
        sa=memory * state.sa + direction * acceleration,
        aa=memory * state.aa + acceleration * acceleration,
        y=memory * state.y + force,
        sy=memory * state.sy + direction * force,
        ay=memory * state.ay + acceleration * force,
        fresh=state.fresh + 1.0,
    )
    return state if state.fresh < SAMPLES_PER_SOLUTION else _solve(state._replace(fresh=0.0), c)


def _solve(state: EstimatorState, c: EstimatorCoefficients) -> EstimatorState:
    """Solve for mass and friction, and move the estimates towards the solution."""
    per_n = 1.0 / state.n
    s, a = state.s * per_n, state.a * per_n
    ss = state.n + FRICTION_RIDGE - state.s * s
    sa, aa = state.sa - state.a * s, state.aa - state.a * a
    sy = state.sy + FRICTION_RIDGE * c.nominal_friction - state.y * s
    ay = state.ay + MASS_RIDGE * c.nominal_mass - state.y * a
    q = sa / ss
    information = aa - sa * q
    mass = (ay - q * sy) / (information + MASS_RIDGE)
    friction = (sy - sa * mass) / ss
    return state._replace(
        mass=state.mass + GAIN * (min(max(mass, MASS_MIN), MASS_MAX) - state.mass),
        friction=state.friction + GAIN * (min(max(friction, 0.0), FRICTION_MAX) - state.friction),
        mass_trusted=information > MASS_INFORMATION,
        friction_trusted=ss > FRICTION_INFORMATION,
    )
