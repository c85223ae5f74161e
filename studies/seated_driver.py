"""The seated driver: figure of its curves, and what explicit coupling to the seat costs.

    python -m studies.seated_driver              the tables of docs/explanation/seated-driver.md
    python -m studies.seated_driver --write      and docs/figures/seated_driver.svg

It needs the FMUs of ``seat-cosim build``.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import click
import numpy as np

from cosim import System
from plant_models.driver import body as bodies
from plant_models.driver import driver
from plant_models.driver.interface import Inputs as DriverInputs
from plant_models.driver.interface import Parameters as DriverParameters
from plant_models.seat import seat
from plant_models.seat.interface import DriverModel, Inputs, Parameters
from seat_cosim import scenarios
from seat_cosim.carried import fmu_folder
from seat_cosim.plotting import Curve, Panel, draw

FIGURE = Path(__file__).parents[1] / "docs" / "figures" / "seated_driver.svg"
Array = np.ndarray[Any, Any]

FREQUENCIES = np.logspace(math.log10(0.5), math.log10(20.0), 400)
ORDERS = ("driver, seat", "seat, driver", "jacobi")
"""Orders of a step: the second component has the values that the first one has just computed, or none has."""

# ---- curves ----------------------------------------------------------------------------------------------------------


def curves(mass: float, frequencies: Array) -> tuple[Array, Array]:
    """Return normalized apparent mass and transmissibility to the head of a seated driver, from its equations."""
    b = bodies.prepare(mass, DriverParameters().contact_stiffness, DriverParameters().contact_damping)
    s = 2j * math.pi * frequencies
    apparent = np.zeros_like(s)
    above: Array = np.zeros_like(s)  # force per acceleration of the mass below, from the head down
    motion: Array = np.ones_like(s)
    for m, k, c in reversed(list(zip(b.masses, b.k, b.c, strict=True))):
        link = (k + c * s) / s**2
        own = m + above
        ratio = link / (link + own)
        above = own * ratio
        motion = motion * ratio
        apparent = above
    return np.abs(apparent) / mass, np.abs(motion)


def lumped(frequencies: Array) -> Array:
    """Return the normalized apparent mass of one mass on the cushion of Table 1, which is its transmissibility, too."""
    p, s = Parameters(), 2j * math.pi * frequencies
    link = p.cushion_stiffness + p.cushion_damping * s
    return np.abs(link / (link + p.driver_mass * s**2))


def write_figure() -> None:
    """Draw the curves."""
    mass, head = curves(55.0, FREQUENCIES)
    one = lumped(FREQUENCIES)
    grey = {"color": "0.6", "linewidth": 1.0}
    panels = [
        Panel(
            "Apparent mass over\nmass on the seat",
            FREQUENCIES,
            [Curve("seated, four masses", mass, {"color": "C0"}), Curve("one mass on the cushion", one, grey)],
            {},
        ),
        Panel(
            "Acceleration over\nthat of the seat",
            FREQUENCIES,
            [Curve("head of the seated driver", head, {"color": "C0"}), Curve("one mass on the cushion", one, grey)],
            {},
        ),
    ]
    draw(FIGURE, "Drivers on a seat that moves vertically", panels, "Frequency (Hz)", log=True)


# ---- coupling, linear ------------------------------------------------------------------------------------------------


class Mode(NamedTuple):
    """A vibration: natural frequency in Hz and damping ratio."""

    frequency: float
    damping: float


SEAT = Parameters(friction_alpha=0.0, driver_model=DriverModel.external)
"""The linear seat, without friction."""


def step_matrix(linear: Parameters, step_size: float, order: str | None) -> Array:
    """Return the linear map of one step of seat and driver; ``order`` None for the driver inside the seat."""
    d = driver.prepare(DriverParameters(driver_mass=linear.driver_mass))
    c = seat.prepare(linear if order else replace(linear, driver_model=DriverModel.seated))

    def after(x: Array) -> Array:
        z_s, v_s, a_s, push = x[8:12].tolist()
        z, v = tuple(x[:4].tolist()), tuple(x[4:8].tolist())
        if order is None:
            masses = seat.Masses(z_s, v_s, z[0], v[0], 0.0, z[1:], v[1:])
            m = seat.advance(seat.State(masses), Inputs(), c, 0.0, step_size)[0].masses
            body = (m.driver_displacement, *m.upper_displacements, m.driver_velocity, *m.upper_velocities)
            return np.array([*body, m.seat_displacement, m.seat_velocity, 0.0, 0.0])
        felt = DriverInputs(z_s, v_s, a_s)
        if order != "seat, driver":
            person, force = driver.advance(driver.State(z, v), felt, d, 0.0, step_size)
        used = push if order != "driver, seat" else force.contact_force
        state = seat.State(seat.Masses(z_s, v_s, 0.0, 0.0, 0.0))
        outputs = seat.advance(state, Inputs(driver_force=used), c, 0.0, step_size)[1]
        if order == "seat, driver":
            felt = DriverInputs(outputs.seat_displacement, outputs.seat_velocity, outputs.seat_acceleration)
            person, force = driver.advance(driver.State(z, v), felt, d, 0.0, step_size)
        moved = (outputs.seat_displacement, outputs.seat_velocity, outputs.seat_acceleration, force.contact_force)
        return np.array([*person.displacements, *person.velocities, *moved])

    return np.array([after(x) for x in np.eye(12)]).T


def modes(linear: Parameters, step_size: float, order: str | None) -> list[Mode]:
    """Return the two slowest vibrations, of the seat and of the body on its contact; growing ones have damping < 0."""
    values = np.linalg.eigvals(step_matrix(linear, step_size, order))
    poles = np.log(values[np.abs(values) > 1e-6].astype(complex)) / step_size
    found = [Mode(abs(p) / (2.0 * math.pi), -p.real / abs(p)) for p in poles if p.imag > 1.0]
    return sorted(found)[:2]


def longest_step(linear: Parameters, order: str) -> float:
    """Return the longest stable step in ms, to a tenth."""
    tenths = 10
    while np.abs(np.linalg.eigvals(step_matrix(linear, 1e-4 * tenths, order))).max() < 1.0 and tenths < 1000:
        tenths += 1
    return 0.1 * (tenths - 1)


def print_modes() -> None:
    """Print frequencies and damping ratios of the coupled vibrations."""
    for damping in (0.0, 300.0):
        linear = replace(SEAT, suspension_damping=damping)
        print(f"linear seat, c_f = {damping:g} N.s/m: vibrations of seat and body")
        for order in (None, *ORDERS):
            for step_size in (2e-3, 1e-3) if order else (2e-3,):
                shown = ", ".join(f"{m.frequency:.3f} Hz {m.damping:.4f}" for m in modes(linear, step_size, order))
                print(f"  {order or 'inside':13s} {1e3 * step_size:g} ms: {shown}")
        for order in ORDERS:
            print(f"  {order:13s} stable up to {longest_step(linear, order):.1f} ms")


# ---- coupling, through the FMUs --------------------------------------------------------------------------------------


def coupled_system(order: str, folder: Path) -> System:
    """Return shaker, seat, controller and driver of the FMUs of a folder, the driver outside the seat."""
    system = scenarios.seat_suspension(folder)
    system.add("driver", folder / "SeatedDriver.fmu")
    for name in ("displacement", "velocity", "acceleration"):
        system.connect(f"seat.seat_{name}", f"driver.seat_{name}")
    system.connect("driver.contact_force", "seat.driver_force")
    first, second = ("seat", "driver") if order == "seat, driver" else ("driver", "seat")
    system.order = ("controller", first, second, "shaker")
    return system


def coupling_errors(step_size: float, order: str, parameters: dict[str, Any], stop: float, folder: Path) -> list[float]:
    """Return errors against the driver inside at the same step, in %, for pelvis, then head.

    Two each: RMS of the difference over the RMS, and deviation of the RMS.
    """
    algorithm = "jacobi" if order == "jacobi" else "gauss-seidel"  # with both drivers
    inside = scenarios.seat_suspension(folder).simulate(
        stop, step_size, {**parameters, "seat.driver.model": "seated"}, algorithm=algorithm
    )
    outside = coupled_system(order, folder).simulate(
        stop, step_size, {**parameters, "seat.driver.model": "external"}, algorithm=algorithm
    )
    found = []
    for name in ("driver_acceleration", "head_acceleration"):
        reference = np.asarray(inside[f"seat.{name}"])
        coupled = np.asarray(outside[f"driver.{name}"])
        rms = [float(np.sqrt(np.mean(signal**2))) for signal in (reference, coupled, coupled - reference)]
        found += [100.0 * rms[2] / rms[0], 100.0 * (rms[1] / rms[0] - 1.0)]
    return found


RIDES = {
    "bump, uncontrolled": ({**scenarios.SCENARIOS["bump"].parameters, **scenarios.control(False)}, 3.0),
    "bump, published": ({**scenarios.SCENARIOS["bump"].parameters}, 3.0),
    "EM3, uncontrolled": (
        {**scenarios.SCENARIOS["random"].parameters, "shaker.random.class": "EM3", **scenarios.control(False)},
        20.0,
    ),
    "EM3, published": ({**scenarios.SCENARIOS["random"].parameters, "shaker.random.class": "EM3"}, 20.0),
}
"""Name of a ride to its parameters and duration in s."""


def print_errors() -> None:
    """Print the errors of explicit coupling."""
    print("against the driver inside, %: RMS of the difference over the RMS, deviation of the RMS; pelvis / head")
    for ride, (parameters, stop) in RIDES.items():
        for order in ORDERS:
            cells = (coupling_errors(step_size, order, parameters, stop, fmu_folder()) for step_size in (2e-3, 1e-3))
            shown = ", ".join(f"{p:.1f} {p_rms:+.1f} / {h:.1f} {h_rms:+.1f}" for p, p_rms, h, h_rms in cells)
            print(f"  {ride:20s} {order:13s} at 2 ms, 1 ms: {shown}")


@click.command()
@click.option("--write", is_flag=True, help="Write the figure.")
def main(write: bool) -> None:
    """Print the tables of the coupling; draw the figure."""
    print_modes()
    print_errors()
    if write:
        write_figure()


if __name__ == "__main__":
    main()
