"""Designs of experiments: which values the variables of a sweep have in each run.

A design is a product of blocks, the first of which varies slowest. Run ``i`` has the same values whoever asks, and in
whatever order.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal, get_args

import numpy as np

from cosim.errors import SetupError, did_you_mean
from cosim.fmi.values import Scalar

Point = dict[str, Scalar]
"""Variable to its value in a run."""

Scale = Literal["linear", "log"]
SCALES: tuple[Scale, ...] = get_args(Scale)

MAX_RUNS = 10**8
"""Largest number of runs of a design."""


@dataclass(frozen=True)
class Values:
    """The values that a variable takes.

    Attributes
    ----------
    values
        At least one; each once, unless they stand side by side with those of other variables.
    """

    values: tuple[Scalar, ...]

    def __post_init__(self) -> None:
        """Check the values."""
        object.__setattr__(self, "values", tuple(self.values))
        if not self.values:
            raise SetupError("values: expected at least one, got none")

    def at(self, shares: np.ndarray[Any, Any]) -> list[Scalar]:
        """Return the values at shares from 0 to 1 of the list; each has the same share.

        Parameters
        ----------
        shares
            Shape (runs,).
        """
        last = len(self.values) - 1
        return [self.values[min(int(share * len(self.values)), last)] for share in shares.tolist()]

    @property
    def extremes(self) -> tuple[Scalar, ...]:
        """All values, in their order."""
        return self.values


@dataclass(frozen=True)
class Range:
    """An interval in which a variable is distributed evenly.

    Attributes
    ----------
    low, high
        Its ends.
    scale
        ``linear``, or ``log`` where the logarithm is distributed evenly.
    integer
        Whether the variable is a whole number; each from ``low`` to ``high`` has the same share.
    """

    low: float
    high: float
    scale: Scale = "linear"
    integer: bool = False

    def __post_init__(self) -> None:
        """Check the ends."""
        problems = []
        ends = f"{self.low} and {self.high}"
        if not (math.isfinite(self.low) and math.isfinite(self.high) and self.low < self.high):
            problems.append(f"range: expected finite low < high, got {ends}")
        if self.scale not in SCALES:
            problems.append(f"scale: expected {' or '.join(SCALES)}, got {self.scale}")
        elif self.scale == "log" and not self.low > 0.0:
            problems.append(f"range: expected low above 0 for scale log, got {ends}")
        if self.integer and not (float(self.low).is_integer() and float(self.high).is_integer()):
            problems.append(f"range: expected whole numbers, got {ends}")
        if problems:
            raise SetupError(*problems)

    def at(self, shares: np.ndarray[Any, Any]) -> list[Scalar]:
        """Return the values at shares from 0 to 1 of the interval.

        Parameters
        ----------
        shares
            Shape (runs,).
        """
        low, high = (self.low, self.high + 1.0) if self.integer else (self.low, self.high)
        found = low + (high - low) * shares if self.scale == "linear" else low * (high / low) ** shares
        if not self.integer:
            return list(np.clip(found, self.low, self.high).tolist())
        return [min(int(value), int(self.high)) for value in found.tolist()]

    @property
    def extremes(self) -> tuple[Scalar, ...]:
        """Both ends of the range."""
        return (int(self.low), int(self.high)) if self.integer else (self.low, self.high)


Domain = Values | Range


@dataclass(frozen=True)
class Variable:
    """A quantity that a sweep varies.

    Attributes
    ----------
    domain
        The values that it takes.
    sets
        Parameters that take its value, as ``component.variable``: one variable may set several alike.
    scales
        Parameters whose value in the run it multiplies.
    adds
        Parameters to whose value in the run it is added.
    unit
        For the dataset; that of the first parameter which it sets where None.
    """

    domain: Domain
    sets: tuple[str, ...] = ()
    scales: tuple[str, ...] = ()
    adds: tuple[str, ...] = ()
    unit: str | None = None

    @property
    def targets(self) -> tuple[str, ...]:
        """Parameters on which it acts; empty for a variable whose name says it."""
        return (*self.sets, *self.scales, *self.adds)


DESIGNS = ("grid", "list", "samples", "latin-hypercube", "sobol")
"""Names of the designs: all combinations; values side by side; given points; two that fill space."""

_RANDOM = ("latin-hypercube", "sobol")


@dataclass(frozen=True)
class Block:
    """Variables that are varied together.

    Attributes
    ----------
    variables
        Name to variable.
    design
        One of :data:`DESIGNS`.
    n
        Number of points of a Latin hypercube or a Sobol sequence; a power of two for the latter.
    seed
        Of the same.
    samples
        Points of ``samples``: values of all variables, whose domains follow.
    """

    variables: Mapping[str, Variable] = field(default_factory=dict)
    design: str = "grid"
    n: int | None = None
    seed: int = 1
    samples: tuple[Mapping[str, Scalar], ...] = ()

    def __post_init__(self) -> None:
        """Check that the fields fit each other."""
        problems = list(self._problems())
        if problems:
            raise SetupError(*problems)

    def _problems(self) -> Iterator[str]:
        if self.design not in DESIGNS:
            yield f"design: expected one of {', '.join(DESIGNS)}, got {self.design}{did_you_mean(self.design, DESIGNS)}"
            return
        if not self.variables:
            yield "variables: expected at least one, got none"
        yield from self._number_problems()
        ranges = [name for name, each in self.variables.items() if isinstance(each.domain, Range)]
        if ranges and self.design not in _RANDOM:
            yield (
                f"{ranges[0]}: expected a list of values, or linspace or logspace, in design {self.design}, got a range"
            )
        for name, each in self.variables.items():
            values = each.domain.extremes
            if self.design != "list" and len({(type(value), value) for value in values}) < len(values):
                yield f"{name}: expected each value once, got {', '.join(map(str, values))}"
        lengths = {len(each.domain.values) for each in self.variables.values() if isinstance(each.domain, Values)}
        if self.design == "list" and len(lengths) > 1:
            yield f"variables: expected lists of one length, got {', '.join(map(str, sorted(lengths)))} values"
        for number, sample in enumerate(self.samples, 1):
            if set(sample) != set(self.variables):
                expected, got = (", ".join(sorted(names)) for names in (self.variables, sample))
                yield f"samples, number {number}: expected values of {expected}, got {got or 'none'}"

    def _number_problems(self) -> Iterator[str]:
        is_random = self.design in _RANDOM
        if is_random and (self.n is None or not 0 < self.n <= MAX_RUNS):
            yield f"n: expected the number of points, 1 to {MAX_RUNS}, of design {self.design}, got {self.n or 'none'}"
        elif self.n is not None and not is_random:
            yield f"n: expected with design {' or '.join(_RANDOM)}, got design {self.design}"
        elif self.design == "sobol" and self.n is not None and self.n & (self.n - 1):
            below = 2 ** (self.n.bit_length() - 1)
            yield f"n: expected a power of two, such as {below} or {2 * below}, of design sobol, got {self.n}"
        if not 0 <= self.seed < 2**63:
            yield f"seed: expected a whole number from 0, got {self.seed}"

    @property
    def runs(self) -> int:
        """Number of points of the block."""
        if self.n is not None:
            return self.n
        if self.design == "samples":
            return len(self.samples)
        lengths = [len(each.domain.extremes) for each in self.variables.values()]
        return lengths[0] if self.design == "list" else math.prod(lengths)

    def point(self, index: int) -> Point:
        """Return the values at a point.

        Parameters
        ----------
        index
            From 0.
        """
        if self.design == "grid":
            found, names = {}, list(self.variables)
            for name in reversed(names):  # the first varies slowest
                values = self.variables[name].domain.extremes
                index, place = divmod(index, len(values))
                found[name] = values[place]
            return {name: found[name] for name in names}
        return {name: values[index] for name, values in self._columns.items()}

    @cached_property
    def _columns(self) -> dict[str, Sequence[Scalar]]:
        """Values of each variable in all points."""
        if self.design == "samples":
            return {name: [sample[name] for sample in self.samples] for name in self.variables}
        if self.design == "list":
            return {name: each.domain.extremes for name, each in self.variables.items()}
        shares = _shares(self.design, len(self.variables), self.runs, self.seed)
        return {name: each.domain.at(shares[:, i]) for i, (name, each) in enumerate(self.variables.items())}


def _shares(design: str, variables: int, runs: int, seed: int) -> np.ndarray[Any, Any]:
    """Return points that fill the unit cube, shape (runs, variables)."""
    from scipy.stats import qmc  # takes a second to load

    kind = qmc.LatinHypercube if design == "latin-hypercube" else qmc.Sobol
    generator = np.random.default_rng(seed)
    try:
        sampler = kind(variables, rng=generator)
    except TypeError:  # before SciPy 1.15
        sampler = kind(variables, seed=generator)
    return np.asarray(sampler.random(runs))


@dataclass(frozen=True)
class Design:
    """A product of blocks.

    Attributes
    ----------
    blocks
        The first varies slowest; none gives one run.
    """

    blocks: tuple[Block, ...] = ()

    def __post_init__(self) -> None:
        """Check that each variable is varied once, and the number of runs."""
        names = [name for block in self.blocks for name in block.variables]
        problems = [f"{name}: expected in one block, got in several" for name in names if names.count(name) > 1]
        if self.runs > MAX_RUNS:
            problems.append(f"runs: expected at most {MAX_RUNS}, got {self.runs}")
        if problems:
            raise SetupError(*dict.fromkeys(problems))

    @property
    def runs(self) -> int:
        """Number of runs of the design."""
        return math.prod(block.runs for block in self.blocks)

    @property
    def variables(self) -> dict[str, Variable]:
        """Name of each variable to it."""
        return {name: each for block in self.blocks for name, each in block.variables.items()}

    def point(self, index: int) -> Point:
        """Return the values of all variables in a run.

        Parameters
        ----------
        index
            Of the run, from 0.

        Examples
        --------
        >>> mass, gain = (Variable(Values(values)) for values in ((55.0, 80.0), ("a", "b", "c")))
        >>> Design((Block({"mass": mass}), Block({"gain": gain}))).point(4)
        {'mass': 80.0, 'gain': 'b'}
        """
        parts: list[Point] = []
        for block in reversed(self.blocks):
            index, place = divmod(index, block.runs)
            parts.append(block.point(place))
        return {name: value for part in reversed(parts) for name, value in part.items()}

    def points(self, indices: Iterable[int]) -> list[Point]:
        """Return the values of all variables in several runs.

        Parameters
        ----------
        indices
            Of the runs.
        """
        return [self.point(index) for index in indices]

    def corners(self) -> Iterator[tuple[str, Point]]:
        """Yield points in which each variable has each of its values, or both ends of its range.

        Yields
        ------
        tuple
            Name of the variable, and the point; the others have their values of the first run.
        """
        first = self.point(0)
        for block in self.blocks:
            samples = [dict(sample) for sample in block.samples]
            points = [{name: value} for name, each in block.variables.items() for value in each.domain.extremes]
            for point in samples if block.design == "samples" else points:
                yield ", ".join(f"{name} = {value}" for name, value in point.items()), {**first, **point}
