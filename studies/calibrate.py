"""Calibrate what the paper does not publish on its 55 kg column, and predict the rest.

The results are those of docs/explanation/calibration.md.

python -m studies.calibrate                   tables and figures, in some three minutes
python -m studies.calibrate --write           and the parameter sets, into plant_models/parameter_sets
python -m studies.calibrate --fmus DIR --figures DIR
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path

from rich.console import Console
from rich.table import Table

from plant_models import parameter_sets
from seat_cosim.paper.published import BUMP_PEAKS, REDUCTIONS
from seat_cosim.scenarios import control
from studies.calibration import (
    CONTROLLED_RMS,
    CUSHIONED,
    LOAD,
    PASSIVE_RMS,
    UNCONTROLLED_RMS,
    Alternative,
    Comparison,
    Shape,
    alternatives,
    calibrate,
    compare,
    contents,
    fit_damping,
    fit_height,
    fit_scale,
    passive_seat,
    required,
    ride,
)
from studies.calibration_figures import draw_figures
from studies.rides import DURATION, FEW_SEEDS, FLOOR, SEEDS, Parameters, Rides

ROOT = Path(__file__).parent.parent
CONSOLE = Console(width=150)


def fitted_table(light: Comparison, sets: Mapping[str, Parameters]) -> Table:
    """Return a table of the paper's numbers that were fitted; ``light`` has a load of 55 kg."""
    table = Table("55 kg, RMS of the seat", "paper", "here", "by", title="Fitted")
    rows = (
        ("uncontrolled", UNCONTROLLED_RMS, light.uncontrolled, "ride", "shaker.random.scale", ""),
        ("passive", PASSIVE_RMS, light.passive, "passive", "seat.suspension_damping", " N s/m"),
        ("controlled", CONTROLLED_RMS, light.prototype, "prototype", "seat.actuator.time_constant", " s"),
    )
    for name, paper, found, of, parameter, unit in rows:
        table.add_row(name, f"{paper}", f"{found.rms:.3f}", f"{parameter} = {sets[of][parameter]:g}{unit}")
    return table


def predicted_table(heavy: Comparison) -> Table:
    """Return a table of the 70 kg column."""
    table = Table("70 kg", "paper", "here", "difference, points", title="Predicted")
    paper, found = REDUCTIONS[70.0], heavy.reduction("prototype")
    table.add_row("prototype against passive", f"-{paper} %", f"-{found:.1f} %", f"{paper - found:+.1f}")
    return table


def bump_table(rides: Rides, sets: Mapping[str, Parameters]) -> Table:
    """Return a table of the bump's peaks, for the bump of the simulation and for one fitted to the first peak."""
    table = Table("peak, m/s2", "paper", "(34): seat", "driver", title="Predicted: bump")
    height = required(fit_height(rides, sets["passive"]))
    for column in (f"{1e3 * height:.1f} mm high: seat", "driver"):
        table.add_column(column)
    for mass, papers in BUMP_PEAKS.items():
        for paper, name, seat in zip(papers.values(), ("passive", "prototype"), (control(False), {}), strict=True):
            bumps: tuple[Parameters, ...] = ({}, {"shaker.bump.height": height})
            peaks = [peak for bump in bumps for peak in rides.bump({**seat, **sets[name], **bump}, mass)]
            table.add_row(f"{mass:g} kg, {name}", f"{paper:.2f}", *(f"{peak:.2f}" for peak in peaks))
    return table


def ideal_table(light: Comparison, heavy: Comparison) -> Table:
    """Return a table of the ideal simulation against the passive seat."""
    table = Table("ideal, against the passive seat", "paper's experiment", "here", title="Predicted: ideal simulation")
    for mass, comparison in ((55.0, light), (70.0, heavy)):
        table.add_row(f"{mass:g} kg", f"-{REDUCTIONS[mass]} %", f"-{comparison.reduction('ideal'):.1f} %")
    return table


def error_table(light: Comparison, heavy: Comparison) -> Table:
    """Return a table of the uncertainty of each RMS, and of the spectra's peaks."""
    table = Table(
        "",
        "RMS, m/s2",
        "sigma",
        "by the formula",
        "of one minute",
        "peak, m/s2",
        "spectrum's peak, Hz",
        title=f"All rides: {len(SEEDS)} x {DURATION:g} s",
    )
    for mass, comparison in ((55, light), (70, heavy)):
        for name, found in comparison._asdict().items():
            table.add_row(
                f"{mass} kg {name}",
                f"{found.rms:.3f}",
                f"{found.scatter / len(SEEDS) ** 0.5:.1%}",
                f"{found.error(len(SEEDS) * DURATION):.1%}",
                f"{found.error(60.0):.0%}",
                f"{found.peak:.1f}",
                f"{found.peak_frequency:.2f}",
            )
    return table


def alternatives_table(rides: Rides, cushioned: Rides, sets: Mapping[str, Parameters]) -> Table:
    """Return a table of predictions under other assumptions that fit; ``cushioned`` has the load on a cushion."""
    table = Table(
        "", "reduction 55 kg", "70 kg", "bump, seat: 55 kg", "70 kg", "driver: 55 kg", "70 kg",
        title="Other assumptions that fit as well (two seeds; bump: passive -> controlled)",
    )  # fmt: skip
    others = [(rides, each) for each in (Alternative("as committed", sets), *alternatives(rides, sets))]
    others.append((cushioned, Alternative("the load on Table 1's cushion", calibrate(cushioned, FEW_SEEDS))))
    for these, (name, other) in others:
        reductions = [compare(these, other, mass, FEW_SEEDS).reduction("prototype") for mass in REDUCTIONS]
        peaks = [
            [these.bump({**control(False), **other["passive"]}, mass), these.bump(other["prototype"], mass)]
            for mass in BUMP_PEAKS
        ]
        bumps = [f"{passive[part]:.2f} -> {active[part]:.2f}" for part in (0, 1) for passive, active in peaks]
        table.add_row(name, *(f"-{value:.1f} %" for value in reductions), *bumps)
    return table


def survey_classes(rides: Rides) -> Table:
    """Return a table of what follows from each shape of the excitation."""
    table = Table(
        "class",
        "scale",
        "floor's peak, Hz",
        "uncontrolled: peak, Hz",
        "m/s2",
        "ideal reduction",
        "passive: damping",
        "peak, Hz",
        "better than uncontrolled by, 2.5-4.5 Hz",
        title="Shapes of the excitation (two seeds; EM2, EM3 and EM4 have one shape)",
    )
    for name in ("EM1", "EM3", "EM5", "EM6", "EM7", "EM8", "EM9"):
        scale = required(fit_scale(rides, name, FEW_SEEDS))
        floor = ride(scale, name)
        shaken = rides.random({**floor, **control(False)}, seeds=FEW_SEEDS, signal=FLOOR)
        free = rides.random({**floor, **control(False)}, seeds=FEW_SEEDS)
        ideal = rides.random(floor, seeds=FEW_SEEDS)
        cells = [f"{scale:.3f}", f"{shaken.peak_frequency:.2f}", f"{free.peak_frequency:.2f}", f"{free.peak:.1f}"]
        damping = fit_damping(rides, floor, seeds=FEW_SEEDS)
        if damping is not None:
            seat = passive_seat(rides, damping)
            there = rides.random({**floor, **control(False), **seat}, seeds=FEW_SEEDS)
            gain = Shape.of(rides, seat).gain
            more = [f"{damping:.0f}", f"{there.peak_frequency:.2f}", f"{gain.min():.2f} … {gain.max():.2f}"]
        else:
            more = ["none"]
        table.add_row(name, *cells, f"{1 - ideal.rms / PASSIVE_RMS:.1%}", *more)
    return table


def main() -> None:
    """Fit, print the tables, draw the figures; write the parameter sets with ``--write``."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fmus", type=Path, default=ROOT / "fmus" / "fmi2", help="folder of the three FMUs")
    parser.add_argument("--figures", type=Path, default=ROOT / "docs" / "figures", help="where the figures go")
    parser.add_argument("--write", action="store_true", help="write the parameter sets, too")
    given = parser.parse_args()
    given.figures.mkdir(parents=True, exist_ok=True)
    with Rides(given.fmus, LOAD) as rides, Rides(given.fmus, CUSHIONED) as cushioned:
        sets = calibrate(rides)
        if given.write:
            for name, content in contents(rides.system, sets).items():
                parameter_sets.path(name).write_bytes(content)
        light, heavy = (compare(rides, sets, mass) for mass in REDUCTIONS)
        CONSOLE.print(fitted_table(light, sets))
        CONSOLE.print(predicted_table(heavy))
        CONSOLE.print(bump_table(rides, sets))
        CONSOLE.print(ideal_table(light, heavy))
        CONSOLE.print(error_table(light, heavy))
        CONSOLE.print(alternatives_table(rides, cushioned, sets))
        CONSOLE.print(survey_classes(rides))
        draw_figures(rides, sets, light, given.figures)


if __name__ == "__main__":
    main()
