"""A floor that gives one signal: what is derived, how exactly, and that it is the same in every flavour."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import accumulate
from pathlib import Path

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from plant_models.seat.floor import MIN_INTERVAL, FloorHistory, FloorMotion, derive_motion
from plant_models.seat.interface import FloorSignals, Inputs, Parameters
from plant_models.seat.seat import advance, initialize, prepare
from seat_cosim.scenarios import SCENARIOS, control, seat_suspension
from tests.helpers.driven import Driven
from tests.helpers.floor_signals import CASES, MOVING, errors, exact, run, sampled
from tests.helpers.paths import NATIVE
from tests.helpers.reference import Case, bump, open_loop
from tests.helpers.rig import Rig

H = 0.002
ONE = [FloorSignals.displacement, FloorSignals.velocity, FloorSignals.acceleration]
one_signal = pytest.mark.parametrize("signal", ONE, ids=lambda s: s.name)

# ---- what is derived -------------------------------------------------------------------------------------------------


def polynomial(*coefficients: float):
    """Motion of which the displacement is a polynomial in time, lowest power first."""
    p = np.polynomial.Polynomial(coefficients)
    return lambda t: FloorMotion(*(float(q(t)) for q in (p, p.deriv(), p.deriv(2))))


EXACT_FOR = {
    FloorSignals.displacement: ((0.01, 0.2, -3.0), 2),
    FloorSignals.velocity: ((0.01, 0.2, -3.0), 1),
    FloorSignals.acceleration: ((0.01, 0.2, -3.0, 40.0), 0),
}
"""Coefficients of the longest polynomial that is derived exactly, and after how many steps it is."""


def inputs_of(motion: FloorMotion, signal: FloorSignals, unused: float = 0.0) -> Inputs:
    values = {f"floor_{name}": value if name == signal.name else unused for name, value in motion._asdict().items()}
    return Inputs(**values)


def follow(
    signal: FloorSignals, motion, steps: list[float], unused: float = 0.0
) -> Iterator[tuple[float, FloorMotion, float]]:
    """Step sizes, one after the other; yields each step's begin, floor, and where it leaves the floor."""
    history = FloorHistory(*motion(0.0))
    for time, step in zip(accumulate([0.0, *steps]), steps, strict=False):
        floor, history = derive_motion(history, inputs_of(motion(time), signal, unused), signal, step)
        yield time, floor, history.end_displacement


def random_steps(seed: int = 1) -> list[float]:
    return list(np.random.default_rng(seed).uniform(2e-4, 6e-3, 200))


@one_signal
def test_polynomials_are_derived_exactly_at_any_step_sizes(signal: FloorSignals):
    coefficients, ready = EXACT_FOR[signal]
    motion = polynomial(*coefficients)
    for count, (time, floor, _) in enumerate(follow(signal, motion, random_steps())):
        if count > ready + 1:  # one step more to catch up with what the first ones missed
            drift = len(coefficients) == 4  # of a cubic's third derivative over a step: 40 * 6 * (6 ms)^3 / 6, m
            assert floor.displacement == pytest.approx(motion(time).displacement, abs=1e-5 if drift else 1e-12)
            assert floor.acceleration == pytest.approx(motion(time).acceleration, abs=1e-6)


@one_signal
def test_a_derived_floor_never_jumps(signal: FloorSignals):
    def motion(t: float) -> FloorMotion:
        return FloorMotion(0.02 * math.sin(19 * t), 0.38 * math.cos(19 * t), -7.22 * math.sin(19 * t))

    before = 0.0
    for _, floor, reached in follow(signal, motion, random_steps()):
        assert floor.displacement == before
        before = reached


def test_a_short_step_after_a_long_one_spreads_what_the_long_one_missed():
    jumping = [Inputs(floor_displacement=z) for z in (0.0, 1e-3, 1e-3)]
    history = FloorHistory()
    speeds = []
    for inputs, step in zip(jumping, (H, 1e-6, H), strict=True):
        floor, history = derive_motion(history, inputs, FloorSignals.displacement, step)
        speeds.append(floor.velocity)
    assert max(speeds) <= 2 * 1e-3 / H * (1 + 1e-12)


@one_signal
def test_samples_that_come_too_soon_are_left_out(signal: FloorSignals):
    """Noise on a floor at rest, met every 0.1 us: differences over 10 us are in order, over 0.1 us they explode."""
    random = np.random.default_rng(2)
    history, order = FloorHistory(), 2 - ONE.index(signal)
    for _ in range(3000):
        noise = FloorMotion(*(MIN_INTERVAL**order * random.standard_normal(3)))
        floor, history = derive_motion(history, inputs_of(noise, signal), signal, 1e-7)
        assert abs(floor.acceleration) < 20.0
        assert history.age < MIN_INTERVAL + 2e-7


@one_signal
def test_a_floor_that_starts_elsewhere_is_no_jump(signal: FloorSignals):
    here = Inputs(floor_displacement=0.05)
    c = prepare(Parameters(floor_signals=signal))
    state, outputs = initialize(here, c, 0.0)
    assert outputs.suspension_deflection == -0.05
    state, outputs = advance(state, here, c, 0.0, H)
    assert outputs.deflection_rate == state.masses.seat_velocity
    # a host that does not pass the displacement on before the first step
    if signal == FloorSignals.displacement:
        state, outputs = advance(initialize(Inputs(), c, 0.0)[0], here, c, 0.0, H)
        assert outputs.deflection_rate == state.masses.seat_velocity
        assert outputs.suspension_deflection == state.masses.seat_displacement - 0.05


@one_signal
def test_unused_floor_inputs_count_at_the_start_only(signal: FloorSignals):
    motion = polynomial(0.0, 0.1, 2.0, 10.0)
    c = prepare(Parameters(floor_signals=signal))
    ends = []
    for unused in (0.0, 1e6):
        state, _ = initialize(Inputs(*motion(0.0)), c, 0.0)
        for k in range(20):
            state, _ = advance(state, inputs_of(motion(k * H), signal, unused), c, k * H, H)
        ends.append(state)
    assert ends[0] == ends[1]


@one_signal
def test_the_deflection_is_that_from_the_derived_floor(signal: FloorSignals):
    c = prepare(Parameters(floor_signals=signal))
    state, _ = initialize(Inputs(), c, 0.0)
    for k in range(50):
        state, outputs = advance(state, inputs_of(FloorMotion(*bump()(k * H)), signal), c, k * H, H)
        assert outputs.suspension_deflection == pytest.approx(
            state.masses.seat_displacement - state.floor.end_displacement, abs=1e-15
        )


# ---- how accurate it is ----------------------------------------------------------------------------------------------

BOUNDS = {
    ("bump", FloorSignals.displacement): (0.010, 0.007),
    ("bump", FloorSignals.velocity): (0.004, 0.003),
    ("bump", FloorSignals.acceleration): (0.007, 0.036),
    ("sine", FloorSignals.displacement): (0.0004, 0.0004),
    ("sine", FloorSignals.velocity): (0.0003, 0.0004),
    ("sine", FloorSignals.acceleration): (0.0003, 0.0017),
}
"""Relative RMS errors of driver's acceleration and deflection: the worse case of docs/explanation/floor.md, and 30 %
of it."""


@pytest.fixture(scope="module")
def rig(native: Path) -> Iterator[Rig]:
    with Rig(native / "fmi2") as rig:
        yield rig


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("excitation", ["bump", "sine"])
def test_each_signal_alone_agrees_with_the_implicit_solver(rig: Rig, excitation: str, case: str):
    expected = exact(excitation, CASES[case])
    floor = sampled(excitation)
    for signal in ONE:
        found = errors(run(rig, floor, signal, CASES[case], MOVING if excitation == "sine" else None), expected)
        print(f"{signal.name}: {found}")
        assert all(a < b for a, b in zip(found, BOUNDS[excitation, signal], strict=True))


def test_one_signal_with_all_signals_declared_fails_these_bounds(rig: Rig):
    expected = exact("bump", False)
    for signal in ONE:
        only = sampled("bump")
        only = only._replace(**{name: 0.0 * values for name, values in only._asdict().items() if name != signal.name})
        assert errors(run(rig, only, FloorSignals.all, False), expected)[0] > 2 * BOUNDS["bump", signal][0]


@pytest.mark.long
def test_an_acceleration_without_the_start_velocity_is_another_floor(rig: Rig):
    found = errors(run(rig, sampled("sine"), FloorSignals.acceleration, False), exact("sine", False))
    assert found[0] > 0.1


@pytest.mark.slow
@pytest.mark.parametrize(("signal", "bound"), [*zip(ONE, (0.0036, 0.0033, 0.0078), strict=True)])
def test_changing_step_sizes_are_as_accurate(signal: FloorSignals, bound: float):
    """Steps of 0.5 to 3.5 ms, 2 ms in the mean; bounds: measured and 50 %."""
    random = np.random.default_rng(3)
    steps = 5e-4 * random.integers(1, 8, 1200)
    times = np.cumsum([0.0, *steps])
    times = times[times < 2.0 - 1e-9]
    expected = open_loop(Case(), bump(), lambda t: 0.0, 2.0, 5e-4 * np.arange(4001))
    expected = expected[np.round(times / 5e-4).astype(int)]
    c = prepare(Parameters(floor_signals=signal))
    state, outputs = initialize(Inputs(), c, 0.0)
    found = []
    for time, step in zip(times.tolist(), steps.tolist(), strict=False):
        found.append([outputs.driver_acceleration, outputs.suspension_deflection])
        state, outputs = advance(state, inputs_of(FloorMotion(*bump()(time)), signal), c, time, step)
    error = np.sqrt(np.mean((np.array(found) - expected) ** 2, axis=0) / np.mean(expected**2, axis=0))
    print(error)
    assert error[0] < bound


# ---- through the FMUs ------------------------------------------------------------------------------------------------


@one_signal
def test_flavours_agree_to_the_last_bit(native: Path, fmus: Path, signal: FloorSignals):
    parameters = {**SCENARIOS["bump"].parameters, **control(True), "seat.floor_signals": signal.name}
    folders = [fmus, *(native / flavour for flavour in NATIVE)]
    found = [seat_suspension(folder).simulate(1.0, H, parameters) for folder in folders]
    assert np.abs(found[0]["seat.driver_acceleration"]).max() > 1.0
    for other in found[1:]:
        for name, expected in found[0].values.items():
            assert np.array_equal(other[name], expected), name


def drive(seat: Driven, first: int, last: int) -> list[list[float]]:
    """Step along the bump by its displacements; returns the driver's accelerations."""
    found = []
    for k in range(first, last):
        seat.set(floor_displacement=bump()(k * H)[0])
        seat.step(k * H, H)
        found.append(seat.get("driver_acceleration"))
    return found


def test_a_step_can_be_undone(seat: Driven):
    seat.begin(floor_signals=2)
    drive(seat, 0, 40)
    state = seat.state()
    once = drive(seat, 40, 80)
    seat.restore(state)
    assert drive(seat, 40, 80) == once
    assert np.abs(once).max() > 0.1


def test_an_unused_input_must_still_be_a_number(seat: Driven):
    seat.begin(floor_signals=2)
    seat.set(floor_velocity=math.nan)
    with pytest.raises(FMICallException):
        seat.step(0.0, H)
    assert "floor_velocity: expected a finite number, got nan" in seat.said
