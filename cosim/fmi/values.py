"""Values for variables: what a user gives, checked and converted to what the FMU takes."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from fmpy.model_description import ModelVariable

from cosim.errors import SetupError
from cosim.fmi.variable_types import KINDS

Scalar = float | bool | str
"""A value as a user gives it: enumerations by item name or number."""

Value = Scalar | Sequence[Any]
"""A scalar, or an array as a sequence, nested by rows or flat."""

Checked = float | str | tuple[float, ...]
"""A value as an FMU takes it: Booleans as 0.0 or 1.0, enumerations as their number, arrays flattened by rows."""

EXACT = 2**53
"""Whole numbers up to this magnitude are exact as float64."""

EVERYTHING = (-math.inf, math.inf)
"""The range of values that has no limits."""

_LARGEST_FLOAT32 = float(np.finfo(np.float32).max)

_TRUTHS = {"true": 1.0, "1": 1.0, "1.0": 1.0, "false": 0.0, "0": 0.0, "0.0": 0.0}


def integer_range(type_: str) -> tuple[float, float]:
    """Return the smallest and the largest value of an integer type.

    Examples
    --------
    >>> integer_range("Int8")
    (-128.0, 127.0)
    """
    bits = int(type_.removeprefix("U").removeprefix("Int")) if type_ != "Integer" else 32
    return (0.0, 2.0**bits - 1.0) if type_.startswith("U") else (-(2.0 ** (bits - 1)), 2.0 ** (bits - 1) - 1.0)


def value_range(variable: ModelVariable) -> tuple[float, float]:
    """Return the smallest and the largest number of a variable's type."""
    kind = KINDS[variable.type]
    if kind == "Enumeration":
        numbers = items_of(variable).values()
        return min(numbers), max(numbers)
    if kind == "Boolean":
        return 0.0, 1.0
    if variable.type == "Float32":
        return -_LARGEST_FLOAT32, _LARGEST_FLOAT32
    return integer_range(variable.type) if kind == "Integer" else EVERYTHING


def may_be_inexact(variable: ModelVariable) -> bool:
    """Whether values of a variable may not be exact as float64."""
    return KINDS[variable.type] == "Integer" and value_range(variable)[1] > EXACT


def items_of(variable: ModelVariable) -> dict[str, float]:
    """Return the items of an enumeration, name to number; empty for other types."""
    return {item.name: float(item.value) for item in variable.declaredType.items} if _is_enumeration(variable) else {}


def _is_enumeration(variable: ModelVariable) -> bool:
    return bool(variable.type == "Enumeration")


def array_of(where: str, shape: tuple[int, ...], given: Value) -> list[Any]:
    """Flatten the value of an array by rows.

    Parameters
    ----------
    where
        Name of the variable, for messages.
    shape
        Of the variable.
    given
        A sequence, nested or flat; or a text: numbers between spaces or commas, rows between semicolons, in brackets or
        not.

    Returns
    -------
    list
        The values of the elements.

    Raises
    ------
    SetupError
        If the number of values or the shape of a nested sequence is not that of the variable.
    """
    count, expected = math.prod(shape), f"expected {' x '.join(map(str, shape))} values"
    if isinstance(given, str):
        given = [word for word in re.split(r"[\s,;\[\]]+", given.strip()) if word]
    if isinstance(given, float | int | bool):
        given = [given]
    try:
        array = np.array(given, dtype=object)
        ragged = any(isinstance(value, Sequence | np.ndarray) and not isinstance(value, str) for value in array.flat)
    except ValueError:
        ragged = True
    if ragged:
        raise SetupError(f"{where}: {expected}, got rows of different lengths")
    if array.size != count or (array.ndim > 1 and array.shape != shape):
        got = " x ".join(map(str, array.shape)) if array.ndim > 1 else str(array.size)
        raise SetupError(f"{where}: {expected}, got {got}")
    return list(array.ravel())


def number(variable: ModelVariable, where: str, given: Scalar) -> float:
    """Convert a value to a number as the variable's type requires.

    Parameters
    ----------
    variable
        Which.
    where
        Its name, for messages.
    given
        Number, Boolean, or text as from a command line; an enumeration's item by name or number. A number is never
        taken for the name of an item.

    Returns
    -------
    float
        Booleans as 0.0 or 1.0, enumerations as their number.

    Raises
    ------
    SetupError
        If the value does not fit the type.
    """
    kind = KINDS[variable.type]
    if isinstance(given, float | int) and not isinstance(given, bool) and kind == "Real":
        try:
            return float(given)
        except OverflowError:
            return math.inf  # or the other, which is not finite either
    text = str(given).strip()
    if kind == "Boolean":
        if text.lower() not in _TRUTHS:
            raise SetupError(f"{where}: expected true or false, got {given}")
        return _TRUTHS[text.lower()]
    items = items_of(variable)
    if isinstance(given, str) and text in items:
        return items[text]
    return _parsed(variable, where, text, given, items)


def _parsed(variable: ModelVariable, where: str, text: str, given: Scalar, items: dict[str, float]) -> float:
    """Read a number, or the number of an item."""
    whole = KINDS[variable.type] == "Integer"
    expected = f"one of {', '.join(items)}" if items else "a whole number" if whole else "a number"
    try:
        found = float(text)
        exact = int(text) if whole and re.fullmatch(r"[-+]?\d+", text) else None
    except ValueError:
        raise SetupError(f"{where}: expected {'a number' if whole else expected}, got {given}") from None
    if (items and found not in items.values()) or (whole and not found.is_integer()):
        raise SetupError(f"{where}: expected {expected}, got {given}")
    if whole:
        low, high = integer_range(variable.type)
        if not low <= found <= high:
            raise SetupError(f"{where}: expected a value in [{low:.0f}, {high:.0f}], got {given}")
        if exact is not None and exact != int(found):
            raise SetupError(f"{where}: expected a whole number up to 2^53 either way, got {given}")
    return found


def starts(variable: ModelVariable, count: int) -> tuple[float, ...] | None:
    """Return the start values of a numeric variable's elements.

    Parameters
    ----------
    variable
        Which; of its start value's text, one value stands for all elements.
    count
        How many elements it has.

    Returns
    -------
    tuple of float or None
        None where the description has none, or not as many as there are elements.
    """
    if variable.start is None:
        return None
    words: Iterable[str] = str(variable.start).split()
    found = tuple(_TRUTHS[word.lower()] if word.lower() in _TRUTHS else float(word) for word in words)
    if len(found) == 1:
        return found * count
    return found if len(found) == count else None
