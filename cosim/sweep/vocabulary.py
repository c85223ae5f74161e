"""What the words of a study mean: choices beside parameters, and metrics of a run.

The vocabulary of this module knows no field: its metrics are functions of single signals, such as ``rms(seat.force)``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from cosim.errors import SetupError, did_you_mean
from cosim.fmi.values import Scalar, Value
from cosim.metrics.samples import Samples, trim
from cosim.results.result import Result
from cosim.system import System

FUNCTIONS: dict[str, Callable[[Samples], Any]] = {
    "rms": lambda x: np.sqrt(np.mean(x**2)),
    "peak": lambda x: np.max(np.abs(x)),
    "mean": np.mean,
    "min": np.min,
    "max": np.max,
    "range": np.ptp,
    "final": lambda x: x[-1],
}
"""Functions of a signal, without the warm-up."""

_FUNCTION = re.compile(r"(\w+)\((.+)\)")


@dataclass(frozen=True)
class SignalMetric:
    """A metric of one signal.

    Attributes
    ----------
    function
        Name from :data:`FUNCTIONS`.
    signal
        Output, as ``component.variable``.
    """

    function: str
    signal: str

    @classmethod
    def parse(cls, text: str) -> SignalMetric | None:
        """Read ``function(component.variable)``; None for another text.

        Parameters
        ----------
        text
            The text.

        Returns
        -------
        SignalMetric or None
            The metric.

        Raises
        ------
        SetupError
            If there is no such function.
        """
        found = _FUNCTION.fullmatch(text.strip())
        if found is None:
            return None
        function, signal = found.groups()
        if function not in FUNCTIONS:
            known = ", ".join(FUNCTIONS)
            raise SetupError(
                f"metric {text}: expected a function among {known}, got {function}{did_you_mean(function, FUNCTIONS)}"
            )
        return cls(function, signal)

    def of(self, result: Result, rate: float, warm_up: float) -> float:
        """Return the metric of a run.

        Parameters
        ----------
        result
            Result of the run.
        rate
            Rows per second.
        warm_up
            Time at the beginning that is left out, in s.
        """
        samples = trim(result[self.signal], rate, warm_up, name=self.signal)
        return float(FUNCTIONS[self.function](samples))


class Vocabulary:
    """Choices and metrics of any system: none but functions of its signals.

    A vocabulary travels to the workers; what it reads from files, it reads in :meth:`load`.
    """

    words: ClassVar[Mapping[str, str]] = {}
    """Choice, which a study fixes or varies by this name, to its unit; empty where it has none."""

    metrics: ClassVar[Mapping[str, str]] = {}
    """Metric to its unit, ``"1"`` where it has none."""

    figures: ClassVar[tuple[str, ...]] = ()
    """Names of the figures that a study may ask for."""

    def system_file(self, name: str, folder: Path) -> Path:
        """Return the file of a system.

        Parameters
        ----------
        name
            Name or path in a study.
        folder
            Folder in which relative paths start.
        """
        return folder / Path(name).expanduser()

    def fmu(self, name: str, folder: Path) -> Path:
        """Return the file of an FMU.

        Parameters
        ----------
        name
            Name or path in a study.
        folder
            Folder in which relative paths start.
        """
        return folder / Path(name).expanduser()

    def load(self, word: str, value: Scalar, system: System, folder: Path) -> None:
        """Read what a choice needs, before any run.

        Parameters
        ----------
        word, value
            The choice.
        system
            The system that it is for.
        folder
            Folder in which relative paths start.

        Raises
        ------
        SetupError
            If there is no such choice.
        """

    def content(self) -> str:
        """Return what was read in :meth:`load`, as a text that differs where it differs."""
        return ""

    def default_stop_time(self, words: Mapping[str, Scalar]) -> float | None:
        """Return the stop time in s that choices suggest; None where they do not.

        Parameters
        ----------
        words
            Choice to value.
        """
        return None

    def parameters(self, words: Mapping[str, Scalar], given: Mapping[str, Value], system: System) -> dict[str, Value]:
        """Return all parameters of a run.

        Parameters
        ----------
        words
            Choice to value.
        given
            Parameters that the study sets, as ``component.variable``; they win.
        system
            The system.
        """
        return dict(given)

    def default_metrics(self, system: System) -> tuple[str, ...]:
        """Return the metrics of a study that names none.

        Parameters
        ----------
        system
            The system.
        """
        return ()

    def signals(self, metrics: Sequence[str], system: System) -> list[str]:
        """Return the outputs that metrics of :attr:`metrics` need.

        Parameters
        ----------
        metrics
            Names of metrics.
        system
            The system.

        Raises
        ------
        SetupError
            If the system has none of them.
        """
        return []

    def measure(
        self, metrics: Sequence[str], system: System, result: Result, rate: float, warm_up: float
    ) -> dict[str, float | None]:
        """Compute metrics of a run.

        Parameters
        ----------
        metrics
            Names of metrics; those that a run does not have may be left out.
        system
            The system, with all parameters of the run.
        result
            Its result, which reached the stop time.
        rate
            Rows per second.
        warm_up
            Time at the beginning that is not evaluated, in s.

        Returns
        -------
        dict
            Name of each metric to its value; None where the run does not have it.

        Raises
        ------
        SignalError
            If a metric cannot be computed.
        """
        return {}
