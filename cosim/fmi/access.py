"""How values pass between FMUs and the table of all outputs, and what of it a loop in C can call."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class AccessCall:
    """One call of an FMU's getter or setter: some variables of one type, moved between the FMU and a buffer.

    Attributes
    ----------
    name
        Of the function.
    function
        As fmpy loaded it.
    arguments
        What it is called with: instance, value references, pointer to ``buffer``, sizes.
    references
        Value references.
    buffer
        What the FMU reads or writes.
    """

    name: str
    function: Any
    arguments: tuple[Any, ...]
    references: Any
    buffer: np.ndarray[Any, Any]


@dataclass(frozen=True)
class VariableAccess:
    """Some variables of one type, moved between the FMU and a part of a table of values.

    Attributes
    ----------
    access
        How.
    places
        Where in the table each value belongs.
    factors, offsets
        What transforms values on their way from the table; both None where they stay as they are.
    discrete
        Whether the variables are discrete outputs.
    direct
        Whether the FMU writes into the table itself, of which ``buffer`` is a part.
    """

    access: AccessCall
    places: np.ndarray[Any, Any]
    factors: np.ndarray[Any, Any] | None = None
    offsets: np.ndarray[Any, Any] | None = None
    discrete: bool = False
    direct: bool = False


@dataclass(frozen=True)
class NativeCalls:
    """What a loop in C needs of an instance to call the FMU's own functions.

    Attributes
    ----------
    standard
        Major version of FMI.
    component
        The instance's pointer.
    step_name, step
        Name and function of the step.
    inputs, outputs
        What is set before it and got after it.
    """

    standard: int
    component: int
    step_name: str
    step: Any
    inputs: Sequence[VariableAccess]
    outputs: Sequence[VariableAccess]
