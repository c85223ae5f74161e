"""The variables of components as a page of tables."""

from __future__ import annotations

from collections.abc import Iterable

from fmus.component import Component
from fmus.variables import Variable

CONVENTIONS = """Up is positive for displacements, forces and accelerations; displacements are from static equilibrium,
accelerations without gravity; everything starts at rest."""
"""What all variables have in common."""

_HEAD = f"""# Variables of the FMUs

Generated from the declarations by `python -m seat_cosim.reference`. All flavours of a component have these variables in
this order; the value reference is the position.

{CONVENTIONS}
"""


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:g}"


COLUMNS = ("#", "variable", "unit", "causality", "variability", "start", "range", "description")
"""What a table says of each variable."""


def row(reference: int, v: Variable) -> tuple[str, ...]:
    """Write the cells of a variable's row, see :data:`COLUMNS`.

    Parameters
    ----------
    reference
        The value reference.
    v
        The variable.
    """
    start = _number(v.start) if isinstance(v.start, float) else "" if v.start is None else str(v.start)
    start = start.lower() if v.type is bool else start
    items = ", ".join(f"{number} {name}" for name, number in v.items.items())
    bounds = "" if v.minimum is None and v.maximum is None else f"{_number(v.minimum)} … {_number(v.maximum)}"
    return (str(reference), v.name, v.unit or "", v.causality, v.variability, start, items or bounds, v.description)


def _line(reference: int, variable: Variable) -> str:
    number, name, *cells = row(reference, variable)
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in (number, f"`{name}`", *cells)) + " |"


def table(component: Component) -> str:
    """Write a component's variables as a Markdown table."""
    head = f"| {' | '.join(COLUMNS)} |\n" + "|---" * len(COLUMNS) + "|"
    rows = [_line(reference, variable) for reference, variable in enumerate(component.variables)]
    return "\n".join([head, *rows])


def page(components: Iterable[Component]) -> str:
    """Write the whole page."""
    parts = [f"## {c.name}\n\n{c.description}.\n\n{table(c)}\n" for c in components]
    return "\n".join([_HEAD, *parts])
