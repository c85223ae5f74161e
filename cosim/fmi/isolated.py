"""An FMU in a process of its own: if it crashes or hangs, that process ends, and this one goes on.

The process runs :mod:`cosim.fmi.worker`, which drives a :class:`cosim.fmi.instance.Instance` and answers requests
through a pipe. A step is one request and one answer: time, step size and inputs there, outputs back, as raw float64.
That costs 100 to 170 us more than a step in this process on a busy machine with two cores
(``benchmarks/isolation.py``): a quarter of it for moving the bytes, the rest mostly for waking up.
"""

from __future__ import annotations

import os
import pickle
import sys
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np

from cosim.errors import RunError, SetupError
from cosim.fmi.access import VariableMapping
from cosim.fmi.child_process import ChildProcess
from cosim.fmi.description import ModelDescription
from cosim.fmi.instance import Experiment, Instance
from cosim.fmi.values import Checked
from cosim.fmi.worker import VALUES, Answer

TIME_LIMIT = 10.0
"""Default of how long a call of an isolated FMU may take, in s."""

MAX_TIME_LIMIT = 1e6
"""The largest limit, in s."""

LOADING_LIMIT = 60.0
"""How long it may take at least to start the process, load the FMU and instantiate it, in s."""


class IsolatedInstance:
    """An instantiated FMU in a process of its own, with the interface of :class:`cosim.fmi.instance.Instance`.

    Inputs travel with the next request and outputs with every answer, so that it does not matter for the cost whether a
    stepper calls ``step`` or its three parts.

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

    Attributes
    ----------
    warnings
        Warnings of this run and what was printed, each text once, with call and time.

    Raises
    ------
    SetupError
        If the system cannot pass a pipe on to another process (Windows).
    RunError
        If the FMU cannot be loaded or refuses to be instantiated, or crashes or hangs while that is tried.
    """

    def __init__(self, name: str, model: ModelDescription, folder: Path, time_limit: float = TIME_LIMIT) -> None:
        if os.name != "posix":
            raise SetupError(f"{name}: expected Linux or macOS for an isolated component, got {sys.platform}")
        self.name = name
        self.model = model
        self.warnings: list[str] = []
        self._time_limit = time_limit
        self._ended = False
        self._fresh = False  # whether the outputs are those of the inputs and the time
        self._noted = False  # whether there are inputs to set with the next exchange
        self._time = 0.0
        self._request = np.zeros(2)  # time, step size, inputs
        self._outputs = np.zeros(0)
        self._values = np.zeros(0)
        self._mapping = VariableMapping()
        self._sources = np.zeros(0, dtype=int)
        self._outputs_at: dict[str, list[int]] = {}
        self._targets: dict[bool | None, tuple[Any, Any]] = {}
        self._process = ChildProcess("cosim.fmi.worker", discard_output=True)
        try:
            self._call("load or instantiate", 0.0, ("load", name, model, folder), max(time_limit, LOADING_LIMIT))
        except BaseException:
            self._end()
            raise

    # ---- requests and answers ----------------------------------------------------------------------------------------

    def _call(self, call: str, time: float, request: tuple[Any, ...], limit: float | None = None) -> None:
        """Call a method in the process; see :func:`cosim.fmi.worker.serve`."""
        self._exchange(call, time, pickle.dumps(request), self._time_limit if limit is None else limit)
        self._fresh = False

    def _exchange(self, call: str, time: float, request: bytes, limit: float) -> None:
        """Send a request and read the answer.

        Raises
        ------
        RunError
            If the FMU failed, its process ended, or took longer than ``limit`` s.
        """
        if self._ended:
            raise RunError(f"{self.name}: expected an FMU that can run, got one whose process has ended")
        connection = self._process.connection
        try:
            connection.send_bytes(request)
            if not self._process.has_answered(limit):
                self._end()
                raise self._failed(call, time, f"expected an answer within {limit:g} s, got none")
            answer = connection.recv_bytes()
        except (EOFError, OSError):
            raise self._failed(call, time, f"expected an answer, but the process {self._end(grace=1.0)}") from None
        except BaseException:  # an answer that is not read would be taken for that to the next request
            self._end()
            raise
        self._read(answer)

    def _read(self, answer: bytes) -> None:
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

    def _end(self, grace: float = 0.0) -> str:
        """End the process, by force where it does not end by itself within ``grace`` s; returns how it ended."""
        self._ended = True
        return self._process.end(grace)

    def calling(self, call: str, time: float = 0.0) -> AbstractContextManager[None]:
        """Do nothing: the process turns exceptions into a :class:`RunError` that names the call.

        Parameters
        ----------
        call
            Name of the call.
        time
            Simulated time in s.

        Returns
        -------
        context manager
            Does nothing.
        """
        return nullcontext()

    def collect_stdout(self, call: str, time: float) -> bool:
        """Do nothing: the process collects what is printed in it.

        Parameters
        ----------
        call
            Name of the call.
        time
            Simulated time in s.

        Returns
        -------
        bool
            Always false.
        """
        return False

    def failure(self, error: Exception, call: str, time: float = 0.0) -> RunError:
        """Describe a failed call; the process has described its own failures already.

        Parameters
        ----------
        error
            The exception of the call.
        call
            Name of the call.
        time
            Simulated time in s.

        Returns
        -------
        RunError
            The error; it is not raised here.
        """
        return error if isinstance(error, RunError) else self._failed(call, time, str(error))

    # ---- variables ---------------------------------------------------------------------------------------------------

    def map_variables(self, values: np.ndarray[Any, Any], mapping: VariableMapping) -> None:
        """Map outputs and connected inputs to the table of values.

        The process has a table of its own: the values its inputs are made of, then its outputs.

        Parameters
        ----------
        values
            The table, float64.
        mapping
            Where the variables are in it.
        """
        self._values = values
        sources = [entry.index for entries in mapping.inputs.values() for entry in entries]
        outputs = [entry.index for entries in mapping.outputs.values() for entry in entries]
        sampled = [self.model.is_sampled(name) for name, entries in mapping.outputs.items() for _ in entries]
        self._sources, index = np.array(sources, dtype=int), np.array(outputs, dtype=int)
        for which in (None, False, True):
            chosen = np.array([which in (None, each) for each in sampled], dtype=bool)
            self._targets[which] = index[chosen], np.flatnonzero(chosen)
        self._request = np.zeros(2 + len(sources))
        places = count()
        theirs = VariableMapping(
            inputs={n: [replace(e, index=next(places)) for e in entries] for n, entries in mapping.inputs.items()},
            outputs={n: [replace(e, index=next(places)) for e in entries] for n, entries in mapping.outputs.items()},
        )
        self._outputs_at = {
            name: [entry.index - len(sources) for entry in entries] for name, entries in theirs.outputs.items()
        }
        self._mapping = mapping
        self._call("map variables", 0.0, ("map_variables", theirs))

    def native_calls(self) -> None:
        """Return None: the loop in C cannot call functions of another process."""

    def set_inputs(self, time: float) -> None:
        """Note the values of all connected inputs for the next call."""
        self._request[2:] = self._values[self._sources]
        self._fresh, self._noted = False, True

    def get_outputs(self, time: float, sampled: bool | None = None) -> None:
        """Get outputs into the table of values.

        Parameters
        ----------
        time
            Simulated time, in s.
        sampled
            True for those at the begin of a step, False for the others, None for all.
        """
        if not self._fresh:
            self.exchange(time, list(self._mapping.inputs) if self._noted else (), list(self._outputs_at))
            self._fresh = True
        index, chosen = self._targets[sampled]
        self._values[index] = self._outputs[chosen]

    def exchange(self, time: float, inputs: Sequence[str], outputs: Sequence[str]) -> None:
        """Set some connected inputs from the table of values, then get some outputs into it.

        Parameters
        ----------
        time
            Simulated time, in s.
        inputs, outputs
            Names of variables.
        """
        values = self._values[self._sources].tobytes()
        self._noted = False
        self._call("initial exchange", time, ("exchange", time, tuple(inputs), tuple(outputs), values))
        for name in outputs:
            for entry, place in zip(self._mapping.outputs[name], self._outputs_at[name], strict=True):
                self._values[entry.index] = self._outputs[place]

    # ---- life cycle --------------------------------------------------------------------------------------------------

    def enter_initialization(self, experiment: Experiment, values: Mapping[str, Checked]) -> None:
        """Enter the initialization of a run.

        Parameters
        ----------
        experiment
            Times and tolerance of the run.
        values
            Checked parameters and start values by variable name.
        """
        self._time = experiment.start_time
        self._call("initialisation", self._time, ("enter_initialization", experiment, dict(values)))

    def exit_initialization(self) -> None:
        """Exit the initialization."""
        self._call("initialisation", self._time, ("exit_initialization",))

    def do_step(self, time: float, step_size: float) -> None:
        """Step with the inputs noted last.

        Parameters
        ----------
        time, step_size
            Begin and length of the step, in s.
        """
        self._request[:2] = time, step_size
        self._exchange("doStep", time, VALUES + self._request.tobytes(), self._time_limit)
        self._fresh, self._noted = True, False

    def step(self, time: float, step_size: float) -> None:
        """Set inputs, step from ``time`` by ``step_size`` (both in s), get outputs.

        Parameters
        ----------
        time
            Begin of the step in s.
        step_size
            Its size in s.
        """
        self.set_inputs(time)
        self.do_step(time, step_size)
        self.get_outputs(time)

    def terminate(self, time: float = 0.0) -> None:
        """Terminate a run at a time in s."""
        self._time = time
        if not self._ended:
            self._call("terminate", time, ("terminate", time))

    def free(self) -> None:
        """Free the instance and end its process."""
        try:
            if not self._ended:
                self._call("free", self._time, ("free",))
        except RunError as error:
            self.warnings = [*self.warnings, str(error).removeprefix(f"{self.name}: ")]
        self._end(grace=1.0)


AnyInstance = Instance | IsolatedInstance
"""What a master drives: an FMU in this process or in one of its own."""
