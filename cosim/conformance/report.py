"""Format the results of a validation as a table for people and as JSON for programs."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from rich.box import SIMPLE
from rich.table import Table
from rich.text import Text

from cosim.conformance.suite import RuleOutcome, ValidationReport

_STYLES = {"passed": "green", "failed": "bold red", "warning": "yellow", "not applicable": "dim"}
"""Verdict to style."""


def table(report: ValidationReport, full: bool = False) -> Table:
    """Return the results of an FMU as a table with one row for each rule.

    Parameters
    ----------
    report
        The results.
    full
        Whether to show all messages of a rule; otherwise the first three.
    """
    result = Table("rule", "verdict", "what holds, or what was found", box=SIMPLE, title=str(report.path))
    result.title_justify = "left"
    for outcome in report.outcomes.values():
        verdict = "FAILED" if outcome.verdict == "failed" else outcome.verdict
        result.add_row(outcome.rule.id, Text(verdict, _STYLES[outcome.verdict]), Text(_outcome_text(outcome, full)))
    return result


def _outcome_text(outcome: RuleOutcome, full: bool) -> str:
    if outcome.not_applicable:
        return outcome.not_applicable
    messages = [finding.message for finding in outcome.findings]
    if not messages:
        return outcome.rule.title
    shown = messages if full else messages[:3]
    more = [f"and {len(messages) - len(shown)} more"] if len(messages) > len(shown) else []
    return "\n".join(f"- {text}" if len(messages) > 1 else text for text in (*shown, *more))


def summary(report: ValidationReport) -> str:
    """Return the number of rules with each verdict as one line of text.

    Parameters
    ----------
    report
        The results of an FMU.
    """
    counts = (
        (report.count("passed"), "passed"),
        (report.count("failed"), "failed"),
        (report.count("warning"), "with warnings"),
        (report.count("not applicable"), "not applicable"),
    )
    return f"{report.path}: {', '.join(f'{count} {what}' for count, what in counts)}"


def data(reports: Iterable[ValidationReport]) -> dict[str, Any]:
    """Return the results of several FMUs as a dict that can be written as JSON.

    Parameters
    ----------
    reports
        The results of each FMU.
    """
    return {
        "fmus": [
            {
                "file": str(report.path),
                "failed": report.count("failed"),
                "warnings": report.count("warning"),
                "rules": [_row(outcome) for outcome in report.outcomes.values()],
            }
            for report in reports
        ]
    }


def _row(outcome: RuleOutcome) -> dict[str, Any]:
    return {
        "rule": outcome.rule.id,
        "title": outcome.rule.title,
        "clause": outcome.rule.clause,
        "verdict": outcome.verdict,
        "reason": outcome.not_applicable,
        "findings": [{"severity": f.severity, "message": f.message} for f in outcome.findings],
    }
