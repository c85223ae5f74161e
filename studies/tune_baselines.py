"""Tuning of the controllers of examples/controllers, and comparison with the paper's.

python -m studies.tune_baselines            tunes (ten minutes), prints the numbers for the scripts, compares
python -m studies.tune_baselines --compare  compares the scripts as they are

All runs use the FMUs and the master: EM3 of ISO 7096, a driver of 80 kg. The larger of two weighted accelerations of
the driver is minimised, one with an ideal actuator, one with an actuator that is 10 ms late: a controller must tolerate
that delay. Two penalties are added: for a peak deflection beyond 50 mm in either ride, and for a seat that moves more
than 20 mm in a minute on a still floor with an accelerometer bias of 20 mm/s2 (2 mg).
"""

from __future__ import annotations

import argparse
import math
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.linalg import expm, solve_discrete_are
from scipy.optimize import minimize

from cosim.engine.session import Session
from cosim.fmi.values import Value
from cosim.metrics import actuator, deflection_range, ride
from seat_controller_fmu.parameters import OBSERVERS, SAMPLE_TIME
from seat_cosim.scenarios import control, driver_mass, observer, seat_suspension

ROOT = Path(__file__).parent.parent
SCRIPTS = ROOT / "examples" / "controllers"

MASS, CLASS, SEED = 80.0, "EM3", 1
"""Driver's mass in kg, class and seed of the excitation."""
DURATION, WARM_UP = 60.0, 10.0
"""Evaluated time of a ride, and time before it, in s."""
DELAY = 0.010
"""Delay of the late actuator, in s."""
ROOM = 0.050
"""Peak deflection without a penalty, in m."""
OFFSET, DRIFT = 0.020, 0.020
"""Bias of the accelerometer in m/s2, and deflection under it without a penalty, in m."""

FLOOR = 1.93 / 2.0
"""Two-sided density of the white noise by which the LQG models the floor's acceleration, in (m/s2)2/Hz: that of EM3."""

DEFLECTION_NOISE, ACCELERATION_NOISE = 1e-4, 0.02
"""RMS noise of the sensors in the LQG's model, per sample, in m and m/s2."""

LQG_CORNER = 0.05
"""Corner frequency of the residual acceleration in the LQG's model, in Hz; also in lqg.py."""


LQG_WEIGHTS = {"stiffness": 0.741, "level": 0.0025}
"""Result of the tuning; the gains in lqg.py follow from it."""


def lqg_gains(stiffness: float, level: float) -> dict[str, float]:
    """Design the LQG for its three states: deflection x, its rate v, the residual acceleration e.

    Parameters
    ----------
    stiffness
        Weight of the squared deflection, in 1/s4, where that of the squared acceleration is 1. For x'' = -a the
        regulator is a = w^2 x + sqrt(2) w v with w^4 the weight.
    level
        Density of the noise that drives e, in (m/s3)2/Hz; the larger, the faster the filter estimates e.

    Returns
    -------
    dict
        Name of a gain in lqg.py to its value.
    """
    dynamics = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -2.0 * np.pi * LQG_CORNER]])
    density = np.diag([0.0, FLOOR, level])
    both = np.block([[-dynamics, density], [np.zeros((3, 3)), dynamics.T]])  # after Van Loan
    exponential = expm(both * SAMPLE_TIME.value)
    transition = exponential[3:, 3:].T
    process = transition @ exponential[:3, 3:]
    sees = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    noise = np.diag([DEFLECTION_NOISE**2, ACCELERATION_NOISE**2])
    variance = solve_discrete_are(transition.T, sees.T, process, noise)
    gain = variance @ sees.T @ np.linalg.inv(sees @ variance @ sees.T + noise)
    w = stiffness**0.25
    regulator = {"K_deflection": w * w, "K_rate": math.sqrt(2.0) * w}
    states, innovations = ("deflection", "rate", "rest"), ("m", "a")
    return regulator | {
        f"L_{state}_{y}": float(gain[i, j]) for j, y in enumerate(innovations) for i, state in enumerate(states)
    }


class Baseline(NamedTuple):
    """A controller to tune.

    Attributes
    ----------
    script
        Name of its script, without suffix.
    start
        Name of a tuned number to its initial value.
    parameters
        Function of the tuned numbers that returns the controller's parameters.
    """

    script: str
    start: Mapping[str, float]
    parameters: Callable[..., dict[str, float]]


BASELINES = {
    "Skyhook": Baseline("skyhook", {"rate": 20.0, "corner": 0.2}, dict),
    "Pid": Baseline("pid", {"p": 0.5, "i": 20.0, "d": 0.005, "bandwidth": 10.0, "corner": 0.2}, dict),
    "Lqg": Baseline("lqg", {"stiffness": 1.0, "level": 1e-3}, lqg_gains),
}


@dataclass(frozen=True)
class Score:
    """Metrics of a controller; ``late`` with the delayed actuator.

    Attributes
    ----------
    a_w, a_w_late
        Weighted acceleration of the driver, in m/s2.
    peak, peak_late
        Largest deflection, in m.
    drift
        Largest deflection on a still floor with a biased accelerometer, in m.
    force
        RMS of the force, in N.
    """

    a_w: float
    a_w_late: float
    peak: float
    peak_late: float
    drift: float
    force: float

    @property
    def cost(self) -> float:
        """Cost to minimise: the larger a_w, plus ten times the relative excess over the bounds as its share."""
        beyond = max(0.0, max(self.peak, self.peak_late) / ROOM - 1.0) + max(0.0, self.drift / DRIFT - 1.0)
        return max(self.a_w, self.a_w_late) * (1.0 + 10.0 * beyond)


ACCELERATION, DEFLECTION, FORCE = "seat.driver_acceleration", "seat.suspension_deflection", "controller.force"


def score(session: Session, parameters: Mapping[str, Value]) -> Score:
    """Run a controller three times: ideal actuator, late actuator, still floor with a biased accelerometer.

    Parameters
    ----------
    session
        Session of a seat suspension with the controller.
    parameters
        ``component.variable`` to value.
    """

    def run(**seat: float) -> list[np.ndarray]:
        floor = {"shaker.profile": "random", "shaker.random.class": CLASS, "shaker.random.seed": SEED}
        imperfections = {f"seat.{name.replace('__', '.')}": value for name, value in seat.items()}
        still = {"shaker.random.scale": 0.0} if "sensor__acceleration_bias" in seat else {}
        signals = (ACCELERATION, DEFLECTION, FORCE)
        result = session.run(
            DURATION + WARM_UP, None, {**driver_mass(MASS), **floor, **still, **imperfections, **parameters}, signals
        )
        if result.error is not None:
            raise result.error
        return [result[signal] for signal in signals]

    rate = 1.0 / SAMPLE_TIME.value
    acceleration, deflection, force = run()
    late = run(actuator__delay=DELAY)
    biased = run(sensor__acceleration_bias=OFFSET)
    return Score(
        ride(acceleration, rate, WARM_UP).a_w,
        ride(late[0], rate, WARM_UP).a_w,
        deflection_range(deflection, rate, WARM_UP).peak,
        deflection_range(late[1], rate, WARM_UP).peak,
        abs(deflection_range(biased[1], rate).peak),
        actuator(force, deflection, rate, WARM_UP).force_rms,
    )


def of_controller(parameters: Mapping[str, Value]) -> dict[str, Value]:
    """Return parameters of the controller as ``component.variable``."""
    return {f"controller.{name}": value for name, value in parameters.items()}


def tune(session: Session, baseline: Baseline) -> dict[str, float]:
    """Tune a controller by the simplex method of Nelder and Mead over logarithms of the numbers; deterministic.

    Parameters
    ----------
    session
        Session of a seat suspension with the controller.
    baseline
        The controller.

    Returns
    -------
    dict
        Name of a tuned number to its value.
    """
    names, start = list(baseline.start), np.log(list(baseline.start.values()))

    def numbers(x: np.ndarray) -> dict[str, float]:
        return {name: float(f"{math.exp(value):.3g}") for name, value in zip(names, x, strict=True)}

    def cost(x: np.ndarray) -> float:
        return score(session, of_controller(baseline.parameters(**numbers(x)))).cost

    simplex = np.vstack([start, start + 0.5 * np.eye(len(names))])
    options = {"initial_simplex": simplex, "xatol": 0.02, "fatol": 5e-4, "maxfev": 50 * len(names)}
    return numbers(minimize(cost, start, method="Nelder-Mead", options=options).x)


def build(folder: Path) -> None:
    """Build the FMUs of all baselines with pythonfmu, into a folder."""
    for baseline in BASELINES.values():
        script = str(SCRIPTS / f"{baseline.script}.py")
        subprocess.run([sys.executable, "-m", "pythonfmu", "build", "-f", script, "-d", str(folder)], check=True)


def report(name: str, found: Score) -> None:
    """Print a row of the table: a controller's name and its metrics."""
    lengths = (1e3 * length for length in (found.peak, found.peak_late, found.drift))
    numbers = [f"{found.a_w:.3f}", f"{found.a_w_late:.3f}", *(f"{mm:.0f}" for mm in lengths), f"{found.force:.0f}"]
    print("| " + " | ".join([name, *numbers]) + " |", flush=True)


def main() -> None:
    """Tune the baselines, unless ``--compare`` is given, and compare all controllers."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--compare", action="store_true", help="compare the scripts as they are, without tuning")
    parser.add_argument("--only", choices=BASELINES, help="tune this one")
    arguments = parser.parse_args()
    ours = seat_suspension(ROOT / "fmus" / "fmi2")
    with tempfile.TemporaryDirectory() as folder:
        build(Path(folder))
        systems = {}
        for name in BASELINES:
            systems[name] = seat_suspension(ROOT / "fmus" / "fmi2")
            systems[name].replace("controller", Path(folder, f"{name}.fmu"))
        if not arguments.compare:
            for name in [arguments.only] if arguments.only else BASELINES:
                with systems[name].open() as session:
                    found = tune(session, BASELINES[name])
                print(f"{name}: {found} -> {BASELINES[name].parameters(**found)}", flush=True)
        print("| controller | a_w | a_w, 10 ms late | peak, mm | peak, late, mm | drift, mm | force RMS, N |")
        print("|---|---:|---:|---:|---:|---:|---:|")
        with ours.open() as session:
            report("uncontrolled", score(session, control(False)))
            for number, gamma in OBSERVERS.items():
                report(f"Observer {number}", score(session, observer(gamma.value)))
        for name, system in systems.items():
            with system.open() as session:
                report(name, score(session, {}))


if __name__ == "__main__":
    main()
