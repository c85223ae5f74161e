"""The command ``seat-cosim design``: gains, certificate, figures. Like all commands it parses, calls and prints."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np
from rich.box import SIMPLE
from rich.table import Table

from cosim.errors import RunError, SetupError, writing_to
from seat_controller_fmu.design.synthesis import FOLLOW, OBJECTIVES, SOLVERS
from seat_cosim.cli.console import console, progress_shown

if TYPE_CHECKING:
    from seat_controller_fmu.design.certificate import Certificate
    from seat_controller_fmu.design.gains import Gains
    from seat_controller_fmu.design.tradeoff import TradeOffCriteria, TradeOffPoint

_MASSES_SHOWN = (45.0, 55.0, 80.0, 120.0)
_SCALES = (0.5, 0.7, 0.85, 1.0, 1.1, 1.25, 1.5)
_FOLLOWS = (0.08, 0.14, 0.2, 0.3)


@click.command()
@click.option("--gains", "given", metavar="NAME|FILE", help="Certify a preset or a gains.json; design nothing.")
@click.option("--objective", type=click.Choice(OBJECTIVES), default=OBJECTIVES[0], show_default=True)
@click.option("--lambda", "level", type=float, help="H-infinity level lambda [default: 1.2, the paper's].")
@click.option(
    "--follow",
    type=float,
    metavar="HZ",
    default=FOLLOW,
    show_default=True,
    help="Trade-off: the seat follows the cabin below.",
)
@click.option(
    "--force-weight", type=float, default=0.0, show_default=True, help="Trade-off: weight of the force, (m/s2)^2/N^2."
)
@click.option("--driver-mass-min", type=float, metavar="KG", help="[default: 45]")
@click.option("--driver-mass-max", type=float, metavar="KG", help="[default: 80]")
@click.option("--observer-gamma", type=float, help="Gamma of (23) in s/kg2 [default: -3e-6, Observer 1].")
@click.option(
    "--observer-rate", type=float, metavar="1/S", help="Equal-rate observer: its pole, below 0, at all masses."
)
@click.option("--observer-gains", type=float, nargs=2, metavar="L1 L2", help="Observer gains themselves, kg/s.")
@click.option("--alpha", type=float, help="[default: 0.02, Table 1]")
@click.option("--c0", type=float, help="[default: 1, not given in the paper]")
@click.option("--p2", type=float, help="[default: 400, Table 1]")
@click.option("--solver", type=click.Choice(SOLVERS), default=SOLVERS[0], show_default=True)
@click.option(
    "--pareto/--no-pareto",
    default=None,
    help="Survey observer and state feedback [default: with --output, designs only].",
)
@click.option("--output", type=click.Path(path_type=Path), help="Folder for gains.json, gains.ssv and figures.")
def design(given: str | None, output: Path | None, pareto: bool | None, **request: Any) -> None:
    """Design gains by the paper's LMIs, or certify given ones.

    \b
    Examples:
      seat-cosim design --gains published
      seat-cosim design --driver-mass-max 120 --observer-gains -4000 -3500 --output results/design
      seat-cosim run bump --gains results/design/gains.json
    """
    from seat_controller_fmu.design.certificate import certify
    from seat_controller_fmu.design.gains import load
    from seat_controller_fmu.design.setting import GainsError
    from seat_controller_fmu.design.synthesis import DesignError
    from seat_cosim.nominal_seat import nominal_seat

    try:
        with progress_shown("design") as report:
            report("solving" if given is None else "reading")
            gains = load(given) if given else _designed(request)
            report("certifying")
            certificate = certify(gains, nominal_seat, request["level"])
    except (DesignError, GainsError) as error:
        raise SetupError(str(error)) from error
    gains = replace(gains, figures=certificate.figures(), Q=certificate.Q)
    _print(gains, certificate)
    if output is not None:
        _write(gains, output, survey=pareto if pareto is not None else given is None)
    if certificate.problems:
        raise RunError("; ".join(certificate.problems))


def _designed(request: dict[str, Any]) -> Gains:
    """Translate the options into a setting and design."""
    from seat_controller_fmu import parameters as p
    from seat_controller_fmu.design.setting import by_gamma, equal_rate
    from seat_controller_fmu.design.synthesis import design as solve

    def chosen(option: str, default: float) -> float:
        return default if request[option] is None else float(request[option])

    masses = chosen("driver_mass_min", p.DRIVER_MASS_MIN.value), chosen("driver_mass_max", p.DRIVER_MASS_MAX.value)
    weights = chosen("alpha", p.ALPHA.value), chosen("c0", p.C_0.value), chosen("p2", p.P_2.value)
    observers = [name for name in ("observer_gamma", "observer_rate", "observer_gains") if request[name] is not None]
    if len(observers) > 1:
        raise SetupError(
            f"design: expected one of --observer-gamma, --observer-rate, --observer-gains, got {len(observers)}"
        )
    gamma = chosen("observer_gamma", p.OBSERVERS[1].value)
    if not gamma < 0.0:
        raise SetupError(f"design: expected an observer constant Gamma below 0 (a stable observer), got {gamma:g}")
    if request["observer_rate"] is not None:
        setting = equal_rate(*masses, request["observer_rate"], *weights)
    else:
        setting = by_gamma(*masses, gamma, *weights)
        if request["observer_gains"] is not None:
            L_1, L_2 = request["observer_gains"]
            setting = replace(setting, L1=L_1, L2=L_2, observer_gamma=None)
    return solve(
        setting,
        request["objective"],
        chosen("level", p.LAMBDA.value),
        follow=request["follow"],
        force_weight=request["force_weight"],
        solver=request["solver"],
    )


def _print(gains: Gains, certificate: Certificate) -> None:
    """Print gains, certificate and margins."""
    s = gains.setting
    table = Table(title="Gains", title_justify="left", box=SIMPLE)
    for column in ("vertex", "driver", "K deflection (N/m)", "K rate (N s/m)", "L (kg/s)", "observer pole (1/s)"):
        table.add_column(column, justify="left" if column == "vertex" else "right")
    vertices = zip((1, 2), (s.driver_mass_min, s.driver_mass_max), gains.feedback, s.observer, s.vertices, strict=True)
    for index, mass, K, L, total in vertices:
        table.add_row(str(index), f"{mass:g} kg", f"{K[0]:.2f}", f"{K[1]:.2f}", f"{L:.1f}", f"{L / total:.1f}")
    console.print(table)
    middle = 0.5 * (s.driver_mass_min + s.driver_mass_max)
    h_1, _ = s.vertices.memberships(s.vertices.minimum + middle - s.driver_mass_min)
    console.print(
        f"  Memberships: h_1 falls from 1 at {s.driver_mass_min:g} kg by way of {h_1:.3f} at {middle:g} kg to 0 at "
        f"{s.driver_mass_max:g} kg, h_2 = 1 - h_1; outside they stay.\n"
    )
    table = Table(title=f"Certificate at lambda = {certificate.lambda_:.4g}", title_justify="left", box=SIMPLE)
    table.add_column("what")
    table.add_column("value", justify="right")
    table.add_column("needed")
    for name, margin in certificate.margins.items():
        table.add_row(f"margin of {name}", f"{margin:.3g}", "> 0")
    table.add_row("smallest certified lambda", f"{certificate.certified_lambda:.4f}", f"<= {certificate.lambda_:.4g}")
    table.add_row("true worst-case gain", f"{certificate.worst_case_lambda:.4f}", f"> {s.alpha:g}, a seat's floor")
    console.print(table)
    table = Table(title="Extra delay the sampled loop survives (linear, no friction)", title_justify="left", box=SIMPLE)
    table.add_column("driver (kg)")
    margins = certificate.delay_margin_ms
    shown = [mass for mass in margins if mass % 10 == 5 or mass in (80.0, 120.0)]
    for mass in shown:
        table.add_column(f"{mass:g}", justify="right")
    table.add_row("margin (ms)", *(f"{margins[mass]:.0f}" for mass in shown))
    console.print(table)


def _write(gains: Gains, folder: Path, *, survey: bool) -> None:
    """Write gains.json, gains.ssv and the figures."""
    with writing_to(folder):
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "gains.json").write_text(gains.to_json(), encoding="utf-8")
        (folder / "gains.ssv").write_text(gains.to_ssv(), encoding="utf-8")
    _draw_transmissibility(gains, folder / "transmissibility.png")
    _draw_delay_margin(gains, folder / "delay_margin.png")
    if survey:
        from seat_controller_fmu.design.gains import preset
        from seat_controller_fmu.design.tradeoff import TradeOffCriteria
        from seat_controller_fmu.design.tradeoff import survey as surveyed
        from seat_cosim.nominal_seat import friction_force, nominal_seat

        judge = TradeOffCriteria.relative_to(preset("published"), nominal_seat, friction_force())
        with progress_shown("survey of observer and state feedback") as report:
            sets = surveyed(gains, judge, _SCALES, _FOLLOWS, lambda share: report(f"{share:.0%}"))
        _draw_pareto(gains, sets, judge, folder / "pareto.png")
    console.print(f"gains and figures in {folder}")


def _draw_transmissibility(gains: Gains, path: Path) -> None:
    from seat_controller_fmu.design.tradeoff import transmissibility
    from seat_cosim.nominal_seat import nominal_seat
    from seat_cosim.plotting import Curve, Panel, draw

    frequencies = np.logspace(-1.5, 1.5, 400)
    curves = [
        Curve(f"{mass:g} kg", transmissibility(gains, nominal_seat, mass, frequencies), {"color": f"C{i}"})
        for i, mass in enumerate(_MASSES_SHOWN)
    ]
    panel = Panel("Driver over floor acceleration", frequencies, curves, {"1": 1.0})
    draw(path, "Closed-loop transmissibility, linear and without friction", [panel], "Frequency (Hz)", log=True)


def _draw_delay_margin(gains: Gains, path: Path) -> None:
    from seat_controller_fmu.design.certificate import delay_margins
    from seat_controller_fmu.design.gains import preset
    from seat_cosim.nominal_seat import nominal_seat
    from seat_cosim.plotting import Curve, Panel, draw

    masses = np.arange(45.0, 121.0, 2.5)
    sets = {
        "these gains": (gains, {"color": "C0"}),
        "published": (preset("published"), {"color": "0.45", "linestyle": "--"}),
    }
    curves = [
        Curve(
            name,
            np.array(list(delay_margins(found, nominal_seat, tuple(masses)).values())),
            {**style, "drawstyle": "steps-mid"},
        )
        for name, (found, style) in sets.items()
    ]
    panel = Panel("Delay margin (ms)", masses, curves, {"30 ms": 30.0})
    draw(path, "Extra delay the sampled loop survives", [panel], "Driver mass (kg)")


def _draw_pareto(gains: Gains, sets: list[TradeOffPoint], judge: TradeOffCriteria, path: Path) -> None:
    from seat_controller_fmu.design.gains import preset
    from seat_controller_fmu.design.tradeoff import front
    from seat_cosim.plotting import Panel, draw

    published = preset("published")
    curves = []
    for i, follow in enumerate(_FOLLOWS):
        of_one = [s for s in sets if s.follow == follow and np.isfinite(s.margin)]
        curves.append(_points(f"$f_x$ = {follow:g} Hz", of_one, {"color": f"C{i}", "marker": "o", "linewidth": 0.8}))
    curves.append(_points("Pareto front", front(sets), {"color": "0.2", "linewidth": 3.0, "alpha": 0.25}))
    for name, found, marker in (("published", published, "s"), ("these gains", gains, "*")):
        judged = judge.rate(found, 1.0, 0.0)
        curves.append(_points(name, [judged], {"color": "k", "marker": marker, "markersize": 11, "linestyle": "none"}))
    widest = max(s.margin for s in sets if np.isfinite(s.margin))
    panel = Panel(
        "Driver's RMS over published", np.array([0.0, widest + 4.0]), curves, {"no worse than published": 1.0}
    )
    title = "What a delay margin costs: observer gains from half to one and a half of these"
    draw(path, title, [panel], "Smallest delay margin over 45-120 kg (ms)")


def _points(name: str, sets: list[TradeOffPoint], style: dict[str, Any]) -> Any:
    from seat_cosim.plotting import Curve

    return Curve(name, np.array([s.rms for s in sets]), style, np.array([s.margin for s in sets]))
