"""The other side of :mod:`cosim.fmi.isolated`: a process that runs one FMU and answers questions about it."""

from __future__ import annotations

import os
import pickle
import select
import signal
import sys
import threading
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from cosim.errors import CosimError
from cosim.fmi.instance import Instance, instantiate
from cosim.fmi.output_capture import Diversion

VALUES = b"values: "
"""What a message of raw float64 begins with, as long as one of them; all others are pickled."""


@dataclass
class Answer:
    """An answer that is more than the values of the outputs.

    Attributes
    ----------
    outputs
        Their values, float64.
    warnings
        All so far.
    error
        Why the call failed.
    """

    outputs: bytes = b""
    warnings: list[str] = field(default_factory=list)
    error: str | None = None


class Worker:
    """Holds the instance and does what is asked."""

    def __init__(self) -> None:
        self._instance: Instance | None = None
        self._table = np.zeros(0)
        self._inputs = self._outputs = self._table
        self._known = 0

    def answer(self, question: bytes) -> bytes:
        """Do what is asked; whatever goes wrong is part of the answer."""
        error = None
        try:
            if question.startswith(VALUES):
                self._exchange(np.frombuffer(question, offset=len(VALUES)))
            else:
                method, *arguments = pickle.loads(question)
                self._call(method, arguments)
        except CosimError as failure:
            error = str(failure)
        except Exception as failure:
            error = f"{type(failure).__name__} in the isolated process: {failure}"
        if question.startswith(VALUES) and error is None and not self._news():
            return VALUES + self._outputs.tobytes()
        warnings = self._instance.warnings if self._instance is not None else []
        return pickle.dumps(Answer(self._outputs.tobytes(), warnings, error))

    def _news(self) -> bool:
        """Whether the FMU said something since the last time."""
        assert self._instance is not None
        known, self._known = self._known, self._instance.messages.length
        return self._known > known

    def _exchange(self, values: np.ndarray[Any, Any]) -> None:
        """Take inputs, step if the step size is not zero, give outputs."""
        assert self._instance is not None
        time, step_size = values[:2].tolist()
        self._inputs[:] = values[2:]
        call = "doStep" if step_size else "initial exchange"
        try:
            if step_size:
                self._instance.step(time, step_size)
            else:
                self._instance.set_inputs(time)
                self._instance.get_outputs(time)
        except Exception as error:
            raise self._instance.failure(error, call, time) from error
        finally:
            self._instance.listen(call, time)

    def _call(self, method: str, arguments: list[Any]) -> None:
        if method == "load":
            self._instance = instantiate(*arguments)
        elif method == "wire":
            self._wire(*arguments)
        else:
            getattr(self._instance, method)(*arguments)

    def _wire(self, outputs: dict[str, int], inputs: dict[str, Any]) -> None:
        assert self._instance is not None
        self._table = np.zeros(len(inputs) + len(outputs))
        self._inputs, self._outputs = self._table[: len(inputs)], self._table[len(inputs) :]
        self._instance.wire(self._table, outputs, inputs)


def serve(connection: Connection) -> None:
    """Answer questions until there are no more; what the FMU prints becomes its warnings."""
    worker = Worker()
    with Diversion().on():
        while True:
            connection.send_bytes(worker.answer(connection.recv_bytes()))


def _end_with(connection: Connection) -> None:
    """End this process when the other side is gone, also in the middle of a call."""
    gone = select.poll()
    gone.register(connection.fileno(), 0)  # a hang-up comes unasked
    gone.poll()
    os._exit(0)  # foreign libraries may crash on a regular end


def main() -> None:
    """Serve the connection whose file descriptor is the first argument."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    connection = Connection(int(sys.argv[1]))
    threading.Thread(target=_end_with, args=[connection], daemon=True).start()
    try:
        serve(connection)
    except (EOFError, OSError):
        os._exit(0)


if __name__ == "__main__":
    main()
