"""HTML documentation in a native FMU: description, variables, equations, an example."""

from __future__ import annotations

import sys
from html import escape

from fmus.component import Component, DefaultExperiment
from fmus.export.variables_table import COLUMNS, CONVENTIONS, row

_STYLE = "body {font-family: sans-serif; max-width: 75em} td, th {padding: .2em .6em; text-align: left}"


def _table(component: Component) -> str:
    head = "".join(f"<th>{escape(column)}</th>" for column in COLUMNS)
    rows = (
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row(reference, variable)) + "</tr>"
        for reference, variable in enumerate(component.variables)
    )
    return "\n".join([f"<table>\n<tr>{head}</tr>", *rows, "</table>"])


def _example(component: Component, experiment: DefaultExperiment) -> str:
    return f"""import fmpy
from fmpy.util import read_csv

inputs = read_csv("{component.name}_in.csv")  # columns: time and inputs, as beside the FMU; None for default inputs
stop_time, step_size = {experiment.stop_time}, {experiment.step_size}
result = fmpy.simulate_fmu("{component.name}.fmu", stop_time=stop_time, output_interval=step_size, input=inputs)
print(result.dtype.names, result[-1])"""


def page(component: Component, experiment: DefaultExperiment) -> str:
    """Return the page of a component.

    Parameters
    ----------
    component
        Component to describe; the docstring of its module has the equations.
    experiment
        Default experiment.

    Returns
    -------
    str
        HTML text.
    """
    equations = str(sys.modules[component.module].__doc__).strip()
    return f"""<!DOCTYPE html>
<html lang="en">
<head><meta charset="utf-8"><title>{component.name}</title><style>{_STYLE}</style></head>
<body>
<h1>{component.name}</h1>
<p>{escape(component.description)}.</p>
<p>{CONVENTIONS} The recommended communication step is {experiment.step_size} s.</p>
<h2>Variables</h2>
{_table(component)}
<h2>Equations</h2>
<pre>{escape(equations)}</pre>
<h2>Example</h2>
<pre>{escape(_example(component, experiment))}</pre>
</body>
</html>
"""
