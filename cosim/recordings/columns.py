"""Columns of a measurement file: their names and units, as headers have them, and the choice of one by its name."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import NamedTuple

from cosim.errors import SetupError, did_you_mean, listed
from cosim.recordings.quantities import Quantity, find_unit, is_unit


class Column(NamedTuple):
    """A column or channel of a file.

    Attributes
    ----------
    text
        Its name as the file has it.
    name
        The name without a unit in brackets.
    unit
        Unit from brackets, from a row of units or from the file's metadata; None where the file has none.
    """

    text: str
    name: str
    unit: str | None = None


_BRACKETS = re.compile(r"(.*?)[\s_]*(?:\[([^\[\]]*)\]|\(([^()]*)\)|<([^<>]*)>|\{([^{}]*)\})\s*")
_ENDS = (
    re.compile(r"(.+?)\s+in\s+(\S+)"),
    re.compile(r"(.+?),\s*(\S+)"),
    re.compile(r"(.+)[\s_](\S+)"),
)
"""Forms of a header that ends in a unit without brackets."""

_COMMON = ("m", "mm", "cm", "µm", "m/s", "mm/s", "km/h", "s", "ms", "g", "N", "kN", "V", "mV", "A", "Hz", "°C", "bar")
"""Units whose names behind a stroke can be nothing else."""


def read_column(text: str, unit: str | None = None) -> Column:
    """Read the name of a column.

    Parameters
    ----------
    text
        Text of the header, for example ``acc [g]``.
    unit
        Unit from elsewhere, which wins; None or empty where there is none.

    Returns
    -------
    Column
        Name and unit.

    Examples
    --------
    >>> read_column("acc [g]")
    Column(text='acc [g]', name='acc', unit='g')
    """
    whole = " ".join(text.replace("\ufeff", "").split())
    name, inside = whole, None
    if found := _BRACKETS.fullmatch(whole):
        bracketed = next(group for group in found.groups()[1:] if group is not None).strip()
        is_square = found[2] is not None
        if found[1] and (is_square or is_unit(bracketed)):  # "acc (seat)" is a name
            name, inside = found[1].rstrip("_ "), bracketed
    elsewhere = (unit or "").strip().strip("[]() ")
    declared = elsewhere or inside
    return Column(whole, name, None if declared in (None, "", "-", "--", "n/a") else declared)


def unit_at_the_end(column: Column, quantity: Quantity) -> Column | None:
    """Read a unit of a quantity at the end of a name without brackets: ``Acc_z/m/s^2``, ``t_ms``, ``acc in g``.

    Parameters
    ----------
    column
        A column without a unit.
    quantity
        Quantity of the unit. Behind a stroke, a common unit of another quantity is found as well.

    Returns
    -------
    Column or None
        Name and unit; None where the name does not end in a unit.
    """
    if column.unit is not None:
        return None
    strokes = [at for at, character in enumerate(column.name) if character == "/" and column.name[:at].strip()]
    for at in strokes:
        name, unit = column.name[:at].strip(), column.name[at + 1 :].strip()
        if find_unit(unit, quantity) or unit in _COMMON:
            return column._replace(name=name, unit=unit)
    for pattern in _ENDS:
        found = pattern.fullmatch(column.name)
        if found and find_unit(found[2], quantity):
            return column._replace(name=found[1].rstrip("_ "), unit=found[2])
    return None


def _folded(text: str) -> str:
    return " ".join(text.split()).casefold()


def choose_column(columns: Sequence[Column], wanted: str, option: str, quantity: Quantity) -> tuple[int, Column]:
    """Choose a column by its name, with or without the unit, in capitals or not, or by its number as ``#2``.

    Parameters
    ----------
    columns
        Columns of the file.
    wanted
        The name that the user gave.
    option
        The option that it was given with, for messages.
    quantity
        The quantity that the column must have.

    Returns
    -------
    int
        Index of the column.
    Column
        The column with the unit that was found.

    Raises
    ------
    SetupError
        If there is no such column, or there are several.
    """
    read = [unit_at_the_end(column, quantity) or column for column in columns]
    if re.fullmatch(r"#\d+", wanted) and 1 <= int(wanted[1:]) <= len(columns):
        index = int(wanted[1:]) - 1
        return index, read[index]
    levels: tuple[Callable[[int], str], ...] = (
        lambda i: columns[i].text,
        lambda i: columns[i].name,
        lambda i: read[i].name,
    )
    for fold in (str, _folded):
        for name_of in levels:
            found = [i for i in range(len(columns)) if fold(name_of(i)) == fold(wanted)]
            if len(found) > 1:
                places = " and ".join(f"#{i + 1}" for i in found)
                raise SetupError(f"{option} {wanted}: expected one column, got {len(found)} of that name; use {places}")
            if found:
                return found[0], read[found[0]]
    names = [column.text for column in columns]
    raise SetupError(
        f"{option} {wanted}: expected one of the columns {listed(names, 20)}, got none of that name"
        f"{did_you_mean(wanted, [column.name for column in read])}"
    )
