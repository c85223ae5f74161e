"""Run rules of the stage ``behaviour`` in separate processes: a crash or a hang of the FMU becomes a finding."""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass, field, replace
from pathlib import Path

from cosim.conformance.model_description import RawDescription
from cosim.conformance.rule import Finding, NotApplicableError
from cosim.errors import RunError
from cosim.fmi.child_process import ChildProcess


@dataclass
class RuleRequest:
    """A request to apply a rule to an FMU.

    Attributes
    ----------
    rule
        Id of the rule.
    description
        The FMU's model description; on the way to the server None where it is that of the request before.
    folder
        Where the FMU was extracted.
    time_limit
        How long the rule may take, in s.
    scratch
        Working folder of the child process; set by the server.
    """

    rule: str
    description: RawDescription | None
    folder: Path
    time_limit: float
    scratch: Path = Path()


@dataclass
class RuleResult:
    """The result of applying a rule.

    Attributes
    ----------
    findings
        What the rule found.
    not_applicable
        Why the rule does not apply; empty where it does.
    """

    findings: list[Finding] = field(default_factory=list)
    not_applicable: str = ""


class RuleRunner:
    """Applies rules in child processes of a server, one for each rule.

    The server is started at the first request and ended at the end of the context. One runner serves any number of
    FMUs.
    """

    def __init__(self) -> None:
        self._server: ChildProcess | None = None
        self._sent: RawDescription | None = None

    def __enter__(self) -> RuleRunner:
        return self

    def __exit__(self, *_: object) -> None:
        if self._server is not None:
            self._server.end()
            self._server = self._sent = None

    def run(self, request: RuleRequest) -> list[Finding]:
        """Apply a rule in a child process.

        Parameters
        ----------
        request
            The rule and the FMU.

        Returns
        -------
        list of Finding
            What the rule found.

        Raises
        ------
        NotApplicableError
            If the rule does not apply to the FMU, or this operating system cannot fork processes.
        RunError
            If the server has ended.
        """
        if os.name != "posix":
            raise NotApplicableError(f"rules of behaviour need Linux or macOS, this is {sys.platform}")
        if self._server is None:
            self._server = ChildProcess("cosim.conformance.server", {"OPENBLAS_NUM_THREADS": "1"})
        try:
            is_known = self._sent is not None and request.description is self._sent
            self._server.connection.send(replace(request, description=None) if is_known else request)
            self._sent = request.description
            result: RuleResult = self._server.connection.recv()
        except (EOFError, OSError):
            raise RunError(f"{request.rule}: expected a result, but the process that runs FMUs has ended") from None
        if result.not_applicable:
            raise NotApplicableError(result.not_applicable)
        return result.findings
