"""Network of a system: its FMUs, the connections between them, and the names of variables in it."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from fmpy.model_description import ModelVariable

from cosim.engine.compatibility import Compatibility, QuantityUnit, check_types, convert_units
from cosim.errors import Problems, SetupError, did_you_mean, with_article
from cosim.fmi.description import ModelDescription
from cosim.fmi.elements import Elements, sizes_problems
from cosim.fmi.values import Value
from cosim.fmi.variable_types import KINDS
from cosim.units import IDENTITY, Linear


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
    notes
        What a user should know.
    """

    source: VariableRef
    transformation: Linear = IDENTITY
    explicit: Linear = IDENTITY
    convert_units: bool = True
    notes: tuple[str, ...] = ()


class Network:
    """FMUs and their connections, by the descriptions alone: no FMU is loaded.

    Connections are checked against the descriptions when they are made.

    Attributes
    ----------
    models
        Component to its FMU.
    connections
        Input to the connection that feeds it.
    parameters
        ``component.variable`` to the value the system gives it; a run may give others.
    """

    def __init__(self) -> None:
        self.models: dict[str, ModelDescription] = {}
        self.connections: dict[VariableRef, Connection] = {}
        self.parameters: dict[str, Value] = {}

    def add(self, name: str, fmu: str | Path | ModelDescription) -> None:
        """Add a component.

        Parameters
        ----------
        name
            The component's name.
        fmu
            Its ``.fmu`` file, or what was read of it.

        Raises
        ------
        SetupError
            If the name is taken or unfit, or the file is no FMU that can be used here.
        """
        if not name:
            raise SetupError(f"component {name!r}: expected a name, got an empty one")
        if name in self.models:
            raise SetupError(f"component {name}: expected a new name, got one that is there already")
        model = fmu if isinstance(fmu, ModelDescription) else ModelDescription.read(fmu)
        self._check_names(name, model)
        self.models[name] = model

    def _check_names(self, name: str, model: ModelDescription) -> None:
        """Check that ``component.variable`` means one variable only, although components' names may have dots."""
        for other, known in self.models.items():
            pairs = [((name, model), (other, known)), ((other, known), (name, model))]
            for (long, of_long), (short, of_short) in pairs:
                rest = long.removeprefix(f"{short}.")
                if other == name or rest == long:
                    continue
                for variable in of_long.variables:
                    if of_short.has(f"{rest}.{variable}"):
                        raise SetupError(
                            f"component {name}: expected names that differ from those of {other}, "
                            f"got {long}.{variable} in both"
                        )

    def connect(
        self,
        output: str,
        input: str,  # noqa: A002
        transformation: Linear = IDENTITY,
        convert_units: bool = True,
    ) -> None:
        """Connect an output to an input; a calculated parameter is an output, too, which does not change in a run.

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
        source, sink = self.reference(output), self.reference(input)
        ends = {"output": (source, self.variable(source)), "input": (sink, self.variable(sink))}
        between = f"connection {source} -> {sink}"
        problems = [
            f"expected {ref} to be an {causality}, got {with_article(variable.causality)}"
            for causality, (ref, variable) in ends.items()
            if variable.causality != causality
            and not (causality == "output" and variable.causality == "calculatedParameter")
        ]
        if (fed := self.feeding(sink)) is not None:
            problems.append(
                f"expected a free input, got one that {fed.source} feeds; "
                f"--disconnect {sink}, or System.disconnect, frees it"
            )
        types = check_types(ends["output"][1], ends["input"][1])
        problems += types + self._shape_problems(source, sink)
        units = Compatibility()
        if convert_units and not types:
            units = self.conversion(source, sink)
            problems += units.problems
        combined = transformation.after(units.transformation)
        if combined != IDENTITY and KINDS[ends["input"][1].type] != "Real":
            kinds = " and ".join(variable.type for _, variable in ends.values())
            problems.append(f"expected no transformation of values of type {kinds}, got {combined}")
        if problems:
            raise SetupError(*(f"{between}: {problem}" for problem in problems))
        notes = tuple(f"{between}: {note}" for note in units.notes)
        self.connections[sink] = Connection(source, combined, transformation, convert_units, notes)

    def _shape_problems(self, source: VariableRef, sink: VariableRef) -> list[str]:
        """Compare the shapes of two ends."""
        shapes = []
        for ref in (source, sink):
            elements = self.elements(ref)
            shapes.append(elements.shape if elements.is_whole else ())
        if shapes[0] == shapes[1]:
            return []
        expected, got = (" x ".join(map(str, shape)) or "a scalar" for shape in (shapes[1], shapes[0]))
        return [f"expected the shape of the input, {expected}, got {got}"]

    def feeding(self, sink: VariableRef, sizes: Mapping[str, Mapping[int, int]] | None = None) -> Connection | None:
        """Return the connection that feeds an input, or an element of it; None where there is none.

        Parameters
        ----------
        sink
            The input.
        sizes
            From :meth:`sizes`; those of the system's own parameters where None.
        """
        wanted = self.elements(sink, sizes)
        if not wanted.shape:
            return self.connections.get(VariableRef(sink.component, wanted.variable))
        for ref, connection in self.connections.items():
            if ref.component == sink.component:
                found = self.elements(ref, sizes)
                if found.variable == wanted.variable and set(found.places) & set(wanted.places):
                    return connection
        return None

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
        sink = self.reference(input)
        if sink not in self.connections:
            fed = [str(ref) for ref in self.connections]
            raise SetupError(f"{sink}: expected an input that is fed, got one that is free{did_you_mean(input, fed)}")
        del self.connections[sink]

    def parse(self, text: str) -> VariableRef:
        """Split ``component.variable``; both names may contain dots.

        Parameters
        ----------
        text
            The longest component whose name it begins with is meant, if the rest is a variable of it.

        Raises
        ------
        SetupError
            If there is no component or no variable in the text.
        """
        candidates = [name for name in self.models if text.startswith(f"{name}.") and len(text) > len(name) + 1]
        refs = [VariableRef(name, text[len(name) + 1 :]) for name in sorted(candidates, key=len, reverse=True)]
        if refs:
            return next((ref for ref in refs if self.models[ref.component].has(ref.variable)), refs[0])
        component, dot, variable = text.partition(".")
        if not (component and dot and variable):
            raise SetupError(f"{text}: expected COMPONENT.VARIABLE")
        return VariableRef(component, variable)

    def reference(self, text: str) -> VariableRef:
        """Find a variable or an element by its name; an alias becomes the name of its variable.

        Parameters
        ----------
        text
            ``component.variable``.

        Raises
        ------
        SetupError
            If there is no such component, variable or element, with similar names.
        """
        ref = self.parse(text)
        elements = self.elements(ref).owner
        return VariableRef(ref.component, elements.variable if elements.is_whole else elements.names[0])

    def has(self, ref: VariableRef | str) -> bool:
        """Whether there is a variable or an element of a name."""
        try:
            self.elements(self.parse(ref) if isinstance(ref, str) else ref)
        except SetupError:
            return False
        return True

    def elements(self, ref: VariableRef, sizes: Mapping[str, Mapping[int, int]] | None = None) -> Elements:
        """Find the elements of a variable.

        Parameters
        ----------
        ref
            A variable or one element of it.
        sizes
            From :meth:`sizes`; those of the system's own parameters where None.

        Raises
        ------
        SetupError
            If there is no such component, variable or element, with similar names.
        """
        model = self._model(ref)
        if sizes is None and not model.structural:  # parameters of other components do not matter
            return model.elements(ref.component, ref.variable, model.sizes())
        given = self.sizes({})[ref.component] if sizes is None else sizes[ref.component]
        return model.elements(ref.component, ref.variable, given)

    def _model(self, ref: VariableRef) -> ModelDescription:
        if ref.component not in self.models:
            raise SetupError(
                f"{ref}: expected a component among {', '.join(self.models) or 'none'}, got {ref.component}"
                + did_you_mean(ref.component, self.models)
            )
        return self.models[ref.component]

    def variable(self, ref: VariableRef) -> ModelVariable:
        """Look up a variable, also by the name of an element, whatever the sizes of arrays are.

        Parameters
        ----------
        ref
            Which.

        Raises
        ------
        SetupError
            If there is no such component or variable, with similar names.
        """
        return self._model(ref).variable_of(ref.component, ref.variable)

    def sizes(self, parameters: Mapping[str, Value]) -> dict[str, dict[int, int]]:
        """Return the values of structural parameters.

        Parameters
        ----------
        parameters
            ``component.variable`` to value, beside the system's own.

        Returns
        -------
        dict
            Component to value reference to value.

        Raises
        ------
        SetupError
            If a value does not fit.
        """
        given: dict[str, dict[str, float]] = {name: {} for name, model in self.models.items() if model.structural}
        for text, value in {**self.parameters, **parameters}.items() if given else ():
            component, name = self.parse(text)
            if component in given and name in self.models[component].structural:
                given[component][name] = self.models[component].structural_value(component, name, value)
        sizes = {name: model.sizes(given.get(name, {})) for name, model in self.models.items()}
        problems = Problems()
        for name in given:
            variables = self.models[name].variables.values()
            problems.found += [f"{name}: {problem}" for problem in sizes_problems(variables, sizes[name])]
        problems.raise_any()
        return sizes

    def conversion(self, source: VariableRef, sink: VariableRef) -> Compatibility:
        """Return the conversion between the units of two variables."""
        ends = [QuantityUnit.of(self.models[ref.component], self.variable(ref)) for ref in (source, sink)]
        return convert_units(*ends)

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
        model = ModelDescription.read(fmu)
        self._check_names(name, model)
        self.models[name] = model
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
            if self.parse(text).component != name or self.has(self.parse(text))
        }
        return [sink for sink in affected if sink.component != name and sink not in self.connections]
