"""Layout of the table of values: an entry for each element of every output, and for constants behind them.

The layout follows from the structure and from the values of structural parameters, which give arrays their sizes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from fmpy.model_description import ModelVariable

from cosim.engine.compatibility import range_to_check
from cosim.engine.structure import Structure
from cosim.fmi.access import InputEntry, OutputEntry, VariableMapping
from cosim.fmi.description import ModelDescription
from cosim.fmi.values import Checked, starts
from cosim.units import Linear

Sizes = Mapping[str, Mapping[int, int]]
"""Component to the sizes that dimensions refer to, by value reference."""


class Constant(NamedTuple):
    """An element without a connection of an array input that has one: constant over a run.

    Attributes
    ----------
    component, variable
        The input.
    place
        Of the element in the flattened array.
    """

    component: str
    variable: str
    place: int


@dataclass
class Layout:
    """The table of values.

    Attributes
    ----------
    names
        Elements of all outputs and of connected calculated parameters as ``component.element``, in the order of the
        table.
    mappings
        Component to where its variables are.
    constants
        Values behind the outputs.
    """

    names: list[str] = field(default_factory=list)
    mappings: dict[str, VariableMapping] = field(default_factory=dict)
    constants: list[Constant] = field(default_factory=list)

    @property
    def size(self) -> int:
        """Number of entries."""
        return len(self.names) + len(self.constants)

    def constant_values(self, structure: Structure, values: Mapping[str, Mapping[str, Checked]]) -> Sequence[float]:
        """Return the values of the constants: as given for a run, else the start values, else 0.

        Parameters
        ----------
        structure
            The system.
        values
            Component to variable to the checked value.
        """
        found = []
        for component, variable, place in self.constants:
            count = len(self.mappings[component].inputs[variable])
            given = values[component].get(variable)
            elements = (
                given if isinstance(given, tuple) else starts(structure.models[component].variables[variable], count)
            )
            found.append(elements[place] if elements else 0.0)
        return found


class _Element(NamedTuple):
    component: str
    variable: str
    place: int


class _ElementConnection(NamedTuple):
    source: _Element
    sink: _Element
    transformation: Linear
    range: tuple[float, float] | None


def layout_of(structure: Structure, sizes: Sizes) -> Layout:
    """Lay out the table of a system.

    Parameters
    ----------
    structure
        The system.
    sizes
        From :meth:`cosim.engine.structure.Structure.sizes`.
    """
    layout = Layout()
    connections = list(_element_connections(structure, sizes))
    connected = {connection.source for connection in connections}
    index: dict[_Element, int] = {}
    for name, model in structure.models.items():
        mapping = layout.mappings[name] = VariableMapping()
        for output in (*model.outputs, *_calculated(model, {e.variable for e in connected if e.component == name})):
            found = model.elements(name, output.name, sizes[name])
            elements = [_Element(name, found.variable, place) for place in found.places]
            mapping.outputs[output.name] = [
                OutputEntry(own_name, len(layout.names) + place, element in connected)
                for own_name, place, element in zip(found.names, found.places, elements, strict=True)
            ]
            index |= {element: len(layout.names) + element.place for element in elements}
            layout.names += [f"{name}.{own_name}" for own_name in found.names]
    fed: dict[tuple[str, str], dict[int, _ElementConnection]] = {}
    for connection in connections:
        fed.setdefault(connection.sink[:2], {})[connection.sink.place] = connection
    for (name, variable), sources in fed.items():
        names = structure.models[name].elements(name, variable, sizes[name]).names
        entries = layout.mappings[name].inputs[variable] = []
        for place, own_name in enumerate(names):
            if place in sources:
                source, _, transformation, range_ = sources[place]
                entries.append(InputEntry(own_name, index[source], transformation, range_))
            else:
                entries.append(InputEntry(own_name, layout.size))
                layout.constants.append(Constant(name, variable, place))
    return layout


def _calculated(model: ModelDescription, connected: set[str]) -> list[ModelVariable]:
    """Return the calculated parameters of an FMU among its connected variables."""
    return [v for v in model.variables.values() if v.causality == "calculatedParameter" and v.name in connected]


def _element_connections(structure: Structure, sizes: Sizes) -> Iterator[_ElementConnection]:
    """Split connections of arrays into those of their elements."""
    for sink, connection in structure.connections.items():
        ends = [(ref.component, structure.elements(ref, sizes)) for ref in (connection.source, sink)]
        variables = [structure.models[component].variables[elements.variable] for component, elements in ends]
        range_ = range_to_check(*variables)
        (source, source_elements), (target, target_elements) = ends
        for places in zip(source_elements.places, target_elements.places, strict=True):
            yield _ElementConnection(
                _Element(source, source_elements.variable, places[0]),
                _Element(target, target_elements.variable, places[1]),
                connection.transformation,
                range_,
            )
