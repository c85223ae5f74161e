"""The floor of the truck's cab: its spectrum beside the linear solution, and its vibration by road and speed.

    python -m studies.truck_floor

It needs the FMUs of ``seat-cosim build``, prints the modes and a table, and writes docs/figures/truck_floor.svg.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from cosim import System
from cosim.metrics import psd, ride, rms
from plant_models.truck.interface import Parameters, RoadClass
from plant_models.truck.modes import floor_response, modes, road_density
from seat_cosim.carried import fmu_folder
from seat_cosim.plotting import Curve, Panel, draw

FIGURE = Path(__file__).parents[1] / "docs" / "figures" / "truck_floor.svg"
STEP, DURATION, WARM_UP = 0.002, 600.0, 10.0
"""Communication step, duration of a ride and what is left out at its begin, in s."""

RESOLUTION = 0.1
"""Of the spectra, in Hz."""

SPEEDS = (30, 60, 90)
"""In km/h."""


def floor(road_class: RoadClass, speed: float, duration: float = DURATION) -> np.ndarray[Any, Any]:
    """Drive over a random road without a force of the seat.

    Parameters
    ----------
    road_class
        Class of ISO 8608.
    speed
        In km/h.
    duration
        In s.

    Returns
    -------
    ndarray
        Acceleration of the floor in m/s2, every 2 ms.
    """
    system = System()
    system.add("truck", fmu_folder() / "TruckCab.fmu")
    parameters = {"truck.road.class": road_class.name, "truck.speed": speed / 3.6}
    found = system.simulate(duration, STEP, parameters, record=["truck.floor_acceleration"])
    return np.asarray(found["truck.floor_acceleration"])


def main() -> None:
    """Print the tables and draw the figure."""
    print("mode, Hz     " + "".join(f"{mode.frequency:8.2f}" for mode in modes(Parameters())))
    print("damping      " + "".join(f"{mode.damping:8.2f}" for mode in modes(Parameters())))
    print("class km/h    RMS   a_w  peak Hz  energy in 1-4 Hz")
    curves = []
    for road_class in RoadClass:
        for speed in SPEEDS:
            acceleration = floor(road_class, speed)
            spectrum = psd(acceleration, 1.0 / STEP, RESOLUTION, WARM_UP)
            whole = acceleration[round(WARM_UP / STEP) :]
            share = (spectrum.rms(1.0, 4.0) / rms(whole)) ** 2
            peak = spectrum.frequency[np.argmax(spectrum.density)]
            a_w = ride(acceleration, 1.0 / STEP, WARM_UP).a_w
            print(f"{road_class.name:5} {speed:4} {rms(whole):6.2f} {a_w:5.2f} {peak:8.1f} {100.0 * share:8.0f} %")
            if road_class == RoadClass.C and speed == 60:
                curves.append(Curve("simulated, 600 s", spectrum.density, {"color": "C0"}, spectrum.frequency))
    truck = Parameters()
    frequency = np.linspace(0.3, 15.0, 800)
    density = np.abs(floor_response(truck, frequency)[0]) ** 2 * road_density(truck, frequency)
    curves.append(Curve("linear solution", density, {"color": "0.2", "linestyle": "--"}, frequency))
    panel = Panel("Acceleration of the floor\n((m/s²)²/Hz)", frequency, curves, {}, limits=(1e-4, 3.0))
    draw(FIGURE, "Cab floor of the truck at the seat, road of class C, 60 km/h", [panel], "Frequency (Hz)", log=True)


if __name__ == "__main__":
    main()
