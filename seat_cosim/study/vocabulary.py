"""What the words of a study of the seat suspension mean: its choices, and the metrics of a ride."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

from cosim.errors import SetupError, did_you_mean
from cosim.fmi.values import Scalar, Value
from cosim.metrics import peak
from cosim.metrics.samples import trim
from cosim.results.result import Result
from cosim.sweep.vocabulary import Vocabulary
from cosim.system import System
from seat_cosim import carried, choices
from seat_cosim.evaluation.results import RideResult
from seat_cosim.evaluation.runner import measure
from seat_cosim.evaluation.seat import SIGNALS
from seat_cosim.evaluation.system import EvaluatedSystem, SignalMap
from seat_cosim.scenarios import SCENARIOS, floor_of

_OF_RIDE = {
    "a_w": "m/s2",
    "vdv": "m/s^1.75",
    "mtvv": "m/s2",
    "crest_factor": "1",
    "floor_a_w": "m/s2",
    "seat": "1",
    "seat_vdv": "1",
    "peak_acceleration": "m/s2",
}
"""Metrics of each ride to their units."""

_OF_SUSPENSION = {"peak_deflection": "m", "mean_deflection": "m", "end_stop_hits": "1", "impact_share": "1"}
"""Metrics of a system with a suspension deflection."""

_OF_ACTUATOR = {"force_rms": "N", "driving_power": "W", "saturated_share": "1"}
"""Metrics of a system with an actuator, too."""


class SeatVocabulary(Vocabulary):
    """Choices of :mod:`seat_cosim.choices` and a scenario; the metrics of an evaluation."""

    words: ClassVar[dict[str, str]] = {
        "scenario": "",
        "mode": "",
        "gains": "",
        "observer": "",
        "control": "",
        "parameter_sets": "",
        "driver_mass": "kg",
    }
    metrics: ClassVar[dict[str, str]] = {**_OF_RIDE, **_OF_SUSPENSION, **_OF_ACTUATOR}
    figures = ("masses", "tolerance", "mismatch", "imperfections", "pareto")

    def __init__(self) -> None:
        self._loaded: dict[tuple[str, Scalar], dict[str, Value]] = {}
        self._signals: dict[int, SignalMap] = {}

    def __getstate__(self) -> dict[str, Any]:
        """Return what travels to a worker: not the maps of this process's objects."""
        return {**vars(self), "_signals": {}}

    def system_file(self, name: str, folder: Path) -> Path:
        """Return the file of a system, by the name of one of this project or a path.

        Parameters
        ----------
        name
            Name or path in a study.
        folder
            Folder in which relative paths start.
        """
        return carried.ssp(name) if _is_name(name, folder) else folder / Path(name).expanduser()

    def fmu(self, name: str, folder: Path) -> Path:
        """Return the file of an FMU, by the name of one of this project or a path.

        Parameters
        ----------
        name
            Name or path in a study.
        folder
            Folder in which relative paths start.
        """
        return carried.fmu(name) if _is_name(name, folder) else folder / Path(name).expanduser()

    def load(self, word: str, value: Scalar, system: System, folder: Path) -> None:
        """Read gains and parameter sets, and check the other choices.

        Parameters
        ----------
        word, value
            The choice.
        system
            The system that it is for.
        folder
            Folder in which relative paths start.
        """
        if word == "scenario":
            _scenario(value)
            if (floor := SCENARIOS[str(value)].floor) not in system.models:
                have = ", ".join(system.models)
                raise SetupError(f"scenario {value}: expected a system with a component {floor}, got one of {have}")
        elif word == "driver_mass":
            if isinstance(value, bool | str) or not value > 0.0:
                raise SetupError(f"driver_mass: expected a number above 0 kg, got {value}")
        elif word == "mode":
            choices.parameters({word: value}, {}, system)
        else:
            names = [name.strip() for name in str(value).split(",")] if word == "parameter_sets" else [str(value)]
            found = [name if _is_name(name, folder) else str(folder / Path(name).expanduser()) for name in names]
            self._loaded[word, value] = choices.choice(word, ",".join(found), system)

    def content(self) -> str:
        """Return the parameters of all gains, parameter sets and other choices."""
        return repr(sorted(self._loaded.items(), key=repr))

    def default_stop_time(self, words: Mapping[str, Scalar]) -> float | None:
        """Return the stop time of the scenario in s; None where there is none.

        Parameters
        ----------
        words
            Choice to value.
        """
        return SCENARIOS[str(words["scenario"])].stop_time if "scenario" in words else None

    def parameters(self, words: Mapping[str, Scalar], given: Mapping[str, Value], system: System) -> dict[str, Value]:
        """Return the parameters of the scenario, of the choices in their order, and what is given; later ones win.

        Parameters
        ----------
        words
            Choice to value.
        given
            Parameters that the study sets, as ``component.variable``.
        system
            The system.
        """
        scenario = _scenario(words["scenario"]) if "scenario" in words else {}
        return scenario | choices.parameters(words, given, system, {**system.parameters, **scenario}, self._read)

    def _read(self, word: str, value: Any, system: Any) -> Mapping[str, Value]:
        return self._loaded[word, value] if (word, value) in self._loaded else choices.choice(word, value, system)

    def default_metrics(self, system: System) -> tuple[str, ...]:
        """Return all metrics that the signals of a system give.

        Parameters
        ----------
        system
            The system.
        """
        signals = self._signal_map(system)
        outputs = system.outputs()
        if not {signals.seat_acceleration, signals.floor_acceleration} <= set(outputs):
            return ()
        found = dict(_OF_RIDE)
        if signals.suspension_deflection is not None:
            found |= _OF_SUSPENSION
            found |= {} if signals.actuator_force is None else _OF_ACTUATOR
        return tuple(found)

    def signals(self, metrics: Sequence[str], system: System) -> list[str]:
        """Return the outputs of the evaluation that the system has.

        Parameters
        ----------
        metrics
            Names of metrics.
        system
            The system.
        """
        signals, outputs = self._signal_map(system), system.outputs()
        for name in (signals.seat_acceleration, signals.floor_acceleration):
            if name not in outputs:
                raise SetupError(
                    f"metric {metrics[0]}: expected an output {name} of {system.name}, got none"
                    f"{did_you_mean(name, outputs)}; functions such as rms(A.x) take any output"
                )
        return list(signals.outputs)

    def _signal_map(self, system: System) -> SignalMap:
        """Return the signal map of a system, without optional signals that it does not have."""
        known = self._signals.get(id(system.models))
        if known is None:
            known = self._signals[id(system.models)] = SIGNALS[floor_of(system.models)]().within(system)
        return known

    def measure(
        self, metrics: Sequence[str], system: System, result: Result, rate: float, warm_up: float
    ) -> dict[str, float | None]:
        """Compute the metrics of a ride by the evaluation's own functions.

        Parameters
        ----------
        metrics
            Names of metrics.
        system
            The system, with all parameters of the run.
        result
            Its result.
        rate
            Rows per second.
        warm_up
            Time at the beginning that is not evaluated, in s.

        Returns
        -------
        dict
            Name of each metric to its value; None where the system does not have it.
        """
        evaluated = _Ridden(system.name, system, self._signal_map(system))
        found = _of_ride(measure(evaluated, result, rate, warm_up))
        if "peak_acceleration" in metrics:
            name = evaluated.signals.seat_acceleration
            driver = evaluated.in_si_units(name, result[name])
            found["peak_acceleration"] = peak(trim(driver, rate, warm_up, name=name))
        return {name: found[name] for name in metrics}


class _Ridden(EvaluatedSystem):
    """A system after a run, which has checked its parameters: they are not checked again for each metric."""

    def _number(self, name: str) -> float:
        value = self.system.parameters.get(name)
        return self.system.start(name) if value is None else float(value)  # type: ignore[arg-type]  # a number


def _is_name(name: str, folder: Path) -> bool:
    """Whether a text is a bare name, not that of a file."""
    path = Path(name)
    return path == Path(path.name) and not path.suffix and not (folder / path).is_file()


def _scenario(value: Scalar) -> dict[str, Value]:
    """Return the parameters of a scenario."""
    if str(value) not in SCENARIOS:
        raise SetupError(
            f"scenario: expected one of {', '.join(SCENARIOS)}, got {value}{did_you_mean(str(value), SCENARIOS)}"
        )
    return dict(SCENARIOS[str(value)].parameters)


def _of_ride(ride: RideResult) -> dict[str, float | None]:
    """Return the metrics of a ride by their names."""
    found: dict[str, float | None] = {name: getattr(ride, name) for name in (*_OF_SUSPENSION, *_OF_ACTUATOR)}
    found |= {name: getattr(ride.seat, name) for name in ("a_w", "vdv", "mtvv", "crest_factor")}
    return found | {"floor_a_w": ride.floor.a_w, "seat": ride.seat_rms, "seat_vdv": ride.seat_vdv}
