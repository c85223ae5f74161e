"""One SSP file in several masters: ``python -m benchmarks.interoperation [FILE.ssp] [FIGURE.png]``.

Prints the numbers of docs/reference/interoperation.md and draws its figure: the paper's bump, this master in its
sequential order against masters that exchange all values at once.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from cosim import System
from seat_controller_fmu.parameters import OBSERVERS
from seat_cosim.plotting import Curve, Panel, draw
from seat_cosim.scenarios import observer
from tests.helpers.peers import PACKAGES, PEERS, SIGNALS, Values, differences, here, run


def draw_exchanges(figure: Path, step_size: float, in_order: Values, at_once: Values) -> None:
    """Draw the bump's first half second in two ways of exchange; ``step_size`` in s."""
    rows = round(0.5 / step_size)
    panels = [
        Panel(
            f"{signal.partition('.')[2]} ({unit})".replace("_", " "),
            step_size * np.arange(1, rows + 1),
            [
                Curve("in the order controller, seat, shaker", in_order[signal][:rows], {"color": "0.2"}),
                Curve("all at once", at_once[signal][:rows], {"linestyle": "--"}),
            ],
            {},
        )
        for signal, unit in SIGNALS.items()
    ]
    figure.parent.mkdir(parents=True, exist_ok=True)
    draw(figure, "One SSP file, two ways to exchange values: the bump, Observer 2", panels)


def peers(system: System) -> dict[str, Values]:
    """Run a system in every other master; by its name and version."""
    clock = system.clock()
    with TemporaryDirectory() as folder:
        system.save(Path(folder) / "system.ssp")
        return {
            f"{peer} {version(PACKAGES[peer])}": run(
                peer, Path(folder) / "system.ssp", clock.steps, clock.step_size, list(SIGNALS)
            )
            for peer in PEERS
        }


def row(number: int, what: str, values: Sequence[float], digits: int) -> str:
    """Write a line of a table."""
    return f"| {number} | {what} | " + " | ".join(f"{value:.{digits}g}" for value in values) + " |"


def bump_results(found: Values) -> list[float]:
    """Return the bump's results: peak and RMS of the driver's acceleration in m/s², the largest force in N."""
    acceleration, force = (found[name] for name in SIGNALS)
    return [float(x) for x in (np.abs(acceleration).max(), np.sqrt(np.mean(acceleration**2)), np.abs(force).max())]


def main() -> None:
    """Print the tables and draw the figure."""
    source = Path(sys.argv[1] if len(sys.argv) > 1 else "fmus/SeatSuspension.ssp")
    figure = Path(sys.argv[2] if len(sys.argv) > 2 else "docs/figures/interoperation.png")
    results, compared = [], []
    for number, gamma in OBSERVERS.items():
        system = System.load(source)
        system.parameters |= observer(gamma.value)
        in_order, at_once = here(system, "gauss-seidel"), here(system, "jacobi")
        others = peers(system)
        mine = {"this one, in order": in_order, "this one, all at once": at_once}
        results += [row(number, name, bump_results(found), 8) for name, found in (mine | others).items()]
        compared.append(row(number, "this one in order, against itself all at once", differences(in_order, at_once), 2))
        for name, found in others.items():
            compared.append(row(number, f"{name}, against this one all at once", differences(found, at_once), 2))
            compared.append(row(number, f"{name}, against this one in order", differences(found, in_order), 2))
    print("| observer | master | peak, m/s² | RMS, m/s² | force, N |", "|---" * 5 + "|", *results, sep="\n")
    names = " | ".join(f"{name}, {unit}" for name, unit in SIGNALS.items())
    print(f"\n| observer | master | {names} |", "|---" * 4 + "|", *compared, sep="\n")
    draw_exchanges(figure, system.clock().step_size, in_order, at_once)


if __name__ == "__main__":
    main()
