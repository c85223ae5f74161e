"""A seat on a floor at rest, without control: the energy it stores never grows.

    V = m_s z_s'^2/2 + m_b z_b'^2/2 + k_f x^2/2 + k_c (z_b - z_s)^2/2 + k_e max(0, |x + x_m| - x_e)^2/2 + S(z_d)

with S what the friction stores, see ``test_friction_work.py``. By (1)-(2), V' = -c_f x'^2 - c_c (z_b' - z_s')^2 less
what friction and end stops take, all of them at most 0: V never grows, exactly.

What the integration may add: classical Runge-Kutta takes energy from undamped oscillations, by a factor of
1 - (omega h)^6/72 + ..., up to omega h = 2.8; it can add some where the friction's slope jumps, at turning points. A
substep's whole error, as a share of the state in the norm sqrt(V), is sum_{j>=5} x^j/j! = 2.8e-4 where x = omega h =
1/2, the radians a substep is made for; so it adds at most twice that to V. What the search finds is less, see GROWTH.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import strategies as st
from hypothesis import target

from fmus.component import ParameterError
from plant_models.seat.interface import Inputs, Parameters
from plant_models.seat.seat import Coefficients, Masses, State, advance, prepare
from tests.helpers.driven import Driven
from tests.helpers.searching import examples, fails, for_all
from tests.system.invariants.test_friction_work import PUBLISHED, Law, powers

GROWTH = 5.7e-4
"""Share of V that a step may add: what a substep's error is worth. The most that a search for the largest found in 8000
seats is 8.3e-5: 20 kg on 10 kg without any damper."""

GROWTH_AS_PUBLISHED = 1e-5
"""The same for the published seat under any driver: nothing found, measured to this."""

ROUNDING = 1e-30
"""In J; a state fades to zero from some 1e-30 on."""


def energy(state: State, p: Parameters) -> float:
    """V, in J."""
    position = state.masses.seat_displacement + p.end_stop_height
    depth = max(0.0, abs(position) - p.end_stop_travel) if p.end_stop_travel > 0.0 else 0.0
    friction = Law(p.friction_alpha, p.friction_gamma, p.friction_beta, p.friction_amplitude)
    return friction.stored(state.masses.friction) + 0.5 * (
        p.seat_mass * state.masses.seat_velocity**2
        + p.driver_mass * state.masses.driver_velocity**2
        + p.suspension_stiffness * state.masses.seat_displacement**2
        + p.cushion_stiffness * (state.masses.driver_displacement - state.masses.seat_displacement) ** 2
        + p.end_stop_stiffness * depth**2
    )


def around(start: float, decades: int) -> st.SearchStrategy[float]:
    return powers(-decades, decades).map(lambda factor: start * factor)


def perhaps(values: st.SearchStrategy[float]) -> st.SearchStrategy[float]:
    return st.one_of(st.just(0.0), values)


symmetric = st.builds(
    Parameters,
    driver_mass=st.floats(20.0, 250.0),
    seat_mass=st.floats(10.0, 100.0),
    suspension_stiffness=around(4600.0, 1),
    suspension_damping=perhaps(around(500.0, 1)),
    cushion_stiffness=around(90e3, 1),
    cushion_damping=perhaps(around(2500.0, 1)),
    friction_alpha=perhaps(around(3.0983e5, 1)),
    friction_beta=st.floats(-2e8, 2e8),
    end_stop_travel=perhaps(st.floats(0.005, 0.05)),
    end_stop_stiffness=around(1e5, 1),
    end_stop_damping=perhaps(around(1000.0, 1)),
)
seats = st.builds(
    lambda p, share: replace(p, end_stop_height=share * p.end_stop_travel), symmetric, perhaps(st.floats(-0.95, 0.95))
)
beginnings = st.tuples(powers(-4, 0), *[st.floats(-1.0, 1.0)] * 5)
"""How far off, and in which direction, each as a share of 50 mm, 0.5 m/s or the plateau."""

steps = st.sampled_from([5e-4, 2e-3, 1e-2])


def begun(share: tuple[float, ...], c: Coefficients) -> State:
    size, z_s, v_s, z_b, v_b, z_d = share
    return State(
        Masses(0.05 * size * z_s, 0.5 * size * v_s, 0.05 * size * z_b, 0.5 * size * v_b, c.friction.plateau * z_d)
    )


def growth(p: Parameters, c: Coefficients, share: tuple[float, ...], step: float) -> float:
    """Let go, and return the largest share of V that a step adds."""
    state, worst = begun(share, c), -1.0
    before = energy(state, p)
    for k in range(40):
        state, _ = advance(state, Inputs(), c, k * step, step)
        after = energy(state, p)
        worst = max(worst, (after - before - ROUNDING) / max(before, ROUNDING))
        if worst > 1.0:  # enough said, before it leads beyond all floats
            return worst
        before = after
    return worst


def check(p: Parameters, share: tuple[float, ...], step: float) -> None:
    try:
        c = prepare(p)
    except ParameterError:
        return
    found = growth(p, c, share, step)
    target(max(found, 0.0))
    assert found <= GROWTH


@pytest.mark.slow
@examples(120, 8_000)
def test_the_energy_of_a_seat_left_alone_never_grows(count: int):
    for_all(count, check, p=seats, share=beginnings, step=steps)


@pytest.mark.parametrize(
    "name", ["suspension_damping", "cushion_damping", "friction_alpha", "end_stop_damping"], ids=lambda name: name
)
def test_whatever_gives_energy_instead_of_taking_it_is_noticed(name: str):
    """Coefficients of a part that pushes where it should resist; V is that of the honest seat."""
    field = {
        "suspension_damping": "c_f",
        "cushion_damping": "c_c",
        "friction_alpha": "alpha",
        "end_stop_damping": "c_e",
    }

    def perturbed(p: Parameters, share: tuple[float, ...], step: float) -> None:
        try:
            c = prepare(p)
        except ParameterError:
            return
        c = c._replace(**{field[name]: -getattr(c, field[name])})
        assert growth(p, c, share, step) <= GROWTH

    stopped = seats.map(
        lambda p: replace(
            p, end_stop_travel=0.005, end_stop_height=0.0, **{name: 10.0 * getattr(Parameters(), name) or 3e3}
        )
    )
    fails(2000, perturbed, p=stopped, share=beginnings, step=steps)


# ---- through the FMUs ------------------------------------------------------------------------------------------------

STEP = 0.002


def coasting(seat: Driven, parameters: dict[str, float], forces: list[float], held: float = 0.0) -> np.ndarray:
    """Push the seat, each force for 20 ms, let go to a force that is held, and return V in J after each of 500 steps.

    The driver's velocity is no output; it follows from the driver's acceleration by (2).
    """
    seat.begin(**parameters)
    p = Parameters(**{name.replace("__", "_"): value for name, value in parameters.items()})
    names = ("seat_displacement", "deflection_rate", "driver_displacement", "driver_acceleration", "friction_force")
    found, tick = [], 0
    for force, duration in [*((force, 10) for force in forces), (held, 500)]:
        seat.set(force=force)
        for _ in range(duration):
            seat.step(tick * STEP, STEP)
            tick += 1
            if duration == 500:
                z_s, v_s, z_b, a_b, f_r = seat.get(*names)
                v_b = v_s - (p.driver_mass * a_b + p.cushion_stiffness * (z_b - z_s)) / p.cushion_damping
                found.append(energy(State(Masses(z_s, v_s, z_b, v_b, f_r / p.friction_alpha)), p))
    seat.end()
    return np.array(found)


@examples(6, 300)
def test_the_fmus_energy_never_grows(seat: Driven, count: int):
    def check(mass: float, forces: list[float]) -> None:
        energies = coasting(seat, {"driver_mass": mass}, forces)
        assert (
            np.diff(energies) <= GROWTH_AS_PUBLISHED * energies[:-1] + 1e-12
        ).all()  # of 1 J at most, by (2)'s cancellation
        assert energies[-1] < energies[0] or energies[0] < 1e-12

    for_all(count, check, mass=st.floats(45.0, 120.0), forces=st.lists(st.floats(-600.0, 600.0), max_size=10))


def test_a_force_that_is_not_let_go_is_noticed_in_the_fmus_energy(seat: Driven):
    for held, grows in ((0.0, False), (100.0, True)):
        energies = coasting(seat, {}, [300.0] * 5, held)
        assert (np.diff(energies) > GROWTH_AS_PUBLISHED * energies[:-1]).any() == grows


def test_the_published_friction_is_the_default():
    assert Law(*(getattr(Parameters(), f"friction_{n}") for n in PUBLISHED._fields)) == PUBLISHED
