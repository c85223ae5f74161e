"""How the gains that come with the package were made.

``python -m seat_controller_fmu.preset_sources`` writes them anew; it needs the extra ``design``. Each
set becomes ``presets/<name>.json`` (inputs, gains, certified figures) and ``presets/<name>.ssv`` (an SSP parameter set
for the SeatController FMU).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from plant_models.parameters import SEAT_MASS
from seat_controller_fmu import parameters as p
from seat_controller_fmu.certify import certify
from seat_controller_fmu.design import design
from seat_controller_fmu.fuzzy import MassRange, observer_gain
from seat_controller_fmu.gains import PRESETS, Gains, Setting

FOLDER = Path(__file__).with_name("presets")

PRINTED_MASS_MAX = 120.0
"""m_bmax in kg as Table 1 prints it; also the heaviest driver the recommended set is made for."""

RECOMMENDED_OBSERVER = (-4000.0, -3500.0)
"""L_1 and L_2 in kg/s. The delay margin collapses where |L| exceeds about 4000 at light and 3600 at heavy drivers,
whatever the state feedback: see docs/design.md. Hence nearly one value for all masses, instead of the 1/M of (23)."""


def by_gamma(mass_min: float, mass_max: float, gamma: float, alpha: float, c_0: float, P_2: float) -> Setting:
    """Return a setting with the observer gains of (23); masses in kg, Gamma in s/kg2."""
    vertices = MassRange(mass_min + SEAT_MASS.value, mass_max + SEAT_MASS.value)
    L_1, L_2 = (observer_gain(mass, gamma) for mass in vertices)
    return Setting(mass_min, mass_max, L_1, L_2, alpha, c_0, P_2, gamma)


def equal_rate(mass_min: float, mass_max: float, rate: float, alpha: float, c_0: float, P_2: float) -> Setting:
    """Return a setting whose observer has one pole at all masses, L_i = rate M_i; rate below 0, in 1/s."""
    L_1, L_2 = rate * (mass_min + SEAT_MASS.value), rate * (mass_max + SEAT_MASS.value)
    return Setting(mass_min, mass_max, L_1, L_2, alpha, c_0, P_2)


def _setting(mass_max: float) -> Setting:
    values = (p.DRIVER_MASS_MIN, p.OBSERVERS[1], p.ALPHA, p.C_0, p.P_2)
    mass_min, gamma, alpha, c_0, P_2 = (quantity.value for quantity in values)
    return by_gamma(mass_min, mass_max, gamma, alpha, c_0, P_2)


def published() -> Gains:
    """Return the paper's gains as printed; what made them is not known."""
    K_1 = (p.K_1_DEFLECTION.value, p.K_1_RATE.value)
    K_2 = (p.K_2_DEFLECTION.value, p.K_2_RATE.value)
    return Gains(K_1, K_2, _setting(p.DRIVER_MASS_MAX.value), p.LAMBDA.value)


def table1_printed(solver: str = "CLARABEL") -> Gains:
    """Design by the feasibility margin for Table 1 as it is printed, 45-120 kg."""
    return design(_setting(PRINTED_MASS_MAX), "margin", p.LAMBDA.value, solver=solver)


def recommended(solver: str = "CLARABEL") -> Gains:
    """Design the set to use for 45-120 kg, chosen by numbers: see docs/design.md."""
    L_1, L_2 = RECOMMENDED_OBSERVER
    setting = replace(_setting(PRINTED_MASS_MAX), L1=L_1, L2=L_2, observer_gamma=None)
    return design(setting, "trade-off", p.LAMBDA.value, solver=solver)


SOURCES: dict[str, Callable[[], Gains]] = dict(zip(PRESETS, (published, table1_printed, recommended), strict=True))
"""What makes each preset."""


def rounded(gains: Gains) -> Gains:
    """Round gains to 0.01 and Q to eight digits: what a solver says beyond differs between machines."""
    K_1, K_2 = ((round(K[0], 2), round(K[1], 2)) for K in gains.feedback)
    Q = gains.Q and ((_digits(gains.Q[0][0]), _digits(gains.Q[0][1])), (_digits(gains.Q[1][0]), _digits(gains.Q[1][1])))
    return replace(gains, K1=K_1, K2=K_2, Q=Q)


def _digits(value: float) -> float:
    return float(f"{value:.8g}")


def main() -> None:
    """Write all presets."""
    for name, source in SOURCES.items():
        gains = rounded(source())
        certificate = certify(gains)
        if certificate.problems:
            raise SystemExit("\n".join(certificate.problems))
        figures = {key: _short(value) for key, value in certificate.figures().items()}
        gains = replace(gains, figures=figures)
        (FOLDER / f"{name}.json").write_text(gains.to_json(), encoding="utf-8")
        (FOLDER / f"{name}.ssv").write_text(gains.to_ssv(), encoding="utf-8")
        print(f"{name}: K1 {gains.K1}, K2 {gains.K2}, {figures}")


def _short(value: object) -> object:
    if isinstance(value, dict):
        return {key: _short(entry) for key, entry in value.items()}
    return round(value, 6) if isinstance(value, float) else value


if __name__ == "__main__":
    main()
