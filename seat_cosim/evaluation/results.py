"""Results of an evaluation: metrics of single rides, of a driver on a class, and of a whole system."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from cosim.metrics import Ride, daily_vdv, seat_factor
from seat_cosim.evaluation.protocol import MAX_SPREAD, MIN_RUNS
from seat_cosim.evaluation.system import EvaluatedSystem


@dataclass(frozen=True)
class RideResult:
    """Metrics of one ride of one driver; None for a signal that the system does not have.

    Attributes
    ----------
    seat, floor
        Metrics of the weighted acceleration on the seat and on the floor.
    peak_deflection
        Largest deflection of the suspension from static equilibrium, in m.
    end_stop_hits
        Number of contacts with the end stops.
    force_rms
        RMS of the actuator's force, in N.
    driving_power
        Mean power while the actuator drives, in W.
    """

    seat: Ride
    floor: Ride
    peak_deflection: float | None = None
    end_stop_hits: int | None = None
    force_rms: float | None = None
    driving_power: float | None = None

    @property
    def seat_rms(self) -> float:
        """SEAT value by the weighted RMS a_w."""
        return seat_factor(self.seat, self.floor).rms

    @property
    def seat_vdv(self) -> float:
        """SEAT value by the vibration dose value VDV."""
        return seat_factor(self.seat, self.floor).vdv


@dataclass(frozen=True)
class DriverClassResult:
    """Results of one driver on one class of excitation.

    Attributes
    ----------
    rides
        One for each seed.
    """

    rides: tuple[RideResult, ...]

    def mean(self, metric: Callable[[RideResult], float | None]) -> float | None:
        """Return the mean of a metric over the rides; None if no ride has it."""
        values = [metric(ride) for ride in self.rides]
        found = [value for value in values if value is not None]
        return sum(found) / len(found) if found else None

    @property
    def seat(self) -> float:
        """SEAT by a_w, mean of the rides."""
        return sum(ride.seat_rms for ride in self.rides) / len(self.rides)

    @property
    def a_w(self) -> float:
        """Weighted acceleration of the driver, in m/s2, mean of the rides."""
        return sum(ride.seat.a_w for ride in self.rides) / len(self.rides)

    @property
    def spread(self) -> float:
        """Largest deviation of a ride's SEAT from the mean, as a share of the mean."""
        return max(abs(ride.seat_rms / self.seat - 1.0) for ride in self.rides) if self.seat else 0.0

    @property
    def is_repeatable(self) -> bool:
        """Whether there are as many rides, and as close to their mean, as ISO 10326-1 requires."""
        return len(self.rides) >= MIN_RUNS and self.spread <= MAX_SPREAD * (1.0 + 1e-9)

    @property
    def peak_deflection(self) -> float | None:
        """Largest deflection of all rides, in m."""
        return max((ride.peak_deflection for ride in self.rides if ride.peak_deflection is not None), default=None)

    @property
    def end_stop_hits(self) -> int | None:
        """Number of contacts with the end stops in all rides together."""
        found = [ride.end_stop_hits for ride in self.rides if ride.end_stop_hits is not None]
        return sum(found) if found else None


@dataclass(frozen=True)
class Metric:
    """One metric of the tables.

    Attributes
    ----------
    key
        Name in files.
    title
        Name on pages.
    unit
        Unit in which the metric is shown; ``"1"`` where it has no dimension.
    digits
        Decimals on pages.
    value
        Function that returns the metric in SI units; None where the system does not have it.
    factor
        Factor from SI units to ``unit``.
    """

    key: str
    title: str
    unit: str
    digits: int
    value: Callable[[DriverClassResult], float | None]
    factor: float = 1.0

    @property
    def unit_shown(self) -> str:
        """Unit on pages; empty where the metric has no dimension."""
        return "" if self.unit == "1" else self.unit

    def number(self, result: DriverClassResult) -> float | None:
        """Return the metric of a result, in ``unit``."""
        value = self.value(result)
        return None if value is None else self.factor * value

    def text(self, result: DriverClassResult) -> str:
        """Return the metric of a result as pages show it; a dash where there is none."""
        number = self.number(result)
        return "–" if number is None else f"{number:.{self.digits}f}"


METRICS = (
    Metric("seat", "SEAT", "1", 2, lambda result: result.seat),
    Metric("seat_vdv", "SEAT by VDV", "1", 2, lambda result: result.mean(lambda ride: ride.seat_vdv)),
    Metric("spread", "spread of runs", "%", 1, lambda result: result.spread, 100.0),
    Metric("a_w", "a_w", "m/s²", 2, lambda result: result.a_w),
    Metric(
        "vdv_8h",
        "VDV in 8 h",
        "m/s^1.75",
        1,
        lambda result: result.mean(lambda ride: daily_vdv(ride.seat.vdv, ride.seat.duration)),
    ),
    Metric("mtvv", "MTVV", "m/s²", 2, lambda result: result.mean(lambda ride: ride.seat.mtvv)),
    Metric("peak_deflection", "largest deflection", "mm", 0, lambda result: result.peak_deflection, 1e3),
    Metric("end_stop_hits", "end-stop hits", "1", 0, lambda result: result.end_stop_hits),
    Metric("force_rms", "force, RMS", "N", 0, lambda result: result.mean(lambda ride: ride.force_rms)),
    Metric("power", "power, driving", "W", 1, lambda result: result.mean(lambda ride: ride.driving_power)),
)
"""The metrics of the tables, in their order."""


@dataclass(frozen=True)
class Evaluation:
    """Results of one system.

    Attributes
    ----------
    evaluated
        The system.
    results
        Class and driver's mass in kg to the result, class after class.
    warnings
        Warnings of the FMUs, each text once.
    """

    evaluated: EvaluatedSystem
    results: Mapping[tuple[str, float], DriverClassResult]
    warnings: Sequence[str] = ()
