"""Delay margins of seats that are not as assumed: by eigenvalues, and in time through the FMUs."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from seat_controller_fmu.design.gains import preset
from seat_controller_fmu.design.robustness import CONDITIONS, MASSES, SEATED, LinearSeat, robustness
from seat_cosim import scenarios
from seat_cosim.nominal_seat import nominal_seat, seated_body
from tests.helpers.rig import LINEAR, Rig, bump, settles

SAMPLE = 2.0
"""In ms."""


@pytest.fixture(scope="module")
def rig(native: Path) -> Iterator[Rig]:
    with Rig(native / "fmi2") as opened:
        yield opened


def in_time(rig: Rig, name: str, condition: str, mass: float, delay: int) -> bool:
    """Return whether the FMUs come to rest after a small bump, without friction and force limit."""
    gains = preset(name)
    case = CONDITIONS[condition](gains, LinearSeat.of(nominal_seat(mass)))
    parameters = {
        **LINEAR,
        **scenarios.gains(name),
        "controller.driver_mass": case.known_mass,
        "seat.driver_mass": case.seat.driver_mass,
        "seat.cushion_stiffness": case.seat.cushion_stiffness,
        "seat.cushion_damping": case.seat.cushion_damping,
    }
    return settles(rig.run(bump(8.0, height=0.001), parameters, delay))


@pytest.mark.parametrize(
    ("name", "row", "mass"),
    [("published", 3, 55.0), ("published", 4, 70.0), ("recommended", 1, 120.0)],
    ids=["strapped load", "soft cushion", "controller has the lightest mass"],
)
def test_cells_are_what_the_fmus_do_in_time(rig: Rig, name: str, row: int, mass: float):
    """Within one sample."""
    condition = list(CONDITIONS)[row]
    margin = robustness(preset(name), nominal_seat)[condition][mass]
    delay = round(margin / SAMPLE)
    assert in_time(rig, name, condition, mass, delay - 1)
    assert not in_time(rig, name, condition, mass, delay + 2)


@pytest.mark.parametrize(("name", "mass"), [("published", 55.0), ("recommended", 80.0)])
def test_cells_of_the_seated_driver_are_what_the_fmus_do_in_time(rig: Rig, name: str, mass: float):
    """Within one sample; the body is inside the seat's integrator."""
    delay = round(robustness(preset(name), nominal_seat, seated_body)[SEATED][mass] / SAMPLE)
    parameters = {**LINEAR, **scenarios.gains(name), **scenarios.driver_mass(mass), "seat.driver.model": 2}
    assert settles(rig.run(bump(8.0, height=0.001), parameters, delay - 1))
    assert not settles(rig.run(bump(8.0, height=0.001), parameters, delay + 2))


def test_a_seated_driver_costs_margin():
    """docs/explanation/seated-driver.md."""
    published, recommended, equal = (
        robustness(preset(name), nominal_seat, seated_body)[SEATED]
        for name in ("published", "recommended", "equal-rate")
    )
    assert list(published.values()) == [10.0, 14.0, 24.0, 76.0, 82.0, 88.0]
    assert list(recommended.values()) == [12.0, 14.0, 18.0, 24.0, 76.0, 82.0]
    assert list(equal.values()) == [10.0, 8.0, 8.0, 8.0, 10.0, 10.0]


def test_the_table_is_that_of_the_pages():
    """docs/explanation/certificate.md, README."""
    published, recommended = (robustness(preset(name), nominal_seat) for name in ("published", "recommended"))
    true, lightest, _, strapped, soft, empty = published.values()
    assert (true[55.0], strapped[55.0], soft[55.0], empty[55.0]) == (48.0, 28.0, 10.0, 10.0)
    assert min(recommended["true mass, cushion of Table 1"].values()) == 38.0
    assert recommended["controller has the lightest mass"][120.0] == 22.0
    assert lightest[45.0] == true[45.0]


def test_the_first_row_is_the_certificate():
    for name in ("published", "recommended", "equal-rate"):
        gains = preset(name)
        first = robustness(gains, nominal_seat)["true mass, cushion of Table 1"]
        assert {f"{mass:g}": first[mass] for mass in MASSES}.items() <= gains.figures["delay_margin_ms"].items()
