"""Results of an evaluation: metrics of single rides, of a driver on a class, and of a whole system."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from cosim.metrics import ACTION, LIMIT, Ride, a8, daily_vdv, hours_to_a8, hours_to_vdv, seat_factor
from cosim.metrics.exposure import DAY, ExposureValue
from seat_cosim.evaluation.damping import DampingTest
from seat_cosim.evaluation.inputs import InputConformity
from seat_cosim.evaluation.protocol import MAX_SPREAD, MIN_RUNS, Run
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
    mean_deflection
        Mean deflection from static equilibrium, in m, up positive.
    end_stop_hits
        Number of contacts with the end stops.
    impact_share
        Share of the driver's VDV that impacts on the end stops have, see :func:`cosim.metrics.impact_share`.
    saturated_share
        Share of the time in which the actuator's force is at its limit.
    force_rms
        RMS of the actuator's force, in N.
    driving_power
        Mean power while the actuator drives, in W.
    conformity
        Deviations of the floor's motion from its class; None for a class that is not known, or a short ride.
    run
        Seed and repetition.
    """

    seat: Ride
    floor: Ride
    peak_deflection: float | None = None
    mean_deflection: float | None = None
    end_stop_hits: int | None = None
    impact_share: float | None = None
    saturated_share: float | None = None
    force_rms: float | None = None
    driving_power: float | None = None
    conformity: InputConformity | None = None
    run: Run | None = None

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
        One for each run.
    """

    rides: tuple[RideResult, ...]

    def mean(self, metric: Callable[[RideResult], float | None]) -> float | None:
        """Return the mean of a metric over the rides; None if no ride has it."""
        found = self._of_rides(metric)
        return sum(found) / len(found) if found else None

    def worst(self, metric: Callable[[RideResult], float | None]) -> float | None:
        """Return the value of a metric with the largest magnitude of all rides; None if no ride has it."""
        return max(self._of_rides(metric), key=abs, default=None)

    def _of_rides(self, metric: Callable[[RideResult], float | None]) -> list[float]:
        return [value for value in map(metric, self.rides) if value is not None]

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
    def seat_vdv(self) -> float:
        """SEAT by VDV, mean of the rides."""
        return sum(ride.seat_vdv for ride in self.rides) / len(self.rides)

    @property
    def peak_deflection(self) -> float | None:
        """Largest deflection of all rides, in m."""
        return self.worst(lambda ride: ride.peak_deflection)

    @property
    def mean_deflection(self) -> float | None:
        """Mean deflection of the ride in which it is largest, in m, up positive."""
        return self.worst(lambda ride: ride.mean_deflection)

    @property
    def impact_share(self) -> float | None:
        """Largest share of the VDV that impacts have, of all rides."""
        return self.worst(lambda ride: ride.impact_share)

    @property
    def seat_vdv_of_impacts(self) -> float | None:
        """What impacts add to the SEAT by VDV, in the ride in which they add most."""
        return self.worst(lambda ride: None if ride.impact_share is None else ride.impact_share * ride.seat_vdv)

    @property
    def saturated_share(self) -> float | None:
        """Largest share of the time at the force's limit, of all rides."""
        return self.worst(lambda ride: ride.saturated_share)

    @property
    def end_stop_hits(self) -> int | None:
        """Number of contacts with the end stops in all rides together."""
        found = [ride.end_stop_hits for ride in self.rides if ride.end_stop_hits is not None]
        return sum(found) if found else None

    @property
    def conformity(self) -> InputConformity | None:
        """Deviations of the input that deviates most; None where those of a ride are not known."""
        found = [ride.conformity for ride in self.rides]
        known = [each for each in found if each is not None]
        return max(known, key=lambda each: each.share) if len(known) == len(found) else None

    @property
    def day(self) -> float:
        """VDV of eight hours of this ride, in m/s^1.75."""
        return sum(daily_vdv(ride.seat.vdv, ride.seat.duration) for ride in self.rides) / len(self.rides)


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
    in_tables
        Whether it stands in the tables of pages and terminals, not in files alone.
    """

    key: str
    title: str
    unit: str
    digits: int
    value: Callable[[DriverClassResult], float | None]
    factor: float = 1.0
    in_tables: bool = True

    @property
    def unit_shown(self) -> str:
        """Unit on pages; empty where the metric has no dimension."""
        return "" if self.unit == "1" else self.unit

    def number(self, result: DriverClassResult) -> float | None:
        """Return the metric of a result, in ``unit``."""
        value = self.value(result)
        return value if value is None or self.factor == 1.0 else self.factor * value

    def text(self, result: DriverClassResult) -> str:
        """Return the metric of a result as pages show it; a dash where there is none."""
        number = self.number(result)
        return "–" if number is None else f"{round(number, self.digits) + 0.0:.{self.digits}f}"


def _hours(result: DriverClassResult, value: ExposureValue) -> float:
    """Return the time in h after which the dose of a result reaches an exposure value."""
    return hours_to_vdv(result.day, 3600.0 * DAY, value)


def _input(result: DriverClassResult, deviation: str) -> float | None:
    """Return a deviation of the input that deviates most, with its sign."""
    worst = result.conformity
    return None if worst is None else float(getattr(worst, deviation))


METRICS = (
    Metric("seat", "SEAT", "1", 2, lambda result: result.seat),
    Metric("seat_vdv", "SEAT by VDV", "1", 2, lambda result: result.seat_vdv),
    Metric("spread", "spread of runs", "%", 1, lambda result: result.spread, 100.0),
    Metric("a_w", "a_w", "m/s²", 2, lambda result: result.a_w),
    Metric("vdv_8h", "VDV in 8 h", "m/s^1.75", 1, lambda result: result.day),
    Metric("mtvv", "MTVV", "m/s²", 2, lambda result: result.mean(lambda ride: ride.seat.mtvv)),
    Metric("peak_deflection", "largest deflection", "mm", 0, lambda result: result.peak_deflection, 1e3),
    Metric("mean_deflection", "mean deflection", "mm", 1, lambda result: result.mean_deflection, 1e3),
    Metric("end_stop_hits", "end-stop hits", "1", 0, lambda result: result.end_stop_hits),
    Metric("impact_share", "impacts' share of VDV", "%", 1, lambda result: result.impact_share, 100.0),
    Metric("force_rms", "force, RMS", "N", 0, lambda result: result.mean(lambda ride: ride.force_rms)),
    Metric("saturated_share", "time at force limit", "%", 1, lambda result: result.saturated_share, 100.0),
    Metric("power", "power, driving", "W", 1, lambda result: result.mean(lambda ride: ride.driving_power)),
    Metric("a8", "A(8) of 8 h", "m/s²", 2, lambda result: a8(result.a_w, DAY), in_tables=False),
    Metric("action_a_w", "to action value by a_w", "h", 1, lambda r: hours_to_a8(r.a_w, ACTION), in_tables=False),
    Metric("limit_a_w", "to limit value by a_w", "h", 1, lambda r: hours_to_a8(r.a_w, LIMIT), in_tables=False),
    Metric("action_vdv", "to action value by VDV", "h", 1, lambda r: _hours(r, ACTION), in_tables=False),
    Metric("limit_vdv", "to limit value by VDV", "h", 1, lambda r: _hours(r, LIMIT), in_tables=False),
    Metric("input_rms_error", "input, RMS", "%", 1, lambda r: _input(r, "rms_error"), 100.0, False),
    Metric("input_psd_error", "input, PSD", "%", 1, lambda r: _input(r, "psd_error"), 100.0, False),
)
"""The metrics of the tables and files, in their order."""

TABLE_METRICS = tuple(metric for metric in METRICS if metric.in_tables)
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
    damping
        The damping test; None where there was none.
    """

    evaluated: EvaluatedSystem
    results: Mapping[tuple[str, float], DriverClassResult]
    warnings: Sequence[str] = ()
    damping: DampingTest | None = None
