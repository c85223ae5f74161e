"""Reference runs beside the FMUs, computed by the Python models: what a tester compares a host's results with.

The files and their names are those of the FMI cross-check: ``<name>_in.csv`` with the inputs over time,
``<name>_ref.csv`` with the outputs, ``<name>_ref.opt`` with the settings of the run. Inputs hold over the step that
follows them; row k of the outputs is what step k - 1 left.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from operator import attrgetter
from pathlib import Path

from fmus.component import Component
from fmus.variables import Variable, variables_of

STEPS = 500
"""Length of a reference run, in communication steps."""

_FREQUENCIES = (1.3, 2.1, 3.7, 5.9)
"""In Hz, one input after the other: no two of them move alike."""


def _signal(variable: Variable, frequency: float, time: float) -> float:
    """Move an input like a sine of its nominal magnitude."""
    return (variable.nominal or 1.0) * math.sin(2.0 * math.pi * frequency * time)


def reference(component: Component, step_size: float) -> tuple[list[tuple[float, ...]], list[tuple[float, ...]]]:
    """Run a component with default parameters.

    Parameters
    ----------
    component
        Which.
    step_size
        Communication step size, in s.

    Returns
    -------
    tuple of two tables
        Rows of time in s and inputs, rows of time and outputs.
    """
    inputs, outputs = variables_of(component.inputs), variables_of(component.outputs)
    names = [v.field for v in outputs]
    values = attrgetter(*names)
    coefficients = component.prepare(component.parameters())

    def given(time: float) -> tuple[float, ...]:
        return tuple(_signal(v, _FREQUENCIES[i % len(_FREQUENCIES)], time) for i, v in enumerate(inputs))

    state, found = component.initial(component.inputs(*given(0.0)), coefficients, 0.0)
    driven, left = [(0.0, *given(0.0))], [(0.0, *map(float, values(found)))]
    for k in range(STEPS):
        time = k * step_size
        state, found = component.advance(state, component.inputs(*driven[-1][1:]), coefficients, time, step_size)
        time = (k + 1) * step_size
        driven.append((time, *given(time)))
        left.append((time, *map(float, values(found))))
    return driven, left


def _csv(names: Sequence[str], rows: Iterable[Sequence[float]]) -> str:
    lines = [",".join(f'"{name}"' for name in ("time", *names)), *(",".join(map(repr, row)) for row in rows)]
    return "\n".join(lines) + "\n"


def write(component: Component, step_size: float, folder: Path) -> None:
    """Write a component's reference run into a folder; a component without inputs has no file of them."""
    inputs, outputs = variables_of(component.inputs), variables_of(component.outputs)
    driven, left = reference(component, step_size)
    settings = {"StartTime": 0.0, "StopTime": STEPS * step_size, "StepSize": step_size, "RelTol": 1e-6}
    texts = {
        "ref.csv": _csv([v.name for v in outputs], left),
        "ref.opt": "".join(f"{name},{value!r}\n" for name, value in settings.items()),
    }
    if inputs:
        texts["in.csv"] = _csv([v.name for v in inputs], driven)
    for ending, text in texts.items():
        (folder / f"{component.name}_{ending}").write_text(text, encoding="utf-8")
