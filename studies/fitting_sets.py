"""All sets of assumptions that fit the paper's 55 kg column, and the range of what they predict.

The paper publishes neither passive seat, nor excitation, nor the prototype's imperfections. A set of assumptions is
drawn at random, three unknowns are fitted to it, and the set is kept if it fits what the paper says of 55 kg. Only then
are 70 kg and the bumps run. docs/explanation/calibration.md shows the results.

Drawn are the class of the excitation, the bandwidths of platform, sensors and recorder, the actuator's delay, the
prototype's friction, the passive seat's friction, end stops with or without a spring set anew for 70 kg, the form of
the observer, and the three RMS values of Table 2 within their scatter. Fitted are the level of the excitation, the
passive seat's damping and the actuator's lag.

python -m studies.fitting_sets            search, print the ranges
python -m studies.fitting_sets --write    and write seat_cosim/paper/fitting_sets.csv and the figure
python -m studies.fitting_sets --draw     print the ranges and draw the figure of that file
"""

from __future__ import annotations

import argparse
import csv
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.signal import lfilter

from cosim.fmi.values import Value
from cosim.metrics import peak, psd, rms
from cosim.ssp import read_parameters
from plant_models import parameter_sets
from seat_cosim.paper.fitting_sets import FILE, Predictions, read
from seat_cosim.paper.published import RMS
from seat_cosim.paper.runner import FLOOR, RATE, SEAT_MEASURED
from seat_cosim.scenarios import control, named_observer
from studies.calibration import BAND, LOAD, RESONANCE, SINE_AMPLITUDE
from studies.fitting_figure import draw_predictions
from studies.rides import RESOLUTION, Rides

Array = np.ndarray[Any, Any]
Parameters = dict[str, Value]

ROOT = Path(__file__).parent.parent
FIGURE = ROOT / "docs" / "figures" / "calibration_predictions.png"
COUNT = 211
"""Number of fitting sets to find; ten minutes of CPU."""
DRAWS_SEED = 17
"""Seed of the draws."""
WARM_UP, DURATION = 10.0, 60.0
"""Of each ride, in s. The evaluated minute is that of the paper's figures; each floor has a seed of its own."""

# ---- what fits, stated before 70 kg is run ---------------------------------------------------------------------------

SCATTER = 0.045
"""Largest deviation of a fitted RMS from the paper's, relative: the standard error of one minute."""
PEAK, PEAK_RANGE = 2.0, 0.5
"""Fig. 15: passive and uncontrolled seat peak "around 2 Hz"; largest distance in Hz."""
VERY_CLOSE = 0.25
"""Fig. 10: the two curves are "very close" from 2.5 to 4.5 Hz; largest difference of the transmissibilities."""

LOW = BAND[BAND <= 3.5]
"""Fig. 10: frequencies at which the controlled seat isolates, and better than the passive one, in Hz."""

CLOSE = 0.005
"""Largest relative error of a fit; the RMS values to be met are drawn within a scatter nine times as large."""
LEVELS = {"EM1": 0.7, "EM3": 0.8, "EM5": 1.0, "EM8": 3.4}
"""Class to the level at which the uncontrolled seat has about the paper's RMS."""
HEAVY_DAMPING, LIGHT_DAMPING = (350.0, 1500.0), (60.0, 350.0)
"""Ranges of the passive seat's damping in N.s/m: its RMS is least between them, so two dampings give one RMS."""
PROTOTYPES = 8
"""Number of prototypes that are drawn for each floor and passive seat that fit."""
OF_PROTOTYPE = ("delay", "observer", "preload")
"""Assumptions that change neither the passive nor the uncontrolled seat at 55 kg."""

GRAVITY = 9.81
LIGHT, HEAVY = 55.0, 70.0


@dataclass(frozen=True)
class Assumptions:
    """One set: what is drawn and what is fitted.

    Attributes
    ----------
    seed
        Of the random floor.
    excitation
        Class of ISO 7096.
    platform
        Natural frequency of the platform in Hz; 0 for an ideal one.
    sensors, recorder
        Bandwidths in Hz of the sensors, which the controller has as well, and of what records the seat's acceleration
        behind them; 0 for none.
    delay
        Delay of the actuator, in s.
    friction, passive_friction
        Friction of prototype and passive seat, over that of the paper's appendix.
    travel, height, preload
        End stops: travel in m (0: none), height of the 55 kg equilibrium in m above its middle, and whether the spring
        is ``anew`` set for 70 kg or ``kept``, so that the seat sags.
    observer
        One of :data:`seat_cosim.scenarios.OBSERVERS`.
    scale, damping, lag
        Fitted: level of the excitation, damping of the passive seat in N.s/m, lag of the actuator in s.
    """

    seed: int
    excitation: str
    platform: float
    sensors: float
    recorder: float
    delay: float
    friction: float
    passive_friction: float
    travel: float
    height: float
    preload: str
    observer: str
    scale: float = 1.0
    damping: float = 0.0
    lag: float = 0.0


COMMITTED = Assumptions(1, "EM3", 0.0, 50.0, 0.0, 0.002, 1.0, 0.2, 0.0, 0.0, "anew", "1")
"""The assumptions of the parameter sets of this project; scale, damping and lag are read from there."""

STOP_STIFFNESS, STOP_DAMPING = 20_000.0, 300.0
"""Of the end stops, in N/m and N.s/m: rubber that takes the weight of a driver within 30 mm."""


def draw(random: np.random.Generator) -> tuple[Assumptions, dict[str, float]]:
    """Draw a set of assumptions, and the RMS values that it shall meet, in m/s2.

    Parameters
    ----------
    random
        Generator of the random numbers.

    Returns
    -------
    Assumptions
        Not fitted yet.
    dict
        Seat to its RMS.
    """

    def between(low: float, high: float, absent: float = 0.0) -> float:
        """Draw log-uniformly from a range, or 0 with a probability."""
        value = float(np.exp(random.uniform(np.log(low), np.log(high))))
        return 0.0 if random.random() < absent else float(f"{value:.3g}")

    def choice(*items: str) -> str:
        return items[int(random.integers(len(items)))]

    travel = 0.0 if random.random() < 0.5 else round(random.uniform(0.04, 0.06), 3)
    found = Assumptions(
        seed=int(random.integers(1, 1_000_000)),
        excitation=choice("EM1", "EM3", "EM5", "EM8"),
        platform=between(2.0, 20.0, 0.3),
        sensors=between(15.0, 150.0, 0.2),
        recorder=between(15.0, 150.0, 0.5),
        delay=0.002 * int(random.integers(5)),
        friction=round(random.uniform(0.6, 1.1), 2),
        passive_friction=round(random.uniform(0.0, 0.6), 2),
        travel=travel,
        height=round(random.uniform(-0.005, 0.015), 3) if travel else 0.0,
        preload=choice("anew", "kept") if travel else "anew",
        observer=choice("1", "equal-rate"),
    )
    targets = {name: value * (1.0 + random.uniform(-SCATTER, SCATTER)) for name, value in RMS[LIGHT].items()}
    return found, targets


class Rig:
    """The seats under one set of assumptions.

    Parameters
    ----------
    rides
        Runs the seat.
    assumptions
        The set.
    """

    def __init__(self, rides: Rides, assumptions: Assumptions) -> None:
        self._rides, self._set = rides, assumptions
        self._alpha = float(rides.system.start("seat.friction.alpha"))  # type: ignore[arg-type]  # a number

    def seat(self, name: str, mass: float) -> Parameters:
        """Return the parameters of the seat ``passive``, ``uncontrolled`` or ``controlled`` with a load in kg."""
        s = self._set
        height = s.height - (mass - LIGHT) * GRAVITY / self._stiffness if s.preload == "kept" else s.height
        common: Parameters = {
            "seat.sensor.bandwidth": s.sensors,
            "seat.friction.alpha": s.friction * self._alpha,
            "shaker.platform.bandwidth": s.platform,
            **control(name == "controlled"),
        }
        if s.travel:
            common |= {
                "seat.end_stop.travel": s.travel,
                "seat.end_stop.height": height,
                "seat.end_stop.stiffness": STOP_STIFFNESS,
                "seat.end_stop.damping": STOP_DAMPING,
            }
        if name == "passive":
            return {
                **common,
                "seat.suspension_damping": s.damping,
                "seat.friction.alpha": s.passive_friction * self._alpha,
            }
        lag: Parameters = {"seat.actuator.time_constant": s.lag, "seat.actuator.delay": s.delay}
        return {**common, **lag, **named_observer(s.observer)} if name == "controlled" else common

    @property
    def _stiffness(self) -> float:
        return float(self._rides.system.start("seat.suspension_stiffness"))  # type: ignore[arg-type]  # a number

    def _recorded(self, samples: Array) -> Array:
        """Pass samples through the recorder's low-pass, exact for signals that are linear between them."""
        if not self._set.recorder:
            return samples
        angle = 2.0 * np.pi * self._set.recorder / RATE
        gain = -np.expm1(-angle)
        direct = 1.0 - gain / angle
        filtered, _ = lfilter([direct, gain - direct], [1.0, gain - 1.0], samples, zi=[samples[0] * (1.0 - direct)])
        return np.asarray(filtered)

    def ride(self, name: str, mass: float) -> tuple[float, float]:
        """Ride over random motion; returns the RMS in m/s2 of the recorded signal, and its spectrum's peak in Hz."""
        floor = {
            "shaker.profile": "random",
            "shaker.random.class": self._set.excitation,
            "shaker.random.scale": self._set.scale,
            "shaker.random.seed": self._set.seed,
        }
        result = self._rides.run(WARM_UP + DURATION, {**floor, **self.seat(name, mass)}, mass, [SEAT_MEASURED])
        samples = self._recorded(result[SEAT_MEASURED])[round(WARM_UP * RATE) :]
        spectrum = psd(samples, RATE, RESOLUTION)
        return rms(samples), float(spectrum.frequency[np.argmax(spectrum.density)])

    def bump(self, name: str, mass: float) -> float:
        """Run the bump (34); returns the recorded peak in m/s2."""
        result = self._rides.run(4.0, {"shaker.profile": "bump", **self.seat(name, mass)}, mass, [SEAT_MEASURED])
        return peak(self._recorded(result[SEAT_MEASURED]))

    def transmissibility(self, name: str, frequencies: Array, amplitude: float) -> Array:
        """Run sines with 55 kg; returns the ratios of the RMS values of seat and platform, shape as frequencies."""
        found = []
        for frequency in frequencies.tolist():
            sine = {"shaker.profile": "sine", "shaker.sine.frequency": frequency, "shaker.sine.amplitude": amplitude}
            result = self._rides.run(10.0, {**sine, **self.seat(name, LIGHT)}, LIGHT, [SEAT_MEASURED, FLOOR])
            periods = round(-round(6.0 * frequency) / frequency * RATE)
            found.append(rms(self._recorded(result[SEAT_MEASURED])[periods:]) / rms(result[FLOOR][periods:]))
        return np.array(found)


def fig10_order(rig: Rig, amplitude: float) -> bool:
    """Check Fig. 10's order of the curves: passive highest at resonance, then a little lower than uncontrolled."""
    passive, uncontrolled = (rig.transmissibility(name, RESONANCE, amplitude) for name in ("passive", "uncontrolled"))
    if not passive.max() > uncontrolled.max():
        return False
    gain = rig.transmissibility("uncontrolled", BAND, amplitude) - rig.transmissibility("passive", BAND, amplitude)
    return bool(gain.mean() > 0.0 and np.abs(gain).max() <= VERY_CLOSE)


def isolates(rig: Rig) -> bool:
    """Check that the controlled seat isolates low frequencies as in Fig. 10: below 1, and below the passive seat."""
    passive, controlled = (rig.transmissibility(name, LOW, SINE_AMPLITUDE) for name in ("passive", "controlled"))
    return bool((controlled < 1.0).all() and (controlled < passive).all())


def solve(measure: Callable[[float], float], target: float, low: float, high: float) -> float | None:
    """Solve ``measure(x) == target`` by false position (Illinois), to :data:`CLOSE`; None if the ends have one sign."""
    left, right = measure(low) / target - 1.0, measure(high) / target - 1.0
    if left * right > 0.0:
        return None
    for _ in range(20):
        x = float(f"{(low * right - high * left) / (right - left):.4g}")
        error = measure(x) / target - 1.0
        if abs(error) <= CLOSE:
            return x
        if error * right < 0.0:
            low, left = high, right
        else:
            left *= 0.5
        high, right = x, error
    return None


def fitted_floor(rides: Rides, drawn: Assumptions, targets: Mapping[str, float], heavy: bool) -> Assumptions | None:
    """Fit level of the excitation and damping of the passive seat; None if there are none or Fig. 10 or 15 is missed.

    Parameters
    ----------
    rides
        Runs the seats.
    drawn
        As drawn.
    targets
        Seat to its RMS, in m/s2.
    heavy
        On which side of the RMS's minimum over damping to search.
    """

    def uncontrolled(scale: float) -> float:
        return Rig(rides, replace(drawn, scale=scale)).ride("uncontrolled", LIGHT)[0]

    def passive(damping: float) -> float:
        return Rig(rides, replace(drawn, damping=damping)).ride("passive", LIGHT)[0]

    usual = LEVELS[drawn.excitation]
    scale = solve(uncontrolled, targets["uncontrolled"], 0.6 * usual, 2.5 * usual)
    if scale is None:
        return None
    drawn = replace(drawn, scale=scale)
    damping = solve(passive, targets["passive"], *(HEAVY_DAMPING if heavy else LIGHT_DAMPING))
    if damping is None:
        return None
    drawn = replace(drawn, damping=damping)
    rig = Rig(rides, drawn)
    for name in ("passive", "uncontrolled"):
        level, highest = rig.ride(name, LIGHT)
        if abs(level / RMS[LIGHT][name] - 1.0) > SCATTER or abs(highest - PEAK) > PEAK_RANGE:
            return None
    return drawn if any(fig10_order(rig, share * SINE_AMPLITUDE) for share in (1.0, 2.0)) else None


def fitted_lag(rides: Rides, drawn: Assumptions, target: float) -> Assumptions | None:
    """Fit the actuator's lag to the controlled seat's RMS, in m/s2; None if there is none or Fig. 10 is missed."""

    def controlled(lag: float) -> float:
        return Rig(rides, replace(drawn, lag=lag)).ride("controlled", LIGHT)[0]

    lag = solve(controlled, target, 0.0, 0.08)
    if lag is None:
        return None
    drawn = replace(drawn, lag=lag)
    rig = Rig(rides, drawn)
    level, _ = rig.ride("controlled", LIGHT)
    fits = abs(level / RMS[LIGHT]["controlled"] - 1.0) <= SCATTER and isolates(rig)
    return drawn if fits else None


def predicted(rig: Rig, light: Mapping[str, float]) -> Predictions:
    """Run 70 kg and both bumps; ``light`` has the RMS values with 55 kg."""
    heavy = {name: rig.ride(name, HEAVY)[0] for name in ("passive", "controlled")}
    bumps = [rig.bump(name, mass) for mass in (LIGHT, HEAVY) for name in ("passive", "controlled")]
    reductions = [100.0 * (1.0 - level["controlled"] / level["passive"]) for level in (light, heavy)]
    return Predictions(*(float(f"{value:.5g}") for value in (*reductions, *bumps)))


def search(rides: Rides, count: int) -> Iterator[tuple[int, dict[str, Any]]]:
    """Draw until ``count`` sets fit; yields the number of floors drawn, and the row of a set.

    For each floor and passive seat that fit, :data:`PROTOTYPES` prototypes are drawn.

    Parameters
    ----------
    rides
        Runs the seats.
    count
        Number of sets.
    """
    random, found, draws = np.random.default_rng(DRAWS_SEED), 0, 0
    while found < count:
        floor, targets = draw(random)
        heavy = bool(random.random() < 0.8)
        draws += 1
        fitted = fitted_floor(rides, floor, targets, heavy)
        for _ in range(PROTOTYPES if fitted else 0):
            drawn, targets = draw(random)
            own = {name: getattr(drawn, name) for name in OF_PROTOTYPE}
            own["preload"] = drawn.preload if floor.travel and drawn.travel else "anew"
            chosen = fitted_lag(rides, replace(fitted, **own), targets["controlled"])
            if chosen is None or found == count:
                continue
            found += 1
            yield draws, row(rides, chosen)


# ---- results ---------------------------------------------------------------------------------------------------------


def row(rides: Rides, assumptions: Assumptions) -> dict[str, Any]:
    """Run a set at both loads; returns its row of the file."""
    rig = Rig(rides, assumptions)
    light = {name: rig.ride(name, LIGHT)[0] for name in RMS[LIGHT]}
    measured = {f"rms_{name}_55": float(f"{value:.5g}") for name, value in light.items()}
    return {**asdict(assumptions), **measured, **asdict(predicted(rig, light))}


_TYPES: dict[str, Callable[[str], Any]] = {"int": int, "str": str, "float": float}


def assumptions_of(values: Mapping[str, str]) -> Assumptions:
    """Return the assumptions of a row of the file."""
    return Assumptions(**{field.name: _TYPES[str(field.type)](values[field.name]) for field in fields(Assumptions)})


def write(path: Path, rows: list[dict[str, Any]]) -> None:
    """Write the file."""
    with path.open("w", encoding="utf-8", newline="") as stream:
        table = csv.DictWriter(stream, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(rows)


def committed(rides: Rides) -> dict[str, float]:
    """Return what the parameter sets of this project predict, by the same ride as a set of the study."""
    sets = {name: read_parameters(parameter_sets.path(name), rides.system) for name in parameter_sets.NAMES}
    scale, damping, lag = (
        float(sets[name][parameter])  # type: ignore[arg-type]  # they are numbers
        for name, parameter in (
            ("ride", "shaker.random.scale"),
            ("passive", "seat.suspension_damping"),
            ("prototype", "seat.actuator.time_constant"),
        )
    )
    found = row(rides, replace(COMMITTED, scale=scale, damping=damping, lag=lag))
    return {field.name: found[field.name] for field in fields(Predictions)}


def print_ranges(rows: list[dict[str, Any]]) -> None:
    """Print the range of each column that is a number."""
    for name in rows[0]:
        try:
            values = np.array([float(found[name]) for found in rows])
        except ValueError:
            counts = {item: [found[name] for found in rows].count(item) for item in sorted({r[name] for r in rows})}
            print(f"{name}: {counts}")
            continue
        low, median, high = np.percentile(values, [5, 50, 95])
        print(f"{name}: {values.min():.4g} to {values.max():.4g}, 5-95 % {low:.4g} to {high:.4g}, median {median:.4g}")


def main() -> None:
    """Search or read the sets, print the ranges; write file and figure with ``--write``."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fmus", type=Path, default=ROOT / "fmus" / "fmi2", help="folder of the three FMUs")
    parser.add_argument("--count", type=int, default=COUNT, help="number of fitting sets to find")
    parser.add_argument("--write", action="store_true", help="write the file and the figure, too")
    parser.add_argument("--draw", action="store_true", help="search nothing: draw the figure of the file")
    given = parser.parse_args()
    rows: list[dict[str, Any]] = []
    begin = time.process_time()
    with Rides(given.fmus, LOAD) as rides:
        if given.draw:
            rows = list(csv.DictReader(FILE.read_text(encoding="utf-8").splitlines()))
        else:
            for draws, found in search(rides, given.count):
                rows.append(found)
                spent = time.process_time() - begin
                print(f"{len(rows)} sets, {draws} floors drawn, {spent:.0f} s of CPU: {found}", flush=True)
        if given.write:
            write(FILE, rows)
        if given.write or given.draw:
            observers = np.array([found["observer"] for found in rows])
            draw_predictions(read(), observers, committed(rides), FIGURE)
    print_ranges(rows)


if __name__ == "__main__":
    main()
