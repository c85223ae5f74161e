"""Scheduling over the driver's mass: memberships, and a force that does not jump when the mass changes a little.

h_1 is Lipschitz continuous in the mass, across the clamps as well, as clamping is: by (12)

    |dh_1/dm| <= (1/M_min^2)/(1/M_min - 1/M_max) = M_max/(M_min (M_max - M_min)) =: s        (0.042 1/kg by default).

Gains are affine in h_1, so |dK| <= |K_1 - K_2| s, |dL| <= |L_1 - L_2| s, |dD| = |1/M_min - 1/M_max| s. Over one
history of measurements x = (delta, v) and a, the law (24) gives |d(K x)| <= |dK_x| |delta| + |dK_v| |v|. The observer
(21), with q = -h L D between 0 and 1 and w its force, is F_k = (1 - q) F_(k-1) + q w_(k-1) + h L (a + k_f D
delta); w is u = K x + F, or with anti-windup u clipped, which brings no two forces further apart. So from F = 0 on

    |dF_k| <= |dF_(k-1)| + q |d(K x_(k-1))|
              + h |dL| (|a| + |D| (k_f |delta| + |w - F|)) + h |L dD| (k_f |delta| + |w - F|)
    |du_k| <= |d(K x_k)| + |dF_k|

with the largest |L|, |D|, q, and |w - F| = |K x| at either vertex; clipped, w is no further from F than u_lim + |F|.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import pytest
from hypothesis import strategies as st

from fmus.component import ParameterError
from seat_controller_fmu import controller as kernel
from seat_controller_fmu.controller import Coefficients, prepare
from seat_controller_fmu.design.gains import PRESETS, preset
from seat_controller_fmu.fuzzy import MassRange
from seat_controller_fmu.interface import Inputs, Parameters
from seat_controller_fmu.parameters import SAMPLE_TIME
from tests.helpers.driven import Driven
from tests.helpers.searching import examples, fails, for_all

H = SAMPLE_TIME.value
UNLIMITED = 1e9
"""A force limit that shows the demand, in N."""

ROUNDING = 1e-9
"""In N, on forces of some 1000 N: eps times forces, samples and a handful of operations is 1e-11."""

# ---- memberships -----------------------------------------------------------------------------------------------------

masses = st.floats(1.0, 1e6)
ranges = st.tuples(masses, masses).map(sorted).filter(lambda ends: 1.0 / ends[1] < 1.0 / ends[0])


def check_memberships(ends: list[float], mass: float) -> None:
    h_1, h_2 = MassRange(*ends).memberships(mass)
    assert 0.0 <= h_1 <= 1.0
    assert 0.0 <= h_2 <= 1.0
    assert h_1 + h_2 == 1.0


@examples(100, 5_000)
def test_memberships_of_any_range_lie_in_the_unit_interval_and_sum_to_one(count: int):
    for_all(count, check_memberships, ends=ranges, mass=st.floats(1e-3, 1e9))


@examples(100, 5_000)
def test_memberships_are_exact_at_the_vertices_of_any_range(count: int):
    def check(ends: list[float]) -> None:
        vertices = MassRange(*ends)
        assert vertices.memberships(vertices.minimum) == (1.0, 0.0)
        assert vertices.memberships(vertices.maximum) == (0.0, 1.0)

    for_all(count, check, ends=ranges)


def test_memberships_that_are_not_clamped_are_noticed(monkeypatch: pytest.MonkeyPatch):
    def open_ended(vertices: MassRange, mass: float) -> tuple[float, float]:
        slowest, fastest = 1.0 / vertices.maximum, 1.0 / vertices.minimum
        h_1 = (1.0 / mass - slowest) / (fastest - slowest)
        return h_1, 1.0 - h_1

    monkeypatch.setattr(MassRange, "memberships", open_ended)
    fails(200, check_memberships, ends=ranges, mass=st.floats(1e-3, 1e9))


@pytest.mark.parametrize("seat_mass", [1e20, 6.6e307])
def test_a_range_that_is_lost_beside_the_seats_mass_is_refused(seat_mass: float):
    """Found by the search in ``test_force_limit.py``: h_1 was 0/0."""
    with pytest.raises(ParameterError, match="by more than is lost beside seat_mass, got 45.0 kg, 80.0 kg and"):
        prepare(Parameters(seat_mass=seat_mass))


# ---- the force over the mass -----------------------------------------------------------------------------------------


class Sample(NamedTuple):
    """What the controller measures: m/s2, m."""

    acceleration: float
    deflection: float


histories = st.lists(st.builds(Sample, st.floats(-10.0, 10.0), st.floats(-0.1, 0.1)), min_size=1, max_size=20)
drivers = st.one_of(st.floats(40.0, 125.0), st.sampled_from([45.0, 80.0, 120.0]))
apart = st.one_of(st.floats(-12.0, 1.0).map(lambda e: 10.0**e), st.floats(0.0, 40.0))


def variants() -> list[Parameters]:
    found = []
    for name in PRESETS:
        p = preset(name).controller(55.0)
        found += [replace(p, anti_windup=on, force_limit=limit) for on in (False, True) for limit in (250.0, UNLIMITED)]
    return [*found, replace(found[0], observer_gamma=-1e-6, L1=0.0, L2=0.0)]


def bound(p: Parameters, history: list[Sample], steepness: float) -> float:
    """Most by which the force after a history may change, in N per kg of the driver's mass; ``steepness`` is s."""
    minimum, maximum = kernel.mass_range(p)
    L = [abs(gain) for gain in kernel.observer_gains(p)]
    L_most, dL, D, dD = max(L), abs(L[0] - L[1]) * steepness, 1.0 / minimum, (1.0 / minimum - 1.0 / maximum) * steepness
    K = [(abs(p.K1_deflection), abs(p.K1_rate)), (abs(p.K2_deflection), abs(p.K2_rate))]
    dK = abs(p.K1_deflection - p.K2_deflection) * steepness, abs(p.K1_rate - p.K2_rate) * steepness
    tau = prepare(p)
    q = H * L_most * D
    assert q <= 1.0
    dF = dKx = F = gap = v = 0.0
    previous = history[0].deflection
    for a, delta in history:
        v = tau.rate_decay * v + tau.rate_gain * (delta - previous)
        previous = delta
        measured = abs(a) + p.suspension_stiffness * D * abs(delta)
        dF += q * dKx + H * dL * (measured + D * gap) + H * L_most * dD * (p.suspension_stiffness * abs(delta) + gap)
        F += H * L_most * (measured + D * gap)
        dKx = dK[0] * abs(delta) + dK[1] * abs(v)
        Kx = max(k * abs(delta) + c * abs(v) for k, c in K)
        gap = Kx + (min(p.force_limit, F + Kx) + F if p.anti_windup else 0.0)
    return dKx + dF


def force(c: Coefficients, history: list[Sample]) -> float:
    state, _ = kernel.initialize(Inputs(), c, 0.0)
    for sample in history:
        state, outputs = kernel.step(state, Inputs(*sample), c)
    return outputs.force


def steepness(p: Parameters) -> float:
    minimum, maximum = kernel.mass_range(p)
    return maximum / (minimum * (maximum - minimum))


def check_force(p: Parameters, mass: float, further: float, history: list[Sample]) -> None:
    one, other = (force(prepare(replace(p, driver_mass=m)), history) for m in (mass, mass + further))
    assert abs(one - other) <= bound(p, history, steepness(p)) * further + ROUNDING


@examples(150, 5_000)
def test_the_force_is_lipschitz_continuous_in_the_drivers_mass(count: int):
    for_all(count, check_force, p=st.sampled_from(variants()), mass=drivers, further=apart, history=histories)


def test_the_bound_is_not_far_from_what_happens():
    """One sample at the lighter vertex: the law's gain alone, which the bound has exactly."""
    p = Parameters(driver_mass=45.0, force_limit=UNLIMITED, L1=-1e-9, L2=-1e-9)
    history = [Sample(0.0, 0.05)]
    one, other = (force(prepare(replace(p, driver_mass=m)), history) for m in (45.0, 45.001))
    assert abs(one - other) / 0.001 == pytest.approx(bound(p, history, steepness(p)), rel=1e-3)


def test_switching_between_gains_instead_of_blending_them_is_noticed(monkeypatch: pytest.MonkeyPatch):
    blended = MassRange.memberships

    def switched(vertices: MassRange, mass: float) -> tuple[float, float]:
        h_1 = float(round(blended(vertices, mass)[0]))
        return h_1, 1.0 - h_1

    def across_the_switch(p: Parameters, further: float, history: list[Sample]) -> None:
        middle = 2.0 / sum(1.0 / end for end in kernel.mass_range(p)) - p.seat_mass
        check_force(p, middle - 0.5 * further, further, history)

    monkeypatch.setattr(MassRange, "memberships", switched)
    fails(1000, across_the_switch, p=st.sampled_from(variants()), further=apart, history=histories)


# ---- through the FMUs ------------------------------------------------------------------------------------------------


def force_of_fmu(controller: Driven, mass: float, history: list[Sample], **parameters: float) -> float:
    controller.begin(driver_mass=mass, **parameters)
    for k, sample in enumerate(history):
        controller.set(seat_acceleration=sample.acceleration, suspension_deflection=sample.deflection)
        controller.step(k * H, H)
    found = controller.get("force")[0]
    controller.end()
    return found


@examples(20, 500)
def test_the_fmus_force_is_lipschitz_continuous_in_the_drivers_mass(controller: Driven, count: int):
    def check(mass: float, further: float, history: list[Sample]) -> None:
        p = Parameters()
        one, other = (force_of_fmu(controller, m, history) for m in (mass, mass + further))
        assert abs(one - other) <= bound(p, history, steepness(p)) * further + ROUNDING

    for_all(count, check, mass=drivers, further=apart, history=histories)


@pytest.mark.parametrize(("mass", "number"), [(45.0, 1), (40.0, 1), (80.0, 2), (120.0, 2)])
def test_at_a_vertex_and_beyond_the_fmus_use_its_gains_alone(controller: Driven, mass: float, number: int):
    """The other vertex's gains change no bit."""
    history = [Sample(1.0, 0.01), Sample(-2.0, 0.02), Sample(0.5, 0.015)]
    other = 3 - number
    elsewhere = {f"K{other}__deflection": 1.0, f"K{other}__rate": 2.0, f"L{other}": -5.0}
    plain = force_of_fmu(controller, mass, history, force_limit=UNLIMITED)
    assert force_of_fmu(controller, mass, history, force_limit=UNLIMITED, **elsewhere) == plain
    here = {name.replace(str(other), str(number)): value for name, value in elsewhere.items()}
    assert force_of_fmu(controller, mass, history, force_limit=UNLIMITED, **here) != plain
