"""One SSP file in several masters: ``python benchmarks/interoperation.py [FILE.ssp] [FIGURE.svg]``.

Prints the numbers of docs/interoperation.md and draws its figure: the paper's bump, this master in its sequential order
against masters that exchange all values at once.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave
from peers import PACKAGES, PEERS, run

from cosim import System
from cosim.figures import Curve, Panel, draw
from cosim.model import Model, Value
from cosim.scenarios import observer
from seat_controller_fmu.parameters import OBSERVERS

SIGNALS = {"seat.driver_acceleration": "m/s²", "controller.force": "N"}
"""What is compared, and its unit."""


Values = Mapping[str, np.ndarray]
"""Signal to its values at t_1 ... t_N, after each step."""


@contextmanager
def _slave(name: str, model: Model) -> Iterator[FMU2Slave]:
    with TemporaryDirectory() as folder:
        fmpy.extract(model.open(), folder)
        fmu = FMU2Slave(
            guid=model.description.guid,
            modelIdentifier=model.description.coSimulation.modelIdentifier,
            unzipDirectory=folder,
            instanceName=name,
        )
        fmu.instantiate()
        fmu.setupExperiment(startTime=0.0)
        yield fmu
        fmu.terminate()
        fmu.freeInstance()


def by_hand(system: System, steps: int, step_size: float, parameters: Mapping[str, Value]) -> Values:
    """Run a system of FMI 2 FMUs with all values exchanged at once: an independent loop, one call a value.

    Parameters
    ----------
    system
        Its models and connections, all of them of real numbers.
    steps, step_size
        How many steps of how many s.
    parameters
        ``component.variable`` to a real number.

    Returns
    -------
    dict
        For each of :data:`SIGNALS`.
    """
    with ExitStack() as stack:
        fmus = {name: stack.enter_context(_slave(name, model)) for name, model in system.models.items()}

        def place(port: str) -> tuple[FMU2Slave, list[int]]:
            component, _, variable = port.partition(".")
            return fmus[component], [system.models[component].variables[variable].valueReference]

        def get(port: str) -> float:
            fmu, reference = place(port)
            return float(fmu.getReal(reference)[0])

        def exchange() -> None:
            values = {sink: feed.transformation(get(str(feed.source))) for sink, feed in system.connections.items()}
            for sink, value in values.items():
                fmu, reference = place(str(sink))
                fmu.setReal(reference, [value])

        for port, value in parameters.items():
            fmu, reference = place(port)
            fmu.setReal(reference, [float(value)])
        for fmu in fmus.values():
            fmu.enterInitializationMode()
        for _ in fmus:
            exchange()
        for fmu in fmus.values():
            fmu.exitInitializationMode()
        rows = []
        for tick in range(steps):
            exchange()
            for fmu in fmus.values():
                fmu.doStep(currentCommunicationPoint=tick * step_size, communicationStepSize=step_size)
            rows.append([get(signal) for signal in SIGNALS])
    return dict(zip(SIGNALS, np.array(rows).T, strict=True))


def sequential(system: System) -> Values:
    """Run a system as it is here, in its order; values as those of :func:`by_hand`.

    A row holds the discrete outputs that follow from its own instant, which other masters show one step later.
    """
    result = system.simulate(record=list(SIGNALS))
    return {
        "seat.driver_acceleration": result["seat.driver_acceleration"][1:],
        "controller.force": result["controller.force"][:-1],
    }


def differences(one: Values, other: Values) -> list[float]:
    """Return the largest difference of each of :data:`SIGNALS`, in its unit."""
    return [float(np.abs(one[name] - other[name]).max()) for name in SIGNALS]


def draw_exchanges(figure: Path, step_size: float, ours: Values, others: Values) -> None:
    """Draw the bump's first half second in two ways of exchange; ``step_size`` in s."""
    rows = round(0.5 / step_size)
    panels = [
        Panel(
            f"{signal.partition('.')[2]} ({unit})".replace("_", " "),
            step_size * np.arange(1, rows + 1),
            [
                Curve("in the order controller, seat, shaker", ours[signal][:rows], {"color": "0.2"}),
                Curve("all at once", others[signal][:rows], {"linestyle": "--"}),
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
        ours = sequential(system)
        at_once = by_hand(system, clock.steps, clock.step_size, system.parameters)
        rows = {"this one, against all at once": differences(ours, at_once)}
        with TemporaryDirectory() as folder:
            system.save(Path(folder) / "system.ssp")
            for peer in PEERS:
                found = run(peer, Path(folder) / "system.ssp", clock.steps, clock.step_size, list(SIGNALS))
                rows[f"{peer} {version(PACKAGES[peer])}, against all at once"] = differences(found, at_once)
                rows[f"{peer} {version(PACKAGES[peer])}, against this one"] = differences(found, ours)
        rows["largest value"] = [float(np.abs(ours[name]).max()) for name in SIGNALS]
        for what, values in rows.items():
            print(f"| {number} | {what} | " + " | ".join(f"{value:.2g}" for value in values) + " |")
    draw_exchanges(figure, clock.step_size, ours, at_once)


if __name__ == "__main__":
    main()
