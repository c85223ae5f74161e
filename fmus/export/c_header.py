"""What the C code of a native FMU knows of its component: ``model.h``, written from the one declaration."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence

from fmus.component import LATEST_TIME, LONGEST_STEP, SAME_TIME, Component, StateField, state_fields
from fmus.export.model_description import LOG_CATEGORIES
from fmus.variables import LONGEST_TEXT, Variable, variables_of


def prefix(component: Component) -> str:
    """Return what the names of a component's C kernel begin with, e.g. ``seat_plant`` for ``SeatPlant``."""
    return re.sub(r"(?<!^)(?=[A-Z])", "_", component.name).lower()


def _number(value: float | None, otherwise: str) -> str:
    return otherwise if value is None else repr(float(value))


def _type(variable: Variable) -> str:
    if variable.type is str:
        return "TEXT"
    return "BOOLEAN" if variable.type is bool else "INTEGER" if issubclass(variable.type, int) else "REAL"


def _bounds(variable: Variable) -> tuple[float | None, float | None]:
    if variable.items:
        if sorted(variable.items.values()) != list(range(1, len(variable.items) + 1)):
            raise ValueError(f"enumeration {variable.name}: expected items counted from 1, got {variable.items}")
        return 1.0, float(len(variable.items))
    return (0.0, 1.0) if variable.type is bool else (variable.minimum, variable.maximum)


def _table_row(variable: Variable) -> str:
    low, high = _bounds(variable)
    cells = (
        f'"{variable.name}"',
        f'"{variable.unit or ""}"',
        f"TYPE_{_type(variable)}",
        f"CAUSALITY_{variable.causality.upper()}",
        f"VARIABILITY_{variable.variability.upper()}",
        _number(None if isinstance(variable.start, str) else variable.start, "0.0"),
        _number(low, "-INFINITY"),
        _number(high, "INFINITY"),
    )
    return "    {" + ", ".join(cells) + "},"


def _read(variable: Variable, reference: int, texts: Sequence[Variable]) -> str:
    """Write the expression that takes a variable's value from the table of values, or from the texts."""
    if variable in texts:
        return f"texts[{texts.index(variable)}]"
    value = f"values[{reference}]"
    return {"BOOLEAN": f"{value} != 0.0", "INTEGER": f"(int){value}", "REAL": value}[_type(variable)]


def _taking(
    name: str, struct: str, members: list[tuple[int, Variable]], texts: Sequence[Variable] | None = None
) -> Iterator[str]:
    """Write a function that takes a struct from the table of values and, where given, the texts in their order."""
    arguments = "const double values[]" if texts is None else "const double values[], const char *const texts[]"
    yield f"static inline {struct} {name}({arguments})"
    yield "{"
    yield f"    {struct} taken = {{0}};"
    yield "    (void)values;" if texts is None else "    (void)values, (void)texts;"
    yield from (f"    taken.{v.field} = {_read(v, reference, texts or ())};" for reference, v in members)
    yield "    return taken;"
    yield "}\n"


def _releasing(component: Component, texts: Sequence[Variable]) -> Iterator[str]:
    """Write how coefficients are released: a kernel that takes names of files may hold memory."""
    yield "static inline void model_release(ModelCoefficients *coefficients)"
    yield "{"
    yield f"    {prefix(component)}_release(coefficients);" if texts else "    (void)coefficients;"
    yield "}\n"


def _storing(members: list[tuple[int, Variable]]) -> Iterator[str]:
    yield "static inline void model_store_outputs(const ModelOutputs *outputs, double values[VARIABLE_COUNT])"
    yield "{"
    yield from (f"    values[{reference}] = (double)outputs->{v.field};" for reference, v in members)
    yield "}\n"


def _packing(component: Component) -> Iterator[str]:
    """Write how a state becomes numbers and comes back."""
    yield "static inline void model_pack(const ModelState *state, double *packed)"
    yield "{"
    yield "    (void)state, (void)packed;"
    yield from (f"    {loop}*packed++ = (double)state->{place};" for _, loop, place in _places(component))
    yield "}\n"
    yield "static inline void model_unpack(ModelState *state, const double *packed)"
    yield "{"
    yield "    (void)state, (void)packed;"
    for field, loop, place in _places(component):
        yield f"    {loop}state->{place} = *packed++{' != 0.0' if field.kind is bool else ''};"
    yield "}\n"
    yield from _copying(state_fields(component.state))


def _copying(fields: tuple[StateField, ...]) -> Iterator[str]:
    """Write how a state is copied: what is not in use of its last field costs nothing."""
    last = fields[-1] if fields and fields[-1].used else None
    yield "/* How many numbers at the end of a state are in use, where that changes; those behind them are zero. */"
    yield "static inline size_t model_tail(const ModelState *state)"
    yield "{"
    yield "    (void)state;"
    yield f"    return {f'(size_t)state->{last.used}' if last else '0'};"
    yield "}\n"
    yield "static inline void model_copy(ModelState *to, const ModelState *from, size_t tail)"
    yield "{"
    yield f"    memcpy(to, from, {f'offsetof(ModelState, {last.path})' if last else 'sizeof *to'});"
    yield "    (void)tail;"
    if last:
        yield "    if (tail > 0) {"
        yield f"        memcpy(to->{last.path}, from->{last.path}, tail * sizeof *to->{last.path});"
        yield "    }"
    yield "}\n"


def _places(component: Component) -> Iterator[tuple[StateField, str, str]]:
    """Yield each field of a state, the loop over its numbers where they are many, and where one of them stands."""
    for field in state_fields(component.state):
        if field.length is None:
            yield field, "", field.path
        else:
            yield field, f"for (int i = 0; i < {field.length}; ++i) ", f"{field.path}[i]"


def _start(variable: Variable) -> str:
    if variable.type is bool:
        return str(bool(variable.start)).lower()
    if isinstance(variable.start, str):
        return json.dumps(variable.start)
    return str(int(variable.start or 0)) if issubclass(variable.type, int) else f"(real){variable.start!r}"


def defaults_header(component: Component) -> str:
    """Write ``defaults.h``: the start values of all parameters as an initialiser of the kernel's parameters.

    Parameters
    ----------
    component
        Whose. The macro's argument is the type of its numbers.
    """
    records = [component.parameters, *([component.constants] if component.constants else [])]
    variables = [variable for record in records for variable in variables_of(record)]
    lines = ", \\\n    ".join(f".{v.field} = {_start(v)}" for v in variables)
    return f"""/* Generated from the declaration of {component.name}: do not edit.
 *
 *   const {prefix(component)}_parameters parameters = {{{prefix(component).upper()}_DEFAULTS(double)}};
 */
#define {prefix(component).upper()}_DEFAULTS(real) \\
    {lines}
"""


def model_header(component: Component, token: str) -> str:
    """Write ``model.h`` of a component.

    Parameters
    ----------
    component
        Whose variables; its C kernel lies beside its Python module, with the same names of fields.
    token
        The FMU's GUID or instantiation token.
    """
    numbered = list(enumerate(component.variables))
    of = {
        kind: [(i, v) for i, v in numbered if v.causality in causalities]
        for kind, causalities in (("INPUT", ("input",)), ("OUTPUT", ("output",)), ("", ("parameter", "local")))
    }
    categories = list(LOG_CATEGORIES)
    texts = [variable for _, variable in numbered if variable.type is str]
    kernel = component.module.rpartition(".")[2]
    state_count = sum(field.length or 1 for field in state_fields(component.state))
    types = ("parameters", "coefficients", "state", "inputs", "outputs")
    functions = ("prepare", "warning", "is_valid_state", "initial", "advance")
    lines = [
        f"/* Generated from the declaration of {component.name}: do not edit. See component.h. */",
        "#ifndef MODEL_H\n#define MODEL_H\n",
        f'#include "defaults.h"\n#include "{kernel}.h"\n',
        "#include <math.h>\n#include <stdbool.h>\n#include <stddef.h>\n#include <string.h>\n",
        f'#define MODEL_NAME "{component.name}"',
        f'#define MODEL_TOKEN "{token}"\n',
        "/* Times in s: what is the same time, the largest magnitude of a time, the longest step. */",
        f"#define SAME_TIME {SAME_TIME!r}",
        f"#define LATEST_TIME {LATEST_TIME!r}",
        f"#define LONGEST_STEP {LONGEST_STEP!r}\n",
        "#define MODEL_LOG_CATEGORIES " + ", ".join(f'"{name}"' for name in categories),
        f"enum {{ MODEL_WARNINGS = {categories.index('logStatusWarning')}, "
        f"MODEL_ERRORS = {categories.index('logStatusError')}, "
        f"MODEL_ALL_MESSAGES = {categories.index('logAll')} }};\n",
        f"enum {{ VARIABLE_COUNT = {len(numbered)}, STATE_COUNT = {state_count} }};",
        *(
            f"enum {{ FIRST_{kind} = {members[0][0] if members else 0}, {kind}_COUNT = {len(members)} }};"
            for kind, members in of.items()
            if kind
        ),
        f"enum {{ TEXT_COUNT = {len(texts)}, LONGEST_TEXT = {LONGEST_TEXT} }};",
        f"#define MODEL_TEXTS {''.join(f'{json.dumps(v.start)}, ' for v in texts)}NULL",
        "\n#define MODEL_VARIABLES \\",
        " \\\n".join(_table_row(variable) for _, variable in numbered) + "\n",
        *(f"typedef {prefix(component)}_{name} Model{name.capitalize()};" for name in types),
        *(f"#define model_{name} {prefix(component)}_{name}" for name in functions),
        "",
        *_taking("model_inputs", "ModelInputs", of["INPUT"]),
        *_taking("model_parameters", "ModelParameters", of[""], texts),
        *_releasing(component, texts),
        *_storing(of["OUTPUT"]),
        *_packing(component),
        f"#define MODEL_DEFAULTS {prefix(component).upper()}_DEFAULTS(double)\n",
        "#endif",
    ]
    return "\n".join(lines) + "\n"
