"""Rules of behaviour in processes of their own: a crash or hang of the FMU is a finding, not the end of the tool."""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass, field
from pathlib import Path

from cosim.conformance.model_description import Description
from cosim.conformance.rule import Finding, NotApplicableError
from cosim.errors import RunError
from cosim.fmi.child_process import ChildProcess


@dataclass
class Question:
    """Which rule to apply to which FMU.

    Attributes
    ----------
    rule
        Id.
    description
        The FMU's.
    folder
        Where it was extracted.
    limit
        How long it may take, in s.
    scratch
        The child's working folder, which the server gives.
    """

    rule: str
    description: Description
    folder: Path
    limit: float
    scratch: Path = Path()


@dataclass
class Answer:
    """What a rule found, or why it does not apply."""

    findings: list[Finding] = field(default_factory=list)
    reason: str = ""


class Processes:
    """The server that forks a child for each rule; started at the first question, ended by the context.

    One of them serves any number of FMUs.
    """

    def __init__(self) -> None:
        self._process: ChildProcess | None = None

    def __enter__(self) -> Processes:
        return self

    def __exit__(self, *_: object) -> None:
        if self._process is not None:
            self._process.end()
            self._process = None

    def ask(self, question: Question) -> list[Finding]:
        """Apply a rule.

        Raises
        ------
        NotApplicableError
            If the FMU gives it nothing to look at, or this system has no way to fork.
        RunError
            If the server itself is gone.
        """
        if os.name != "posix":
            raise NotApplicableError(f"rules of behaviour need Linux or macOS, this is {sys.platform}")
        if self._process is None:
            self._process = ChildProcess("cosim.conformance.server", {"OPENBLAS_NUM_THREADS": "1"})
        try:
            self._process.connection.send(question)
            answer: Answer = self._process.connection.recv()
        except (EOFError, OSError):
            raise RunError(f"{question.rule}: expected an answer, but the process that runs FMUs has ended") from None
        if answer.reason:
            raise NotApplicableError(answer.reason)
        return answer.findings
