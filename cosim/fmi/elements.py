"""Elements of variables: the numbers that arrays of FMI 3 are made of.

An array is flattened in row-major order, as FMI 3 passes it. Its elements are named ``y[1]``, ``y[2,1]``, counted
from 1 as in structured variable names. A scalar variable has one element, of its own name. Sizes may follow from
structural parameters (FMI 3.0, 2.4.7.5.1).
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from itertools import product
from typing import NamedTuple

from fmpy.model_description import ModelVariable

MOST_ELEMENTS = 10**6
"""Most elements of all variables of an FMU together."""

_SUBSCRIPTS = re.compile(r"(?P<name>.+)\[(?P<subscripts>\d+(?:\s*,\s*\d+)*)\]")


class Elements(NamedTuple):
    """Some elements of one variable.

    Attributes
    ----------
    variable
        Name of the variable; that of its owner where it is an alias.
    places
        Places in the flattened array, counted from 0.
    shape
        Of the whole variable; empty for a scalar.
    alias
        Name by which the variable was found.
    """

    variable: str
    places: tuple[int, ...]
    shape: tuple[int, ...]
    alias: str

    @property
    def names(self) -> list[str]:
        """Names of the elements, by the name with which the variable was found."""
        names = element_names(self.alias, self.shape)
        return [names[place] for place in self.places]

    @property
    def owner(self) -> Elements:
        """The same elements by the name of the alias's owner."""
        return self._replace(alias=self.variable)

    @property
    def is_whole(self) -> bool:
        """Whether these are all elements of the variable."""
        return len(self.places) == math.prod(self.shape)


def element_names(variable: str, shape: tuple[int, ...]) -> list[str]:
    """Name the elements of a variable by its name and its shape; a scalar has one, of its own name.

    Parameters
    ----------
    variable
        Name of the variable.
    shape
        Its shape.

    Returns
    -------
    list of str
        In row-major order.

    Examples
    --------
    >>> element_names("y", (2, 2))
    ['y[1,1]', 'y[1,2]', 'y[2,1]', 'y[2,2]']
    """
    if not shape:
        return [variable]
    subscripts = product(*(range(1, size + 1) for size in shape))
    return [f"{variable}[{','.join(map(str, each))}]" for each in subscripts]


def array_name(element: str) -> str:
    """Return the name of the array that an element is of, as its name says; empty for other names."""
    match = _SUBSCRIPTS.fullmatch(element)
    return match["name"] if match else ""


def sizes_problems(variables: Iterable[ModelVariable], sizes: Mapping[int, int]) -> list[str]:
    """Find arrays whose sizes make no sense.

    Parameters
    ----------
    variables
        Of an FMU.
    sizes
        Value reference of each structural parameter to its value.

    Returns
    -------
    list of str
        One line for each problem.
    """
    problems, total = [], 0
    for variable in variables:
        shape = shape_of(variable, sizes)
        if any(size < 0 for size in shape):
            problems.append(f"{variable.name}: expected dimensions of at least 0, got {list(shape)}")
        total += math.prod(shape)
    if total > MOST_ELEMENTS:
        problems.append(f"expected at most {MOST_ELEMENTS} elements of all variables together, got {total}")
    return problems


def shape_of(variable: ModelVariable, sizes: Mapping[int, int]) -> tuple[int, ...]:
    """Return the shape of a variable; empty for a scalar.

    Parameters
    ----------
    variable
        Which.
    sizes
        Value reference of each structural parameter to its value.
    """
    return tuple(
        int(dimension.start) if dimension.valueReference is None else sizes[dimension.valueReference]
        for dimension in variable.dimensions
    )


def find_elements(text: str, variables: Mapping[str, ModelVariable], sizes: Mapping[int, int]) -> Elements | None:
    """Find the elements of a name: a variable's, all of it, or one element's.

    The exact name of a variable wins over that of an element; an alias stands for its variable.

    Parameters
    ----------
    text
        The name.
    variables
        Of the FMU, by name.
    sizes
        Value reference of each structural parameter to its value.

    Returns
    -------
    Elements or None
        None where there is no such variable or element.
    """
    if text in variables:
        shape = shape_of(variables[text], sizes)
        return Elements(owner(variables[text]), tuple(range(math.prod(shape))), shape, text)
    match = _SUBSCRIPTS.fullmatch(text)
    if match is None or match["name"] not in variables:
        return None
    variable = variables[match["name"]]
    shape = shape_of(variable, sizes)
    subscripts = [int(number) for number in match["subscripts"].split(",")]
    if len(subscripts) != len(shape) or any(not 1 <= i <= size for i, size in zip(subscripts, shape, strict=True)):
        return None
    place = 0
    for subscript, size in zip(subscripts, shape, strict=True):
        place = place * size + subscript - 1
    return Elements(owner(variable), (place,), shape, variable.name)


def owner(variable: ModelVariable) -> str:
    """Return the name of a variable, that of its owner where it is an alias."""
    return str(variable.alias.name if variable.alias is not None else variable.name)
