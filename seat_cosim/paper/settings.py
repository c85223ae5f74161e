"""Table 1: parameters as the paper prints them, and as the FMUs and the design have them."""

from __future__ import annotations

from collections.abc import Iterator

from seat_cosim.paper.finding import Finding, Kind, Row, text
from seat_cosim.paper.runner import ExperimentRunner

_SAME = ""
"""No remark."""
_PRINTED = [
    ("Driver mass m_b", "kg", 55.0, "seat.driver_mass", 0, _SAME),
    ("Seat mass m_s", "kg", 28.0, "seat.seat_mass", 0, _SAME),
    ("Cushion stiffness k_c", "N/m", 90000.0, "seat.cushion_stiffness", 0, _SAME),
    ("Cushion damping c_c", "N s/m", 2500.0, "seat.cushion_damping", 0, _SAME),
    ("Suspension stiffness k_f", "N/m", 4600.0, "seat.suspension_stiffness", 0, _SAME),
    ("Force limit u_lim", "N", 250.0, "controller.force_limit", 0, _SAME),
    ("Least driver mass m_bmin", "kg", 45.0, "controller.driver_mass_min", 0, _SAME),
    (
        "Largest driver mass m_bmax",
        "kg",
        120.0,
        "controller.driver_mass_max",
        0,
        "A misprint: the published observer gains, -3086 = 1/(108 · -3e-6) and -9259 = 1/(108 · -1e-6), and both rows "
        "of K, follow from 108 kg in all, a driver of 80 kg.",
    ),
    ("alpha", "1", 0.02, "alpha", 2, _SAME),
    ("P_2", "1", 400.0, "P_2", 0, _SAME),
    (
        "lambda",
        "1",
        1.2,
        "lambda",
        1,
        "The same, but hardly a constraint: it bounds alpha times the ratio of the seat's acceleration to the "
        "floor's, so it allows an amplification of 60; the published gains are certified down to 0.023.",
    ),
    ("Gamma of Observer 1", "1e-6 s/kg²", -3.0, "Gamma_1", 0, _SAME),
    ("Gamma of Observer 2", "1e-6 s/kg²", -1.0, "Gamma_2", 0, _SAME),
]
"""Name, unit, printed value, ``component.variable`` or symbol of the design that holds ours, decimals, remark."""


def parameters(runner: ExperimentRunner) -> Iterator[Finding]:
    """Make Table 1; no run is needed.

    Parameters
    ----------
    runner
        Has system and design.
    """
    design = {**runner.settings, **{f"Gamma_{number}": 1e6 * gamma for number, gamma in runner.gammas.items()}}
    rows = []
    for name, unit, printed, source, digits, remark in _PRINTED:
        ours = runner.system.start(source) if "." in source else design[source]
        rows.append(Row(name, unit, text(printed, digits), (ours,), Kind.GIVEN, remark, digits))
    yield Finding("table1", "The start values of the FMUs, and the numbers of the design.", rows)
