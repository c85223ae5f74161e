"""What isolation costs: a step of a native FMU in this process and in one of its own, and the start of that process.

    python -m benchmarks.isolation [fmus/fmi2]

Medians; "round trip" is the same bytes between two Python processes without any FMU, the floor of what is possible.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from multiprocessing import Pipe
from pathlib import Path
from statistics import median
from time import perf_counter

from cosim import System

STEPS, H, REPEATS = 5000, 0.002, 5

FLOOR = ("displacement", "velocity", "acceleration")
"""Signals of the floor, which stays at rest."""

ECHO = """
import sys
from multiprocessing.connection import Connection
connection = Connection(int(sys.argv[1]))
while (message := connection.recv_bytes()) != b"end":
    connection.send_bytes(message)
"""


def seconds(action: Callable[[], object]) -> float:
    """Time one call."""
    begin = perf_counter()
    action()
    return perf_counter() - begin


def step_cost(system: System, isolate: tuple[str, ...]) -> float:
    """Median time of a step in us, and of opening and closing the session in s."""
    with system.open(isolate=isolate, capture_stdout=False) as session:
        session.run(0.1, H)
        return median(seconds(lambda: session.run(STEPS * H, H)) for _ in range(REPEATS)) / STEPS * 1e6


def opening(system: System, isolate: tuple[str, ...]) -> float:
    """Median time to load and free in ms."""

    def open_and_close() -> None:
        with system.open(isolate=isolate):
            pass

    return median(seconds(open_and_close) for _ in range(REPEATS)) * 1e3


def round_trip(size: int) -> float:
    """Median time in us to send bytes to a process and have them sent back."""
    ours, theirs = Pipe()
    number = theirs.fileno()
    with theirs:
        process = subprocess.Popen([sys.executable, "-c", ECHO, str(number)], pass_fds=[number])
    message = b" " * size

    def exchange() -> None:
        for _ in range(STEPS):
            ours.send_bytes(message)
            ours.recv_bytes()

    exchange()
    found = median(seconds(exchange) for _ in range(REPEATS)) / STEPS * 1e6
    ours.send_bytes(b"end")
    process.wait()
    return found


def main() -> None:
    """Print the table."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "fmus/fmi2")
    system = System()
    system.add("seat", folder / "SeatPlant.fmu")
    system.parameters = dict.fromkeys((f"seat.floor_{name}" for name in FLOOR), 0.0)
    inside, apart = step_cost(system, ()), step_cost(system, ("seat",))
    print(f"step in this process         {inside:8.1f} us")
    print(f"step in its own process      {apart:8.1f} us")
    print(f"isolation of a step          {apart - inside:8.1f} us")
    print(f"round trip without an FMU    {round_trip(8 * 12):8.1f} us")
    print(f"load and free, this process  {opening(system, ()):8.1f} ms")
    print(f"load and free, its own       {opening(system, ('seat',)):8.1f} ms")


if __name__ == "__main__":
    main()
