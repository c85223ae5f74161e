"""How a run is made: every option once, with its check."""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field, replace
from typing import Concatenate, ParamSpec, TypeVar

from cosim.engine import native_stepper
from cosim.engine.clock import Clock
from cosim.engine.schedule import Decimation, decimations
from cosim.engine.structure import ALGORITHMS, Algorithm, Structure
from cosim.engine.unconnected_inputs import UnconnectedInputs
from cosim.errors import Problems, did_you_mean
from cosim.fmi.isolated import MAX_TIME_LIMIT, TIME_LIMIT
from cosim.fmi.values import Checked, Value
from cosim.results.result import STEPPERS, Sink, StepperName


@dataclass(frozen=True)
class CheckedRun:
    """Options that fit a system.

    Attributes
    ----------
    key
        What all but the values follows from.
    sizes
        Component to the sizes of its arrays, see :meth:`cosim.engine.structure.Structure.sizes`.
    clock
        Of the run.
    decimations
        Component to how it steps along with the communication steps.
    record
        Outputs to record, as ``component.element``.
    unconnected
        Component to how its unconnected inputs are resolved.
    notes
        What the user should know.
    values
        Component to variable to the value as its FMU takes it.
    """

    key: tuple[object, ...]
    sizes: dict[str, dict[int, int]]
    clock: Clock = Clock(1.0, 1)
    decimations: dict[str, Decimation] = field(default_factory=dict)
    record: list[str] = field(default_factory=list)
    unconnected: dict[str, UnconnectedInputs] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    values: dict[str, dict[str, Checked]] = field(default_factory=dict)


def _names(given: Iterable[str]) -> tuple[str, ...]:
    """Return names as a tuple; a text is one name, not its letters."""
    return (given,) if isinstance(given, str) else tuple(given)


@dataclass(frozen=True)
class RunOptions:
    """All options of a run.

    Attributes
    ----------
    stop_time, step_size
        Stop time and communication step size, in s; from the start time to the stop time there is a whole number of
        steps. Where None, the system's.
    parameters
        ``component.variable`` to value; all others start from their defaults, whatever ran before.
    record
        Outputs to record as ``component.variable``; all where None.
    progress
        Called with the simulated time reached, in s, some twenty times a second or after each longer step.
    record_every
        N: rows of t_0, t_N, t_2N, ... and of the stop time are recorded.
    start_time
        In s; where None, the system's, else that on which the default experiments of the FMUs agree, else 0.
    tolerance
        Relative tolerance for all FMUs; where None, each gets that of its default experiment.
    algorithm
        How components exchange values, see :data:`cosim.engine.structure.ALGORITHMS`; the system's where None.
    stepper
        Which loop steps the components, ``"c"`` or ``"python"``, with the same results; where None, the one in C if it
        is built and can call all FMUs.
    real_time
        Whether no step begins before its time has come.
    isolate
        Components whose FMUs run in processes of their own.
    time_limit
        How long a call of an isolated FMU may take, in s.
    capture_stdout
        Whether what FMUs print becomes warnings; otherwise it goes to this process's standard output.
    formats
        Files of the result beside CSV, see :data:`cosim.results.formats.FORMATS`; only where the run writes files.
    sinks
        What takes the rows as they come.
    keep
        Whether the result has the rows, too; where not, memory does not grow with the run.
    """

    stop_time: float | None = None
    step_size: float | None = None
    parameters: Mapping[str, Value] | None = None
    record: Iterable[str] | None = None
    progress: Callable[[float], None] | None = None
    _: KW_ONLY
    record_every: int = 1
    start_time: float | None = None
    tolerance: float | None = None
    algorithm: Algorithm | None = None
    stepper: StepperName | None = None
    real_time: bool = False
    isolate: Iterable[str] = ()
    time_limit: float = TIME_LIMIT
    capture_stdout: bool = True
    formats: Iterable[str] = ()
    sinks: Sequence[Sink] = ()
    keep: bool = True
    values: Mapping[str, Value] = field(init=False, repr=False)
    """The parameters, an empty mapping where None was given."""

    def __post_init__(self) -> None:
        """Copy what is given into tuples and a dict: iterators are read once."""
        names = {name: _names(getattr(self, name)) for name in ("isolate", "formats")}
        record = None if self.record is None else _names(self.record)
        for name, value in {**names, "record": record, "values": dict(self.parameters or {})}.items():
            object.__setattr__(self, name, value)

    def check(self, structure: Structure, previous: CheckedRun | None = None) -> CheckedRun:
        """Check all that can be checked before an FMU is loaded.

        Parameters
        ----------
        structure
            The system that is to run.
        previous
            Of the run before, of the same system: what follows from the same options is not checked again.

        Returns
        -------
        CheckedRun
            What the options mean for the system.

        Raises
        ------
        SetupError
            With all problems found.
        """
        problems = Problems()
        sizes = structure.sizes(self.values)
        times = self.stop_time, self.step_size, self.start_time
        given = tuple(self.values)
        key = (times, self.record, self.record_every, self.algorithm, self.stepper, sizes, given)
        if previous is not None and previous.key == key:
            checked = previous
        else:
            checked = self._check_all_but_values(structure, problems, CheckedRun(key, sizes))
        with problems.collected():
            values = structure.check_parameters(self.values, sizes, checked.unconnected)
        if self.isolate or self.time_limit != TIME_LIMIT:
            problems.found += isolation_problems(structure, self.isolate, self.time_limit)
        problems.raise_any()
        return replace(checked, values=values)

    def _check_all_but_values(self, structure: Structure, problems: Problems, checked: CheckedRun) -> CheckedRun:
        """Check what depends on names only."""
        problems.found += self._problems()
        notes: list[str] = []
        with problems.collected():
            clock = structure.clock(self.stop_time, self.step_size, self.start_time)
            own_steps = structure.own_steps(clock)
            steps = decimations(own_steps, list(structure.models), clock)
            checked = replace(checked, clock=clock, decimations=steps)
            notes += structure.time_notes(clock)
        with problems.collected():
            checked = replace(checked, record=structure.recorded(self.record, checked.sizes))
        unconnected = structure.unconnected_inputs(self.values)
        notes = [*structure.notes(self.values, unconnected), *notes]
        notes += structure.unrecorded() if self.record is None else []
        return replace(checked, unconnected=unconnected, notes=notes)

    def _problems(self) -> list[str]:
        """Find options that are wrong for every system."""
        problems = []
        if self.algorithm is not None and self.algorithm not in ALGORITHMS:
            problems.append(f"algorithm: expected {' or '.join(ALGORITHMS)}, got {self.algorithm}")
        if not isinstance(self.record_every, int) or self.record_every < 1:
            problems.append(f"record every: expected a whole number of steps above 0, got {self.record_every}")
        if self.tolerance is not None and not 0.0 < self.tolerance < math.inf:
            problems.append(f"tolerance: expected a finite number above 0, got {self.tolerance}")
        if self.stepper is not None and self.stepper not in STEPPERS:
            problems.append(f"stepper: expected {' or '.join(STEPPERS)}, got {self.stepper}")
        elif self.stepper == "c" and native_stepper.load() is None:
            problems.append(
                "stepper: expected the one in C to be built, got none of this version; run: seat-cosim build"
            )
        return problems


def isolation_problems(structure: Structure, components: Iterable[str], time_limit: float) -> list[str]:
    """Find what is wrong with the components to isolate and the time limit in s of their calls."""
    problems = [
        f"isolate {name}: expected a component among {', '.join(structure.models) or 'none'}, got none of that name"
        + did_you_mean(name, structure.models)
        for name in sorted(set(components).difference(structure.models))
    ]
    if not 0.0 < time_limit <= MAX_TIME_LIMIT:
        problems.append(f"time limit: expected more than 0 and at most {MAX_TIME_LIMIT:g} s, got {time_limit} s")
    return problems


P = ParamSpec("P")
Owner = TypeVar("Owner")
R = TypeVar("R")


def _decorator(
    options: Callable[P, RunOptions],
) -> Callable[[Callable[[Owner, RunOptions], R]], Callable[Concatenate[Owner, P], R]]:
    def decorate(method: Callable[[Owner, RunOptions], R]) -> Callable[Concatenate[Owner, P], R]:
        @functools.wraps(method)
        def call(owner: Owner, /, *args: P.args, **kwargs: P.kwargs) -> R:
            return method(owner, options(*args, **kwargs))

        own, *_ = inspect.signature(method).parameters.values()
        fields = inspect.signature(options).parameters.values()
        call.__signature__ = inspect.signature(method).replace(parameters=[own, *fields])  # type: ignore[attr-defined]
        return call

    return decorate


takes_run_options = _decorator(RunOptions)
"""Decorator of a method with one parameter ``options``: callers give the fields of :class:`RunOptions` as arguments."""
