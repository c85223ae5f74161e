"""What a rule is: a function that inspects an FMU and yields a message for each problem, with an id and a clause.

A rule of the stages ``archive`` and ``description`` reads files only and takes a
:class:`cosim.conformance.fmu_archive.FmuArchive`. A rule of the stage ``behaviour`` runs the FMU in a separate process
and takes a :class:`cosim.conformance.harness.Harness`. Each message says what, where, expected, got. A rule that only
requires calls to succeed yields nothing: a call that fails raises an exception with the message. A message of the type
:class:`Advice` is a warning, whatever the severity of the rule.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Literal

Stage = Literal["archive", "description", "behaviour"]
Severity = Literal["error", "warning"]
Check = Callable[[Any], Iterable[str] | None]

RULES: dict[str, Rule] = {}
"""Id to rule; filled when the modules of the rules are imported."""


@dataclass(frozen=True)
class Finding:
    """A problem of an FMU.

    Attributes
    ----------
    rule
        Id of the rule that found it.
    message
        What, where, expected, got; one line.
    severity
        ``error`` for a violation of the standard, ``warning`` for a deviation from good practice.
    """

    rule: str
    message: str
    severity: Severity


class Advice(str):
    """A message that is a warning, whatever the severity of its rule."""

    __slots__ = ()


class NotApplicableError(Exception):
    """Raised by a rule that does not apply to the FMU; the message says why."""


@dataclass(frozen=True)
class Rule:
    """A rule of the suite.

    Attributes
    ----------
    id
        Group and name, for example ``archive.paths``.
    title
        What holds in a conforming FMU.
    clause
        Clauses of the standards; empty for good practice that no standard demands.
    stage
        What the rule inspects.
    severity
        Severity of its findings.
    needs
        Ids of the rules that must pass before this one applies.
    only_if_stage_passed
        Whether the rule applies only where no other rule of its stage found anything.
    check
        The function.
    """

    id: str
    title: str
    clause: str
    stage: Stage
    severity: Severity
    needs: tuple[str, ...]
    only_if_stage_passed: bool
    check: Check

    def apply(self, target: Any) -> list[Finding]:
        """Apply the rule to an FMU.

        Parameters
        ----------
        target
            An :class:`~cosim.conformance.fmu_archive.FmuArchive` or a :class:`~cosim.conformance.harness.Harness`,
            depending on the stage.

        Returns
        -------
        list of Finding
            Empty where the FMU conforms.

        Raises
        ------
        NotApplicableError
            If the rule does not apply to the FMU.
        """
        return [self.finding(message) for message in self.check(target) or ()]

    def finding(self, message: str) -> Finding:
        """Return a finding with a message, on one line.

        Parameters
        ----------
        message
            What, where, expected, got; :class:`Advice` for a warning.
        """
        return Finding(self.id, " ".join(message.split()), "warning" if isinstance(message, Advice) else self.severity)


def rule(
    name: str,
    title: str,
    *,
    clause: str = "",
    stage: Stage,
    severity: Severity = "error",
    needs: tuple[str, ...] = (),
    only_if_stage_passed: bool = False,
) -> Callable[[Check], Check]:
    """Register the decorated function as a rule.

    Parameters
    ----------
    name
        Id of the rule: group and name.
    title, clause, stage, severity, needs, only_if_stage_passed
        As the attributes of :class:`Rule`.

    Returns
    -------
    Callable
        A decorator that returns the function unchanged.
    """

    def register(check: Check) -> Check:
        assert name not in RULES, name
        RULES[name] = Rule(name, title, clause, stage, severity, needs, only_if_stage_passed, check)
        return check

    return register
