"""The test harness of the rules of the stage ``behaviour``: instances, short runs with varying inputs, comparisons."""

from __future__ import annotations

import ctypes
import math
import os
import struct
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from cosim.conformance.model_description import RawDescription, RawVariable, parse_number
from cosim.conformance.raw_instance import (
    WARNING,
    CallFailedError,
    InstantiationError,
    RawInstance,
    RawLibrary,
    StepResult,
    Values,
    load_library,
)
from cosim.conformance.rule import NotApplicableError
from cosim.fmi.variable_types import FLOATS, INTEGERS

STEPS = 20
"""Number of steps of a run, unless the default experiment ends before."""

_OBSERVED = 300
"""How many variables besides the outputs are observed."""

_AMPLITUDE = 0.1
"""Amplitude of the inputs, relative to their start or nominal value."""

Row = dict[str, Values]
"""Name to values at one communication point."""


@dataclass(frozen=True)
class Experiment:
    """The experiment of a run.

    Attributes
    ----------
    start_time, step_size
        In s.
    steps
        Number of steps.
    """

    start_time: float
    step_size: float
    steps: int

    def time(self, k: int) -> float:
        """Return the time of the communication point k, in s.

        Parameters
        ----------
        k
            Index of the communication point, from 0.
        """
        return self.start_time + k * self.step_size


class Harness:
    """Runs an FMU in this process.

    Parameters
    ----------
    description
        The FMU's model description.
    folder
        Where the FMU was extracted.
    output
        File that receives the standard output and standard error of this process.
    """

    def __init__(self, description: RawDescription, folder: Path, output: Path) -> None:
        self.description = description
        self.folder = folder
        self._output = output

    @cached_property
    def library(self) -> RawLibrary:
        """The FMU's library, loaded at the first use."""
        return load_library(self.description, self.folder)

    # ---- instances ---------------------------------------------------------------------------------------------------

    def instantiate(self, name: str = "instance") -> RawInstance:
        """Instantiate the FMU with the description's GUID or token.

        Parameters
        ----------
        name
            Name of the instance.

        Returns
        -------
        RawInstance
            The instance, not initialized.

        Raises
        ------
        InstantiationError
            If the FMU returns a null pointer.
        """
        self.library.instances += 1
        pointer = self.library.instantiate(name, self.description.token)
        if not pointer:
            token = "guid" if self.description.fmi_major == 2 else "instantiationToken"
            raise InstantiationError(
                f"expected an instance with the description's {token} {self.description.token}, got none"
                f"{self.library.last_message()}"
            )
        return RawInstance(self.library, pointer)

    @contextmanager
    def instance(self, name: str = "instance") -> Iterator[RawInstance]:
        """Instantiate the FMU, and free the instance at the end.

        Parameters
        ----------
        name
            Name of the instance.

        Yields
        ------
        RawInstance
            The instance, not initialized.
        """
        instance = self.instantiate(name)
        yield instance  # after an error the process ends, and nothing needs to be freed
        instance.free()

    @contextmanager
    def initialized(self, name: str = "instance") -> Iterator[RawInstance]:
        """Instantiate and initialize the FMU; terminate and free the instance at the end.

        Parameters
        ----------
        name
            Name of the instance.

        Yields
        ------
        RawInstance
            The instance, in step mode.
        """
        with self.instance(name) as instance:
            self.initialize(instance)
            yield instance
            instance.call_ok("Terminate")

    def initialize(self, instance: RawInstance, stop_time: float | None = None) -> None:
        """Initialize an instance with the start values of the description.

        Parameters
        ----------
        instance
            A new instance.
        stop_time
            Stop time of the experiment in s; none is defined where it is None.

        Raises
        ------
        CallFailedError
            If a call fails.
        """
        instance.enter_initialization_mode(self.experiment.start_time, stop_time)
        instance.exit_initialization_mode()

    # ---- the run -----------------------------------------------------------------------------------------------------

    @cached_property
    def experiment(self) -> Experiment:
        """The default experiment of the description, limited to :data:`STEPS` steps."""
        declared = self.description.default_experiment
        start = parse_number(declared.get("startTime")) or 0.0
        stop = parse_number(declared.get("stopTime"))
        internal = parse_number(self.description.co_simulation.get("fixedInternalStepSize"))
        size = parse_number(declared.get("stepSize")) or internal or ((stop - start) / 100 if stop else 0.01)
        if not (math.isfinite(size) and size > 0.0):
            size = 0.01
        possible = math.floor((stop - start) / size * (1 + 1e-9)) if stop and stop > start else STEPS
        return Experiment(start, size, max(1, min(STEPS, possible)))

    def start_values(self, variable: RawVariable) -> Values:
        """Convert a variable's start values to the Python types in which the FMU returns its values.

        Parameters
        ----------
        variable
            One of :attr:`readable`, with start values or without.

        Returns
        -------
        tuple
            One for each element of an array, also where the description has one for all; empty without start values.
        """
        values = tuple(_parse(variable.type, text) for text in variable.start or ())
        return values * self.library.value_count(variable) if len(values) == 1 else values

    @cached_property
    def inputs(self) -> list[RawVariable]:
        """Inputs with floating-point values; only these vary during a run."""
        return [v for v in self.readable if v.causality == "input" and v.type in FLOATS and v.start]

    def input_values(self, k: int) -> Row:
        """Return the values of the inputs at a communication point: sines around the start values, within the bounds.

        Parameters
        ----------
        k
            Index of the communication point.
        """
        row: Row = {}
        for i, v in enumerate(self.inputs):
            amplitude = _AMPLITUDE * (abs(v.nominal) if v.nominal else 1.0)
            centre = self.start_values(v)
            moved = (x + (abs(x) * _AMPLITUDE or amplitude) * math.sin(0.7 * k + i) for x in centre)
            low = -math.inf if v.minimum is None else v.minimum
            high = math.inf if v.maximum is None else v.maximum
            row[v.name] = tuple(min(max(x, low), high) for x in moved)
        return row

    def set_inputs(self, instance: RawInstance, k: int) -> None:
        """Set the inputs for the step that begins at a communication point.

        Parameters
        ----------
        instance
            An initialized instance.
        k
            Index of the communication point.

        Raises
        ------
        CallFailedError
            If the FMU rejects a value.
        """
        values = self.input_values(k)
        for v in self.inputs:
            if instance.set_values(v, values[v.name]) > WARNING:
                message = f"{v}: expected {values[v.name]} to be accepted, got an error{self.library.last_message()}"
                raise CallFailedError(message)

    @cached_property
    def readable(self) -> list[RawVariable]:
        """Variables of all types but clocks, without arrays of invalid dimensions."""
        found = self.description
        return [v for v in found.variables if v.type in self.library.TYPES and found.shape(v) is not None]

    @cached_property
    def observed(self) -> list[RawVariable]:
        """Variables that are read after each step: all outputs, and a limited number of the others."""
        outputs = [v for v in self.readable if v.causality == "output"]
        return outputs + [v for v in self.readable if v.causality != "output"][:_OBSERVED]

    def do_step(self, instance: RawInstance, k: int) -> StepResult:
        """Set the inputs and make the step that begins at a communication point.

        Parameters
        ----------
        instance
            An initialized instance.
        k
            Index of the communication point.

        Returns
        -------
        StepResult
            Its status is ok or a warning, unless the FMU requests the end.

        Raises
        ------
        CallFailedError
            If a call fails.
        """
        self.set_inputs(instance, k)
        return instance.do_step(self.experiment.time(k), self.experiment.step_size)

    def run(self, instance: RawInstance, first: int = 0, last: int | None = None) -> list[Row]:
        """Make steps and read the observed variables after each; stop where the FMU requests the end.

        Parameters
        ----------
        instance
            An initialized instance.
        first, last
            Indices of the first and last communication point; ``last`` is the experiment's last one by default.

        Returns
        -------
        list of dict
            One row for each step.

        Raises
        ------
        CallFailedError
            If a call fails.
        """
        rows = []
        for k in range(first, self.experiment.steps if last is None else last):
            result = self.do_step(instance, k)
            rows.append(instance.get_values(self.observed))
            if result.terminate:
                break
        return rows

    @cached_property
    def middle_step(self) -> int:
        """Index of the communication point in the middle of the experiment.

        Raises
        ------
        NotApplicableError
            If the experiment has less than four steps.
        """
        if self.experiment.steps < 4:
            raise NotApplicableError("the default experiment has less than four steps")
        return self.experiment.steps // 2

    # ---- output and capabilities -------------------------------------------------------------------------------------

    def captured_output(self) -> str:
        """Return what this process has written to standard output and standard error so far."""
        sys.stdout.flush()
        sys.stderr.flush()
        ctypes.CDLL(None).fflush(None)
        return self._output.read_text(errors="replace")

    def require_capability(self, capability: str) -> None:
        """Continue only if the FMU declares a capability.

        Parameters
        ----------
        capability
            Its name in FMI 3.0.

        Raises
        ------
        NotApplicableError
            If the FMU does not declare it.
        """
        if not self.description.has_capability(capability):
            raise NotApplicableError(f"the FMU does not declare {capability}")

    @property
    def instantiates_once(self) -> bool:
        """Whether the FMU declares that a process may have one instance of it only."""
        return self.description.has_capability("canBeInstantiatedOnlyOncePerProcess")


def bit_patterns(values: Values) -> tuple[object, ...]:
    """Replace floats by their bytes, so that comparison finds NaN equal to itself and 0 different from -0.

    Parameters
    ----------
    values
        Values of one variable.

    Returns
    -------
    tuple
        The values, floats as bytes.
    """
    return tuple(struct.pack("d", value) if isinstance(value, float) else value for value in values)


def first_difference(expected: Sequence[Row], got: Sequence[Row], experiment: Experiment, first: int = 0) -> str:
    """Describe the first difference between two runs.

    Parameters
    ----------
    expected, got
        Rows of the two runs.
    experiment
        Experiment of both runs.
    first
        Index of the communication point at the beginning of the first step.

    Returns
    -------
    str
        Empty if the runs are equal to the bit.
    """
    if len(expected) != len(got):
        return f"expected {len(expected)} steps, got {len(got)}"
    for k, (one, other) in enumerate(zip(expected, got, strict=True), first + 1):
        if text := row_difference(one, other):
            return f"at t = {experiment.time(k):g} s: {text}"
    return ""


def row_difference(expected: Row, got: Row) -> str:
    """Describe the difference between two rows.

    Parameters
    ----------
    expected, got
        The rows.

    Returns
    -------
    str
        Empty if the rows are equal to the bit.
    """
    names = [name for name in expected if bit_patterns(expected[name]) != bit_patterns(got[name])]
    if not names:
        return ""
    more = f" (and {len(names) - 1} more)" if len(names) > 1 else ""
    return f"{names[0]}: expected {format_values(expected[names[0]])}, got {format_values(got[names[0]])}{more}"


def format_values(values: Values) -> str:
    """Format the values of a variable for a message; long ones are shortened.

    Parameters
    ----------
    values
        Values of one variable.

    Returns
    -------
    str
        At most four values, or 80 characters of one.
    """
    words = [value.decode(errors="replace") if isinstance(value, bytes) else repr(value) for value in values]
    text = ", ".join(words[:4])
    return f"[{text}{', …' if len(words) > 4 else ''}]" if len(words) != 1 else text[:80]


def number(type_name: str, value: float) -> float | int:
    """Convert a number to what the FMU returns for it.

    Parameters
    ----------
    type_name
        Type of a variable, of floats or integers.
    value
        In its range.

    Returns
    -------
    float or int
        A float of single precision for Float32.
    """
    if type_name == "Float32":
        return float(struct.unpack("f", struct.pack("f", value))[0])
    return float(value) if type_name in FLOATS else int(value)


def _parse(type_name: str, text: str) -> object:
    if type_name in FLOATS:
        return number(type_name, float(text))
    if type_name in (*INTEGERS, "Enumeration"):
        return int(text)
    if type_name == "Boolean":
        return text in ("true", "1")
    return bytes.fromhex(text) if type_name == "Binary" else text.encode()


def file_stats(folder: Path) -> dict[str, tuple[int, int]]:
    """Return the files in a folder, without those in Python's caches.

    Parameters
    ----------
    folder
        The folder; searched recursively.

    Returns
    -------
    dict
        Path relative to the folder, to size in bytes and modification time in ns.
    """
    found = {}
    for place, _, names in os.walk(folder):
        for name in names:
            path = Path(place, name)
            if "__pycache__" not in path.parts:
                stat = path.stat()
                found[str(path.relative_to(folder))] = stat.st_size, stat.st_mtime_ns
    return found
