"""Outcomes as a table for people and as JSON for machines."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from rich.box import SIMPLE
from rich.table import Table
from rich.text import Text

from cosim.conformance.suite import Examination, Outcome

_LOOKS = {"passed": "green", "failed": "bold red", "warning": "yellow", "not applicable": "dim"}


def table(found: Examination, every: bool = False) -> Table:
    """Make a table of an FMU's outcomes: a row for each rule.

    Parameters
    ----------
    found
        The outcomes.
    every
        Whether to show the messages in full, however many there are.
    """
    made = Table("rule", "verdict", "what holds, or what was found", box=SIMPLE, title=str(found.path))
    made.title_justify = "left"
    for outcome in found.outcomes.values():
        verdict = "FAILED" if outcome.verdict == "failed" else outcome.verdict
        made.add_row(outcome.rule.id, Text(verdict, _LOOKS[outcome.verdict]), Text(_said(outcome, every)))
    return made


def _said(outcome: Outcome, every: bool) -> str:
    if outcome.reason:
        return outcome.reason
    messages = [finding.message for finding in outcome.findings]
    if not messages:
        return outcome.rule.title
    shown = messages if every else messages[:3]
    more = [f"and {len(messages) - len(shown)} more"] if len(messages) > len(shown) else []
    return "\n".join(f"- {text}" if len(messages) > 1 else text for text in (*shown, *more))


def summary(found: Examination) -> str:
    """Count the verdicts in a line."""
    counts = (
        (found.count("passed"), "passed"),
        (found.count("failed"), "failed"),
        (found.count("warning"), "with warnings"),
        (found.count("not applicable"), "not applicable"),
    )
    return f"{found.path}: {', '.join(f'{count} {what}' for count, what in counts)}"


def data(examinations: Iterable[Examination]) -> dict[str, Any]:
    """Return outcomes as what becomes JSON."""
    return {
        "fmus": [
            {
                "file": str(found.path),
                "failed": found.count("failed"),
                "warnings": found.count("warning"),
                "rules": [_row(outcome) for outcome in found.outcomes.values()],
            }
            for found in examinations
        ]
    }


def _row(outcome: Outcome) -> dict[str, Any]:
    return {
        "rule": outcome.rule.id,
        "title": outcome.rule.title,
        "clause": outcome.rule.clause,
        "verdict": outcome.verdict,
        "reason": outcome.reason,
        "findings": [{"severity": f.severity, "message": f.message} for f in outcome.findings],
    }
