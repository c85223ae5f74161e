"""Structure: which FMUs there are, what is connected to what, in which order they step."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Literal, NamedTuple, get_args

from fmpy.model_description import ModelVariable

from cosim.engine.clock import Clock
from cosim.engine.step_order import Edge, propose
from cosim.engine.unconnected_inputs import UnconnectedInputs, settle
from cosim.errors import SetupError, did_you_mean
from cosim.fmi.description import KINDS, NUMERIC, ModelDescription, Value
from cosim.units import IDENTITY, Linear, conversion

Algorithm = Literal["gauss-seidel", "jacobi"]
"""How components exchange values: each with the newest of the others, or all at once with those of the step before."""

ALGORITHMS: tuple[Algorithm, ...] = get_args(Algorithm)


class VariableRef(NamedTuple):
    """One variable of one component."""

    component: str
    variable: str

    def __str__(self) -> str:
        return f"{self.component}.{self.variable}"

    @classmethod
    def parse(cls, text: str) -> VariableRef:
        """Split ``component.variable``; the variable's name may hold further dots."""
        component, dot, variable = text.partition(".")
        if not (component and dot and variable):
            raise SetupError(f"{text}: expected COMPONENT.VARIABLE")
        return cls(component, variable)


class Connection(NamedTuple):
    """What an input takes: an output's value, transformed.

    Attributes
    ----------
    source
        The output.
    transformation
        From its value to the input's: the conversion of units, if any, and then ``asked``.
    asked
        The transformation that was asked for.
    convert_units
        Whether units are converted.
    """

    source: VariableRef
    transformation: Linear = IDENTITY
    asked: Linear = IDENTITY
    convert_units: bool = True


class Structure:
    """FMUs, their connections and how to run them, by their descriptions alone: nothing is loaded.

    Every check that a description allows is made as soon as its two ends are known.

    Attributes
    ----------
    name
        The system's name.
    models
        Component to its FMU.
    connections
        Input to what feeds it.
    parameters
        ``component.variable`` to the value the system gives it; a run may give others.
    algorithm
        How values are exchanged.
    component_steps
        Component to its own step size in s, where it is not that of the system: a multiple of it or a whole part.
    stop_time
        How long a run lasts where it says nothing else, in s; None where that is not known.
    passed_over
        What was left out when the system was read from a file, a line each.
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
            f"{between}: expected {port} to be an {causality}, got a {variable.causality}"
            for causality, (port, variable) in ends.items()
            if variable.causality != causality
        ]
        if sink in self.connections:
            problems.append(f"{between}: expected a free input, got one that {self.connections[sink].source} feeds")
        kinds = [KINDS[variable.type] for _, variable in ends.values()]
        if kinds[0] != kinds[1] or kinds[0] not in NUMERIC:
            types = " and ".join(variable.type for _, variable in ends.values())
            problems.append(f"{between}: expected two ends of one numeric type, got {types}")
        elif transformation != IDENTITY and kinds[0] != "Real":
            problems.append(f"{between}: expected no transformation of values of type {kinds[0]}, got {transformation}")
        converted = self.conversion(source, sink) if convert_units else IDENTITY
        if converted is None:
            units = " and ".join(str(self.unit(str(port))) for port in (source, sink))
            problems.append(f"{between}: expected two units of one dimension, got {units}")
        if problems:
            raise SetupError(*problems)
        combined = transformation.after(converted or IDENTITY)
        self.connections[sink] = Connection(source, combined, transformation, convert_units)

    def disconnect(self, input: str) -> None:  # noqa: A002
        """Free an input.

        Raises
        ------
        SetupError
            If nothing feeds it.
        """
        sink = VariableRef.parse(input)
        self.variable(sink)
        if sink not in self.connections:
            fed = [str(port) for port in self.connections]
            raise SetupError(f"{sink}: expected an input that is fed, got one that is free{did_you_mean(input, fed)}")
        del self.connections[sink]

    def variable(self, port: VariableRef) -> ModelVariable:
        """Look up a variable.

        Raises
        ------
        SetupError
            If there is no such component or variable, with the nearest names.
        """
        if port.component not in self.models:
            raise SetupError(
                f"{port}: expected a component among {', '.join(self.models) or 'none'}, got {port.component}"
                + did_you_mean(port.component, self.models)
            )
        return self.models[port.component].variable(port.component, port.variable)

    def conversion(self, source: VariableRef, sink: VariableRef) -> Linear | None:
        """Find what converts between the units of two ports; None where the dimensions differ."""
        return conversion(*(self.models[port.component].defined_unit(self.variable(port)) for port in (source, sink)))

    def swap(self, name: str, fmu: str | Path) -> list[VariableRef]:
        """Put another FMU in a component's place and keep the connections and parameters that fit it.

        Parameters
        ----------
        name
            The component; the newcomer takes its name and its place in the order.
        fmu
            The newcomer's ``.fmu`` file.

        Returns
        -------
        list of Port
            Inputs of other components that have lost what fed them.

        Raises
        ------
        SetupError
            If there is no such component, or the file is no FMU that can be used here.
        """
        if name not in self.models:
            known = ", ".join(self.models) or "none"
            raise SetupError(f"{name}: expected a component among {known}, got none{did_you_mean(name, self.models)}")
        self.models[name] = newcomer = ModelDescription.read(fmu)
        touched = {
            sink: feed for sink, feed in self.connections.items() if name in (sink.component, feed.source.component)
        }
        for sink in touched:
            del self.connections[sink]
        for sink, feed in touched.items():
            with suppress(SetupError):
                self.connect(str(feed.source), str(sink), feed.asked, feed.convert_units)
        self.parameters = {
            text: value
            for text, value in self.parameters.items()
            if VariableRef.parse(text).component != name or VariableRef.parse(text).variable in newcomer.variables
        }
        return [sink for sink in touched if sink.component != name and sink not in self.connections]

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
        """Tell of each connected input when its value is made."""
        return {
            sink: Edge(feed.source.component, sink.component, self.variable(feed.source).variability != "continuous")
            for sink, feed in self.connections.items()
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
        """Make the clock of a run, of the system's own times where None is given.

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

    def check(
        self, parameters: Mapping[str, Value], settled: Mapping[str, UnconnectedInputs] | None = None
    ) -> dict[str, dict[str, float | str]]:
        """Check the system's own parameters and those of a run, which win, against the descriptions.

        Parameters
        ----------
        parameters
            ``component.variable`` to value.
        settled
            What :meth:`settled` gives for them, where that is known already.

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
        problems: list[str] = []
        given = {**self.parameters, **parameters}
        for name, inputs in (self.settled(parameters) if settled is None else settled).items():
            problems += inputs.problems
            given |= {f"{name}.{parameter}": value for parameter, value in inputs.settings.items()}
        for text, value in given.items():
            try:
                port = VariableRef.parse(text)
                self.variable(port)
                if port in self.connections:
                    raise SetupError(
                        f"{port}: expected a free input, got one that {self.connections[port].source} feeds"
                    )
                values[port.component][port.variable] = self.models[port.component].value(*port, value)
            except SetupError as error:
                problems += error.problems
        if problems:
            raise SetupError(*problems)
        return values

    def settled(self, parameters: Iterable[str] = ()) -> dict[str, UnconnectedInputs]:
        """Decide what becomes of inputs that nothing feeds, by component, where a run sets these parameters."""
        fed, given = {str(sink) for sink in self.connections}, {*self.parameters, *parameters}
        return {name: settle(name, model, fed, given) for name, model in self.models.items()}

    def notes(
        self, parameters: Iterable[str] = (), settled: Mapping[str, UnconnectedInputs] | None = None
    ) -> list[str]:
        """Say what a user should know: what was passed over, and which inputs nothing feeds; see :meth:`check`."""
        known = self.settled(parameters) if settled is None else settled
        return [*self.ignored, *(note for inputs in known.values() for note in inputs.notes)]

    def outputs(self) -> list[str]:
        """Name all outputs as ``component.variable``, in order."""
        return [f"{name}.{v.name}" for name, model in self.models.items() for v in model.outputs]

    def recorded(self, record: Iterable[str] | None) -> list[str]:
        """Check which outputs to record; all where None is given."""
        if record is None:
            return self.outputs()
        known = self.outputs()
        problems = [
            f"record {name}: expected an output{did_you_mean(name, known)}" for name in record if name not in known
        ]
        if problems:
            raise SetupError(*problems)
        return list(record)

    def unit(self, port: str) -> str | None:
        """Return the unit of ``component.variable``."""
        component, variable = VariableRef.parse(port)
        return self.models[component].unit(self.variable(VariableRef(component, variable)))

    def start(self, port: str) -> float:
        """Return the start value of the number ``component.variable``."""
        return float(self.variable(VariableRef.parse(port)).start)
