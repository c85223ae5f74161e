"""Criteria by which an evaluation judges: what is compared with which limit, and where the limit comes from."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

from seat_cosim.evaluation.damping import DampingTest
from seat_cosim.evaluation.inputs import INPUTS, MAX_PSD_ERROR, MAX_RMS_ERROR, RESOLUTION
from seat_cosim.evaluation.protocol import MAX_SPREAD, MIN_RUNS
from seat_cosim.evaluation.results import DriverClassResult

MAX_SEAT_VDV_OF_IMPACTS = 0.05
"""Largest SEAT by VDV that impacts on the end stops may add.

A limit of their share of the driver's own VDV would judge a light touch in a seat that isolates well more severely than
heavy impacts in one that does not.
"""

MAX_MEAN_DEFLECTION = 0.25
"""Largest mean deflection, as a share of the travel to one side."""

MAX_SATURATED_SHARE = 0.05
"""Largest share of a ride's time in which the force is at its limit."""

_TOLERANCE = 1e-9
"""Relative tolerance of all comparisons, for rounding."""


class Outcome(StrEnum):
    """Outcome of a criterion, and of a verdict."""

    PASS = "pass"
    FAIL = "fail"
    NOT_JUDGED = "not judged"


@dataclass(frozen=True)
class Criterion:
    """A criterion: a value that must not exceed a limit.

    Attributes
    ----------
    key
        Name in files.
    words
        Name on pages.
    source
        Where the limit comes from.
    unit
        Unit in which value and limit are shown; empty for none.
    digits
        Decimals on pages.
    factor
        Factor from the unit of value and limit to the one shown.
    of_the_test
        Whether it judges the test, not the seat. Such a criterion decides only where no criterion of the seat has the
        same outcome.
    """

    key: str
    words: str
    source: str
    unit: str = ""
    digits: int = 2
    factor: float = 1.0
    of_the_test: bool = False

    def text(self, value: float | None) -> str:
        """Return a value or limit with its unit, as pages show it; a dash where there is none."""
        if value is None:
            return "–"
        return f"{self.factor * value:.{self.digits}f}{f' {self.unit}' if self.unit else ''}"


_OWN = "chosen by this project"

SEAT_RMS = Criterion("seat_rms", "SEAT by a_w", "ISO 7096, as recalled")
SEAT_VDV = Criterion("seat_vdv", "SEAT by VDV, against the passive seat", f"{_OWN}: no more dose than without actuator")
END_STOPS = Criterion("end_stops", "end stops: what impacts add to the SEAT by VDV", _OWN)
MEAN_DEFLECTION = Criterion("mean_deflection", "mean deflection, of the travel", _OWN, "%", 0, 100.0)
SATURATION = Criterion("saturation", "time with the force at its limit", _OWN, "%", 1, 100.0)
REPEATABILITY = Criterion("repeatability", "runs repeat: distance from their mean", "ISO 10326-1", "%", 1, 100.0, True)
INPUT = Criterion(
    "input",
    f"input conforms: of {MAX_RMS_ERROR:.0%} of the RMS, {MAX_PSD_ERROR:.0%} of the PSD's peak",
    f"ISO 7096, as recalled; at {RESOLUTION:g} Hz",
    "%",
    0,
    100.0,
    of_the_test=True,
)
DAMPING = Criterion("damping", "damping test: transmissibility at the resonance", "ISO 7096, as recalled")


@dataclass(frozen=True)
class Judgement:
    """A criterion applied to a result.

    Attributes
    ----------
    criterion
        The criterion.
    value, limit
        Value and the largest that is allowed; None where it is not known.
    detail
        More about the value; where it cannot be judged, why.
    """

    criterion: Criterion
    value: float | None
    limit: float | None
    detail: str = ""

    @property
    def outcome(self) -> Outcome:
        """Whether the value is within its limit."""
        if self.value is None or self.limit is None or math.isnan(self.value):
            return Outcome.NOT_JUDGED
        return Outcome.PASS if self.value <= self.limit * (1.0 + _TOLERANCE) else Outcome.FAIL

    @property
    def share(self) -> float:
        """Value as a multiple of its limit; 0 where it is not judged."""
        if self.value is None or not self.limit:
            return 0.0
        return self.value / self.limit

    @property
    def sentence(self) -> str:
        """Value and limit as words, or why it is not judged."""
        if self.outcome is Outcome.NOT_JUDGED:
            return f"{self.criterion.words}: {self.detail}"
        sign = "≤" if self.outcome is Outcome.PASS else ">"
        comparison = f"{self.criterion.text(self.value)} {sign} {self.criterion.text(self.limit)}"
        return f"{self.criterion.words}: {comparison}{f' ({self.detail})' if self.detail else ''}"


def judge_seat_rms(excitation_class: str, result: DriverClassResult) -> Judgement:
    """Judge the SEAT by a_w by the limit of its class.

    Parameters
    ----------
    excitation_class
        Name of the class of the floor, for example ``EM3``.
    result
        Result of a driver on a class.
    """
    known = INPUTS.get(excitation_class)
    limit = known.seat_limit if known else None
    return Judgement(
        SEAT_RMS, result.seat, limit, "" if limit is not None else f"no limit of class {excitation_class} known"
    )


def judge_seat_vdv(result: DriverClassResult, reference: DriverClassResult | None) -> Judgement:
    """Judge the SEAT by VDV by that of the passive seat on the same rides.

    Parameters
    ----------
    result
        Result of a driver on a class.
    reference
        The same of the passive seat; None where there is none.
    """
    if reference is None:
        return Judgement(SEAT_VDV, result.seat_vdv, None, "no passive seat beside it")
    return Judgement(SEAT_VDV, result.seat_vdv, reference.seat_vdv)


def judge_end_stops(result: DriverClassResult) -> Judgement:
    """Judge the impacts on the end stops by what they add to the VDV, as a share of the floor's.

    Parameters
    ----------
    result
        Result of a driver on a class.
    """
    hits, share, added = result.end_stop_hits, result.impact_share, result.seat_vdv_of_impacts
    if hits is None or share is None:
        why = "no signal of the deflection" if result.peak_deflection is None else "unlimited travel, no end stops"
        return Judgement(END_STOPS, None, MAX_SEAT_VDV_OF_IMPACTS, why)
    words = f"{hits} hit{'' if hits == 1 else 's'}, {share:.0%} of the driver's VDV"
    return Judgement(END_STOPS, added, MAX_SEAT_VDV_OF_IMPACTS, words)


def judge_mean_deflection(result: DriverClassResult, travel: float | None) -> Judgement:
    """Judge the mean deflection by the travel.

    Parameters
    ----------
    result
        Result of a driver on a class.
    travel
        Travel in m, from its middle to each side; None where it is unlimited.
    """
    mean = result.mean_deflection
    if mean is None:
        return Judgement(MEAN_DEFLECTION, None, MAX_MEAN_DEFLECTION, "no signal of the deflection")
    if travel is None:
        return Judgement(MEAN_DEFLECTION, None, MAX_MEAN_DEFLECTION, "unlimited travel")
    return Judgement(MEAN_DEFLECTION, abs(mean) / travel, MAX_MEAN_DEFLECTION, f"{1e3 * mean:.1f} mm")


def judge_saturation(result: DriverClassResult) -> Judgement:
    """Judge the share of the time in which the force is at its limit.

    Parameters
    ----------
    result
        Result of a driver on a class.
    """
    return Judgement(
        SATURATION,
        result.saturated_share,
        MAX_SATURATED_SHARE,
        "no signal of the force, or no limit of it" if result.saturated_share is None else "",
    )


def judge_repeatability(result: DriverClassResult) -> Judgement:
    """Judge the distance of the runs on one input from their mean.

    Parameters
    ----------
    result
        Result of a driver on a class.
    """
    if len(result.rides) < MIN_RUNS:
        return Judgement(REPEATABILITY, None, MAX_SPREAD, f"fewer than {MIN_RUNS} runs")
    return Judgement(REPEATABILITY, result.spread, MAX_SPREAD)


def judge_input(excitation_class: str, result: DriverClassResult) -> Judgement:
    """Judge the floor's motion by the spectrum and RMS of its class.

    Parameters
    ----------
    excitation_class
        Name of the class of the floor, for example ``EM3``.
    result
        Result of a driver on a class.
    """
    worst = result.conformity
    if worst is None:
        why = f"no spectrum of class {excitation_class} known" if excitation_class not in INPUTS else "ride too short"
        return Judgement(INPUT, None, 1.0, why)
    return Judgement(INPUT, worst.share, 1.0, worst.words)


def judge_damping(excitation_class: str, found: DampingTest | None) -> Judgement:
    """Judge the transmissibility at the resonance by the limit of the class.

    Parameters
    ----------
    excitation_class
        Name of the class of the floor, for example ``EM3``.
    found
        The damping test; None where it could not be made.
    """
    known = INPUTS.get(excitation_class)
    limit = known.damping_limit if known else None
    if found is None:
        return Judgement(DAMPING, None, limit, "no sine of the floor")
    why = f"at {found.frequency:g} Hz" if limit is not None else f"no limit of class {excitation_class} known"
    return Judgement(DAMPING, found.transmissibility, limit, why)
