"""Tables of the evaluation report: criteria, inputs, exposure, and all numbers of a system."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from cosim.metrics import ACTION, LIMIT, a8, hours_to_a8, hours_to_vdv
from cosim.metrics.exposure import DAY
from seat_cosim.evaluation.criteria import Outcome
from seat_cosim.evaluation.inputs import INPUTS, MAX_PSD_ERROR, MAX_RMS_ERROR, RESOLUTION
from seat_cosim.evaluation.protocol import Protocol, Run
from seat_cosim.evaluation.results import TABLE_METRICS, DriverClassResult, Evaluation, RideResult
from seat_cosim.evaluation.verdict import SeatVerdict

STYLES = {Outcome.PASS: "", Outcome.FAIL: "fail", Outcome.NOT_JUDGED: "open"}
"""Outcome to the class of a row in the page's style."""


@dataclass(frozen=True)
class Table:
    """Table of the page.

    Attributes
    ----------
    title
        Heading.
    heads
        Name and unit of each column.
    rows
        Style and cells of each row.
    lines, warnings
        Sentences above it.
    left
        Columns of words.
    """

    title: str
    heads: Sequence[tuple[str, str]]
    rows: Sequence[tuple[str, Sequence[str]]]
    lines: Sequence[str] = ()
    warnings: Sequence[str] = field(default_factory=tuple)
    left: Sequence[int] = ()


def criteria_table(title: str, verdict: SeatVerdict, *, with_sentence: bool = False) -> Table:
    """Return the criteria of a system with their worst values.

    Parameters
    ----------
    title
        Name of the system.
    verdict
        Its verdict.
    with_sentence
        Whether the verdict stands above the table.
    """
    heads = [(name, "") for name in ("criterion", "verdict", "worst value", "limit", "where", "failed", "not judged")]
    heads += [("about the value", ""), ("limit from", "")]
    rows = []
    for each in verdict.criteria:
        worst = each.worst
        numbers = (worst.criterion.text(worst.value), worst.criterion.text(worst.limit))
        cells = [
            worst.criterion.words,
            str(worst.outcome),
            *numbers,
            each.place,
            f"{each.counts[Outcome.FAIL]} of {len(verdict.cells)}",
        ]
        cells += [str(each.counts[Outcome.NOT_JUDGED]), worst.detail or "–", worst.criterion.source]
        rows.append((STYLES[worst.outcome], cells))
    lines = [f"{verdict.sentence}."] if with_sentence else []
    return Table(f"Criteria: {title}", heads, rows, lines, left=(0, 7, 8))


def input_table(evaluation: Evaluation, protocol: Protocol) -> Table:
    """Return how far the floor of each run is from its class, by the samples that the seat rode on.

    Parameters
    ----------
    evaluation
        Of any system of the evaluation; all have the same floor.
    protocol
        Its protocol.
    """
    heads = [("class", ""), ("seed", ""), ("RMS", "m/s²"), ("target", "m/s²"), ("deviation", f"±{MAX_RMS_ERROR:.0%}")]
    heads += [("largest deviation of the PSD", f"±{MAX_PSD_ERROR:.0%} of its peak"), ("at", "Hz"), ("conforms", "")]
    rows = []
    for excitation_class in protocol.classes:
        for run, ride in inputs(evaluation, protocol, excitation_class).items():
            name, found = f"{run.seed}", ride.conformity
            if found is None:
                rows.append(("open", [excitation_class, name, *["–"] * 5, "not judged"]))
                continue
            numbers = [f"{found.rms:.3f}", f"{found.target_rms:.2f}", f"{found.rms_error:+.1%}"]
            numbers += [f"{found.psd_error:+.1%}", f"{found.frequency:g}", "yes" if found.share <= 1.0 else "no"]
            style = "" if found.share <= 1.0 else "fail"
            rows.append((style, [excitation_class, name, *(text.replace("-", "−") for text in numbers)]))
    line = (
        f"Computed from the samples that the seat rode on, after the warm-up; spectra at {RESOLUTION:g} Hz with a Hann "
        "window, compared within the band of each class."
    )
    return Table("Inputs", heads, rows, [line])


def inputs(evaluation: Evaluation, protocol: Protocol, excitation_class: str) -> dict[Run, RideResult]:
    """Return a ride on each input of a class.

    Parameters
    ----------
    evaluation
        Of any system.
    protocol
        Its protocol.
    excitation_class
        Name of the class.
    """
    rides = evaluation.results[excitation_class, protocol.masses[0]].rides
    return {Run(ride.run.seed): ride for ride in rides if ride.run is not None and ride.run.repetition == 0}


def exposure_table(evaluation: Evaluation, protocol: Protocol) -> Table:
    """Return the daily exposure of the driver whom each class shakes most, by Directive 2002/44/EC.

    Parameters
    ----------
    evaluation
        Of the system.
    protocol
        Its protocol.
    """
    heads = [("class", ""), ("driver", "kg"), ("A(8) of 8 h", "m/s²"), ("VDV of 8 h", "m/s^1.75")]
    for value in (ACTION, LIMIT):
        name = value.name.removeprefix("exposure ")
        heads += [(f"to {name} by a_w", f"{value.a8:g} m/s²"), ("by VDV", f"{value.vdv:g} m/s^1.75")]
    rows = []
    for excitation_class in protocol.classes:
        results = {mass: evaluation.results[excitation_class, mass] for mass in protocol.masses}
        mass = max(results, key=lambda each: results[each].a_w)
        result = results[mass]
        cells = [excitation_class, f"{mass:g}", f"{a8(result.a_w, DAY):.2f}", f"{result.day:.1f}"]
        for value in (ACTION, LIMIT):
            hours = (hours_to_a8(result.a_w, value), hours_to_vdv(result.day, 3600.0 * DAY, value))
            cells += [duration(each) for each in hours]
        rows.append((_exposed(result), cells))
    line = (
        "Vertical vibration alone, of the driver with the largest a_w, if the whole time is driven on this class. A "
        "member state chooses a_w or VDV. Marked: a day of eight hours exceeds the limit value by a_w."
    )
    return Table(f"Daily exposure (Directive 2002/44/EC): {evaluation.evaluated.title}", heads, rows, [line])


def _exposed(result: DriverClassResult) -> str:
    return "fail" if result.a_w > LIMIT.a8 else ""


def duration(hours: float) -> str:
    """Return a duration of a day as words.

    Parameters
    ----------
    hours
        In h.

    Examples
    --------
    >>> duration(0.75), duration(7.3), duration(25.0)
    ('45 min', '7.3 h', 'over 24 h')
    """
    if hours > 24.0:
        return "over 24 h"
    return f"{60.0 * hours:.0f} min" if hours < 1.0 else f"{hours:.1f} h"


def numbers_table(evaluation: Evaluation, verdict: SeatVerdict, first: Evaluation) -> Table:
    """Return all numbers of a system.

    Parameters
    ----------
    evaluation
        Of the system.
    verdict
        Its verdict.
    first
        The evaluation that the report is about; of others, the change of a_w from them to it is shown.
    """
    compared = evaluation is not first
    heads = [("class", ""), ("driver", "kg"), ("verdict", ""), ("decided by", ""), ("SEAT limit", "")]
    heads += [(metric.title, metric.unit_shown) for metric in TABLE_METRICS]
    heads += [("a_w above", "changed by")] if compared else []
    rows = []
    for (excitation_class, mass), result in evaluation.results.items():
        cell = verdict.cells[excitation_class, mass]
        known = INPUTS.get(excitation_class)
        limit = "–" if known is None or known.seat_limit is None else f"{known.seat_limit:.1f}"
        row = [excitation_class, f"{mass:g}", str(cell.outcome), cell.deciding.criterion.key.replace("_", " "), limit]
        row += [metric.text(result).replace("-", "−") for metric in TABLE_METRICS]
        if compared:
            change = first.results[excitation_class, mass].a_w / result.a_w - 1.0
            row.append(f"{change:+.0%}".replace("-", "−"))
        rows.append((STYLES[cell.outcome], row))
    return Table(evaluation.evaluated.title, heads, rows, warnings=evaluation.warnings)
