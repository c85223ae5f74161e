"""Design of the presets, the sets of gains of this project.

``python -m studies.make_presets`` writes them; it needs the extra ``design``. A set is written as
``presets/<name>.json`` (inputs, gains, certified figures) and ``presets/<name>.ssv`` (an SSP parameter set for the
SeatController FMU).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from seat_controller_fmu import parameters as p
from seat_controller_fmu.design.certificate import certify
from seat_controller_fmu.design.gains import FOLDER, PRESETS, Gains
from seat_controller_fmu.design.setting import Setting, by_gamma, equal_rate
from seat_controller_fmu.design.synthesis import design
from seat_cosim.nominal_seat import nominal_seat

PRINTED_MASS_MAX = 120.0
"""m_bmax in kg as Table 1 prints it; also the heaviest driver for whom the recommended set is designed."""

RECOMMENDED_OBSERVER = (-4000.0, -3500.0)
"""L_1 and L_2 in kg/s. The delay margin collapses where |L| exceeds about 4000 with light and 3600 with heavy drivers,
whatever the state feedback (see docs/explanation/certificate.md); so they are nearly equal for all masses, unlike the
1/M of (23)."""


def _setting(mass_max: float) -> Setting:
    values = (p.DRIVER_MASS_MIN, p.OBSERVERS[1], p.ALPHA, p.C_0, p.P_2)
    mass_min, gamma, alpha, c_0, P_2 = (quantity.value for quantity in values)
    return by_gamma(mass_min, mass_max, gamma, alpha, c_0, P_2)


def published() -> Gains:
    """Return the paper's gains as printed; how they were designed is not known."""
    K_1 = (p.K_1_DEFLECTION.value, p.K_1_RATE.value)
    K_2 = (p.K_2_DEFLECTION.value, p.K_2_RATE.value)
    return Gains(K_1, K_2, _setting(p.DRIVER_MASS_MAX.value), p.LAMBDA.value)


def table1_printed(solver: str = "CLARABEL") -> Gains:
    """Design gains for Table 1 as it is printed, 45-120 kg, by the feasibility margin; ``solver`` as of the design."""
    return design(_setting(PRINTED_MASS_MAX), "margin", p.LAMBDA.value, solver=solver)


def recommended(solver: str = "CLARABEL") -> Gains:
    """Design the recommended gains for 45-120 kg, see docs/explanation/certificate.md; ``solver`` as of the design."""
    L_1, L_2 = RECOMMENDED_OBSERVER
    setting = replace(_setting(PRINTED_MASS_MAX), L1=L_1, L2=L_2, observer_gamma=None)
    return design(setting, "trade-off", p.LAMBDA.value, solver=solver)


def equal_rate_observer() -> Gains:
    """Return the paper's state feedback with an observer of one rate at all masses: that of Observer 1 at M_min."""
    gains = published()
    s = gains.setting
    rate = s.L1 / s.vertices.minimum
    return replace(gains, setting=equal_rate(s.driver_mass_min, s.driver_mass_max, rate, s.alpha, s.c_0, s.P_2))


SOURCES: dict[str, Callable[[], Gains]] = dict(
    zip(PRESETS, (published, table1_printed, recommended, equal_rate_observer), strict=True)
)
"""Name of a preset to the function that designs it."""


def rounded(gains: Gains) -> Gains:
    """Round gains to 0.01 and Q to eight digits: further digits of a solver differ between machines."""
    K_1, K_2 = ((round(K[0], 2), round(K[1], 2)) for K in gains.feedback)
    Q = gains.Q and ((_digits(gains.Q[0][0]), _digits(gains.Q[0][1])), (_digits(gains.Q[1][0]), _digits(gains.Q[1][1])))
    return replace(gains, K1=K_1, K2=K_2, Q=Q)


def _digits(value: float) -> float:
    return float(f"{value:.8g}")


def main() -> None:
    """Write all presets."""
    for name, source in SOURCES.items():
        gains = rounded(source())
        certificate = certify(gains, nominal_seat)
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
