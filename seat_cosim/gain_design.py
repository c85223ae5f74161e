"""Design of gains for the nominal seat: request, certificate and files of ``seat-cosim design``."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from cosim.errors import SetupError, writing_to
from seat_controller_fmu import parameters as paper
from seat_controller_fmu.design.certificate import Certificate, certify
from seat_controller_fmu.design.gains import Gains, load
from seat_controller_fmu.design.setting import GainsError, Setting, by_gamma, equal_rate
from seat_controller_fmu.design.synthesis import FOLLOW, OBJECTIVES, SOLVERS, DesignError, design
from seat_cosim.nominal_seat import nominal_seat


def _or_default(value: float | None, default: float) -> float:
    return default if value is None else value


@dataclass(frozen=True)
class DesignRequest:
    """Request for a set of gains; the paper's values where None.

    Attributes
    ----------
    objective
        One of :data:`seat_controller_fmu.design.synthesis.OBJECTIVES`.
    level
        H-infinity level lambda.
    follow
        Frequency below which the seat follows the cabin, in Hz; of the objective ``trade-off``.
    force_weight
        Weight of the force, in (m/s2)^2/N^2; of the objective ``trade-off``.
    driver_mass_min, driver_mass_max
        Range of the driver's mass, in kg.
    observer_gamma
        Gamma of (23), in s/kg2, below 0.
    observer_rate
        Pole of the observer at all masses, in 1/s, below 0; instead of Gamma.
    observer_gains
        L_1 and L_2, in kg/s, below 0; instead of Gamma.
    alpha, c0, p2
        Weights of the inequalities, see :class:`seat_controller_fmu.design.setting.Setting`.
    solver
        One of :data:`seat_controller_fmu.design.synthesis.SOLVERS`.
    """

    objective: str = OBJECTIVES[0]
    level: float | None = None
    follow: float = FOLLOW
    force_weight: float = 0.0
    driver_mass_min: float | None = None
    driver_mass_max: float | None = None
    observer_gamma: float | None = None
    observer_rate: float | None = None
    observer_gains: tuple[float, float] | None = None
    alpha: float | None = None
    c0: float | None = None
    p2: float | None = None
    solver: str = SOLVERS[0]

    def setting(self) -> Setting:
        """Return mass range, observer gains and weights of the request.

        Raises
        ------
        SetupError
            If Gamma is not below 0.
        GainsError
            If another value is out of range.
        """
        masses = (
            _or_default(self.driver_mass_min, paper.DRIVER_MASS_MIN.value),
            _or_default(self.driver_mass_max, paper.DRIVER_MASS_MAX.value),
        )
        weights = (
            _or_default(self.alpha, paper.ALPHA.value),
            _or_default(self.c0, paper.C_0.value),
            _or_default(self.p2, paper.P_2.value),
        )
        gamma = _or_default(self.observer_gamma, paper.OBSERVERS[1].value)
        if not gamma < 0.0:
            raise SetupError(f"design: expected an observer constant Gamma below 0 (a stable observer), got {gamma:g}")
        if self.observer_rate is not None:
            return equal_rate(*masses, self.observer_rate, *weights)
        setting = by_gamma(*masses, gamma, *weights)
        if self.observer_gains is not None:
            L_1, L_2 = self.observer_gains
            setting = replace(setting, L1=L_1, L2=L_2, observer_gamma=None)
        return setting

    def design(self) -> Gains:
        """Design the gains that the options ask for.

        Raises
        ------
        SetupError, GainsError
            If the request is out of range.
        DesignError
            If there are no such gains, or the solver is not installed or fails.
        """
        return design(
            self.setting(),
            self.objective,
            _or_default(self.level, paper.LAMBDA.value),
            follow=self.follow,
            force_weight=self.force_weight,
            solver=self.solver,
        )


def certified_gains(
    request: DesignRequest, given: str | None = None, progress: Callable[[str], None] = lambda text: None
) -> tuple[Gains, Certificate]:
    """Design or read gains, and certify them for the nominal seat.

    Parameters
    ----------
    request
        Request for the design; of given gains its level alone is used.
    given
        Name of a preset, or a ``gains.json``; nothing is designed then.
    progress
        Called with a description of the progress.

    Returns
    -------
    Gains
        With figures and Lyapunov matrix of the certificate.
    Certificate
        What holds for them.

    Raises
    ------
    SetupError
        If the request is out of range, there are no such gains, or they cannot be read.
    """
    try:
        progress("solving" if given is None else "reading")
        gains = request.design() if given is None else load(given)
        progress("certifying")
        certificate = certify(gains, nominal_seat, request.level)
    except (DesignError, GainsError) as error:
        raise SetupError(str(error)) from error
    return replace(gains, figures=certificate.figures(), Q=certificate.Q), certificate


def write_design(
    gains: Gains, folder: Path, *, survey: bool, progress: Callable[[float], None] = lambda share: None
) -> None:
    """Write ``gains.json``, ``gains.ssv`` and the figures of a design.

    Parameters
    ----------
    gains
        The set.
    folder
        Folder of the files; it is made if it does not exist.
    survey
        Whether to survey observer and state feedback, and draw the result.
    progress
        Called with the share of the survey that is done.

    Raises
    ------
    SetupError
        If the folder cannot be written to.
    """
    from seat_cosim.design_figures import draw_delay_margin, draw_pareto, draw_transmissibility

    with writing_to(folder):
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "gains.json").write_text(gains.to_json(), encoding="utf-8")
        (folder / "gains.ssv").write_text(gains.to_ssv(), encoding="utf-8")
    draw_transmissibility(gains, folder / "transmissibility.png")
    draw_delay_margin(gains, folder / "delay_margin.png")
    if survey:
        draw_pareto(gains, folder / "pareto.png", progress)
