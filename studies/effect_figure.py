"""Draw the figure of the README: what a driver feels on a random ride, on the passive seat and with control.

    python -m studies.effect_figure

It needs the FMUs of ``seat-cosim build`` and writes docs/figures/effect.svg.
"""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from seat_cosim import scenarios
from seat_cosim.carried import fmu_folder
from seat_cosim.compare import Ride, rides
from seat_cosim.plotting import Curve, Panel, draw

FIGURE = Path(__file__).parents[1] / "docs" / "figures" / "effect.svg"
MASS = 80.0
CLASS = "EM3"
BEGIN, END = 20.0, 30.0
"""Part of the ride that is shown, in s."""

STYLES = {
    "passive": ("passive seat", {"color": "0.6", "linewidth": 1.0}),
    "published": ("with the published controller", {"color": "C0"}),
}
SIGNAL = "seat.driver_acceleration"


def ride() -> list[Ride]:
    """Ride the same 60 s with the passive seat and with the controller."""
    ridden = scenarios.SCENARIOS["random"]
    parameters = {**ridden.parameters, "shaker.random.class": CLASS, **scenarios.driver_mass(MASS)}
    with TemporaryDirectory() as folder:
        return list(
            rides(
                list(STYLES),
                lambda: scenarios.seat_suspension(fmu_folder()),
                lambda system: parameters,
                ridden.stop_time,
                Path(folder),
            )
        )


def main() -> None:
    """Draw the figure."""
    found = ride()
    time = found[0].result.time
    shown = (time >= BEGIN) & (time <= END)
    curves = []
    for each in found:
        name, style = STYLES[each.variant.title]
        label = f"{name}: a_w {each.summary.values['a_w']:.2f} m/s², SEAT {each.summary.values['seat']:.2f}"
        curves.append(Curve(label, np.asarray(each.result[SIGNAL])[shown], style))
    panel = Panel("Acceleration of the driver\n(m/s²)", time[shown], curves, {})
    draw(FIGURE, f"Simulated random ride, ISO 7096 class {CLASS}, driver of {MASS:g} kg", [panel])


if __name__ == "__main__":
    main()
