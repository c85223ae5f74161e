"""Structure of a system: its FMUs, their connections and the order in which they step."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Literal, NamedTuple, get_args

from fmpy.model_description import ModelVariable

from cosim.engine.clock import Clock
from cosim.engine.step_order import Edge, propose
from cosim.engine.unconnected_inputs import UnconnectedInputs, resolve_unconnected
from cosim.errors import Problems, SetupError, did_you_mean
from cosim.fmi.description import ModelDescription, Value
from cosim.fmi.variable_types import KINDS, NUMERIC
from cosim.units import IDENTITY, Linear, conversion

Algorithm = Literal["gauss-seidel", "jacobi"]
"""How components exchange values: each with the newest of the others, or all at once with those of the step before."""

ALGORITHMS: tuple[Algorithm, ...] = get_args(Algorithm)


class VariableRef(NamedTuple):
    """One variable of one component.

    Attributes
    ----------
    component, variable
        Their names.
    """

    component: str
    variable: str

    def __str__(self) -> str:
        return f"{self.component}.{self.variable}"

    @classmethod
    def parse(cls, text: str) -> VariableRef:
        """Split ``component.variable``; the variable's name may contain further dots.

        Parameters
        ----------
        text
            ``component.variable``.

        Raises
        ------
        SetupError
            If there is no component or no variable.
        """
        component, dot, variable = text.partition(".")
        if not (component and dot and variable):
            raise SetupError(f"{text}: expected COMPONENT.VARIABLE")
        return cls(component, variable)


class Connection(NamedTuple):
    """What feeds an input: an output's value, transformed.

    Attributes
    ----------
    source
        The output.
    transformation
        From its value to the input's: the conversion of units, if any, and then ``explicit``.
    explicit
        The transformation that was given with the connection.
    convert_units
        Whether units are converted.
    """

    source: VariableRef
    transformation: Linear = IDENTITY
    explicit: Linear = IDENTITY
    convert_units: bool = True


class Structure:
    """FMUs, their connections and how to run them, by their descriptions alone: no FMU is loaded.

    Connections are checked against the descriptions when they are made.

    Attributes
    ----------
    name
        The system's name.
    models
        Component to its FMU.
    connections
        Input to the connection that feeds it.
    parameters
        ``component.variable`` to the value the system gives it; a run may give others.
    algorithm
        How values are exchanged.
    component_steps
        Component to its own step size in s, where it is not that of the system: a multiple of it or a whole part.
    stop_time
        Default stop time of a run, in s; None where that is not known.
    ignored
        What was ignored when the system was read from a file, one line each.
    """

    def __init__(self) -> None:
        self.name = "system"
        self.models: dict[str, ModelDescription] = {}
        self.connections: dict[VariableRef, Connection] = {}
        self.parameters: dict[str, Value] = {}
        self.algorithm: Algorithm = ALGORITHMS[0]
        self.component_steps: dict[str, float] = {}
        self.stop_time: float | None = None
        self.ignored: tuple[str, ...] = ()
        self._step_size: float | None = None
        self._order: tuple[str, ...] | None = None

    # ---- building ----------------------------------------------------------------------------------------------------

    def add(self, name: str, fmu: str | Path | ModelDescription) -> None:
        """Add a component.

        Parameters
        ----------
        name
            The component's name, without dots.
        fmu
            Its ``.fmu`` file, or what was read of it.

        Raises
        ------
        SetupError
            If the name is taken or unfit, or the file is no FMU that can be used here.
        """
        if not name or "." in name:
            raise SetupError(f"component {name!r}: expected a name without dots")
        if name in self.models:
            raise SetupError(f"component {name}: expected a new name, got one that is there already")
        self.models[name] = fmu if isinstance(fmu, ModelDescription) else ModelDescription.read(fmu)

    def connect(
        self,
        output: str,
        input: str,  # noqa: A002
        transformation: Linear = IDENTITY,
        convert_units: bool = True,
    ) -> None:
        """Connect an output to an input.

        Parameters
        ----------
        output, input
            ``component.variable`` of each end.
        transformation
            Applied to each value, after the conversion of units.
        convert_units
            Whether to convert between the units the FMUs define; otherwise units are not looked at.

        Raises
        ------
        SetupError
            If an end does not exist, has the wrong causality, the input is fed already, or types or dimensions differ.
        """
        source, sink = VariableRef.parse(output), VariableRef.parse(input)
        ends = {"output": (source, self.variable(source)), "input": (sink, self.variable(sink))}
        between = f"connection {source} -> {sink}"
        problems = [
            f"{between}: expected {ref} to be an {causality}, got one of causality {variable.causality}"
            for causality, (ref, variable) in ends.items()
            if variable.causality != causality
        ]
        if sink in self.connections:
            problems.append(
                f"{between}: expected a free input, got one that {self.connections[sink].source} feeds; "
                f"--disconnect {sink}, or System.disconnect, frees it"
            )
        kinds = [KINDS[variable.type] for _, variable in ends.values()]
        if kinds[0] != kinds[1] or kinds[0] not in NUMERIC:
            types = " and ".join(variable.type for _, variable in ends.values())
            problems.append(f"{between}: expected two ends of one numeric type, got {types}")
        elif transformation != IDENTITY and kinds[0] != "Real":
            problems.append(f"{between}: expected no transformation of values of type {kinds[0]}, got {transformation}")
        converted = self.conversion(source, sink) if convert_units else IDENTITY
        if converted is None:
            units = " and ".join(str(self.unit(str(ref))) for ref in (source, sink))
            problems.append(f"{between}: expected two units of one dimension, got {units}")
        if problems:
            raise SetupError(*problems)
        combined = transformation.after(converted or IDENTITY)
        self.connections[sink] = Connection(source, combined, transformation, convert_units)

    def disconnect(self, input: str) -> None:  # noqa: A002
        """Remove the connection of an input.

        Parameters
        ----------
        input
            ``component.variable``.

        Raises
        ------
        SetupError
            If nothing feeds it.
        """
        sink = VariableRef.parse(input)
        self.variable(sink)
        if sink not in self.connections:
            fed = [str(ref) for ref in self.connections]
            raise SetupError(f"{sink}: expected an input that is fed, got one that is free{did_you_mean(input, fed)}")
        del self.connections[sink]

    def variable(self, ref: VariableRef) -> ModelVariable:
        """Look up a variable.

        Parameters
        ----------
        ref
            Which.

        Raises
        ------
        SetupError
            If there is no such component or variable, with the nearest names.
        """
        if ref.component not in self.models:
            raise SetupError(
                f"{ref}: expected a component among {', '.join(self.models) or 'none'}, got {ref.component}"
                + did_you_mean(ref.component, self.models)
            )
        return self.models[ref.component].variable(ref.component, ref.variable)

    def conversion(self, source: VariableRef, sink: VariableRef) -> Linear | None:
        """Return the conversion between the units of two variables; None where the dimensions differ."""
        return conversion(*(self.models[ref.component].defined_unit(self.variable(ref)) for ref in (source, sink)))

    def replace_component(self, name: str, fmu: str | Path) -> list[VariableRef]:
        """Put another FMU in a component's place and keep the connections and parameters that fit it.

        Parameters
        ----------
        name
            The component; the replacement takes its name and its place in the order.
        fmu
            The replacement's ``.fmu`` file.

        Returns
        -------
        list of VariableRef
            Inputs of other components that have lost their connection.

        Raises
        ------
        SetupError
            If there is no such component, or the file is no FMU that can be used here.
        """
        if name not in self.models:
            known = ", ".join(self.models) or "none"
            raise SetupError(f"{name}: expected a component among {known}, got none{did_you_mean(name, self.models)}")
        self.models[name] = replacement = ModelDescription.read(fmu)
        affected = {
            sink: connection
            for sink, connection in self.connections.items()
            if name in (sink.component, connection.source.component)
        }
        for sink in affected:
            del self.connections[sink]
        for sink, connection in affected.items():
            with suppress(SetupError):
                self.connect(str(connection.source), str(sink), connection.explicit, connection.convert_units)
        self.parameters = {
            text: value
            for text, value in self.parameters.items()
            if VariableRef.parse(text).component != name or VariableRef.parse(text).variable in replacement.variables
        }
        return [sink for sink in affected if sink.component != name and sink not in self.connections]

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
            sink: Edge(
                connection.source.component,
                sink.component,
                self.variable(connection.source).variability != "continuous",
            )
            for sink, connection in self.connections.items()
        }

    @property
    def step_size(self) -> float | None:
        """Communication step in s: as set, else the smallest that an FMU's default experiment asks for."""
        if self._step_size is not None:
            return self._step_size
        experiments = [model.description.defaultExperiment for model in self.models.values()]
        return min((float(e.stepSize) for e in experiments if e is not None and e.stepSize), default=None)

    @step_size.setter
    def step_size(self, seconds: float | None) -> None:
        self._step_size = seconds

    def clock(self, stop_time: float | None = None, step_size: float | None = None) -> Clock:
        """Make the clock of a run.

        Parameters
        ----------
        stop_time, step_size
            In s; the system's where None.

        Raises
        ------
        SetupError
            If a time is not given anywhere or makes no sense.
        """
        stop_time = self.stop_time if stop_time is None else stop_time
        step_size = self.step_size if step_size is None else step_size
        if stop_time is None or step_size is None:
            missing = "stop time" if stop_time is None else "step size"
            raise SetupError(f"{missing}: expected one, as neither the system nor its FMUs have a default, got none")
        return Clock.until(stop_time, step_size)

    # ---- checks ------------------------------------------------------------------------------------------------------

    def check_parameters(
        self, parameters: Mapping[str, Value], unconnected: Mapping[str, UnconnectedInputs] | None = None
    ) -> dict[str, dict[str, float | str]]:
        """Check the system's own parameters and those of a run, which win, against the descriptions.

        Parameters
        ----------
        parameters
            ``component.variable`` to value.
        unconnected
            What :meth:`unconnected_inputs` returns for them, where that is known already.

        Returns
        -------
        dict
            Component to variable to the value as its FMU takes it.

        Raises
        ------
        SetupError
            With all problems found.
        """
        values: dict[str, dict[str, float | str]] = {name: {} for name in self.models}
        problems = Problems()
        given = {**self.parameters, **parameters}
        for name, inputs in (self.unconnected_inputs(parameters) if unconnected is None else unconnected).items():
            problems.found += inputs.problems
            given |= {f"{name}.{parameter}": value for parameter, value in inputs.parameters.items()}
        for text, value in given.items():
            with problems.collected():
                ref = VariableRef.parse(text)
                self.variable(ref)
                if ref in self.connections:
                    source = self.connections[ref].source
                    raise SetupError(f"{ref}: expected a free input, got one that {source} feeds")
                values[ref.component][ref.variable] = self.models[ref.component].value(*ref, value)
        problems.raise_any()
        return values

    def unconnected_inputs(self, parameters: Iterable[str] = ()) -> dict[str, UnconnectedInputs]:
        """Resolve the inputs without a connection.

        Parameters
        ----------
        parameters
            Names of the parameters that a run sets, as ``component.variable``.

        Returns
        -------
        dict
            By component.
        """
        connected, given = {str(sink) for sink in self.connections}, {*self.parameters, *parameters}
        return {name: resolve_unconnected(name, model, connected, given) for name, model in self.models.items()}

    def notes(
        self, parameters: Iterable[str] = (), unconnected: Mapping[str, UnconnectedInputs] | None = None
    ) -> list[str]:
        """List what a user should know: what was ignored, and inputs without a connection.

        Parameters
        ----------
        parameters
            Names of the parameters that a run sets, as ``component.variable``.
        unconnected
            What :meth:`unconnected_inputs` returns for them, where that is known already.
        """
        known = self.unconnected_inputs(parameters) if unconnected is None else unconnected
        return [*self.ignored, *(note for inputs in known.values() for note in inputs.notes)]

    def outputs(self) -> list[str]:
        """Return all outputs as ``component.variable``, in order."""
        return [f"{name}.{v.name}" for name, model in self.models.items() for v in model.outputs]

    def recorded(self, record: Iterable[str] | None) -> list[str]:
        """Check which outputs to record.

        Parameters
        ----------
        record
            Outputs as ``component.variable``; all where None.

        Raises
        ------
        SetupError
            With all names that are no output.
        """
        if record is None:
            return self.outputs()
        known = self.outputs()
        problems = [
            f"record {name}: expected an output{did_you_mean(name, known)}" for name in record if name not in known
        ]
        if problems:
            raise SetupError(*problems)
        return list(record)

    def unit(self, ref: str) -> str | None:
        """Return the unit of ``component.variable``."""
        component, variable = VariableRef.parse(ref)
        return self.models[component].unit(self.variable(VariableRef(component, variable)))

    def start(self, ref: str) -> float:
        """Return the start value of the number ``component.variable``."""
        return float(self.variable(VariableRef.parse(ref)).start)
