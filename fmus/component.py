"""The interface between models and FMUs: a component is a set of variables and pure functions over its state."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints

from fmus.variables import TIME, Terminal, VariableDeclaration, variables_of

TIME_TOLERANCE = 1e-9
"""Relative (above 1 s) or absolute (below, in s) difference up to which two times are equal."""

MAX_TIME = 1e9
"""Largest magnitude of a time, in s: 30 years, where times are resolved to 1e-7 s."""

MAX_STEP_SIZE = 1e3
"""Largest communication step size, in s: a longer step would take too long to compute."""

CLOCK_TOLERANCE = 1.0
"""Largest difference in s between the clock in a state and the time of the run; allows for rounding errors of hosts."""


class ParameterError(ValueError):
    """Parameters that are each within their range, but contradict one another."""


class DefaultExperiment(NamedTuple):
    """Default experiment of a model description.

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
        Name of the field; in nested states the names that lead to it, joined by dots.
    kind
        Type of each number: ``float``, ``int`` or ``bool``.
    length
        Number of values of a tuple, None for a single number.
    length_field
        Path of the field with the number of values in use, the others being zero; None if all are in use.
    """

    path: str
    kind: type
    length: int | None
    length_field: str | None = None


class _Member(NamedTuple):
    """A member of a state class: as :class:`StateField`, but ``kind`` is a class if the member is a state itself."""

    name: str
    kind: type
    length: int | None
    length_field: str | None

    @property
    def is_state(self) -> bool:
        return hasattr(self.kind, "_fields")


@cache
def _members(state: type) -> tuple[_Member, ...]:
    """Read the members of a state class; cached, as the module of the class may be unloaded later."""
    members = []
    for name, hint in get_type_hints(state, include_extras=True).items():
        if get_origin(hint) is Annotated:
            numbers, length, *length_field = get_args(hint)
            members.append(_Member(name, get_args(numbers)[0], length, length_field[0] if length_field else None))
        else:
            members.append(_Member(name, hint, None, None))
    return tuple(members)


@cache
def state_fields(state: type, prefix: str = "") -> tuple[StateField, ...]:
    """Read the fields of a state class, with the fields of nested states in their place.

    A tuple of n numbers is declared ``Annotated[tuple[float, ...], n]``. The last field of all may have a variable
    number of values in use: ``Annotated[tuple[float, ...], n, "field"]``, where the member ``field`` of the same state
    holds this number.

    Parameters
    ----------
    state
        ``NamedTuple`` class of numbers, tuples of numbers and further such states.
    prefix
        Prefix of all paths.

    Returns
    -------
    tuple of StateField
        In the order of :func:`pack_state`.

    Examples
    --------
    >>> Inner = NamedTuple("Inner", [("value", float)])
    >>> Outer = NamedTuple("Outer", [("inner", Inner), ("values", Annotated[tuple[float, ...], 2])])
    >>> [(field.path, field.length) for field in state_fields(Outer)]
    [('inner.value', None), ('values', 2)]
    """
    fields: list[StateField] = []
    for member in _members(state):
        if member.is_state:
            fields += state_fields(member.kind, f"{prefix}{member.name}.")
        else:
            length_field = prefix + member.length_field if member.length_field else None
            fields.append(StateField(prefix + member.name, member.kind, member.length, length_field))
    return tuple(fields)


def pack_state(state: Any) -> list[float]:
    """Convert a state to a flat list of numbers.

    Parameters
    ----------
    state
        State of a component.

    Returns
    -------
    list of float
        Numbers in the order of :func:`state_fields`.
    """
    if not isinstance(state, tuple):
        return [float(state)]
    return [number for member in state for number in pack_state(member)]


def unpack_state(state: type, numbers: Iterable[float]) -> Any:
    """Convert numbers from :func:`pack_state` back to a state.

    Parameters
    ----------
    state
        Class of the state.
    numbers
        Numbers in the order of :func:`state_fields`.

    Returns
    -------
    state
        Instance of the class.
    """
    rest = iter(numbers)

    def unpack(member: _Member) -> Any:
        if member.is_state:
            return unpack_state(member.kind, rest)
        if member.length is None:
            return member.kind(next(rest))
        return tuple(member.kind(next(rest)) for _ in range(member.length))

    return state(*map(unpack, _members(state)))


@dataclass(frozen=True)
class Component:
    """A model that can be exported as an FMU, in any flavour.

    The state is a ``NamedTuple`` of numbers, tuples of numbers and further such states, so it can be saved, compared
    and restored. What is computed from parameters alone is kept apart from it, in the coefficients.

    Attributes
    ----------
    name
        FMI model name and identifier.
    description
        One sentence for the model description.
    module
        Name of the module that defines the component; a Python FMU contains this module and what it imports.
    inputs, outputs, parameters, constants
        Dataclasses of variables, see :mod:`fmus.variables`; ``constants`` may be None. The inputs hold no other record.
    state
        ``NamedTuple`` class of the state, see :func:`state_fields`.
    prepare
        ``prepare(parameters) -> coefficients``; raises :class:`ParameterError` if parameters contradict one another.
    initialize
        ``initialize(inputs, coefficients, time) -> (state, outputs)`` at the start of a run, ``time`` in s.
    advance
        ``advance(state, inputs, coefficients, time, step_size) -> (state, outputs)`` from ``time`` to
        ``time + step_size``, both in s. The inputs are those at ``time``, the outputs those at the end of the step.
    is_valid_state
        ``is_valid_state(state, parameters, time) -> bool``: whether a run that has reached ``time``, in s, can have a
        state with finite numbers. It is called for states that come from outside.
    warnings
        ``warnings(parameters) -> texts`` about legal parameters that are probably not intended.
    terminals
        Variables that belong to one plug.
    resources
        Returns the files in the resources of the FMU, content by name.
    sample_time
        Period in s of a component with samples, None for others.
    """

    name: str
    description: str
    module: str
    inputs: type
    outputs: type
    parameters: type
    state: type
    prepare: Callable[[Any], Any]
    initialize: Callable[[Any, Any, float], tuple[Any, Any]]
    advance: Callable[[Any, Any, Any, float, float], tuple[Any, Any]]
    is_valid_state: Callable[[Any, Any, float], bool] = lambda state, parameters, time: True
    constants: type | None = None
    warnings: Callable[[Any], Sequence[str]] = lambda parameters: ()
    terminals: tuple[Terminal, ...] = ()
    resources: Callable[[], Mapping[str, bytes]] = dict
    sample_time: float | None = None

    def __post_init__(self) -> None:
        state_fields(self.state)  # fills the cache while the module is loaded, in a Python FMU only during its import

    @cached_property
    def variables(self) -> tuple[VariableDeclaration, ...]:
        """All variables; the position is the value reference, in every flavour. Added ones stand at the end."""
        records = [self.inputs, self.outputs, self.parameters, *([self.constants] if self.constants else [])]
        declared = (TIME, *(variable for record in records for variable in variables_of(record)))
        variables = tuple(sorted(declared, key=lambda variable: variable.added))
        names = [variable.name for variable in variables]
        if len(set(names)) != len(names):
            raise ValueError(f"component {self.name}: a variable name stands twice")
        return variables
