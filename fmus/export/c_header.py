"""C headers of a native FMU, generated from the declaration of its component: ``model.h`` and ``defaults.h``.

The C code is in the templates ``model.h.jinja`` and ``defaults.h.jinja``. This module converts values to C literals.
"""

from __future__ import annotations

import json
import re
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from fmus.component import MAX_STEP_SIZE, MAX_TIME, TIME_TOLERANCE, Component, state_fields
from fmus.export.model_description import LOG_CATEGORIES
from fmus.variables import MAX_TEXT_SIZE, VariableDeclaration, left_out_of


def prefix(component: Component) -> str:
    """Return the prefix of the names in a component's C kernel.

    Parameters
    ----------
    component
        The component.

    Returns
    -------
    str
        E.g. ``seat_plant`` for ``SeatPlant``.
    """
    return re.sub(r"(?<!^)(?=[A-Z])", "_", component.name).lower()


def _type(variable: VariableDeclaration) -> str:
    if variable.type is str:
        return "TEXT"
    return "BOOLEAN" if variable.type is bool else "INTEGER" if issubclass(variable.type, int) else "REAL"


def _number(value: float | str | None, otherwise: str) -> str:
    return otherwise if value is None or isinstance(value, str) else repr(float(value))


def _bounds(variable: VariableDeclaration) -> tuple[str, str]:
    """Return minimum and maximum as C literals."""
    low, high = variable.minimum, variable.maximum
    if variable.items:
        low, high = 1.0, float(len(variable.items))
        if sorted(variable.items.values()) != list(range(1, len(variable.items) + 1)):
            raise ValueError(f"enumeration {variable.name}: expected items counted from 1, got {variable.items}")
    elif variable.type is bool:
        low, high = 0.0, 1.0
    return _number(low, "-INFINITY"), _number(high, "INFINITY")


def _initializer(variable: VariableDeclaration) -> str:
    """Return the start value as an initialiser in C; ``real`` is the type of the kernel's numbers."""
    if variable.type is bool:
        return str(bool(variable.start)).lower()
    if isinstance(variable.start, str):
        return json.dumps(variable.start)
    return str(int(variable.start or 0)) if issubclass(variable.type, int) else f"(real){variable.start!r}"


def _render(template: str, component: Component, **values: Any) -> str:
    environment = Environment(
        loader=PackageLoader("fmus.export", "."),
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        undefined=StrictUndefined,
    )
    environment.filters |= {"c_string": json.dumps, "number": _number, "initializer": _initializer}
    environment.globals |= {"type_of": _type, "bounds_of": _bounds}
    return environment.get_template(template).render(
        component=component,
        prefix=prefix(component),
        variables=component.variables,
        inputs=[v for v in component.variables if v.causality == "input"],
        outputs=[v for v in component.variables if v.causality == "output"],
        parameters=[v for v in component.variables if v.causality in ("parameter", "local")],
        left_out=list(left_out_of(component.parameters)),
        **values,
    )


def defaults_header(component: Component) -> str:
    """Generate ``defaults.h``: the start values of all parameters as an initialiser of the kernel's parameters.

    Parameters
    ----------
    component
        The component.

    Returns
    -------
    str
        Text of the header. The argument of its macro is the type of the numbers.
    """
    return _render("defaults.h.jinja", component)


def model_header(component: Component, token: str) -> str:
    """Generate ``model.h``, see ``fmus/native/component.h`` for its content.

    Parameters
    ----------
    component
        The component. Its C kernel is beside its Python module, with the same names of fields.
    token
        GUID or instantiation token of the FMU.

    Returns
    -------
    str
        Text of the header.
    """
    fields = state_fields(component.state)
    return _render(
        "model.h.jinja",
        component,
        token=token,
        kernel=component.module.rpartition(".")[2],
        limits={"TIME_TOLERANCE": TIME_TOLERANCE, "MAX_TIME": MAX_TIME, "MAX_STEP_SIZE": MAX_STEP_SIZE},
        max_text_size=MAX_TEXT_SIZE,
        categories=list(LOG_CATEGORIES),
        texts=[v for v in component.variables if v.type is str],
        fields=fields,
        state_count=sum(field.length or 1 for field in fields),
        tail=fields[-1] if fields and fields[-1].length_field else None,
    )
