"""What a rider and an engineer want to know of one run: comfort, stroke, force."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cosim.errors import SignalError
from cosim.metrics import Ride, comfort, deflection_range, peak, ride, seat_factor
from cosim.results.result import Result
from cosim.system import System
from seat_cosim.evaluation.seat import seat_signals
from seat_cosim.evaluation.system import EvaluatedSystem
from seat_cosim.scenarios import floor_of

SATURATED = "controller.saturated"


@dataclass(frozen=True)
class Row:
    """One number of the table.

    Attributes
    ----------
    key
        Name in JSON.
    title
        Name in the table.
    unit
        Unit of the number; ``"1"`` where it has none.
    digits
        Decimals in the table.
    """

    key: str
    title: str
    unit: str
    digits: int

    def text(self, value: float | None) -> str:
        """Return a number as the table shows it; a dash where there is none."""
        return "–" if value is None else f"{value:.{self.digits}f}"


ROWS = (
    Row("a_w", "driver, weighted acceleration a_w", "m/s²", 2),
    Row("seat", "SEAT: a_w of driver / a_w of floor", "1", 2),
    Row("vdv", "driver, vibration dose value VDV", "m/s^1.75", 2),
    Row("peak", "driver, acceleration, peak", "m/s²", 2),
    Row("stroke", "suspension deflection, peak", "mm", 0),
    Row("travel_share", "share of the travel to an end stop", "%", 0),
    Row("force_peak", "force, peak", "N", 0),
    Row("saturated", "time at the force limit", "%", 2),
)
"""The numbers, in their order."""


@dataclass(frozen=True)
class RideSummary:
    """Numbers of one run.

    Attributes
    ----------
    values
        Key of :data:`ROWS` to the number in its unit; None where the run does not give it.
    comfort
        Words of ISO 2631-1 for a_w; empty where there is no a_w.
    shocks
        Whether the ride has shocks that a_w alone underestimates (ISO 2631-1, 6.3).
    """

    values: dict[str, float | None]
    comfort: tuple[str, ...]
    shocks: bool

    def as_json(self) -> dict[str, object]:
        """Return the numbers with their units in their names, for scripts."""
        return {**self.values, "comfort": list(self.comfort), "shocks": self.shocks}


def evaluated_system(system: System) -> EvaluatedSystem | None:
    """Return a system with the seat suspension's signals; None for a system without.

    Parameters
    ----------
    system
        The system, with all parameters of the run.
    """
    signals = seat_signals(floor_of(system.models))
    if signals.seat_acceleration not in system.outputs():
        return None
    return EvaluatedSystem(system.name, system, signals.within(system))


def summarize(evaluated: EvaluatedSystem, result: Result) -> RideSummary:
    """Compute the numbers of a run, from its start to its end.

    Parameters
    ----------
    evaluated
        The system that was run.
    result
        Its result.
    """
    values: dict[str, float | None] = dict.fromkeys(row.key for row in ROWS)
    rides: list[Ride | None] = []
    signals = evaluated.signals
    rate = _rate(result)
    samples = {
        name: evaluated.in_si_units(name, result[name])[: _regular(result)]
        for name in signals.outputs
        if name in result.values
    }
    for name in (signals.seat_acceleration, signals.floor_acceleration):
        rides.append(_ride(samples.get(name), rate))
    driver, floor = rides
    if driver is not None:
        values |= {"a_w": driver.a_w, "vdv": driver.vdv}
        if floor is not None and floor.vdv > 0.0:
            values["seat"] = seat_factor(driver, floor).rms
    if signals.seat_acceleration in samples:
        values["peak"] = peak(samples[signals.seat_acceleration])
    values |= _stroke(evaluated, samples.get(signals.suspension_deflection or ""), rate)
    if (force := samples.get(signals.actuator_force or "")) is not None:
        values["force_peak"] = peak(force)
    if SATURATED in result.values and values["force_peak"] is not None:
        values["saturated"] = 100.0 * float(np.mean(result[SATURATED]))
    words = () if driver is None else comfort(driver.a_w)
    return RideSummary(values, words, driver is not None and not driver.rms_suffices)


def _regular(result: Result) -> int:
    """Return the number of rows that are evenly spaced: the last one is not, where every N-th step is recorded."""
    steps = np.diff(result.time)
    uneven = len(steps) > 1 and abs(steps[-1] - steps[0]) > 0.5 * steps[0]
    return len(result.time) - int(uneven)


def _rate(result: Result) -> float:
    """Return the number of rows per second."""
    return float(1.0 / (result.time[1] - result.time[0])) if len(result.time) > 1 else 1.0


def _ride(acceleration: npt.NDArray[np.float64] | None, rate: float) -> Ride | None:
    """Return the metrics of a ride; None where it is too short, or its rate too low."""
    try:
        return None if acceleration is None else ride(acceleration, rate)
    except SignalError:
        return None


def _stroke(
    evaluated: EvaluatedSystem, deflection: npt.NDArray[np.float64] | None, rate: float
) -> dict[str, float | None]:
    """Return the peak of the deflection, and its share of the travel where there are end stops."""
    if deflection is None:
        return {}
    stroke = deflection_range(deflection, rate).peak
    if (travel := evaluated.end_stop_travel) is None:
        return {"stroke": 1e3 * stroke, "travel_share": None}
    from_middle = deflection_range(deflection + evaluated.end_stop_height, rate).peak
    return {"stroke": 1e3 * stroke, "travel_share": 100.0 * from_middle / travel}


def signal_table(result: Result, names: Iterable[str]) -> list[tuple[str, ...]]:
    """Return a row for each signal of any system: name, unit, smallest and largest value, RMS.

    Parameters
    ----------
    result
        Result of a run.
    names
        Signals, as ``component.variable``; those that the result does not have are left out.
    """
    rows: list[tuple[str, ...]] = []
    for name in (each for each in names if each in result.values):
        values = result[name]
        root = float(np.sqrt(np.mean(np.square(values))))
        rows.append((name, result.units[name] or "", f"{values.min():.4g}", f"{values.max():.4g}", f"{root:.4g}"))
    return rows
