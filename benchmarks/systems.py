"""What a step of this project's systems costs in the master's loop in C: ``python -m benchmarks.systems [FMUS]``.

Native FMUs of FMI 2.0, 30 000 steps of 2 ms, all outputs recorded; medians and quickest of rounds in which the systems
take turns. FMUS is a folder of built FMUs, ``fmus/fmi2`` by default.
"""

from __future__ import annotations

import sys
from contextlib import ExitStack
from pathlib import Path
from statistics import median
from time import perf_counter

from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from cosim.engine.session import Session
from cosim.fmi.values import Value
from seat_cosim.scenarios import SCENARIOS, TRUCK, seat_block, seat_suspension

STEPS, H, ROUNDS = 30_000, 0.002, 15


def microseconds(session: Session, parameters: dict[str, Value]) -> float:
    """Run all steps; returns us a step."""
    begin = perf_counter()
    session.run(STEPS * H, H, parameters, stepper="c")
    return 1e6 * (perf_counter() - begin) / STEPS


def main() -> None:
    """Print a table."""
    fmus = Path(sys.argv[1] if len(sys.argv) > 1 else "fmus/fmi2")
    shaken, driven = dict(SCENARIOS["random"].parameters), dict(SCENARIOS["truck"].parameters)
    systems = {
        "Shaker, SeatPlant, SeatController": (seat_suspension(fmus), shaken),
        "TruckCab, SeatPlant, SeatController": (seat_suspension(fmus, TRUCK), driven),
        "TruckCab, ActiveSeat": (seat_block(fmus, "ActiveSeat", TRUCK), driven),
        "TruckCab, PassiveSeat": (seat_block(fmus, "PassiveSeat", TRUCK), driven),
    }
    with ExitStack() as stack:
        sessions = {name: (stack.enter_context(system.open()), given) for name, (system, given) in systems.items()}
        found: dict[str, list[float]] = {name: [] for name in systems}
        for _ in range(ROUNDS):
            for name, (session, given) in sessions.items():
                found[name].append(microseconds(session, given))
    table = Table("system", box=SIMPLE, title=f"{STEPS} steps of {1e3 * H:g} ms, all outputs", title_justify="left")
    for title in ("us a step", "quickest"):
        table.add_column(title, justify="right")
    for name, times in found.items():
        table.add_row(name, f"{median(times):.3f}", f"{min(times):.3f}")
    Console(width=100, highlight=False).print(table)


if __name__ == "__main__":
    main()
