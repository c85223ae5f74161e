"""An FMU in a process of its own: if it crashes or hangs, that process ends, and ours goes on.

The process is :mod:`cosim.fmi.worker`, which runs an :class:`cosim.fmi.instance.Instance` and is asked through a
socket. A step is one question and one answer: time, step size and inputs there, outputs back, as raw float64. That
costs 100 to 170 us more than a step in this process on a busy machine with two cores (``benchmarks/isolation.py``), a
quarter of it for the bytes to go there and back, the rest mostly for waking up.
"""

from __future__ import annotations

import os
import pickle
import select
import signal
import subprocess
import sys
import time as clock
from collections.abc import Mapping
from contextlib import AbstractContextManager, nullcontext, suppress
from multiprocessing import Pipe
from pathlib import Path
from typing import Any

import numpy as np

from cosim.errors import RunError, SetupError
from cosim.fmi import interrupts
from cosim.fmi.description import ModelDescription
from cosim.fmi.instance import Instance
from cosim.fmi.worker import VALUES, Answer
from cosim.units import Linear

TIME_LIMIT = 10.0
"""How long an isolated FMU may take to answer where nothing else is said, in s."""

MAX_TIME_LIMIT = 1e6
"""The largest limit, in s."""

LOADING_LIMIT = 60.0
"""How long it may take at least to start the process, load the FMU and instantiate it, in s."""

_WORKER = "from cosim.fmi.worker import main; main()"

_LOOK = 0.2
"""How long to wait for an answer between two looks at Ctrl-C, in s."""


class IsolatedInstance:
    """An instantiated FMU in a process of its own; outwardly like :class:`cosim.fmi.instance.Instance`.

    Inputs travel with the next question and outputs with every answer, so that it does not matter for the cost
    whether a loop calls ``step`` or its three parts.

    Parameters
    ----------
    name
        The component's name in its system.
    model
        What to instantiate.
    folder
        Where the FMU was extracted.
    time_limit
        How long a call may take, in s; the process of one that takes longer is killed.

    Raises
    ------
    SetupError
        If the system has no way to hand a socket on to another process (Windows).
    RunError
        If the FMU cannot be loaded or refuses to be instantiated, crashes or hangs in doing so.
    """

    def __init__(self, name: str, model: ModelDescription, folder: Path, time_limit: float = TIME_LIMIT) -> None:
        if os.name != "posix":
            raise SetupError(f"{name}: expected Linux or macOS for an isolated component, got {sys.platform}")
        self.name = name
        self.model = model
        self.warnings: list[str] = []
        self._time_limit = time_limit
        self._dead = False
        self._fresh = False
        self._time = 0.0
        self._values = np.zeros(2)
        self._outputs = np.zeros(0)
        self._table = np.zeros(0)
        self._sources = np.zeros(0, dtype=int)
        self._targets: dict[bool | None, tuple[Any, Any]] = {}
        self._connection, theirs = Pipe()
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-c", _WORKER, str(theirs.fileno())],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
                start_new_session=True,  # Ctrl-C is our business
            )
        self._poll = select.poll()
        self._poll.register(self._connection.fileno(), select.POLLIN)
        try:
            self._ask("load or instantiate", 0.0, ("load", name, model, folder), max(time_limit, LOADING_LIMIT))
        except BaseException:
            self._end()
            raise

    # ---- questions and answers ---------------------------------------------------------------------------------------

    def _ask(self, call: str, time: float, question: tuple[Any, ...], limit: float | None = None) -> None:
        """Have a method called in the process; see :func:`cosim.fmi.worker.serve`."""
        self._exchange(call, time, pickle.dumps(question), self._time_limit if limit is None else limit)
        self._fresh = False

    def _exchange(self, call: str, time: float, question: bytes, limit: float) -> None:
        """Put a question and take in the answer.

        Raises
        ------
        RunError
            If the FMU failed, its process ended, or took longer than ``limit`` s.
        """
        if self._dead:
            raise RunError(f"{self.name}: expected an FMU that can run, got one whose process has ended")
        try:
            self._connection.send_bytes(question)
            if not self._answered(limit):
                self._end()
                raise self._failed(call, time, f"expected an answer within {limit:g} s, got none")
            answer = self._connection.recv_bytes()
        except (EOFError, OSError):
            self._end(grace=1.0)
            raise self._failed(call, time, f"expected an answer, but {self._fate()}") from None
        except BaseException:  # an answer that nobody waits for would be taken for the next one
            self._end()
            raise
        self._take_in(answer)

    def _answered(self, limit: float) -> bool:
        deadline = clock.monotonic() + limit
        while not self._poll.poll(1000.0 * min(_LOOK, limit)):
            interrupts.check()
            if clock.monotonic() > deadline:
                return False
        return True

    def _take_in(self, answer: bytes) -> None:
        if answer.startswith(VALUES):
            self._outputs = np.frombuffer(answer, offset=len(VALUES))
            return
        found: Answer = pickle.loads(answer)
        self.warnings = found.warnings
        self._outputs = np.frombuffer(found.outputs)
        if found.error is not None:
            raise RunError(found.error)

    def _failed(self, call: str, time: float, reason: str) -> RunError:
        return RunError(f"{self.name}: {call} failed at t = {time:g} s: {reason}")

    def _fate(self) -> str:
        """Tell how the process ended."""
        code = self._process.returncode
        if code >= 0:
            return f"the process ended with exit code {code}"
        with suppress(ValueError):
            return f"the process ended by signal {-code} ({signal.Signals(-code).name})"
        return f"the process ended by signal {-code}"

    def _end(self, grace: float = 0.0) -> None:
        """See the process end, by force where it does not end by itself within ``grace`` s."""
        self._dead = True
        self._connection.close()
        try:
            self._process.wait(grace)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def calling(self, call: str, time: float = 0.0) -> AbstractContextManager[None]:
        """Nothing: what goes wrong over there comes back as a :class:`RunError` that says where."""
        return nullcontext()

    def listen(self, call: str, time: float) -> bool:
        """Nothing: what is printed over there is heard there."""
        return False

    def failure(self, error: Exception, call: str, time: float = 0.0) -> RunError:
        """Describe a failed call; what went wrong over there is described already."""
        return error if isinstance(error, RunError) else self._failed(call, time, str(error))

    # ---- wiring ------------------------------------------------------------------------------------------------------

    def wire(
        self,
        table: np.ndarray[Any, Any],
        outputs: Mapping[str, int],
        inputs: Mapping[str, tuple[int, Linear]],
    ) -> None:
        """Say where in the table of values each output goes and each connected input comes from.

        The FMU over there has a table of its own: the values its inputs are made of, then its outputs.
        """
        self._table = table
        self._sources = np.array([place for place, _ in inputs.values()], dtype=int)
        places, discrete = np.array(list(outputs.values()), dtype=int), [*map(self.model.is_discrete, outputs)]
        for which in (None, False, True):
            chosen = np.array([which in (None, d) for d in discrete], dtype=bool)
            self._targets[which] = places[chosen], np.flatnonzero(chosen)
        self._values = np.zeros(2 + len(inputs))
        there = {name: len(inputs) + i for i, name in enumerate(outputs)}
        taken = {name: (i, transformation) for i, (name, (_, transformation)) in enumerate(inputs.items())}
        self._ask("wire", 0.0, ("wire", there, taken))

    def calls(self) -> None:
        """Nothing: no loop in C can call functions of another process."""

    def set_inputs(self, time: float) -> None:
        """Note the values of all connected inputs for the next call, at a time in s."""
        self._values[2:] = self._table[self._sources]
        self._fresh = False

    def get_outputs(self, time: float, discrete: bool | None = None) -> None:
        """Get outputs into the table of values, at a time in s: all, those that are discrete, or those that are not."""
        if not self._fresh:
            self._values[:2] = time, 0.0
            self._exchange("initial exchange", time, VALUES + self._values.tobytes(), self._time_limit)
            self._fresh = True
        places, chosen = self._targets[discrete]
        self._table[places] = self._outputs[chosen]

    # ---- life cycle --------------------------------------------------------------------------------------------------

    def start(self, stop_time: float, values: Mapping[str, float | str]) -> None:
        """Enter the initialisation of a run."""
        self._ask("initialisation", 0.0, ("start", stop_time, dict(values)))

    def finish_initialisation(self) -> None:
        """Leave the initialisation."""
        self._ask("initialisation", 0.0, ("finish_initialisation",))

    def advance(self, time: float, step_size: float) -> None:
        """Step from ``time`` by ``step_size``, both in s, with the inputs noted last."""
        self._values[:2] = time, step_size
        self._exchange("doStep", time, VALUES + self._values.tobytes(), self._time_limit)
        self._fresh = True

    def step(self, time: float, step_size: float) -> None:
        """Take inputs, step from ``time`` by ``step_size`` (both in s), give outputs."""
        self.set_inputs(time)
        self.advance(time, step_size)
        self.get_outputs(time)

    def terminate(self, time: float = 0.0) -> None:
        """End a run at a time in s."""
        self._time = time
        if not self._dead:
            self._ask("terminate", time, ("terminate", time))

    def free(self) -> None:
        """Free the instance and end its process."""
        try:
            if not self._dead:
                self._ask("free", self._time, ("free",))
        except RunError as error:
            self.warnings = [*self.warnings, str(error).removeprefix(f"{self.name}: ")]
        self._end(grace=1.0)


AnyInstance = Instance | IsolatedInstance
"""What a master drives: an FMU in this process or in one of its own."""
