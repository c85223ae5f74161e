"""Changing a system: replaced components, other connections; all changes or none."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from cosim.engine.structure import Structure, VariableRef
from cosim.engine.unconnected_inputs import derived_inputs
from cosim.errors import SetupError, did_you_mean
from cosim.units import Linear

_NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_TRANSFORMED = re.compile(rf"(?:(?P<factor>[-+]?{_NUMBER})\s*\*\s*)?(?P<output>.+?)(?P<offset>\s*[-+]\s*{_NUMBER})?")


def parse_source(text: str) -> tuple[str, Linear]:
    """Split an output with the transformation of its values: ``cab.z``, ``0.001*cab.z``, ``-1*cab.z + 0.5``.

    Returns
    -------
    output : str
        Without the transformation.
    transformation : Linear
        The identity where the text holds none.
    """
    found = _TRANSFORMED.fullmatch(text.strip())
    if found is None:
        raise SetupError(f"{text!r}: expected COMPONENT.OUTPUT, or FACTOR*COMPONENT.OUTPUT+OFFSET")
    offset = (found["offset"] or "0").replace(" ", "")
    return found["output"].strip(), Linear(float(found["factor"] or 1.0), float(offset))


def edit(
    structure: Structure,
    replace: Mapping[str, str | Path],
    disconnect: Iterable[str],
    connect: Iterable[tuple[str, Linear, str]],
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
        Output, transformation and input of each new connection; it takes the place of an old one from or to a replaced
        component.

    Raises
    ------
    SetupError
        If a change is not possible, or an input has lost its connection.
    """
    with _all_or_nothing(structure):
        lost = [sink for name, fmu in replace.items() for sink in structure.replace_component(name, fmu)]
        for sink in disconnect:
            structure.disconnect(sink)
        for source, transformation, sink in connect:
            connection = structure.connections.get(VariableRef.parse(sink))
            if connection is not None and {connection.source.component, VariableRef.parse(sink).component} & set(
                replace
            ):
                structure.disconnect(sink)
            structure.connect(source, sink, transformation)
        problems = [_describe(structure, sink, replace) for sink in _unconnected(structure, lost)]
        if problems:
            raise SetupError(*problems)


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
    connected = {str(ref) for ref in structure.connections}
    for sink in lost:
        derived = derived_inputs(sink.component, structure.models[sink.component], connected)
        if str(sink) not in connected | derived and sink.variable in structure.models[sink.component].variables:
            yield sink


def _describe(structure: Structure, sink: VariableRef, replaced: Iterable[str]) -> str:
    """Describe an input that has lost its connection, with the outputs that could feed it."""
    outputs = [f"{name}.{v.name}" for name in replaced for v in structure.models[name].outputs]
    hint = did_you_mean(str(sink), outputs) or did_you_mean(sink.variable, [name.partition(".")[2] for name in outputs])
    listed = ", ".join(outputs[:8]) + (", …" if len(outputs) > 8 else "") or "none"
    example = f"; for example: --connect {outputs[0]}={sink}" if outputs else ""
    return f"{sink}: expected an output of what is new to feed it, got none{hint}; new outputs: {listed}{example}"
