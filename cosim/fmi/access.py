"""How values pass between an FMU and the table of all outputs, and what of it the loop in C can call."""

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
    """Some variables of one type, moved between the FMU and a part of the table of values.

    Attributes
    ----------
    call
        The call that moves them.
    index
        Index of each value in the table.
    factors, offsets
        Transform values on their way from the table; both None where they stay as they are.
    discrete
        Whether the variables are discrete outputs.
    direct
        Whether the FMU writes into the table itself, of which the call's buffer is a part.
    """

    call: AccessCall
    index: np.ndarray[Any, Any]
    factors: np.ndarray[Any, Any] | None = None
    offsets: np.ndarray[Any, Any] | None = None
    discrete: bool = False
    direct: bool = False


@dataclass(frozen=True)
class NativeCalls:
    """What the loop in C needs of an instance to call the FMU's own functions.

    Attributes
    ----------
    fmi_version
        Major version of FMI.
    component
        The instance's pointer.
    step_name, step
        Name and function of the step.
    inputs, outputs
        Variables that are set before it and got after it.
    """

    fmi_version: int
    component: int
    step_name: str
    step: Any
    inputs: Sequence[VariableAccess]
    outputs: Sequence[VariableAccess]
