"""Findings of an experiment: numbers beside those of the paper, curves, and remarks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from seat_cosim.plotting import Panel


class Kind(Enum):
    """How a number was obtained, and so what its agreement with the paper is worth.

    Attributes
    ----------
    GIVEN
        An input, not a result.
    SIMULATED
        Result of the paper's own equations and parameters; nothing is fitted.
    FITTED
        Result to which parameters that are not published were fitted.
    PREDICTED
        Result of the same parameters, to which they were not fitted.
    """

    GIVEN = "given"
    SIMULATED = "simulated"
    FITTED = "fitted"
    PREDICTED = "predicted"


def text(value: float, digits: int, sign: str = "-") -> str:
    """Format a number, with the minus sign of typography.

    Parameters
    ----------
    value
        The number.
    digits
        Decimals.
    sign
        Sign option of a format specification.

    Examples
    --------
    >>> text(3.14159, 2, "+")
    '+3.14'
    """
    return f"{value:{sign}.{digits}f}".replace("-", "−")


@dataclass(frozen=True)
class Row:
    """A number, or the ends of a range, beside the paper's.

    Attributes
    ----------
    quantity, unit
        Quantity and its unit.
    paper
        The paper's words or numbers; empty where it gives none.
    values
        The number found, or the ends of the range.
    kind
        How it was obtained.
    remark
        Sentences on the difference from the paper, or on what the number shows; may be empty.
    digits
        Decimals of ``values``.
    """

    quantity: str
    unit: str
    paper: str
    values: tuple[float, ...]
    kind: Kind
    remark: str
    digits: int = 2

    @property
    def ours(self) -> str:
        """The values as text; a change in % has its sign."""
        sign = "+" if self.unit == "%" else "-"
        return " to ".join(text(value, self.digits, sign) for value in self.values)


@dataclass(frozen=True)
class Finding:
    """Counterpart of one figure or table of the paper.

    Attributes
    ----------
    key
        Key of its entry in :data:`seat_cosim.paper.contents.CONTENTS`.
    conditions
        Conditions under which it was made, in a few sentences.
    rows
        The numbers.
    panels
        Panels of the figure; none for a table.
    x_label
        Label of the axis that the panels share.
    """

    key: str
    conditions: str
    rows: Sequence[Row]
    panels: Sequence[Panel] = ()
    x_label: str = "Time (s)"
