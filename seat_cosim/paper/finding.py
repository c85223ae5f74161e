"""What comes out of an experiment: numbers beside the paper's, curves, and words about them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from seat_cosim.plotting import Panel


class Kind(Enum):
    """How far a number can be trusted to say something about the paper.

    Attributes
    ----------
    GIVEN
        An input, not a result.
    SIMULATED
        Of the paper's own equations and parameters; nothing is fitted.
    FITTED
        Parameters nobody published were chosen so that this number fits.
    PREDICTED
        Of the same parameters, where they were not fitted.
    """

    GIVEN = "given"
    SIMULATED = "simulated"
    FITTED = "fitted"
    PREDICTED = "predicted"


def text(value: float, digits: int, sign: str = "-") -> str:
    """Write a number, with a true minus; ``sign`` as in a format specification."""
    return f"{value:{sign}.{digits}f}".replace("-", "−")


@dataclass(frozen=True)
class Row:
    """A number, or the ends of a range, beside the paper's.

    Attributes
    ----------
    quantity, unit
        What, in which unit.
    paper
        In the paper's words or figures; empty where it says nothing.
    values
        Ours.
    kind
        Of ours.
    remark
        One sentence on the difference, or on what there is none from; empty where there is nothing to say.
    digits
        Of ours, behind the point.
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
        """The values as text; changes in % with their sign."""
        sign = "+" if self.unit == "%" else "-"
        return " to ".join(text(value, self.digits, sign) for value in self.values)


@dataclass(frozen=True)
class Finding:
    """What we have for one figure or table of the paper.

    Attributes
    ----------
    key
        As in :mod:`seat_cosim.paper.contents`.
    conditions
        How it was made, in a few sentences.
    rows
        The numbers.
    panels
        The figure; none for a table.
    x_label
        Of the axis the panels share.
    """

    key: str
    conditions: str
    rows: Sequence[Row]
    panels: Sequence[Panel] = ()
    x_label: str = "Time (s)"
