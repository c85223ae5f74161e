"""``seat-cosim design``: gains, certificate, figures."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from rich.box import SIMPLE
from rich.table import Table

from cosim.errors import RunError, SetupError
from seat_controller_fmu.design.synthesis import FOLLOW, OBJECTIVES, SOLVERS
from seat_cosim.cli.console import console, progress_shown
from seat_cosim.cli.effect import is_given, refuse_without_effect

if TYPE_CHECKING:
    from seat_controller_fmu.design.certificate import Certificate
    from seat_controller_fmu.design.gains import Gains
    from seat_controller_fmu.design.setting import Setting

_OBSERVER_OPTIONS = ("observer_gamma", "observer_rate", "observer_gains")


@click.command()
@click.option(
    "--mode",
    type=click.Choice(["published", "robust"]),
    default="published",
    show_default=True,
    help="robust: certify the sampled loop of the mode robust; design nothing.",
)
@click.option("--set", "settings", multiple=True, metavar="X=VALUE", help="Parameter of the controller, mode robust.")
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
def design(
    mode: str, settings: tuple[str, ...], given: str | None, output: Path | None, pareto: bool | None, **request: Any
) -> None:
    """Design gains by the paper's LMIs, or certify given ones.

    \b
    Examples:
      seat-cosim design --gains published
      seat-cosim design --driver-mass-max 120 --observer-gains -4000 -3500 --output results/design
      seat-cosim run bump --gains results/design/gains.json
      seat-cosim design --mode robust --set actuator_time_constant=0.005
    """
    from seat_cosim.gain_design import DesignRequest, certified_gains, write_design

    if mode == "robust":
        refuse_without_effect(["given", "pareto", *request], "--mode robust", "its gains are parameters of the mode")
        _certify_robust(settings, output)
        return
    if settings:
        raise SetupError(f"design: expected --set with --mode robust only, got {settings[0]}")
    if given is None:
        _check_observer(request)
    else:
        names = [name for name in request if name != "level"]
        refuse_without_effect(names, f"--gains {given}", "nothing is designed of given gains")
    if request["objective"] != "trade-off":
        refuse_without_effect(
            ("follow", "force_weight"),
            f"--objective {request['objective']}",
            "--objective trade-off uses it",
        )
    if output is None:
        _refuse_figures()
    with progress_shown("design") as report:
        gains, certificate = certified_gains(DesignRequest(**request), given, report)
    _print_gains(gains)
    _print_certificate(certificate, gains.setting)
    _print_robustness(gains)
    if output is not None:
        survey = pareto if pareto is not None else given is None
        with progress_shown("figures") as report:
            write_design(gains, output, survey=survey, progress=lambda share: report(f"survey {share:.0%}"))
        console.print(f"gains and figures in {output}")
    if certificate.problems:
        raise RunError("; ".join(certificate.problems))


def _refuse_figures() -> None:
    """Refuse options about figures where none is drawn."""
    if is_given("pareto"):
        raise SetupError("--pareto or --no-pareto: expected with --output FOLDER, got without")


def _check_observer(request: dict[str, Any]) -> None:
    """Check that the observer is given in one way."""
    given = [name for name in _OBSERVER_OPTIONS if request[name] is not None]
    if len(given) > 1:
        raise SetupError(
            f"design: expected one of --observer-gamma, --observer-rate, --observer-gains, got {len(given)}"
        )


def _print_gains(gains: Gains) -> None:
    """Print gains, observer and memberships."""
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


def _print_certificate(certificate: Certificate, setting: Setting) -> None:
    """Print margins, certified level and delay margins; alpha is the least worst-case gain that a seat can have."""
    alpha = setting.alpha
    table = Table(title=f"Certificate at lambda = {certificate.lambda_:.4g}", title_justify="left", box=SIMPLE)
    table.add_column("what")
    table.add_column("value", justify="right")
    table.add_column("needed")
    for name, margin in certificate.margins.items():
        table.add_row(f"margin of {name}", f"{margin:.3g}", "> 0")
    table.add_row("smallest certified lambda", f"{certificate.certified_lambda:.4f}", f"<= {certificate.lambda_:.4g}")
    table.add_row("true worst-case gain", f"{certificate.worst_case_lambda:.4f}", f"> {alpha:g}, a seat's floor")
    console.print(table)
    table = Table(title="Extra delay the sampled loop survives (linear, no friction)", title_justify="left", box=SIMPLE)
    table.add_column("driver (kg)")
    margins = certificate.delay_margin_ms
    ends = (min(margins), max(margins), setting.driver_mass_min, setting.driver_mass_max)
    shown = [mass for mass in margins if mass % 10 == 5 or mass in (80.0, *ends)]
    for mass in shown:
        table.add_column(f"{mass:g}", justify="right")
    table.add_row("margin (ms)", *(f"{margins[mass]:.0f}" for mass in shown))
    console.print(table)


def _print_robustness(gains: Gains) -> None:
    """Print the delay margins of seats that are not the one of the design."""
    from seat_controller_fmu.design.robustness import robustness
    from seat_cosim.nominal_seat import nominal_seat, seated_body

    margins = robustness(gains, nominal_seat, seated_body)
    title = "The same in seats that are not as assumed (ms; a dash where the loop is unstable)"
    table = Table(title=title, title_justify="left", box=SIMPLE)
    table.add_column("on the seat (kg)")
    for mass in next(iter(margins.values())):
        table.add_column(f"{mass:g}", justify="right")
    for condition, row in margins.items():
        table.add_row(condition, *("–" if math.isnan(margin) else f"{margin:.0f}" for margin in row.values()))
    console.print(table)


def _certify_robust(settings: tuple[str, ...], output: Path | None) -> None:
    """Certify the sampled loop of the mode robust, print it, and write it to a folder."""
    from seat_cosim.robust_certificate import certify_robust, write_certificate

    with progress_shown("design") as report:
        report("certifying")
        parameters, certificate = certify_robust(settings)
    lag, delay = parameters.actuator_time_constant * 1e3, parameters.actuator_delay * 1e3
    console.print(f"Mode robust, actuator with a lag of {lag:g} ms and a delay of {delay:g} ms. Drivers in kg.\n")
    tables = (
        ("Extra delay the sampled loop survives (ms)", certificate.delay_margin_ms, ".0f"),
        ("Largest gain from floor to driver, 0.03-50 Hz", certificate.worst_case_gain, ".2f"),
    )
    for title, values, form in tables:
        table = Table(title=title, title_justify="left", box=SIMPLE)
        table.add_column("case")
        for mass in next(iter(values.values())):
            table.add_column(f"{mass:g}", justify="right")
        for case, row in values.items():
            table.add_row(case, *(f"{value:{form}}" for value in row.values()))
        console.print(table)
    if output is not None:
        console.print(f"{write_certificate(parameters, certificate, output)} in {output}")
    if certificate.problems:
        raise RunError("; ".join(certificate.problems))
