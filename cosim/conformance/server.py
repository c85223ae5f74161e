"""The process behind :mod:`cosim.conformance.process`: for each rule it forks a child that runs the FMU.

Everything is imported once, so that a rule costs a fork and no start of Python; and as nothing else runs here, no
thread and no lock of the tool's own is lost in a fork.
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
from cosim.conformance.harness import Bench
from cosim.conformance.process import Answer, Question
from cosim.conformance.raw_instance import Library2, Library3
from cosim.conformance.rule import RULES, NotApplicableError
from cosim.errors import CosimError
from cosim.fmi.child_process import how_it_ended, parent_connection


def answer(question: Question, output: Path) -> Answer:
    """Apply a rule in this process."""
    try:
        bench = Bench(question.description, question.folder, output)
        return Answer(findings=RULES[question.rule].apply(bench))
    except NotApplicableError as reason:
        return Answer(reason=str(reason))
    except CosimError as error:
        return Answer(findings=[RULES[question.rule].finding(str(error))])
    except Exception as error:  # fmpy raises bare exceptions; and a mistake of ours should be told, too
        where = "".join(traceback.format_tb(error.__traceback__)[-1:]).split("\n")[0].strip()
        return Answer(findings=[RULES[question.rule].finding(f"{type(error).__name__}: {error} [{where}]")])


def _child(question: Question, pipe: int) -> None:
    """Apply a rule, its folder and its output being its own; never returns."""
    with suppress(BaseException):
        os.chdir(question.scratch)
        output = question.scratch.with_suffix(".out")
        file = os.open(output, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_APPEND)
        os.dup2(file, 1)
        os.dup2(file, 2)
        os.close(file)
        content = pickle.dumps(answer(question, output))
        with os.fdopen(pipe, "wb") as stream:
            stream.write(content)
    os._exit(0)  # foreign libraries may crash on a regular end


def run(question: Question, connection: Connection) -> Answer:
    """Apply a rule in a child, which is killed after the time limit or when nobody waits for it any more."""
    theirs, ours = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(theirs)
        _child(question, ours)
    os.close(ours)
    deadline = time.monotonic() + question.limit
    content = b""
    poll = select.poll()
    poll.register(theirs, select.POLLIN)
    poll.register(connection.fileno(), 0)  # a hang-up comes unasked
    hung = False
    while True:
        ready = poll.poll(max(0.0, 1000.0 * (deadline - time.monotonic())))
        if not ready or any(number == connection.fileno() for number, _ in ready):
            hung = True
            os.kill(child, signal.SIGKILL)
            break
        part = os.read(theirs, 1 << 16)
        if not part:
            break
        content += part
    os.close(theirs)
    _, status = os.waitpid(child, 0)
    if content and not hung:
        found: Answer = pickle.loads(content)
        return found
    return Answer(findings=[RULES[question.rule].finding(_fate(question, status, hung))])


def _fate(question: Question, status: int, hung: bool) -> str:
    """Say how a child ended that gave no answer."""
    if hung:
        return f"expected an end within {question.limit:g} s, the FMU hung"
    return f"expected a return, but the process {how_it_ended(os.waitstatus_to_exitcode(status))}"


def main() -> None:
    """Serve the connection whose file descriptor is the first argument."""
    suite.load_rules()
    for library in (Library2, Library3):
        library.prototypes()  # once for all children
    connection = parent_connection()
    with tempfile.TemporaryDirectory() as scratch, suppress(EOFError, OSError):
        while True:
            question: Any = connection.recv()
            folder = Path(scratch, question.rule)
            folder.mkdir(exist_ok=True)
            for left in folder.iterdir():
                with suppress(OSError):
                    left.unlink()
            question.scratch = folder
            connection.send(run(question, connection))
