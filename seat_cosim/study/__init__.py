"""Studies of the seat suspension: sweeps whose files speak of drivers, gains, modes, scenarios and metrics of rides.

>>> from seat_cosim.study import Study, read, sweep
>>> result = sweep(read("driver_masses"), "results/masses", processes=2)        # doctest: +SKIP
"""

from cosim.sweep.design import Block, Range, Values, Variable
from cosim.sweep.study import Study
from cosim.sweep.sweep import SweepResult, estimate, sweep
from seat_cosim.study.shipped_studies import SHIPPED, read
from seat_cosim.study.vocabulary import SeatVocabulary

__all__ = [
    "SHIPPED",
    "Block",
    "Range",
    "SeatVocabulary",
    "Study",
    "SweepResult",
    "Values",
    "Variable",
    "estimate",
    "read",
    "sweep",
]
