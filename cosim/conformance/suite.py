"""Applies the rules to an FMU: files first, then the library in processes of its own."""

from __future__ import annotations

import importlib
import tempfile
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from cosim.conformance import TIME_LIMIT
from cosim.conformance.fmu_archive import Subject
from cosim.conformance.process import Processes, Question
from cosim.conformance.raw_instance import library_path
from cosim.conformance.rule import RULES, Finding, NotApplicableError, Rule
from cosim.errors import SetupError

MODULES = (
    "archive",
    "description",
    "variables",
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
class Outcome:
    """What a rule came to.

    Attributes
    ----------
    rule
        The rule.
    findings
        What is wrong.
    reason
        Why the rule does not apply; empty where it does.
    """

    rule: Rule
    findings: tuple[Finding, ...] = ()
    reason: str = ""

    @property
    def verdict(self) -> Verdict:
        """The worst of its findings."""
        if self.reason:
            return "not applicable"
        if any(finding.severity == "error" for finding in self.findings):
            return "failed"
        return "warning" if self.findings else "passed"


@dataclass
class Examination:
    """All outcomes of an FMU.

    Attributes
    ----------
    path
        The FMU.
    outcomes
        By the rule's id, in the order of the rules.
    """

    path: Path
    outcomes: dict[str, Outcome] = field(default_factory=dict)

    @property
    def findings(self) -> list[Finding]:
        """All findings, in the order of the rules."""
        return [finding for outcome in self.outcomes.values() for finding in outcome.findings]

    def count(self, verdict: Verdict) -> int:
        """Count the rules with a verdict."""
        return sum(outcome.verdict == verdict for outcome in self.outcomes.values())


def load_rules() -> dict[str, Rule]:
    """Import all rules, and return them in the order in which they are applied."""
    for module in MODULES:
        importlib.import_module(f"cosim.conformance.rules.{module}")
    order = {module: place for place, module in enumerate(MODULES)}
    ordered = sorted(RULES.values(), key=lambda rule: order[rule.id.partition(".")[0]])
    return {rule.id: rule for rule in ordered}


def _named(words: Iterable[str], rules: Iterable[str]) -> set[str]:
    """Return the rules that ids and groups stand for; a word that is neither is an error."""
    groups: dict[str, set[str]] = {}
    for name in rules:
        groups.setdefault(name.partition(".")[0], set()).add(name)
        groups[name] = {name}
    for word in words:
        if word not in groups:
            expected = ", ".join(name for name in groups if "." not in name)
            raise SetupError(f"rule {word}: expected an id that --list shows, or one of {expected}; got no such rule")
    return set().union(*(groups[word] for word in words))


def validate(
    path: Path,
    *,
    only: Collection[str] = (),
    skip: Collection[str] = (),
    time_limit: float = TIME_LIMIT,
    processes: Processes | None = None,
    progress: Callable[[str], None] = lambda rule: None,
) -> Examination:
    """Apply the rules to an FMU.

    Parameters
    ----------
    path
        The file.
    only
        Rules to show, by id or group (``lifecycle.reset``, ``life``); all if empty. What they need is applied, too, but
        not shown.
    skip
        Rules to leave out, likewise.
    time_limit
        How long a rule may run the FMU, in s.
    processes
        Where rules of behaviour run; of its own if None. To be shared by several FMUs, which saves a start each.
    progress
        Called with the id of each rule before it is applied.

    Raises
    ------
    SetupError
        If there is no such file, or no such rule.
    """
    rules = load_rules()
    if not path.is_file():
        raise SetupError(f"{path}: expected an FMU, got no such file")
    shown, left_out = _named(only, rules), _named(skip, rules)
    wanted = [name for name in rules if name not in left_out and (not only or name in shown)]
    with ExitStack() as stack:
        work = _Work(Subject(path), processes or stack.enter_context(Processes()), time_limit)
        stack.callback(work.subject.close)
        work.folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        found = Examination(path)
        done: dict[str, Outcome] = {}
        for name in _with_needs(wanted, rules):
            progress(name)
            done[name] = work.apply(rules[name], done)
            if name in wanted:
                found.outcomes[name] = done[name]
        return found


def _with_needs(wanted: Collection[str], rules: dict[str, Rule]) -> Iterator[str]:
    """Put before each rule what it needs, all of them once."""
    seen: set[str] = set()

    def visit(name: str) -> Iterator[str]:
        if name not in seen:
            seen.add(name)
            for need in rules[name].needs:
                yield from visit(need)
            yield name

    for name in wanted:
        yield from visit(name)


@dataclass
class _Work:
    """An examination under way."""

    subject: Subject
    processes: Processes
    time_limit: float
    folder: Path = Path()
    _extracted: str | None = None
    """Why the FMU cannot be run, empty if it can; None before that was tried."""

    def apply(self, rule: Rule, done: dict[str, Outcome]) -> Outcome:
        """Apply a rule, given the outcomes of those before it."""
        try:
            self._see_needs(rule, done)
            if rule.stage != "behaviour":
                return Outcome(rule, tuple(rule.apply(self.subject)))
            return Outcome(rule, tuple(self.processes.ask(self._question(rule))))
        except NotApplicableError as reason:
            return Outcome(rule, reason=str(reason))

    def _see_needs(self, rule: Rule, done: dict[str, Outcome]) -> None:
        for need in rule.needs:
            if done[need].reason:
                raise NotApplicableError(done[need].reason)
            if done[need].findings:
                raise NotApplicableError(f"see {need}")
        if rule.last and any(done[name].findings for name in done if done[name].rule.stage == rule.stage):
            raise NotApplicableError("other rules found enough")

    def _question(self, rule: Rule) -> Question:
        if self._extracted is None:
            self._extracted = self._extract()
        if self._extracted:
            raise NotApplicableError(self._extracted)
        assert self.subject.description is not None
        return Question(rule.id, self.subject.description, self.folder, self.time_limit)

    def _extract(self) -> str:
        """Extract the FMU; returns why it cannot be run."""
        description = self.subject.description
        if description is None:
            return "the description cannot be read"
        if "CoSimulation" not in description.interfaces:
            return "the FMU is not for co-simulation"
        try:
            self.subject.extract(self.folder)
        except SetupError:
            return "the archive cannot be extracted safely"
        (self.folder / "resources").mkdir(exist_ok=True)
        path = library_path(description, self.folder)
        if not path.is_file():
            return f"the FMU has no library for this machine, {path.relative_to(self.folder)}"
        return ""
