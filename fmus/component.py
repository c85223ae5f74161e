"""What the project calls a component: an interface of variables and two pure functions over it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints

from fmus.variables import TIME, Terminal, Variable, variables_of

SAME_TIME = 1e-9
"""Relative (above 1 s) or absolute (below, in s) distance within which two times are the same."""

LATEST_TIME = 1e9
"""Largest magnitude of a time, in s: 30 years, where times are still told apart to 1e-7 s."""

LONGEST_STEP = 1e3
"""Longest communication step, in s: a longer one would take so long that it looked like a hang."""

FARTHEST_TICK = 1.0
"""How far a state's own clock may be from the time reached, in s, hosts' rounding errors at late times included."""


class ParameterError(ValueError):
    """Parameters that are each within their range but contradict one another."""


class DefaultExperiment(NamedTuple):
    """What a description recommends to a host.

    Attributes
    ----------
    stop_time
        End of the experiment, in s; it starts at 0.
    step_size
        Communication step size, in s.
    """

    stop_time: float
    step_size: float


class StateField(NamedTuple):
    """One field of a state.

    Attributes
    ----------
    path
        Its name, or the names that lead to it through nested states, joined by dots.
    kind
        ``float``, ``int`` or ``bool``, of each number.
    length
        How many numbers, None where it is one and no tuple.
    used
        Path of the field that tells how many of them are in use, the others being zero; None where all are.
    """

    path: str
    kind: type
    length: int | None
    used: str | None = None


class _Part(NamedTuple):
    """A part of a state: as :class:`StateField`, its kind a class where it is a state itself."""

    name: str
    kind: type
    length: int | None
    used: str | None

    @property
    def is_state(self) -> bool:
        return hasattr(self.kind, "_fields")


@cache
def _parts(state: type) -> tuple[_Part, ...]:
    """Read the parts of a state class; cached, as its module may not be found any more later."""
    parts = []
    for name, hint in get_type_hints(state, include_extras=True).items():
        if get_origin(hint) is Annotated:
            numbers, length, *used = get_args(hint)
            parts.append(_Part(name, get_args(numbers)[0], length, used[0] if used else None))
        else:
            parts.append(_Part(name, hint, None, None))
    return tuple(parts)


@cache
def state_fields(state: type, prefix: str = "") -> tuple[StateField, ...]:
    """Read the fields of a state class, those of nested states in their place.

    A tuple of n numbers is declared ``Annotated[tuple[float, ...], n]``. The last field of all may be one of which only
    a part is in use: ``Annotated[tuple[float, ...], n, "field"]``, where its neighbour ``field`` says how many numbers.
    """
    fields: list[StateField] = []
    for part in _parts(state):
        if part.is_state:
            fields += state_fields(part.kind, f"{prefix}{part.name}.")
        else:
            used = prefix + part.used if part.used else None
            fields.append(StateField(prefix + part.name, part.kind, part.length, used))
    return tuple(fields)


def numbers_of(state: Any) -> list[float]:
    """Write a state as a flat list of numbers."""
    if not isinstance(state, tuple):
        return [float(state)]
    return [number for part in state for number in numbers_of(part)]


def state_of(state: type, numbers: Iterable[float]) -> Any:
    """Read a state of a class from what :func:`numbers_of` wrote."""
    rest = iter(numbers)

    def read(part: _Part) -> Any:
        if part.is_state:
            return state_of(part.kind, rest)
        if part.length is None:
            return part.kind(next(rest))
        return tuple(part.kind(next(rest)) for _ in range(part.length))

    return state(*map(read, _parts(state)))


@dataclass(frozen=True)
class Component:
    """A model that can become an FMU, in any flavour.

    The state is a ``NamedTuple`` of numbers, tuples of numbers and further such states, so it can be saved, compared
    and restored as it is; everything that is computed from parameters alone stands apart, in the coefficients.

    Attributes
    ----------
    name
        FMI model name and identifier.
    description
        One sentence for the FMU's description.
    module
        Name of the module in which the component stands; what it imports is what a Python FMU carries.
    inputs, outputs, parameters, constants
        Interface dataclasses, see :mod:`fmus.variables`; ``constants`` may be None.
    state
        ``NamedTuple`` class of the state, see :func:`state_fields`.
    prepare
        ``prepare(parameters) -> coefficients``; raises :class:`ParameterError` where parameters contradict.
    initial
        ``initial(inputs, coefficients, time) -> (state, outputs)`` at the start of a run, ``time`` in s.
    advance
        ``advance(state, inputs, coefficients, time, step_size) -> (state, outputs)``: from ``time`` to
        ``time + step_size``, both in s, inputs as set at ``time``; outputs hold at the end of the step.
    is_valid_state
        ``is_valid_state(state, parameters, time) -> bool``: whether a run can have that state, all numbers of it
        finite, when it has reached ``time``, in s; what comes from outside is asked.
    warnings
        ``warnings(parameters) -> texts`` for legal parameters that a user should think about.
    terminals
        Which variables make a plug together.
    resources
        Makes the files that the FMU carries in its folder of resources, by name.
    sample_time
        Period in s of a component that samples, None for others.
    """

    name: str
    description: str
    module: str
    inputs: type
    outputs: type
    parameters: type
    state: type
    prepare: Callable[[Any], Any]
    initial: Callable[[Any, Any, float], tuple[Any, Any]]
    advance: Callable[[Any, Any, Any, float, float], tuple[Any, Any]]
    is_valid_state: Callable[[Any, Any, float], bool] = lambda state, parameters, time: True
    constants: type | None = None
    warnings: Callable[[Any], Sequence[str]] = lambda parameters: ()
    terminals: tuple[Terminal, ...] = ()
    resources: Callable[[], Mapping[str, bytes]] = dict
    sample_time: float | None = None

    def __post_init__(self) -> None:
        state_fields(self.state)  # while its module can be looked up, which in a Python FMU is while it is imported

    @cached_property
    def variables(self) -> tuple[Variable, ...]:
        """All variables; the position is the value reference, in every flavour."""
        records = [self.inputs, self.outputs, self.parameters, *([self.constants] if self.constants else [])]
        variables = (TIME, *(variable for record in records for variable in variables_of(record)))
        names = [variable.name for variable in variables]
        if len(set(names)) != len(names):
            raise ValueError(f"component {self.name}: a variable name stands twice")
        return variables
