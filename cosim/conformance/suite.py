"""Apply the rules to an FMU: first to its files, then to its library in separate processes."""

from __future__ import annotations

import importlib
import tempfile
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from cosim.conformance import TIME_LIMIT
from cosim.conformance.fmu_archive import FmuArchive
from cosim.conformance.process import RuleRequest, RuleRunner
from cosim.conformance.raw_instance import library_path
from cosim.conformance.rule import RULES, Finding, NotApplicableError, Rule
from cosim.errors import SetupError

MODULES = (
    "archive",
    "description",
    "variables",
    "arrays",
    "clocks",
    "structure",
    "fmpy_check",
    "binary",
    "lifecycle",
    "steps",
    "state",
    "side_effects",
)
"""Modules of rules, in the order in which they are applied."""

Verdict = Literal["passed", "failed", "warning", "not applicable"]


@dataclass(frozen=True)
class RuleOutcome:
    """The result of a rule for an FMU.

    Attributes
    ----------
    rule
        The rule.
    findings
        What it found.
    not_applicable
        Why the rule does not apply; empty where it does.
    """

    rule: Rule
    findings: tuple[Finding, ...] = ()
    not_applicable: str = ""

    @property
    def verdict(self) -> Verdict:
        """``failed`` with any error, ``warning`` with warnings only, ``passed`` without findings."""
        if self.not_applicable:
            return "not applicable"
        if any(finding.severity == "error" for finding in self.findings):
            return "failed"
        return "warning" if self.findings else "passed"


@dataclass
class ValidationReport:
    """The results of all rules for an FMU.

    Attributes
    ----------
    path
        The FMU.
    outcomes
        Id of each rule to its result, in the order of the rules.
    """

    path: Path
    outcomes: dict[str, RuleOutcome] = field(default_factory=dict)

    @property
    def findings(self) -> list[Finding]:
        """All findings, in the order of the rules."""
        return [finding for outcome in self.outcomes.values() for finding in outcome.findings]

    def count(self, verdict: Verdict) -> int:
        """Return the number of rules with a verdict."""
        return sum(outcome.verdict == verdict for outcome in self.outcomes.values())


def load_rules() -> dict[str, Rule]:
    """Import the modules of all rules.

    Returns
    -------
    dict
        Id to rule, in the order in which they are applied.
    """
    for module in MODULES:
        importlib.import_module(f"cosim.conformance.rules.{module}")
    order = {module: place for place, module in enumerate(MODULES)}
    ordered = sorted(RULES.values(), key=lambda rule: order[rule.id.partition(".")[0]])
    return {rule.id: rule for rule in ordered}


def _selected(names: Iterable[str], rules: Iterable[str]) -> set[str]:
    """Return the ids of the rules that are named by id or group."""
    groups: dict[str, set[str]] = {}
    for rule in rules:
        groups.setdefault(rule.partition(".")[0], set()).add(rule)
        groups[rule] = {rule}
    for name in names:
        if name not in groups:
            expected = ", ".join(group for group in groups if "." not in group)
            raise SetupError(f"rule {name}: expected an id that --list shows, or one of {expected}; got no such rule")
    return set().union(*(groups[name] for name in names))


def validate(
    path: Path,
    *,
    only: Collection[str] = (),
    skip: Collection[str] = (),
    time_limit: float = TIME_LIMIT,
    runner: RuleRunner | None = None,
    progress: Callable[[str], None] = lambda rule: None,
) -> ValidationReport:
    """Validate an FMU against the rules.

    Parameters
    ----------
    path
        The ``.fmu`` file.
    only
        Rules to report, by id or group (``lifecycle.reset``, ``lifecycle``); all if empty. The rules that these need
        are applied, too, but not reported.
    skip
        Rules not to apply, by id or group.
    time_limit
        How long a rule may run the FMU, in s.
    runner
        Applies the rules of the stage ``behaviour``; a new one if None. Validations of several FMUs can share one,
        which starts one server only.
    progress
        Called with the id of each rule before it is applied.

    Returns
    -------
    ValidationReport
        The results of the reported rules.

    Raises
    ------
    SetupError
        If there is no such file, or no such rule.
    RunError
        If the server of the runner has ended.
    """
    rules = load_rules()
    if not path.is_file():
        raise SetupError(f"{path}: expected an FMU, got no such file")
    chosen, skipped = _selected(only, rules), _selected(skip, rules)
    reported = [name for name in rules if name not in skipped and (not only or name in chosen)]
    with ExitStack() as stack:
        validation = _Validation(FmuArchive(path), runner or stack.enter_context(RuleRunner()), time_limit)
        stack.callback(validation.fmu.close)
        validation.folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        report = ValidationReport(path)
        outcomes: dict[str, RuleOutcome] = {}
        for name in _with_needs(reported, rules):
            progress(name)
            outcomes[name] = validation.apply(rules[name], outcomes)
            if name in reported:
                report.outcomes[name] = outcomes[name]
        return report


def _with_needs(names: Collection[str], rules: dict[str, Rule]) -> Iterator[str]:
    """Yield the rules and those that they need, each once and after those that it needs."""
    seen: set[str] = set()

    def visit(name: str) -> Iterator[str]:
        if name not in seen:
            seen.add(name)
            for need in rules[name].needs:
                yield from visit(need)
            yield name

    for name in names:
        yield from visit(name)


@dataclass
class _Validation:
    """A validation in progress."""

    fmu: FmuArchive
    runner: RuleRunner
    time_limit: float
    folder: Path = Path()
    _cannot_run: str | None = None
    """Why the FMU cannot be run, empty where it can; None before the extraction."""

    def apply(self, rule: Rule, outcomes: dict[str, RuleOutcome]) -> RuleOutcome:
        """Apply a rule, given the outcomes of the rules before."""
        try:
            self._check_needs(rule, outcomes)
            if rule.stage != "behaviour":
                return RuleOutcome(rule, tuple(rule.apply(self.fmu)))
            return RuleOutcome(rule, tuple(self.runner.run(self._request(rule))))
        except NotApplicableError as reason:
            return RuleOutcome(rule, not_applicable=str(reason))

    def _check_needs(self, rule: Rule, outcomes: dict[str, RuleOutcome]) -> None:
        for need in rule.needs:
            if outcomes[need].not_applicable:
                raise NotApplicableError(outcomes[need].not_applicable)
            if outcomes[need].findings:
                raise NotApplicableError(f"see {need}")
        same_stage = (outcome for outcome in outcomes.values() if outcome.rule.stage == rule.stage)
        if rule.only_if_stage_passed and any(outcome.findings for outcome in same_stage):
            raise NotApplicableError("other rules found problems already")

    def _request(self, rule: Rule) -> RuleRequest:
        if self._cannot_run is None:
            self._cannot_run = self._extract()
        if self._cannot_run:
            raise NotApplicableError(self._cannot_run)
        assert self.fmu.description is not None
        return RuleRequest(rule.id, self.fmu.description, self.folder, self.time_limit)

    def _extract(self) -> str:
        """Extract the FMU; return why it cannot be run, or an empty text."""
        description = self.fmu.description
        if description is None:
            return "the description cannot be read"
        if "CoSimulation" not in description.interfaces:
            return "the FMU is not for co-simulation"
        try:
            self.fmu.extract(self.folder)
        except SetupError:
            return "the archive cannot be extracted safely"
        (self.folder / "resources").mkdir(exist_ok=True)
        path = library_path(description, self.folder)
        if not path.is_file():
            return f"the FMU has no library for this machine, {path.relative_to(self.folder)}"
        return ""
