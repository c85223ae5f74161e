"""Verdict of an evaluation: the worst of its criteria, for each driver on each class and for a whole system."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from seat_cosim.evaluation.criteria import (
    Criterion,
    Judgement,
    Outcome,
    judge_damping,
    judge_end_stops,
    judge_input,
    judge_mean_deflection,
    judge_repeatability,
    judge_saturation,
    judge_seat_rms,
    judge_seat_vdv,
)
from seat_cosim.evaluation.protocol import EDITIONS, HEAVY, ISO_7096, LIGHT, Protocol
from seat_cosim.evaluation.results import Evaluation

MODEL_NOTE = "Everything is computed by co-simulation; no person and no seat was measured."
LIMITS_NOTE = (
    "The limits of ISO 7096 for SEAT, damping and input are quoted as recalled: check them in the standard before "
    "relying on them."
)
SCATTER_NOTE = (
    "The runs of a survey ride different realizations of a class: their spread is the scatter of the input, and is not "
    "judged as repeatability."
)
ACTIVE_NOTE = (
    "ISO 7096:2020 has a damping test of its own for active and semi-active suspensions (clause 5.5.3). Its text is "
    "not known here: the ordinary damping test was run."
)

Key = tuple[str, float]
"""Class and driver's mass in kg."""

_SEVERITY = {Outcome.PASS: 0, Outcome.NOT_JUDGED: 1, Outcome.FAIL: 2}


def _severity(judgement: Judgement) -> tuple[int, bool, float]:
    return _SEVERITY[judgement.outcome], not judgement.criterion.of_the_test, judgement.share


@dataclass(frozen=True)
class Verdict:
    """Verdict on one driver on one class.

    Attributes
    ----------
    judgements
        One for each criterion.
    """

    judgements: tuple[Judgement, ...]

    @property
    def deciding(self) -> Judgement:
        """The worst judgement: fail before not judged before pass, then the seat's before the test's, then by share."""
        return max(self.judgements, key=_severity)

    @property
    def outcome(self) -> Outcome:
        """Outcome of the worst judgement."""
        return self.deciding.outcome

    def having(self, outcome: Outcome) -> list[Judgement]:
        """Return the judgements with an outcome, worst first."""
        return sorted((each for each in self.judgements if each.outcome is outcome), key=_severity, reverse=True)


@dataclass(frozen=True)
class CriterionSummary:
    """A criterion over all drivers and classes.

    Attributes
    ----------
    criterion
        The criterion.
    worst
        Its worst judgement.
    where
        Class and driver of the worst judgement.
    counts
        Number of combinations with each outcome.
    """

    criterion: Criterion
    worst: Judgement
    where: Key
    counts: Mapping[Outcome, int]

    @property
    def place(self) -> str:
        """Class and driver of the worst judgement, as words."""
        return place(self.where)


@dataclass(frozen=True)
class SeatVerdict:
    """Verdict on a seat: the worst of all drivers and classes.

    Attributes
    ----------
    cells
        Class and driver's mass to the verdict on them.
    """

    cells: Mapping[Key, Verdict]

    @property
    def where(self) -> Key:
        """Class and driver that decide."""
        return max(self.cells, key=lambda key: _severity(self.cells[key].deciding))

    @property
    def deciding(self) -> Judgement:
        """The judgement that decides."""
        return self.cells[self.where].deciding

    @property
    def outcome(self) -> Outcome:
        """Outcome of the worst judgement."""
        return self.deciding.outcome

    @property
    def criteria(self) -> list[CriterionSummary]:
        """The criteria over all drivers and classes, in their order."""
        first = next(iter(self.cells.values()))
        found = []
        for i, judgement in enumerate(first.judgements):
            each = {key: verdict.judgements[i] for key, verdict in self.cells.items()}
            where = max(each, key=lambda key: _severity(each[key]))
            outcomes = [one.outcome for one in each.values()]
            counts = {outcome: outcomes.count(outcome) for outcome in Outcome}
            found.append(CriterionSummary(judgement.criterion, each[where], where, counts))
        return found

    def count(self, outcome: Outcome) -> int:
        """Return the number of combinations of class and driver with an outcome."""
        return sum(verdict.outcome is outcome for verdict in self.cells.values())

    @property
    def sentence(self) -> str:
        """The verdict in one line: outcome, what decides and where, what else fails or is not judged."""
        text = f"Verdict: {self.outcome}, decided by {self.deciding.sentence}, {place(self.where)}"
        passed = f"{self.count(Outcome.PASS)} of {len(self.cells)} combinations of class and driver pass"
        others = [
            f"{words} {', '.join(names)}"
            for words, outcome in (("also failed:", Outcome.FAIL), ("not judged:", Outcome.NOT_JUDGED))
            if (names := [key for key in self._keys(outcome) if key != self.deciding.criterion.key])
        ]
        return "; ".join([text, passed, *others])

    def _keys(self, outcome: Outcome) -> list[str]:
        return [each.criterion.key for each in self.criteria if each.counts[outcome]]


def place(key: Key) -> str:
    """Return class and driver as words."""
    excitation_class, mass = key
    return f"{excitation_class}, {mass:g} kg"


def judge(evaluation: Evaluation, protocol: Protocol, reference: Evaluation | None = None) -> SeatVerdict:
    """Judge a system by all criteria of a protocol.

    Parameters
    ----------
    evaluation
        Of the system.
    protocol
        Its protocol. Repeatability and damping are criteria of a protocol that repeats its inputs.
    reference
        Evaluation of the passive seat on the same rides, which is not compared with itself. A seat without an actuator
        has no criterion of the force.

    Returns
    -------
    SeatVerdict
        The verdict.
    """
    evaluated = evaluation.evaluated
    cells = {}
    for key, result in evaluation.results.items():
        excitation_class, _ = key
        judgements = [
            judge_seat_rms(excitation_class, result),
            judge_end_stops(result),
            judge_mean_deflection(result, evaluated.end_stop_travel),
            judge_input(excitation_class, result),
        ]
        if not evaluated.is_passive:
            judgements.insert(1, judge_seat_vdv(result, reference.results[key] if reference else None))
        if evaluated.has_actuator:
            judgements.insert(-1, judge_saturation(result))
        if protocol.repeats_inputs:
            judgements += [judge_repeatability(result), judge_damping(excitation_class, evaluation.damping)]
        cells[key] = Verdict(tuple(judgements))
    return SeatVerdict(cells)


def judge_all(evaluations: Sequence[Evaluation], protocol: Protocol) -> list[SeatVerdict]:
    """Judge several systems; the passive seat among them is the reference of the others.

    Parameters
    ----------
    evaluations
        On the same rides.
    protocol
        Their protocol.
    """
    reference = next((each for each in evaluations if each.evaluated.is_passive), None)
    return [judge(each, protocol, reference) for each in evaluations]


def protocol_notes(protocol: Protocol) -> list[str]:
    """Return what a reader must know of a protocol.

    Parameters
    ----------
    protocol
        The protocol.
    """
    notes = [f"Protocol {protocol.name}: {EDITIONS[protocol.name]}."]
    if protocol.name != ISO_7096:
        return [*notes, SCATTER_NOTE]
    if not protocol.has_both_persons:
        persons = " and ".join(f"{low:g} to {high:g} kg" for low, high in (LIGHT, HEAVY))
        notes.append(f"The test is not complete: the standard wants persons of {persons}.")
    return [*notes, ACTIVE_NOTE]
