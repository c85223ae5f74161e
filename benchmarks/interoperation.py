"""One SSP file in several masters: ``python benchmarks/interoperation.py [FILE.ssp] [FIGURE.png]``.

Prints the numbers of docs/interoperation.md and draws its figure: the paper's bump, this master in its sequential order
against masters that exchange all values at once.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from peers import PACKAGES, PEERS, run

from cosim import System
from cosim.figures import Curve, Panel, draw
from cosim.scenarios import observer
from cosim.structure import Algorithm
from seat_controller_fmu.parameters import OBSERVERS

SIGNALS = {"seat.driver_acceleration": "m/s²", "controller.force": "N"}
"""What is compared, and its unit."""


Values = Mapping[str, np.ndarray]
"""Signal to its values at t_1 ... t_N, after each step."""


def here(system: System, algorithm: Algorithm) -> Values:
    """Run a system in this master.

    A row holds the discrete outputs that follow from its own instant, which other masters show one step later.
    """
    result = system.simulate(record=list(SIGNALS), algorithm=algorithm)
    return {
        "seat.driver_acceleration": result["seat.driver_acceleration"][1:],
        "controller.force": result["controller.force"][:-1],
    }


def differences(one: Values, other: Values) -> list[float]:
    """Return the largest difference of each of :data:`SIGNALS`, in its unit."""
    return [float(np.abs(one[name] - other[name]).max()) for name in SIGNALS]


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


def main() -> None:
    """Print the table and draw the figure."""
    source = Path(sys.argv[1] if len(sys.argv) > 1 else "fmus/SeatSuspension.ssp")
    figure = Path(sys.argv[2] if len(sys.argv) > 2 else "docs/figures/interoperation.png")
    print("| observer | master | " + " | ".join(f"{name}, {unit}" for name, unit in SIGNALS.items()) + " |")
    print("|---" * (len(SIGNALS) + 2) + "|")
    for number, gamma in OBSERVERS.items():
        system = System.load(source)
        system.parameters |= observer(gamma.value)
        clock = system.clock()
        in_order, at_once = here(system, "gauss-seidel"), here(system, "jacobi")
        rows = {"this one in order, against itself all at once": differences(in_order, at_once)}
        with TemporaryDirectory() as folder:
            system.save(Path(folder) / "system.ssp")
            for peer in PEERS:
                found = run(peer, Path(folder) / "system.ssp", clock.steps, clock.step_size, list(SIGNALS))
                rows[f"{peer} {version(PACKAGES[peer])}, against this one all at once"] = differences(found, at_once)
                rows[f"{peer} {version(PACKAGES[peer])}, against this one in order"] = differences(found, in_order)
        rows["largest value"] = [float(np.abs(in_order[name]).max()) for name in SIGNALS]
        for what, values in rows.items():
            print(f"| {number} | {what} | " + " | ".join(f"{value:.2g}" for value in values) + " |")
    draw_exchanges(figure, clock.step_size, in_order, at_once)


if __name__ == "__main__":
    main()
