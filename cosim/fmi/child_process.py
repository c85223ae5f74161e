"""A child process that is asked through a pipe: started, given a time limit, ended, and how it ended."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from multiprocessing import Pipe
from multiprocessing.connection import Connection

from cosim.fmi import interrupts

_INTERVAL = 0.2
"""How long to wait for an answer between two checks for an interrupt, in s."""


def how_it_ended(code: int) -> str:
    """Describe the end of a process.

    Parameters
    ----------
    code
        Its exit code; minus the signal's number where a signal ended it.

    Examples
    --------
    >>> how_it_ended(3)
    'ended with exit code 3'
    >>> how_it_ended(-11)
    'ended by signal 11 (SIGSEGV)'
    """
    if code >= 0:
        return f"ended with exit code {code}"
    try:
        return f"ended by signal {-code} ({signal.Signals(-code).name})"
    except ValueError:
        return f"ended by signal {-code}"


class ChildProcess:
    """A Python process that runs a function of a module with a pipe to this process.

    The function finds the pipe by :func:`parent_connection`. The child is in a session of its own, so that an interrupt
    of the terminal does not reach it.

    Parameters
    ----------
    module
        Name of a module whose ``main`` the process calls.
    environment
        Environment variables beside those of this process.
    discard_output
        Whether what the process prints to standard output is discarded.

    Attributes
    ----------
    connection
        This end of the pipe.
    """

    def __init__(self, module: str, environment: Mapping[str, str] | None = None, discard_output: bool = False) -> None:
        self.connection, theirs = Pipe()
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-c", f"from {module} import main; main()", str(theirs.fileno())],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL if discard_output else None,
                env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path)), **(environment or {})},
                start_new_session=True,
            )
        self._poll = select.poll()
        self._poll.register(self.connection.fileno(), select.POLLIN)

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._process.pid

    def has_answered(self, limit: float) -> bool:
        """Wait for an answer.

        Parameters
        ----------
        limit
            How long, in s.

        Returns
        -------
        bool
            Whether there is one, or the process has closed the pipe.

        Raises
        ------
        KeyboardInterrupt
            If the user interrupted.
        """
        deadline = time.monotonic() + limit
        while not self._poll.poll(1000.0 * min(_INTERVAL, limit)):
            interrupts.check()
            if time.monotonic() > deadline:
                return False
        return True

    def end(self, grace: float | None = None) -> str:
        """Close the pipe and wait for the end of the process.

        Parameters
        ----------
        grace
            How long to wait before the process is killed, in s; for ever where None.

        Returns
        -------
        str
            How it ended, see :func:`how_it_ended`.
        """
        self.connection.close()
        try:
            self._process.wait(grace)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        return how_it_ended(self._process.returncode)


def parent_connection() -> Connection:
    """Return the pipe to the process that started this one; signals to all processes are the parent's business."""
    for number in (signal.SIGINT, *interrupts.ENDING):
        signal.signal(number, signal.SIG_IGN)
    return Connection(int(sys.argv[1]))
