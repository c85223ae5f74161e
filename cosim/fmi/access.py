"""How values pass between an FMU and the table of all outputs, and what of it the loop in C can call."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cosim.fmi.values import EXACT
from cosim.units import IDENTITY, Linear


@dataclass(frozen=True)
class OutputEntry:
    """An element of an output in the table of values.

    Attributes
    ----------
    name
        Of the element.
    index
        In the table.
    connected
        Whether an input is connected to it.
    """

    name: str
    index: int
    connected: bool


@dataclass(frozen=True)
class InputEntry:
    """What an element of an input takes from the table of values.

    Attributes
    ----------
    name
        Of the element.
    index
        In the table.
    transformation
        From the value there to that of the input.
    range
        Smallest and largest value that the input's type takes; None where all values fit.
    """

    name: str
    index: int
    transformation: Linear = IDENTITY
    range: tuple[float, float] | None = None


@dataclass(frozen=True)
class VariableMapping:
    """Where the variables of a component are in the table of values.

    Attributes
    ----------
    outputs
        All outputs, each with its elements.
    inputs
        Inputs with a connection, each with its elements.
    """

    outputs: dict[str, list[OutputEntry]] = field(default_factory=dict)
    inputs: dict[str, list[InputEntry]] = field(default_factory=dict)


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
        Value references, one for each variable.
    buffer
        What the FMU reads or writes: the elements of all variables.
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
    names
        Names of their elements.
    index
        Index of each element in the table.
    factors, offsets
        Transform values on their way from the table; both None where they stay as they are.
    low, high
        Range of each element that the type of an input takes; both None where all values fit.
    connected
        Whether a connection takes each element from the table, of types whose values may not be exact as float64; None
        for all others.
    sampled
        Whether the variables are outputs at the begin of a step.
    direct
        Whether the FMU writes into the table itself, of which the call's buffer is a part.
    """

    call: AccessCall
    names: Sequence[str]
    index: np.ndarray[Any, Any]
    factors: np.ndarray[Any, Any] | None = None
    offsets: np.ndarray[Any, Any] | None = None
    low: np.ndarray[Any, Any] | None = None
    high: np.ndarray[Any, Any] | None = None
    connected: np.ndarray[Any, Any] | None = None
    sampled: bool = False
    direct: bool = False

    def fill_buffer(self, table: np.ndarray[Any, Any]) -> int | None:
        """Fill the buffer of a setter from the table.

        Parameters
        ----------
        table
            The table of values, float64.

        Returns
        -------
        int or None
            The first element whose value is out of range; then the buffer stays as it was.
        """
        values = table[self.index]
        if self.factors is not None:
            values = self.factors * values + self.offsets
        if self.low is not None:
            outside = ~((self.low <= values) & (values <= self.high))
            if outside.any():
                return int(np.flatnonzero(outside)[0])
        self.call.buffer[:] = values
        return None

    def empty_buffer(self, table: np.ndarray[Any, Any]) -> Iterable[int]:
        """Empty the buffer of a getter into the table.

        Parameters
        ----------
        table
            The table of values, float64.

        Returns
        -------
        iterable of int
            Elements whose values are not exact in the table.
        """
        if not self.direct:
            table[self.index] = self.call.buffer
            if self.connected is not None:
                inexact = self.call.buffer > EXACT
                if np.issubdtype(self.call.buffer.dtype, np.signedinteger):
                    inexact |= self.call.buffer < -EXACT
                return [int(element) for element in np.flatnonzero(inexact)]
        return ()

    def problem(self, element: int, table: np.ndarray[Any, Any]) -> str:
        """Describe a value that does not fit.

        Parameters
        ----------
        element
            Number of the element in this access.
        table
            The table of values, float64.

        Returns
        -------
        str
            Name, what was expected, and the value.
        """
        if self.low is None or self.high is None:
            value = self.call.buffer[element]
            return f"{self.names[element]}: expected a whole number up to 2^53 either way, got {value}"
        value = table[self.index[element]]
        if self.factors is not None and self.offsets is not None:
            value = self.factors[element] * value + self.offsets[element]
        low, high = self.low[element], self.high[element]
        return f"{self.names[element]}: expected a value in [{low:.9g}, {high:.9g}], got {value:.17g}"


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
