"""CPU time to start: ``import cosim``, its main class, and the command line's help.

    python -m benchmarks.start_up

User and system time of a fresh process, the best of ten; the bounds are those that the project keeps.
"""

from __future__ import annotations

import os
import subprocess
import sys

REPEATS = 10

COMMANDS = {
    "import cosim": (["-c", "import cosim"], 0.25),
    "from cosim import System": (["-c", "from cosim import System"], None),
    "from seat_cosim import ssp": (["-c", "from seat_cosim import ssp"], None),
    "seat-cosim --help": (["-m", "seat_cosim", "--help"], 0.35),
    "seat-cosim run --help": (["-m", "seat_cosim", "run", "--help"], None),
}
"""What is timed: words of Python's command line, and the bound in s."""


def cpu_time(words: list[str]) -> float:
    """Return the user and system time in s of a process of Python."""
    before = os.times()
    subprocess.run([sys.executable, *words], stdout=subprocess.DEVNULL, check=True)
    after = os.times()
    return after.children_user + after.children_system - before.children_user - before.children_system


def main() -> None:
    """Print the table; exit with 1 if a bound is exceeded."""
    slow = False
    for name, (words, bound) in COMMANDS.items():
        found = min(cpu_time(words) for _ in range(REPEATS))
        slow = slow or (bound is not None and found > bound)
        print(f"{name:28} {found:6.3f} s" + (f"   at most {bound:.2f} s" if bound else ""))
    sys.exit(int(slow))


if __name__ == "__main__":
    main()
