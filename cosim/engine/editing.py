"""Changing a system: replaced components, other connections; all changes or none."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from cosim.engine.names import parse_source, split_connection
from cosim.engine.network import VariableRef
from cosim.engine.structure import Structure
from cosim.engine.unconnected_inputs import derived_inputs
from cosim.errors import SetupError, did_you_mean
from cosim.units import Linear


def edit(
    structure: Structure,
    replace: Mapping[str, str | Path],
    disconnect: Iterable[str],
    connect: Iterable[str],
    bare_names_of: str | None = None,
) -> None:
    """Change a system; it stays as it was if a change is not possible.

    Parameters
    ----------
    structure
        What to change.
    replace
        Component to the ``.fmu`` file that takes its place and name.
    disconnect
        Inputs whose connection is removed, as ``component.variable``.
    connect
        New connections as ``output=input``, the output with or without a transformation, see
        :mod:`cosim.engine.names`; each takes the place of an old one from or to a replaced component.
    bare_names_of
        A component whose outputs may be named without it.

    Raises
    ------
    SetupError
        If a change is not possible, or an input has lost its connection.
    """
    with _all_or_nothing(structure):
        lost = [sink for name, fmu in replace.items() for sink in structure.replace_component(name, fmu)]
        for sink in disconnect:
            structure.disconnect(sink)
        for text in connect:
            source, transformation, sink = _parse_connection(structure, text, bare_names_of)
            ref = structure.reference(sink)
            connection = structure.connections.get(ref)
            if connection is not None and {connection.source.component, ref.component} & set(replace):
                structure.disconnect(sink)
            structure.connect(source, sink, transformation)
        problems = [_describe(structure, sink, replace) for sink in _unconnected(structure, lost)]
        if problems:
            raise SetupError(*problems)


def _parse_connection(structure: Structure, text: str, component: str | None) -> tuple[str, Linear, str]:
    """Split ``output=input`` into output, transformation and input."""
    source, sink = split_connection(text, structure.has)
    if not (source and sink):
        raise SetupError(f"connect {text}: expected A.x=B.y, the output first")

    def complete(name: str) -> str:
        bare = component is not None and not structure.has(name)
        if bare and (structure.has(f"{component}.{name}") or name.partition(".")[0] not in structure.models):
            return f"{component}.{name}"
        return name

    output, transformation = parse_source(source, lambda name: structure.has(complete(name)))
    return complete(output), transformation, sink


@contextmanager
def _all_or_nothing(structure: Structure) -> Iterator[None]:
    """Restore the structure if an error comes out."""
    before = {name: dict(getattr(structure, name)) for name in ("models", "connections", "parameters")}
    try:
        yield
    except SetupError:
        for name, value in before.items():
            setattr(structure, name, value)
        raise


def _unconnected(structure: Structure, lost: Iterable[VariableRef]) -> Iterator[VariableRef]:
    """Find the inputs without a connection that their component cannot derive."""
    for sink in lost:
        model = structure.models[sink.component]
        if structure.has(sink) and structure.feeding(sink) is None:
            connected = {ref.variable for ref in structure.connections if ref.component == sink.component}
            if sink.variable not in derived_inputs(model, connected):
                yield sink


def _describe(structure: Structure, sink: VariableRef, replaced: Iterable[str]) -> str:
    """Describe an input that has lost its connection, with the outputs that could feed it."""
    outputs = [f"{name}.{v.name}" for name in replaced for v in structure.models[name].outputs]
    hint = did_you_mean(str(sink), outputs) or did_you_mean(sink.variable, [name.partition(".")[2] for name in outputs])
    listed = ", ".join(outputs[:8]) + (", …" if len(outputs) > 8 else "") or "none"
    example = f"; for example: --connect {outputs[0]}={sink}" if outputs else ""
    return f"{sink}: expected an output of what is new to feed it, got none{hint}; new outputs: {listed}{example}"
