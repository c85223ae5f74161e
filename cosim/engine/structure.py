"""Structure of a system: what a run needs to know of it beside the network of its FMUs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from typing import Literal, get_args

from cosim.engine.clock import Clock
from cosim.engine.dependencies import Graph, Node, Stage, dependency_graph, loops
from cosim.engine.names import unquoted
from cosim.engine.network import Network, VariableRef
from cosim.engine.step_order import Edge, propose
from cosim.engine.unconnected_inputs import UnconnectedInputs, resolve_unconnected
from cosim.errors import Problems, SetupError, did_you_mean, with_article
from cosim.fmi.elements import Elements
from cosim.fmi.values import Checked, Value
from cosim.fmi.variable_types import KINDS, NUMERIC

Algorithm = Literal["gauss-seidel", "jacobi"]
"""How components exchange values: each with the newest of the others, or all at once with those of the step before."""

ALGORITHMS: tuple[Algorithm, ...] = get_args(Algorithm)


class Structure(Network):
    """FMUs, their connections and how to run them, by their descriptions alone: no FMU is loaded.

    Attributes
    ----------
    name
        The system's name.
    algorithm
        How values are exchanged.
    component_steps
        Component to its own step size in s, where it is not that of the system: a multiple of it or a whole part.
    start_time, stop_time
        Default start and stop time of a run, in s; None where that is not known.
    ignored
        What was ignored when the system was read from a file, one line each.
    """

    def __init__(self) -> None:
        super().__init__()
        self.name = "system"
        self.algorithm: Algorithm = ALGORITHMS[0]
        self.component_steps: dict[str, float] = {}
        self.start_time: float | None = None
        self.stop_time: float | None = None
        self.ignored: tuple[str, ...] = ()
        self._step_size: float | None = None
        self._order: tuple[str, ...] | None = None

    # ---- order -------------------------------------------------------------------------------------------------------

    @property
    def order(self) -> tuple[str, ...]:
        """Order in which the components step: as set, and then what was added since; or a proposal."""
        if self._order is None:
            return propose(list(self.models), self.edges().values())[0]
        return (*self._order, *(name for name in self.models if name not in self._order))

    @order.setter
    def order(self, names: Sequence[str]) -> None:
        if sorted(names) != sorted(self.models):
            raise SetupError(f"order: expected each of {', '.join(self.models)} once, got {', '.join(names)}")
        self._order = tuple(names)

    @property
    def order_is_given(self) -> bool:
        """Whether the order was set, and is no proposal."""
        return self._order is not None

    def edges(self) -> dict[VariableRef, Edge]:
        """Return the timing of each connected input's value."""
        return {
            sink: Edge(connection.source.component, sink.component, self.is_sampled(connection.source))
            for sink, connection in self.connections.items()
        }

    def is_sampled(self, ref: VariableRef) -> bool:
        """Whether an output is a value at the begin of its component's step."""
        return self.models[ref.component].is_sampled(self.variable(ref).name)

    # ---- times -------------------------------------------------------------------------------------------------------

    @property
    def step_size(self) -> float | None:
        """Communication step in s: as set, else the smallest of the FMUs' default experiments."""
        if self._step_size is not None:
            return self._step_size
        return min((size for m in self.models.values() if (size := m.default_step_size) is not None), default=None)

    @step_size.setter
    def step_size(self, seconds: float | None) -> None:
        self._step_size = seconds

    @property
    def agreed_start_time(self) -> float:
        """Start time in s on which the default experiments of the FMUs agree; 0 where they differ or have none."""
        starts = {m.default_start_time for m in self.models.values() if m.default_start_time is not None}
        return starts.pop() if len(starts) == 1 else 0.0

    def _default(self, what: str, values: Mapping[str, float | None]) -> float | None:
        """Return the time in s on which the default experiments of the FMUs agree.

        Raises
        ------
        SetupError
            If they differ.
        """
        given = {name: value for name, value in values.items() if value is not None}
        if len(set(given.values())) > 1:
            listed = ", ".join(f"{name}: {value:g} s" for name, value in given.items())
            raise SetupError(
                f"{what}: expected one, as the default experiments of the FMUs differ ({listed}), got none"
            )
        return next(iter(given.values()), None)

    def clock(
        self, stop_time: float | None = None, step_size: float | None = None, start_time: float | None = None
    ) -> Clock:
        """Make the clock of a run.

        Parameters
        ----------
        stop_time, step_size, start_time
            In s; the system's where None, else those of the FMUs' default experiments. The start time is 0 where these
            differ or are not before the stop time.

        Raises
        ------
        SetupError
            If a time is not given anywhere or makes no sense.
        """
        start_time = self.start_time if start_time is None else start_time
        stop_time = self.stop_time if stop_time is None else stop_time
        if stop_time is None:
            stop_time = self._default("stop time", {name: m.default_stop_time for name, m in self.models.items()})
            if stop_time is not None and start_time is not None and start_time >= stop_time:
                raise SetupError(
                    f"stop time: expected one after the start time, {start_time:g} s, got none but that of the FMUs' "
                    f"default experiments, {stop_time:g} s"
                )
        if start_time is None:
            start_time = self.agreed_start_time
            if stop_time is not None and start_time >= stop_time:
                start_time = 0.0  # the stop time was not meant for the default experiment
        step_size = self.step_size if step_size is None else step_size
        if stop_time is None or step_size is None:
            missing = "stop time" if stop_time is None else "step size"
            raise SetupError(f"{missing}: expected one, as neither the system nor its FMUs have a default, got none")
        return Clock.until(stop_time, step_size, start_time)

    def own_steps(self, clock: Clock) -> dict[str, float]:
        """Return the step sizes in s of components that do not step with the clock.

        An FMU that cannot handle a variable communication step size steps by that of its default experiment.

        Parameters
        ----------
        clock
            Of the run.
        """
        fixed = {
            name: model.fixed_step_size
            for name, model in self.models.items()
            if model.fixed_step_size not in (None, clock.step_size)
        }
        return {**fixed, **self.component_steps}  # type: ignore[dict-item]

    def time_notes(self, clock: Clock) -> list[str]:
        """List what a user should know about the times of a run.

        Parameters
        ----------
        clock
            Of the run.
        """
        notes = [
            f"{name}: its default experiment starts at {start:g} s, the run at {clock.start_time:g} s"
            for name, model in self.models.items()
            if (start := model.default_start_time) is not None and start != clock.start_time
        ]
        own = self.own_steps(clock)
        notes += [
            f"{name}: steps by {own[name]:g} s, as it cannot handle other communication step sizes"
            for name in self.models
            if name in own and name not in self.component_steps
        ]
        return notes

    # ---- checks ------------------------------------------------------------------------------------------------------

    def check_parameters(
        self,
        parameters: Mapping[str, Value],
        sizes: Mapping[str, Mapping[int, int]] | None = None,
        unconnected: Mapping[str, UnconnectedInputs] | None = None,
    ) -> dict[str, dict[str, Checked]]:
        """Check the system's own parameters and those of a run, which win, against the descriptions.

        Parameters
        ----------
        parameters
            ``component.variable`` to value.
        sizes
            What :meth:`sizes` returns for them, where that is known already.
        unconnected
            What :meth:`unconnected_inputs` returns for them, likewise.

        Returns
        -------
        dict
            Component to variable to the value as its FMU takes it.

        Raises
        ------
        SetupError
            With all problems found.
        """
        values: dict[str, dict[str, Checked]] = {name: {} for name in self.models}
        problems = Problems()
        given = {**self.parameters, **parameters}
        sizes = self.sizes(parameters) if sizes is None else sizes
        for name, inputs in (self.unconnected_inputs(parameters) if unconnected is None else unconnected).items():
            problems.found += inputs.problems
            given |= {f"{name}.{parameter}": value for parameter, value in inputs.parameters.items()}
        arrays: dict[VariableRef, dict[int, float]] = {}
        for text, value in given.items():
            with problems.collected():
                ref = self.parse(text)
                elements = self.elements(ref, sizes)
                if (connection := self.feeding(ref, sizes)) is not None:
                    raise SetupError(f"{ref}: expected a free input, got one that {connection.source} feeds")
                checked = self.models[ref.component].value(ref.component, elements, value)
                if isinstance(checked, tuple):
                    array = arrays.setdefault(VariableRef(ref.component, elements.variable), {})
                    array |= zip(elements.places, checked, strict=True)
                else:
                    values[ref.component][elements.variable] = checked
        for ref, array in arrays.items():
            with problems.collected():
                model = self.models[ref.component]
                values[ref.component][ref.variable] = model.whole_array(*ref, array, sizes[ref.component])
        problems.raise_any()
        return values

    def unconnected_inputs(self, parameters: Iterable[str] = ()) -> dict[str, UnconnectedInputs]:
        """Resolve the inputs without a connection.

        Parameters
        ----------
        parameters
            Names of the parameters that a run sets, as ``component.variable``, or a mapping of them to their values.

        Returns
        -------
        dict
            By component.
        """
        connected: dict[str, dict[str, set[int]]] = {name: {} for name in self.models}
        given: dict[str, dict[str, set[int]]] = {name: {} for name in self.models}
        values: dict[str, dict[str, Value]] = {name: {} for name in self.models}
        known = {**self.parameters, **(parameters if isinstance(parameters, Mapping) else {})}
        for sink in self.connections:
            _add_places(connected[sink.component], self.elements(sink))
        for text in (*self.parameters, *parameters):
            with suppress(SetupError):  # of a name that does not exist: check_parameters reports it
                ref = self.parse(text)
                elements = self.elements(ref)
                _add_places(given[ref.component], elements)
                values[ref.component] |= {elements.variable: known[text]} if text in known else {}
        sizes = self.sizes({})
        return {
            name: resolve_unconnected(name, model, connected[name], given[name], sizes.get(name, {}), values[name])
            for name, model in self.models.items()
        }

    def notes(
        self, parameters: Iterable[str] = (), unconnected: Mapping[str, UnconnectedInputs] | None = None
    ) -> list[str]:
        """List what a user should know: what was ignored or not converted, inputs without a connection, loops.

        Parameters
        ----------
        parameters
            Names of the parameters that a run sets, as ``component.variable``.
        unconnected
            What :meth:`unconnected_inputs` returns for them, where that is known already.
        """
        known = self.unconnected_inputs(parameters) if unconnected is None else unconnected
        return [
            *self.ignored,
            *(note for connection in self.connections.values() for note in connection.notes),
            *(note for inputs in known.values() for note in inputs.notes),
            *self._loop_notes(),
        ]

    def dependencies(self, stage: Stage) -> Graph:
        """Return on what each connected input and each output depends, as declared for a stage of a run."""
        feeding: dict[Node, set[Node]] = {}
        for sink, connection in self.connections.items():
            ends = (sink, connection.source)
            node, source = (Node(r.component, self.elements(r).variable, r is sink) for r in ends)
            feeding.setdefault(node, set()).add(source)
        return dependency_graph(self.models, feeding, stage)

    def _loop_notes(self) -> list[str]:
        """Name loops of variables that depend on each other directly: values pass them with a delay."""
        return [
            f"algebraic loop {' -> '.join(map(str, loop))}: values are exchanged once in a step, not iterated"
            for loop in loops(self.dependencies("step"))
        ]

    def outputs(self, sizes: Mapping[str, Mapping[int, int]] | None = None) -> list[str]:
        """Return the elements of all outputs as ``component.element``, in order.

        Parameters
        ----------
        sizes
            From :meth:`sizes`; those of the system's own parameters where None.
        """
        sizes = self.sizes({}) if sizes is None else sizes
        return [
            f"{name}.{element}"
            for name, model in self.models.items()
            for variable in model.outputs
            for element in model.elements(name, variable.name, sizes[name]).names
        ]

    def recorded(self, record: Iterable[str] | None, sizes: Mapping[str, Mapping[int, int]] | None = None) -> list[str]:
        """Check which outputs to record.

        Parameters
        ----------
        record
            Outputs as ``component.variable``, whole arrays or elements; all where None.
        sizes
            From :meth:`sizes`; those of the system's own parameters where None.

        Returns
        -------
        list of str
            Elements as ``component.element``.

        Raises
        ------
        SetupError
            With all names that are no output.
        """
        sizes = self.sizes({}) if sizes is None else sizes
        known = self.outputs(sizes)
        if record is None:
            return known
        problems, found = Problems(), []
        for name in record:
            with problems.collected():
                try:
                    ref = self.parse(name if self.has(name) else unquoted(name))
                    variable, elements = self.variable(ref), self.elements(ref, sizes)
                except SetupError:
                    raise SetupError(f"record {name}: expected an output{did_you_mean(name, known)}") from None
                if variable.causality != "output":
                    raise SetupError(f"record {name}: expected an output, got {with_article(variable.causality)}")
                if KINDS[variable.type] not in NUMERIC:
                    raise SetupError(f"record {name}: expected a numeric output, got one of type {variable.type}")
                found += [f"{ref.component}.{element}" for element in elements.names]
        problems.raise_any()
        return list(dict.fromkeys(found))

    def unrecorded(self) -> list[str]:
        """List outputs of types that are not recorded."""
        return [
            f"{name}.{variable.name}: not recorded, as its type is {variable.type}"
            for name, model in self.models.items()
            for variable in model.variables.values()
            if variable.causality == "output" and KINDS[variable.type] not in NUMERIC
        ]

    def unit(self, ref: str) -> str | None:
        """Return the unit of ``component.variable``."""
        found = self.parse(ref)
        return self.models[found.component].unit(self.variable(found))

    def start(self, ref: str) -> float:
        """Return the start value of the number ``component.variable``."""
        return float(self.variable(self.parse(ref)).start)

    def number(self, ref: str, parameters: Mapping[str, Value] | None = None) -> float:
        """Return the value that a parameter has in a run.

        Parameters
        ----------
        ref
            A number, or item of an enumeration, as ``component.variable``.
        parameters
            Parameters of the run, which win over the system's.

        Raises
        ------
        SetupError
            If there is no such parameter, or one has a value that its FMU does not take.
        """
        component, variable = self.parse(ref)
        value = self.check_parameters(parameters or {})[component].get(variable)
        return self.start(ref) if value is None else float(value)  # type: ignore[arg-type]  # a number


def _add_places(found: dict[str, set[int]], elements: Elements) -> None:
    """Add elements to those of their variable."""
    found.setdefault(elements.variable, set()).update(elements.places)
