"""Reference results of the FMUs, computed by the Python models, in the files of the FMI cross-check.

``<name>_in.csv`` has the inputs over time, ``<name>_ref.csv`` the outputs, ``<name>_ref.opt`` the settings of the run.
Inputs are constant over the step that follows them. Row k of the outputs is the result of step k - 1.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from operator import attrgetter
from pathlib import Path

from fmus.component import Component
from fmus.variables import VariableDeclaration, variables_of

STEPS = 500
"""Duration of a reference run, in communication steps."""

_FREQUENCIES = (1.3, 2.1, 3.7, 5.9)
"""Frequencies of the inputs, in Hz, all different."""


def _signal(variable: VariableDeclaration, frequency: float, time: float) -> float:
    """Return the value of an input: a sine with its nominal magnitude as amplitude."""
    return (variable.nominal or 1.0) * math.sin(2.0 * math.pi * frequency * time)


def reference(component: Component, step_size: float) -> tuple[list[tuple[float, ...]], list[tuple[float, ...]]]:
    """Simulate a component with default parameters and sinusoidal inputs.

    Parameters
    ----------
    component
        Component to simulate.
    step_size
        Communication step size, in s.

    Returns
    -------
    input_rows, output_rows : list of tuple of float
        Rows of time in s and inputs; rows of time in s and outputs. The units are those of the variables.
    """
    inputs, outputs = variables_of(component.inputs), variables_of(component.outputs)
    output_values = attrgetter(*(v.field for v in outputs))
    coefficients = component.prepare(component.parameters())

    def input_values(time: float) -> tuple[float, ...]:
        return tuple(_signal(v, _FREQUENCIES[i % len(_FREQUENCIES)], time) for i, v in enumerate(inputs))

    state, values = component.initialize(component.inputs(*input_values(0.0)), coefficients, 0.0)
    input_rows, output_rows = [(0.0, *input_values(0.0))], [(0.0, *map(float, output_values(values)))]
    for k in range(STEPS):
        time = k * step_size
        state, values = component.advance(state, component.inputs(*input_rows[-1][1:]), coefficients, time, step_size)
        time = (k + 1) * step_size
        input_rows.append((time, *input_values(time)))
        output_rows.append((time, *map(float, output_values(values))))
    return input_rows, output_rows


def _csv(names: Sequence[str], rows: Iterable[Sequence[float]]) -> str:
    lines = [",".join(f'"{name}"' for name in ("time", *names)), *(",".join(map(repr, row)) for row in rows)]
    return "\n".join(lines) + "\n"


def write(component: Component, step_size: float, folder: Path) -> None:
    """Write the files of a component's reference run; a component without inputs has no ``_in.csv``.

    Parameters
    ----------
    component
        Component to simulate.
    step_size
        Communication step size, in s.
    folder
        Existing folder for the files.
    """
    inputs, outputs = variables_of(component.inputs), variables_of(component.outputs)
    input_rows, output_rows = reference(component, step_size)
    settings = {"StartTime": 0.0, "StopTime": STEPS * step_size, "StepSize": step_size, "RelTol": 1e-6}
    files = {
        "ref.csv": _csv([v.name for v in outputs], output_rows),
        "ref.opt": "".join(f"{name},{value!r}\n" for name, value in settings.items()),
    }
    if inputs:
        files["in.csv"] = _csv([v.name for v in inputs], input_rows)
    for suffix, text in files.items():
        (folder / f"{component.name}_{suffix}").write_text(text, encoding="utf-8")
