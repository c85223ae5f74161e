"""The server of :class:`cosim.conformance.process.RuleRunner`: forks a child process for each rule.

All modules are imported once, so that a rule costs a fork and not a start of Python. The server has no threads, so that
a fork copies no lock that another thread holds.
"""

from __future__ import annotations

import os
import pickle
import select
import signal
import tempfile
import time
import traceback
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from cosim.conformance import suite
from cosim.conformance.harness import Harness
from cosim.conformance.process import RuleRequest, RuleResult
from cosim.conformance.raw_instance import RawLibrary2, RawLibrary3
from cosim.conformance.rule import RULES, NotApplicableError
from cosim.errors import CosimError
from cosim.fmi.child_process import how_it_ended, parent_connection


def apply_rule(request: RuleRequest, output: Path) -> RuleResult:
    """Apply a rule in this process.

    Parameters
    ----------
    request
        The rule and the FMU.
    output
        File that receives the standard output and standard error of this process.

    Returns
    -------
    RuleResult
        Any exception becomes a finding.
    """
    rule = RULES[request.rule]
    assert request.description is not None
    try:
        return RuleResult(findings=rule.apply(Harness(request.description, request.folder, output)))
    except NotApplicableError as reason:
        return RuleResult(not_applicable=str(reason))
    except CosimError as error:
        return RuleResult(findings=[rule.finding(str(error))])
    except Exception as error:  # fmpy raises bare exceptions, and errors of the rule itself must be visible
        where = "".join(traceback.format_tb(error.__traceback__)[-1:]).split("\n")[0].strip()
        return RuleResult(findings=[rule.finding(f"{type(error).__name__}: {error} [{where}]")])


def _child(request: RuleRequest, pipe: int) -> None:
    """Apply a rule with a working folder and an output file of its own, write the result to a pipe and exit."""
    with suppress(BaseException):
        os.chdir(request.scratch)
        output = request.scratch.with_suffix(".out")
        file = os.open(output, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_APPEND)
        os.dup2(file, 1)
        os.dup2(file, 2)
        os.close(file)
        content = pickle.dumps(apply_rule(request, output))
        with os.fdopen(pipe, "wb") as stream:
            stream.write(content)
    os._exit(0)  # foreign libraries may crash at a regular exit


def run_in_child(request: RuleRequest, connection: Connection) -> RuleResult:
    """Apply a rule in a child process.

    The child is killed when the time limit has passed or the client has closed its connection.

    Parameters
    ----------
    request
        The rule and the FMU.
    connection
        Connection to the client.

    Returns
    -------
    RuleResult
        A child that was killed or crashed is a finding.
    """
    read_end, write_end = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(read_end)
        _child(request, write_end)
    os.close(write_end)
    content = _read_until(time.monotonic() + request.time_limit, read_end, connection.fileno())
    if content is None:
        os.kill(child, signal.SIGKILL)
    os.close(read_end)
    _, status = os.waitpid(child, 0)
    if content:
        result: RuleResult = pickle.loads(content)
        return result
    if content is None:
        message = (
            f"expected an end within {request.time_limit:g} s, got none: the FMU hangs, or is slow and needs a longer "
            "--time-limit"
        )
    else:
        message = f"expected a return, but the process {how_it_ended(os.waitstatus_to_exitcode(status))}"
    return RuleResult(findings=[RULES[request.rule].finding(message)])


def _read_until(deadline: float, pipe: int, client: int) -> bytes | None:
    """Read a pipe up to its end; None if the deadline passes or the client hangs up before."""
    content = b""
    poll = select.poll()
    poll.register(pipe, select.POLLIN)
    poll.register(client, 0)  # a hang-up is always reported
    while True:
        ready = poll.poll(max(0.0, 1000.0 * (deadline - time.monotonic())))
        if not ready or any(number == client for number, _ in ready):
            return None
        part = os.read(pipe, 1 << 16)
        if not part:
            return content
        content += part


def main() -> None:
    """Serve requests from the connection whose file descriptor is the first argument of the command line."""
    suite.load_rules()
    for library in (RawLibrary2, RawLibrary3):
        library.prototypes()  # cached for all children
    connection = parent_connection()
    description = None
    with tempfile.TemporaryDirectory() as scratch, suppress(EOFError, OSError):
        while True:
            request: Any = connection.recv()
            request.description = description = request.description or description
            folder = Path(scratch, request.rule)
            folder.mkdir(exist_ok=True)
            for file in folder.iterdir():
                with suppress(OSError):
                    file.unlink()
            request.scratch = folder
            connection.send(run_in_child(request, connection))
