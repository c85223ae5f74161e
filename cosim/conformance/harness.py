"""Where rules of behaviour run an FMU: instances, short runs with moving inputs, and how values are compared."""

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

from cosim.conformance.model_description import FLOATS, INTEGERS, Description, Variable, number
from cosim.conformance.raw_instance import WARNING, Library, RefusedError, Slave, Step, Values, load
from cosim.conformance.rule import NotApplicableError

STEPS = 20
"""How many steps a run has where the experiment does not end before."""

_OBSERVED = 300
"""How many variables are looked at beside the outputs."""

_AMPLITUDE = 0.1
"""How far inputs move, relative to their start or nominal value."""

Row = dict[str, Values]


@dataclass(frozen=True)
class Experiment:
    """When a run begins, the size of its steps (both in s), and how many there are."""

    start: float
    size: float
    steps: int

    def time(self, k: int) -> float:
        """Return the time of a communication point in s."""
        return self.start + k * self.size

    @property
    def stop(self) -> float:
        """The end, in s."""
        return self.time(self.steps)


class Bench:
    """An FMU in the process that runs it.

    Parameters
    ----------
    description
        The FMU's.
    folder
        Where it was extracted.
    output
        File that takes what is written to standard output and standard error.
    """

    def __init__(self, description: Description, folder: Path, output: Path) -> None:
        self.description = description
        self.folder = folder
        self._output = output

    @cached_property
    def library(self) -> Library:
        """The FMU's library, loaded at first use."""
        return load(self.description, self.folder)

    # ---- instances ---------------------------------------------------------------------------------------------------

    def make(self, name: str = "it") -> Slave:
        """Instantiate the FMU.

        Raises
        ------
        RefusedError
            If it does not let itself be instantiated.
        """
        pointer = self.library.make(name, self.description.token)
        if not pointer:
            what = "guid" if self.description.standard == 2 else "instantiationToken"
            raise RefusedError(
                f"expected an instance with the description's {what} {self.description.token}, got none"
                f"{self.library.complaint()}"
            )
        return Slave(self.library, pointer)

    @contextmanager
    def instance(self, name: str = "it") -> Iterator[Slave]:
        """Instantiate the FMU, and free the instance at the end."""
        slave = self.make(name)
        yield slave  # after an error the process ends, and nothing needs to be freed
        slave.free()

    @contextmanager
    def started(self, name: str = "it", stop: float | None = None) -> Iterator[Slave]:
        """Instantiate and initialise the FMU; terminate and free it at the end."""
        with self.instance(name) as slave:
            self.start(slave, stop)
            yield slave
            slave.demand("Terminate")

    def start(self, slave: Slave, stop: float | None = None) -> None:
        """Initialise an instance with the start values of its description."""
        slave.enter(self.experiment.start, stop)
        slave.leave()

    # ---- the run -----------------------------------------------------------------------------------------------------

    @cached_property
    def experiment(self) -> Experiment:
        """The description's default experiment, as much of it as is run."""
        given = self.description.experiment
        start = number(given.get("startTime")) or 0.0
        stop = number(given.get("stopTime"))
        internal = number(self.description.co_simulation.get("fixedInternalStepSize"))
        size = number(given.get("stepSize")) or internal or ((stop - start) / 100 if stop else 0.01)
        if not (math.isfinite(size) and size > 0.0):
            size = 0.01
        fitting = math.floor((stop - start) / size * (1 + 1e-9)) if stop and stop > start else STEPS
        return Experiment(start, size, max(1, min(STEPS, fitting)))

    @cached_property
    def inputs(self) -> list[Variable]:
        """Inputs that are real numbers, which is what moves."""
        return [v for v in self.description.variables if v.causality == "input" and v.type in FLOATS and v.start]

    def stimulus(self, k: int) -> Row:
        """Return the values of the inputs at a communication point: around their start, inside their bounds."""
        found: Row = {}
        for i, v in enumerate(self.inputs):
            amplitude = _AMPLITUDE * (abs(v.nominal) if v.nominal else 1.0)
            centre = [float(text) for text in v.start or ()]
            moved = (x + (abs(x) * _AMPLITUDE or amplitude) * math.sin(0.7 * k + i) for x in centre)
            low = -math.inf if v.minimum is None else v.minimum
            high = math.inf if v.maximum is None else v.maximum
            found[v.name] = tuple(min(max(x, low), high) for x in moved)
        return found

    def feed(self, slave: Slave, k: int) -> None:
        """Set the inputs for the step that begins at a communication point."""
        values = self.stimulus(k)
        for v in self.inputs:
            status = slave.set(v, values[v.name])
            if status > WARNING:
                raise RefusedError(f"{v}: expected to take {values[v.name]}, refused it{self.library.complaint()}")

    @cached_property
    def observed(self) -> list[Variable]:
        """Variables that are looked at after each step: all outputs, and of the others not more than a few hundred."""
        readable = [v for v in self.description.variables if v.type in self.library.TYPES]
        outputs = [v for v in readable if v.causality == "output"]
        return outputs + [v for v in readable if v.causality != "output"][:_OBSERVED]

    def advance(self, slave: Slave, k: int) -> Step:
        """Feed the inputs and make the step that begins at a communication point."""
        self.feed(slave, k)
        return slave.step(self.experiment.time(k), self.experiment.size)

    def run(self, slave: Slave, first: int = 0, last: int | None = None) -> list[Row]:
        """Make steps and look after each; ends early where the FMU asks for it.

        Parameters
        ----------
        slave
            An initialised instance.
        first, last
            Communication points; the last of the experiment by default.
        """
        rows = []
        for k in range(first, self.experiment.steps if last is None else last):
            step = self.advance(slave, k)
            rows.append(slave.get(self.observed))
            if step.ended:
                break
        return rows

    @cached_property
    def middle(self) -> int:
        """The communication point half-way.

        Raises
        ------
        NotApplicableError
            If the FMU's experiment is too short to have one.
        """
        if self.experiment.steps < 4:
            raise NotApplicableError("the default experiment has less than four steps")
        return self.experiment.steps // 2

    # ---- what else it does -------------------------------------------------------------------------------------------

    def printed(self) -> str:
        """Return what this process wrote to standard output and standard error so far."""
        sys.stdout.flush()
        sys.stderr.flush()
        ctypes.CDLL(None).fflush(None)
        return self._output.read_text(errors="replace")

    def can(self, capability: str) -> None:
        """Go on only if the FMU declares a capability.

        Raises
        ------
        NotApplicableError
            If it does not.
        """
        if not self.description.can(capability):
            raise NotApplicableError(f"the FMU does not declare {capability}")

    def several(self) -> None:
        """Go on only if several instances may live in a process; exceptions as those of :meth:`can`."""
        if self.description.can("canBeInstantiatedOnlyOncePerProcess"):
            raise NotApplicableError("the FMU can be instantiated only once per process")


def bits(values: Values) -> tuple[object, ...]:
    """Return values in a form in which they are equal if their bits are; NaN to itself, 0 not to -0."""
    return tuple(struct.pack("d", value) if isinstance(value, float) else value for value in values)


def difference(expected: Sequence[Row], got: Sequence[Row], experiment: Experiment, first: int = 0) -> str:
    """Say where two runs differ first; empty if they do not.

    Parameters
    ----------
    expected, got
        Rows of both, the first after the step that begins at ``first``.
    """
    if len(expected) != len(got):
        return f"expected {len(expected)} steps, got {len(got)}"
    for k, (one, other) in enumerate(zip(expected, got, strict=True), first + 1):
        if text := changed(one, other):
            return f"at t = {experiment.time(k):g} s: {text}"
    return ""


def changed(expected: Row, got: Row) -> str:
    """Say which variables differ in two rows; empty if none does."""
    found = [name for name in expected if bits(expected[name]) != bits(got[name])]
    if not found:
        return ""
    more = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
    return f"{found[0]}: expected {show(expected[found[0]])}, got {show(got[found[0]])}{more}"


def show(values: Values) -> str:
    """Write values for a message."""
    words = [value.decode(errors="replace") if isinstance(value, bytes) else repr(value) for value in values]
    text = ", ".join(words[:4])
    return f"[{text}{', …' if len(words) > 4 else ''}]" if len(words) != 1 else text[:80]


def parsed(variable: Variable) -> Values:
    """Return a variable's start values as the FMU gives them."""
    return tuple(_parse(variable.type, text) for text in variable.start or ())


def _parse(kind: str, text: str) -> object:
    if kind == "Float32":
        return struct.unpack("f", struct.pack("f", float(text)))[0]
    if kind in FLOATS:
        return float(text)
    if kind in (*INTEGERS, "Enumeration"):
        return int(text)
    if kind == "Boolean":
        return text in ("true", "1")
    return bytes.fromhex(text) if kind == "Binary" else text.encode()


def entries(folder: Path) -> dict[str, tuple[int, int]]:
    """Return the files in a folder: path to size and time of change; what Python caches aside."""
    found = {}
    for place, _, names in os.walk(folder):
        for name in names:
            path = Path(place, name)
            if "__pycache__" not in path.parts:
                stat = path.stat()
                found[str(path.relative_to(folder))] = stat.st_size, stat.st_mtime_ns
    return found
