"""What a rule is: a function that looks at an FMU and yields what is wrong, with an id and the standard's clause.

A rule of the stages ``archive`` and ``description`` looks at files alone and takes a
:class:`cosim.conformance.fmu_archive.Subject`; a rule of ``behaviour`` runs the FMU, in a process of its own, and takes
a :class:`cosim.conformance.harness.Bench`. What it yields is a message each: what, where, expected, got; a rule that
merely needs calls to go well yields nothing, as a call that does not raises its message. A message that is ``Advice``
is a warning whatever the rule's severity.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Literal

Stage = Literal["archive", "description", "behaviour"]
Severity = Literal["error", "warning"]
Check = Callable[[Any], Iterable[str] | None]

RULES: dict[str, Rule] = {}
"""All rules by id, in the order in which they are applied; filled when their modules are imported."""


@dataclass(frozen=True)
class Finding:
    """Something wrong with an FMU.

    Attributes
    ----------
    rule
        Id of the rule that found it.
    message
        What, where, expected, got.
    severity
        ``error`` for what the standard demands, ``warning`` for what is wise.
    """

    rule: str
    message: str
    severity: Severity


class Advice(str):
    """A message of a warning."""

    __slots__ = ()


class NotApplicableError(Exception):
    """Raised by a rule that has nothing to look at in this FMU, saying why."""


@dataclass(frozen=True)
class Rule:
    """A rule of the suite.

    Attributes
    ----------
    id
        Subject and name, ``archive.paths``.
    title
        What holds in a good FMU.
    clause
        Where the standards say so; empty for what is merely wise.
    stage
        What it looks at.
    severity
        Of its findings.
    needs
        Ids of rules without which it makes no sense: it is not applicable where one of them found an error.
    last
        Whether it is a second opinion, asked only where no other rule of its stage found anything.
    check
        The function.
    """

    id: str
    title: str
    clause: str
    stage: Stage
    severity: Severity
    needs: tuple[str, ...]
    last: bool
    check: Check

    def apply(self, subject: Any) -> list[Finding]:
        """Apply the rule to what its stage takes.

        Raises
        ------
        NotApplicableError
            If there is nothing to look at.
        """
        return [self.finding(message) for message in self.check(subject) or ()]

    def finding(self, message: str) -> Finding:
        """Make a finding of a message."""
        return Finding(self.id, " ".join(message.split()), "warning" if isinstance(message, Advice) else self.severity)


def rule(
    name: str,
    title: str,
    *,
    clause: str = "",
    stage: Stage,
    severity: Severity = "error",
    needs: tuple[str, ...] = (),
    last: bool = False,
) -> Callable[[Check], Check]:
    """Register a function as a rule; parameters as the attributes of :class:`Rule`."""

    def register(check: Check) -> Check:
        assert name not in RULES, name
        RULES[name] = Rule(name, title, clause, stage, severity, needs, last, check)
        return check

    return register
