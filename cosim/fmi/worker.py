"""The process of an :class:`cosim.fmi.isolated.IsolatedInstance`: drives one FMU and answers requests."""

from __future__ import annotations

import os
import pickle
import select
import threading
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

from cosim.errors import CosimError, SetupError
from cosim.fmi.access import VariableMapping
from cosim.fmi.child_process import parent_connection
from cosim.fmi.description import ModelDescription
from cosim.fmi.instance import Instance
from cosim.fmi.output_capture import OutputCapture
from cosim.fmi.python_modules import clash
from cosim.fmi.versions import instantiate

VALUES = b"values: "
"""Prefix of a message of raw float64, as long as one of them; all other messages are pickled."""


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
    """Holds the instance and carries out requests."""

    def __init__(self) -> None:
        self._instance: Instance | None = None
        self._values = np.zeros(0)
        self._inputs = self._outputs = self._values
        self._reported = 0

    def answer(self, request: bytes) -> bytes:
        """Carry out a request; an exception becomes part of the answer.

        Parameters
        ----------
        request
            :data:`VALUES` and raw float64 (time, step size, inputs), or a pickled name of a method with its arguments.

        Returns
        -------
        bytes
            :data:`VALUES` and the outputs, or a pickled :class:`Answer`.
        """
        error = None
        try:
            if request.startswith(VALUES):
                self._step(np.frombuffer(request, offset=len(VALUES)))
            else:
                method, *arguments = pickle.loads(request)
                self._call(method, arguments)
        except CosimError as failure:
            error = str(failure)
        except Exception as failure:
            error = f"{type(failure).__name__} in the isolated process: {failure}"
        if request.startswith(VALUES) and error is None and not self._has_new_messages():
            return VALUES + self._outputs.tobytes()
        warnings = self._instance.warnings if self._instance is not None else []
        return pickle.dumps(Answer(self._outputs.tobytes(), warnings, error))

    def _has_new_messages(self) -> bool:
        assert self._instance is not None
        reported, self._reported = self._reported, self._instance.messages.length
        return self._reported > reported

    def _step(self, values: np.ndarray[Any, Any]) -> None:
        """Set inputs, step, get outputs."""
        assert self._instance is not None
        time, step_size = values[:2].tolist()
        self._inputs[:] = values[2:]
        try:
            self._instance.step(time, step_size)
        except Exception as error:
            raise self._instance.failure(error, "doStep", time) from error
        finally:
            self._instance.collect_stdout("doStep", time)

    def _call(self, method: str, arguments: list[Any]) -> None:
        if method == "load":
            self._load(*arguments)
        elif method == "map_variables":
            self._map_variables(*arguments)
        elif method == "exchange":
            self._initial_exchange(*arguments)
        else:
            getattr(self._instance, method)(*arguments)

    def _load(self, name: str, model: ModelDescription, folder: Path) -> None:
        if module := clash(folder):
            raise SetupError(
                f"{name}: expected Python modules of names that the isolated process does not use itself, got {module}"
            )
        self._instance = instantiate(name, model, folder)

    def _map_variables(self, mapping: VariableMapping) -> None:
        assert self._instance is not None
        inputs, outputs = (sum(map(len, each.values())) for each in (mapping.inputs, mapping.outputs))
        self._values = np.zeros(inputs + outputs)
        self._inputs, self._outputs = self._values[:inputs], self._values[inputs:]
        self._instance.map_variables(self._values, mapping)

    def _initial_exchange(self, time: float, inputs: tuple[str, ...], outputs: tuple[str, ...], values: bytes) -> None:
        """Set some inputs, get some outputs, without a step."""
        assert self._instance is not None
        self._inputs[:] = np.frombuffer(values)
        with self._instance.calling("initial exchange", time):
            self._instance.exchange(time, inputs, outputs)


def serve(connection: Connection) -> None:
    """Answer requests until the pipe is closed; what the FMU prints becomes its warnings.

    Parameters
    ----------
    connection
        The pipe.
    """
    worker = Worker()
    with OutputCapture().on():
        while True:
            connection.send_bytes(worker.answer(connection.recv_bytes()))


def _exit_with_parent(connection: Connection) -> None:
    """Exit when the parent has closed the pipe, also in the middle of a call."""
    closed = select.poll()
    closed.register(connection.fileno(), 0)  # a hang-up is always reported
    closed.poll()
    os._exit(0)  # foreign libraries may crash at a regular exit


def main() -> None:
    """Serve the process that started this one."""
    connection = parent_connection()
    threading.Thread(target=_exit_with_parent, args=[connection], daemon=True).start()
    try:
        serve(connection)
    except (EOFError, OSError):
        os._exit(0)


if __name__ == "__main__":
    main()
