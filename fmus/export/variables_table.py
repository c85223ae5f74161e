"""Tables of the variables of components, in Markdown."""

from __future__ import annotations

from collections.abc import Iterable

from fmus.component import Component
from fmus.variables import VariableDeclaration

CONVENTIONS = """Up is positive for displacements, forces and accelerations; displacements are from static equilibrium,
accelerations without gravity; everything starts at rest."""
"""Conventions of all variables."""

_HEAD = f"""# Variables of the FMUs

Generated from the declarations by `python -m seat_cosim.reference`. All flavours of a component have these variables in
this order; the value reference is the position.

{CONVENTIONS}
"""


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:g}"


COLUMNS = ("#", "variable", "unit", "causality", "variability", "start", "range", "description")
"""Columns of a table."""


def row(reference: int, v: VariableDeclaration) -> tuple[str, ...]:
    """Return the row of a variable.

    Parameters
    ----------
    reference
        Value reference.
    v
        Declaration of the variable.

    Returns
    -------
    tuple of str
        One cell for each of :data:`COLUMNS`.
    """
    start = _number(v.start) if isinstance(v.start, float) else "" if v.start is None else str(v.start)
    start = start.lower() if v.type is bool else start
    items = ", ".join(f"{number} {name}" for name, number in v.items.items())
    bounds = "" if v.minimum is None and v.maximum is None else f"{_number(v.minimum)} … {_number(v.maximum)}"
    return (str(reference), v.name, v.unit or "", v.causality, v.variability, start, items or bounds, v.description)


def _line(reference: int, variable: VariableDeclaration) -> str:
    number, name, *cells = row(reference, variable)
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in (number, f"`{name}`", *cells)) + " |"


def table(component: Component) -> str:
    """Return the variables of a component as a Markdown table.

    Parameters
    ----------
    component
        The component.

    Returns
    -------
    str
        Markdown text.
    """
    head = f"| {' | '.join(COLUMNS)} |\n" + "|---" * len(COLUMNS) + "|"
    rows = [_line(reference, variable) for reference, variable in enumerate(component.variables)]
    return "\n".join([head, *rows])


def page(components: Iterable[Component]) -> str:
    """Return a page with a table for each component.

    Parameters
    ----------
    components
        The components.

    Returns
    -------
    str
        Markdown text.
    """
    parts = [f"## {c.name}\n\n{c.description}.\n\n{table(c)}\n" for c in components]
    return "\n".join([_HEAD, *parts])
