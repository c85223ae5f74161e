"""A day on the seat: 24 h of EM3 floor through the master, 43.2 million steps, with streamed and thinned results.

    python -m benchmarks.soak [HOURS [FMUS [FIGURE]]]

Prints the numbers of docs/reference/reliability.md and draws its figure: whether memory stays flat, time exact, the
cost of a step what it was, and the motion stationary.
"""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from seat_cosim.cli.console import progress_shown
from tests.helpers.soak import HOUR, STEP_SIZE, WATCHED, Soak, soak


def draw_soak(path: Path, found: Soak, span: float) -> None:
    """Draw memory, cost of a step and root mean squares over the day."""
    from seat_cosim.plotting import Curve, Panel, draw

    costs = found.step_costs(span)
    middle = (np.arange(len(costs)) + 0.5) * span / HOUR
    hours = found.times / HOUR
    panels = [
        Panel("resident memory (MB)", hours, [Curve("", found.resident / 1e6, {})], {}),
        Panel("CPU time of a step (us)", hours, [Curve("", costs, {"marker": "."}, middle)], {}),
        Panel(
            "hourly RMS over the day's",
            hours,
            [
                Curve(name, values / np.sqrt(np.mean(values**2)), {"marker": "."}, middle)
                for name, values in ((name, found.rms(name, span)) for name in WATCHED)
            ],
            {},
        ),
    ]
    path.parent.mkdir(parents=True, exist_ok=True)
    draw(path, "24 h of EM3, 43.2 million steps", panels, "Simulated time (h)")


def main() -> None:
    """Run, print the numbers and draw the figure."""
    hours = float(sys.argv[1]) if len(sys.argv) > 1 else 24.0
    fmus = Path(sys.argv[2] if len(sys.argv) > 2 else "fmus/fmi2")
    figure = Path(sys.argv[3] if len(sys.argv) > 3 else "docs/figures/soak.png")
    span = HOUR if hours > 2.0 else hours * HOUR / 10.0
    with TemporaryDirectory() as folder, progress_shown("soaking") as report:
        found = soak(fmus, hours * HOUR, Path(folder), report)
    times, spent = found.result.time, found.cpu[-1] - found.cpu[0]
    print(f"{round(times[-1] / STEP_SIZE)} steps, {len(times)} rows, last at {times[-1]!r} s, CPU time {spent:.1f} s")
    print(f"largest error of a row's time: {found.time_error()} s")
    settled = found.resident[found.times > span] / 1e6
    print(f"resident: {settled[0]:.2f} MB after the first span, {settled[-1]:.2f} MB at the end", end=", ")
    print(f"most {settled.max():.2f} MB")
    costs = found.step_costs(span)
    print(f"CPU time of a step: first {costs[0]:.3f} us, last {costs[-1]:.3f} us", end=", ")
    print(f"mean {costs.mean():.3f} us, standard deviation {costs.std(ddof=1):.3f} us of {len(costs)} spans")
    for name, unit in WATCHED.items():
        values = found.rms(name, span)
        scatter, predicted = values.std(ddof=1) / values.mean(), found.predicted_scatter(name, span)
        print(f"{name}: RMS {values.mean():.4f} {unit}, scatter {scatter:.2%}, predicted {predicted:.2%}")
    draw_soak(figure, found, span)


if __name__ == "__main__":
    main()
